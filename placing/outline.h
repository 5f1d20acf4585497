// The outline of the body in a photo, or of the model in a picture of it, as a signed distance.
#pragma once

#include <string>
#include <vector>

#include "capture_io/camera.h"
#include "estimation/model/model.h"

namespace hookeye {

/// Distance to the outline of a mask [px]: positive outside, half a pixel in the pixels beside it.
class SignedDistance {
 public:
  SignedDistance() = default;
  /// `inside` per pixel; neither all nor none of them.
  SignedDistance(const std::vector<unsigned char>& inside, int width, int height);
  /// Bilinear; beyond the picture it grows by the distance to it.
  double at(const Eigen::Vector2d& pixel) const;
  Eigen::Vector2d slope(const Eigen::Vector2d& pixel) const;

 private:
  double value(int x, int y) const;
  int width_ = 0, height_ = 0;
  std::vector<float> values_;
};

/// Pixels inside that have a neighbour outside, not on the picture's border, where `counts` (may be
/// empty) holds for the pixel and those about it.
std::vector<int> rim_of(const std::vector<unsigned char>& inside, int width, int height,
                        const std::vector<unsigned char>& counts);

/// By pixel the nearest of `pixels`, as an index into it.
std::vector<int> nearest_of(const std::vector<int>& pixels, int width, int height);

/// What a photo of the body at rest shows of its outline, at one size.
struct Outline {
  std::string camera, example;
  bool image = false;  ///< told by brightness; false: a silhouette
  Camera view;         ///< at this size, in the body's frame as told
  double px = 1.0;     ///< px of the photo in one of these
  std::vector<unsigned char> inside, counts;
  SignedDistance distance;
  std::vector<int> rim;
  Eigen::Vector2d centre;  ///< of what is inside
  double spread = 0.0;     ///< standard deviation of it, over both directions [px]
};

/// Of every camera the first photo at rest that shows its body, at most `look_px` long. `why_not`
/// (may be null) receives a sentence for each photo at rest whose outline cannot be told.
std::vector<Outline> outlines_of(const Scene& scene, int look_px,
                                 std::vector<std::string>* why_not);

}  // namespace hookeye
