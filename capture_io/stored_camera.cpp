#include "capture_io/stored_camera.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "capture_io/camera_pose.h"

namespace hookeye {
namespace {

void read_intrinsics(const StoredFile& from, const StoredKeys& keys, Camera& camera) {
  const StoredFile::Named matrix = from.find(keys.matrix);
  if (!matrix) from.fail("there is no camera matrix", "the key `camera_matrix` or `K` is read");
  const std::vector<double>& k = from.matrix(matrix).numbers;
  if (k.size() != 9)
    from.fail(matrix, fmt::format("`{}` has {} numbers", matrix.name, k.size()),
              "a 3 x 3 matrix is expected");
  camera.fx = k[0], camera.fy = k[4], camera.cx = k[2], camera.cy = k[5];
  if (!(camera.fx > 0) || !(camera.fy > 0))
    from.fail(matrix, fmt::format("the focal lengths are {} and {} px", camera.fx, camera.fy),
              "both must be above zero");
  camera.skew = k[1];
}

/// OpenCV's flag, or the name that ROS and Kalibr give the distortion.
void read_model(const StoredFile& from, Camera& camera) {
  const StoredFile::Named flag = from.find({"fisheye_model"});
  if (flag && from.number(flag) != 0) {
    camera.model = &camera_model("fisheye");
    return;
  }
  const StoredFile::Named told = from.find({"distortion_model"});
  if (!told) return;
  const std::string& name = told.value->text;
  const auto is = [&](std::initializer_list<const char*> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (is({"equidistant", "fisheye"}))
    camera.model = &camera_model("fisheye");
  else if (!is({"plumb_bob", "rational_polynomial", "thin_prism", "radtan", "none"}))
    from.fail(
        told,
        fmt::format("`{}` is {}", told.name,
                    told.value->kind == StoredValue::Kind::text ? "`" + name + "`" : "no name"),
        "one of plumb_bob, rational_polynomial, thin_prism, radtan, none, and of a fisheye "
        "equidistant or fisheye is expected");
}

void read_distortion(const StoredFile& from, const StoredKeys& keys, Camera& camera) {
  const StoredFile::Named told = from.find(keys.distortion);
  if (!told) return;
  camera.distortion = from.matrix(told).numbers;
  if (!camera.model->takes(camera.distortion.size()))
    from.fail(told, fmt::format("`{}` has {} coefficients", told.name, camera.distortion.size()),
              camera.model->count_rule());
}

void read_size(const StoredFile& from, Camera& camera) {
  const StoredFile::Named w = from.find({"image_width", "image_Width", "width"}),
                          h = from.find({"image_height", "image_Height", "height"}),
                          s = from.find({"image_size", "imageSize", "size"});
  double width = 0, height = 0;
  if (w && h) {
    width = from.number(w), height = from.number(h);
  } else if (s) {
    const std::vector<double>& size = from.matrix(s).numbers;
    if (size.size() != 2)
      from.fail(s, fmt::format("`{}` has {} numbers", s.name, size.size()),
                "width and height are expected");
    width = size[0], height = size[1];
  } else {
    return;
  }
  if (!(width >= 1 && width <= 100000 && height >= 1 && height <= 100000) ||
      width != std::floor(width) || height != std::floor(height))
    from.fail(w ? w : s, fmt::format("the picture size is {} x {}", width, height),
              "whole numbers of pixels from 1 to 100000 are expected");
  camera.width = static_cast<int>(width), camera.height = static_cast<int>(height);
}

}  // namespace

bool read_stored_pose(const StoredFile& from, Camera& camera) {
  const StoredFile::Named rotation = from.find({"R", "rotation", "rotation_matrix", "rvec"}),
                          shift =
                              from.find({"T", "t", "translation", "translation_vector", "tvec"});
  if (!rotation && !shift) return false;
  if (!rotation || !shift)
    from.fail("the pose is incomplete", "both rotation `R` and translation `T` are needed");
  const std::vector<double>&r = from.matrix(rotation).numbers, &t = from.matrix(shift).numbers;
  if (t.size() != 3)
    from.fail(shift, fmt::format("`{}` has {} numbers", shift.name, t.size()),
              "three are expected");
  camera.t = Eigen::Map<const Eigen::Vector3d>(t.data());
  if (r.size() == 3) {
    const Eigen::Map<const Eigen::Vector3d> w(r.data());
    // None is longer than pi: beyond two of these it is no slip of a sign.
    if (w.norm() > 2.0 * std::numbers::pi)
      from.fail(
          rotation,
          fmt::format("`{}` turns by {:.4g} rad, more than a whole turn", rotation.name, w.norm()),
          "a rotation vector is in radians: multiply degrees by pi/180");
    if (w.norm() > 0) camera.R = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
  } else if (r.size() == 9) {
    camera.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r.data());
    const std::string fault = make_rotation(camera.R);
    if (!fault.empty())
      from.fail(rotation, fmt::format("`{}` {}", rotation.name, fault), rotation_rule);
  } else {
    from.fail(rotation, fmt::format("`{}` has {} numbers", rotation.name, r.size()),
              "nine (a matrix) or three (a rotation vector) are expected");
  }
  return true;
}

Camera stored_camera(const StoredFile& from, const StoredKeys& keys) {
  Camera camera;
  read_intrinsics(from, keys, camera);
  read_model(from, camera);
  read_distortion(from, keys, camera);
  read_size(from, camera);
  return camera;
}

Camera read_opencv_calibration(const std::filesystem::path& file, bool* has_pose) {
  const StoredFile from(file);
  Camera camera = stored_camera(from);
  camera.name = file.stem().string();
  const bool posed = read_stored_pose(from, camera);
  if (has_pose) *has_pose = posed;
  return camera;
}

}  // namespace hookeye
