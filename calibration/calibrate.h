// Cameras from photos of a board: the whole of `hookeye calibrate`.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibration/bundle.h"
#include "calibration/photos.h"

namespace hookeye {

struct CalibrateOptions {
  int lens = 5;       ///< numbers of the lens: 0, 4, 5 or 8, in OpenCV's order
  std::string frame;  ///< a photo whose board is the world's frame; "": the first camera is
  /// Told after each photo: how many are done, of how many, the photo and what was found.
  std::function<void(size_t done, size_t of)> progress;
  const std::atomic<bool>* cancel = nullptr;  ///< looked at before each photo
  bool stopped() const { return cancel && cancel->load(); }
};

/// What came of one photo.
struct PhotoResult {
  BoardPhoto photo;
  size_t corners = 0, used = 0;
  double rms_px = 0;           ///< of used corners, over x and y together
  std::string why;             ///< where it does not count
  std::optional<size_t> view;  ///< index into Bundle::views
};

struct Calibration {
  Bundle bundle;
  BundleCovariance errors;
  PhotoList list;
  std::vector<PhotoResult> photos;
  std::vector<double> rms_px;  ///< of each camera
  size_t corners = 0, dropped = 0;
  std::string world;                  ///< where the world's frame stands
  std::vector<std::string> said;      ///< what the user is to know
  std::vector<std::string> warnings;  ///< what makes the result doubtful
};

/// The dictionary of a ChArUco board that has none is found first (find_dictionary()). Throws
/// InputError: photos, board or options that do not go together; photos that leave the cameras
/// open. Interrupted where `cancel` is set.
Calibration calibrate(const Board& board, const std::vector<CameraPhotos>& cameras,
                      const CalibrateOptions& options);

/// What makes a calibration doubtful, a sentence each.
std::vector<std::string> doubts(const Calibration& calibration);

}  // namespace hookeye
