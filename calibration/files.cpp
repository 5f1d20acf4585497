#include "calibration/files.h"

#include "calibration/output.h"
#include "capture_io/camera_covariance.h"
#include "capture_io/cameras_file.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {

namespace {

std::string head_of(const Calibration& calibration) {
  return head_line(kCamerasMark + ("calibrate " + calibration.bundle.board.title())) +
         head_line("# the world is " + calibration.world);
}

}  // namespace

std::string calibration_yaml(const Calibration& calibration, const std::string& unit) {
  return calibrated_cameras_yaml(calibration,
                                 head_of(calibration) + head_line("# lengths are in " + unit));
}

CalibrationFiles write_calibration(const Calibration& calibration, const std::string& unit,
                                   const std::filesystem::path& folder) {
  CalibrationFiles files{
      folder / kCamerasFile, folder / kCovarianceFile, folder / "calibration.json", {}};
  for (const auto& file : {files.cameras, files.covariance}) refuse_to_overwrite_cameras(file);
  const std::string yaml = calibration_yaml(calibration, unit);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw cannot_write(folder.string(), error.message());
  for (size_t c = 0; c < calibration.bundle.cameras.size(); ++c) {
    files.maps.push_back(folder / ("corners_" + calibration.bundle.cameras[c].name + ".svg"));
    write_text(files.maps.back(), corner_map(calibration, c));
  }
  write_text(files.numbers, calibration_json(calibration, unit).dump(1) + "\n");
  write_text(files.covariance, calibrated_covariance_yaml(calibration, unit, head_of(calibration)));
  write_text(files.cameras, yaml);
  return files;
}

}  // namespace hookeye
