#include "capture_io/camera.h"
#include "capture_io/helper.h"
#include "capture_io/parcels.h"

namespace hookeye {

Camera read_opencv_calibration(const std::filesystem::path& file, bool* has_pose) {
  HelperRequest wanted;
  wanted.name = "calibration";
  wanted.content = Packer().put(file.string()).take();
  wanted.limits = limits_for(file);
  wanted.place.file = file.string();
  wanted.right = "write it with cv::FileStorage (yml, xml or json)";
  wanted.damaged = "this is not an OpenCV file: its reader breaks off";
  const auto [camera, posed] = ask_helper(wanted, [](Unpacker& from) {
    Camera read = unpack_camera(from);
    return std::pair{std::move(read), from.take<bool>()};
  });
  if (has_pose) *has_pose = posed;
  return camera;
}

}  // namespace hookeye
