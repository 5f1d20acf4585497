// A calibration in its folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/calibrate.h"

namespace hookeye {

/// What cameras.yaml says. Throws InputError where no capture would take it.
std::string calibration_yaml(const Calibration& calibration, const std::string& unit);

struct CalibrationFiles {
  std::filesystem::path cameras;            ///< cameras.yaml
  std::filesystem::path covariance;         ///< camera_covariance.yaml
  std::filesystem::path numbers;            ///< calibration.json
  std::vector<std::filesystem::path> maps;  ///< corners_NAME.svg
};
/// Writes them; cameras.yaml last. Throws InputError: no capture would take it, somebody wrote
/// one of the first two there by hand, or the folder cannot be written.
CalibrationFiles write_calibration(const Calibration& calibration, const std::string& unit,
                                   const std::filesystem::path& folder);

}  // namespace hookeye
