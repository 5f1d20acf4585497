#include "calibration/files.h"

#include "calibration/output.h"
#include "capture_io/cameras_file.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {

std::string calibration_yaml(const Calibration& calibration, const std::string& unit) {
  const std::string title = calibration.bundle.board.title();
  return calibrated_cameras_yaml(calibration, head_line(kCamerasMark + ("calibrate " + title)) +
                                                  head_line("# the world is " + calibration.world) +
                                                  head_line("# lengths are in " + unit));
}

CalibrationFiles write_calibration(const Calibration& calibration, const std::string& unit,
                                   const std::filesystem::path& folder) {
  CalibrationFiles files{folder / "cameras.yaml", folder / "calibration.json", {}};
  refuse_to_overwrite_cameras(files.cameras);
  const std::string yaml = calibration_yaml(calibration, unit);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw cannot_write(folder.string(), error.message());
  for (size_t c = 0; c < calibration.bundle.cameras.size(); ++c) {
    files.maps.push_back(folder / ("corners_" + calibration.bundle.cameras[c].name + ".svg"));
    write_text(files.maps.back(), corner_map(calibration, c));
  }
  write_text(files.numbers, calibration_json(calibration, unit).dump(1) + "\n");
  write_text(files.cameras, yaml);
  return files;
}

}  // namespace hookeye
