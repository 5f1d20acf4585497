// ROS camera_info in yaml, as camera_calibration writes it: one file a camera.
//
// sensor_msgs/CameraInfo: K and D as OpenCV's; R turns the camera's axes into those of the
// rectified picture; P = [fx' 0 cx' Tx; 0 fy' cy' Ty; 0 0 1 0], where (Tx / fx', Ty / fy', 0) moves
// points from the first camera's rectified axes into this one's. Hence, with x in the rectified
// axes of the first,
//   x_in_camera = R^T (x + (Tx / fx', Ty / fy', 0)).
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "capture_io/camera_pose.h"
#include "capture_io/stored_camera.h"
#include "importers/detail.h"

namespace hookeye {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

std::vector<double> numbers(const StoredFile& file, const char* key, size_t count) {
  const StoredFile::Named found = file.find({key});
  if (!found) return {};
  std::vector<double> values = file.matrix(found).numbers;
  if (values.size() != count)
    file.fail(found, fmt::format("`{}` has {} numbers", key, values.size()),
              fmt::format("{} numbers, row by row", count));
  return values;
}

void read_pose(const StoredFile& file, Camera& camera) {
  const std::vector<double> turn = numbers(file, "rectification_matrix", 9),
                            project = numbers(file, "projection_matrix", 12);
  Eigen::Matrix3d rectify = Eigen::Matrix3d::Identity();
  if (!turn.empty()) rectify = Eigen::Map<const RowMajor3>(turn.data());
  const std::string fault = make_rotation(rectify);
  if (!fault.empty())
    file.fail(file.find({"rectification_matrix"}), "`rectification_matrix` " + fault,
              rotation_rule);
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  if (!project.empty() && (project[3] != 0 || project[7] != 0)) {
    if (!(project[0] > 0 && project[5] > 0))
      file.fail(file.find({"projection_matrix"}), "`projection_matrix` has no focal lengths",
                "[fx 0 cx Tx 0 fy cy Ty 0 0 1 0]");
    shift = {project[3] / project[0], project[7] / project[5], 0};
  }
  camera.R = rectify.transpose();
  camera.t = camera.R * shift;
}

class Ros final : public Importer {
 public:
  std::string name() const override { return "ros"; }
  std::string title() const override { return "ROS camera_info (yaml), one file a camera"; }

  bool recognises(const Sources& sources) const override {
    return std::all_of(sources.begin(), sources.end(), [](const auto& file) {
      const std::string head = detail::head_of(file);
      const auto has = [&](const char* key) { return head.find(key) != std::string::npos; };
      return detail::has_ending(file, {".yml", ".yaml"}) && has("camera_matrix") &&
             has("distortion_model") && has("projection_matrix");
    });
  }

  Imported read(const Sources& sources, const ImportOptions&) const override {
    Imported out;
    for (const auto& source : sources) {
      const StoredFile file(source);
      Camera camera = stored_camera(file);
      const StoredFile::Named name = file.find({"camera_name"});
      camera.name = name && !name.value->text.empty() ? name.value->text : source.stem().string();
      read_pose(file, camera);
      for (const Camera& other : out.cameras)
        if ((other.centre() - camera.centre()).norm() == 0)
          file.fail(fmt::format("`{}` and `{}` stand at one place", other.name, camera.name),
                    "calibrate them as a pair: then the fourth column of the second's "
                    "projection_matrix tells the distance");
      out.cameras.push_back(std::move(camera));
    }
    out.world = fmt::format("the rectified axes of {}", out.cameras.front().name);
    out.said.push_back(
        "ROS counts in metres: --scale 1000 makes millimetres of them (or calibrate in the unit of "
        "the capture)");
    return out;
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_IMPORTER(ros, Ros)
