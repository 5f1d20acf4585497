// The cameras of the proposal: a calibration, its units, and which photos are whose.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "capture_io/camera.h"
#include "proposal/body_facts.h"
#include "proposal/inventory.h"
#include "proposal/questions.h"

namespace hookeye {

struct ProposedCameras {
  std::string source;  ///< "opencv: intrinsics.yml, extrinsics.yml"
  /// Each with the photos that it took; in the units of the body.
  std::vector<std::pair<Camera, const PhotoSeries*>> cameras;
  /// Of a calibration of `hookeye calibrate`; empty: not known.
  std::filesystem::path covariance;
  double scale = 1.0;  ///< lengths of the body in one of the calibration
  std::vector<std::string> said;
};

/// Throws InputError: no calibration, one that cannot be read, photos of another size, more series
/// of photos than cameras. The series must outlive the result.
ProposedCameras propose_cameras(const Inventory& inventory, const BodyFacts& body,
                                Questions& questions);

}  // namespace hookeye
