// A calibration as files.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "calibration/calibrate.h"

namespace hookeye {

/// The text of cameras.yaml: `head`, then the cameras. Throws InputError where a capture would not
/// take them: a lens that leaves a pixel without a ray.
std::string calibrated_cameras_yaml(const Calibration& calibration, const std::string& head);

/// The text of camera_covariance.yaml: `head`, then how well the cameras' numbers are known.
std::string calibrated_covariance_yaml(const Calibration& calibration, const std::string& unit,
                                       const std::string& head);

/// The content of calibration.json (docs/calibrate.md).
nlohmann::ordered_json calibration_json(const Calibration& calibration, const std::string& unit);

/// A picture (SVG) of all corners that one camera saw, with what is left of each as an arrow,
/// enlarged a hundred times, and how much of the picture they cover.
std::string corner_map(const Calibration& calibration, size_t camera);

}  // namespace hookeye
