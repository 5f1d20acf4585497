// The only file that touches OpenCV's reader. A program of its own: nested deeply enough, a file
// overruns the reader's stack. Numbers are taken from the raw nodes (rows, cols, data) instead of
// cv::Mat, so that plain maps without OpenCV's type tags read as well.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "capture_io/camera.h"
#include "capture_io/camera_pose.h"
#include "capture_io/helper_main.h"
#include "capture_io/parcels.h"
#include "capture_io/run.h"

namespace hookeye {
namespace {

struct Numbers {
  int rows = 0, cols = 0;
  std::vector<double> values;
};

class Calibration {
 public:
  Calibration(const cv::FileStorage& storage, std::string file)
      : storage_(storage), file_(std::move(file)) {}

  /// The first of the names that the file has.
  std::pair<std::string, cv::FileNode> find(const std::vector<std::string>& names) const {
    for (const std::string& name : names) {
      const cv::FileNode node = storage_[name];
      if (!node.empty() && !node.isNone()) return {name, node};
    }
    return {};
  }
  [[noreturn]] void fail(const std::string& wrong, const std::string& right) const {
    throw InputError({file_}, wrong, right);
  }
  double number(const cv::FileNode& node, const std::string& name) const {
    if (!node.isInt() && !node.isReal())
      fail(fmt::format("`{}` holds no number", name), "a finite number is expected");
    const double value = static_cast<double>(node);
    if (!std::isfinite(value))
      fail(fmt::format("`{}` is not finite", name), "a finite number is expected");
    return value;
  }
  /// A matrix {rows, cols, data} or a plain list (a column).
  Numbers numbers(const cv::FileNode& node, const std::string& name) const {
    Numbers result;
    const cv::FileNode data = node.isMap() ? node["data"] : node;
    if (!data.isSeq() || data.size() > 1000)
      fail(fmt::format("`{}` is not a matrix", name),
           "write !!opencv-matrix with rows, cols, data");
    for (const cv::FileNode& item : data) result.values.push_back(number(item, name));
    result.rows = node.isMap() ? static_cast<int>(number(node["rows"], name))
                               : static_cast<int>(result.values.size());
    result.cols = node.isMap() ? static_cast<int>(number(node["cols"], name)) : 1;
    if (static_cast<double>(result.rows) * result.cols != static_cast<double>(result.values.size()))
      fail(fmt::format("`{}` has {} numbers for {} x {}", name, result.values.size(), result.rows,
                       result.cols),
           "rows times cols must be the number of data");
    return result;
  }

 private:
  const cv::FileStorage& storage_;
  std::string file_;
};

void read_intrinsics(const Calibration& from, Camera& camera) {
  const auto [name, node] =
      from.find({"camera_matrix", "K", "cameraMatrix", "Camera_Matrix", "intrinsic_matrix", "M1"});
  if (name.empty())
    from.fail("there is no camera matrix", "the key `camera_matrix` or `K` is read");
  const Numbers k = from.numbers(node, name);
  if (k.values.size() != 9)
    from.fail(fmt::format("`{}` has {} numbers", name, k.values.size()),
              "a 3 x 3 matrix is expected");
  camera.fx = k.values[0], camera.fy = k.values[4], camera.cx = k.values[2],
  camera.cy = k.values[5];
  if (!(camera.fx > 0) || !(camera.fy > 0))
    from.fail(fmt::format("the focal lengths are {} and {} px", camera.fx, camera.fy),
              "both must be above zero");
  camera.skew = k.values[1];
}

/// OpenCV's flag, or the name that ROS and Kalibr give the distortion.
void read_model(const Calibration& from, Camera& camera) {
  const auto [flag_name, flag] = from.find({"fisheye_model"});
  if (!flag_name.empty() && from.number(flag, flag_name) != 0) {
    camera.model = &camera_model("fisheye");
    return;
  }
  const auto [name, node] = from.find({"distortion_model"});
  if (name.empty()) return;
  const std::string told = node.isString() ? static_cast<std::string>(node) : std::string();
  const auto is = [&](std::initializer_list<const char*> names) {
    return std::find(names.begin(), names.end(), told) != names.end();
  };
  if (is({"equidistant", "fisheye"}))
    camera.model = &camera_model("fisheye");
  else if (!is({"plumb_bob", "rational_polynomial", "thin_prism", "radtan", "none"}))
    from.fail(fmt::format("`{}` is {}", name, told.empty() ? "no name" : "`" + told + "`"),
              "one of plumb_bob, rational_polynomial, thin_prism, radtan, none, and of a fisheye "
              "equidistant or fisheye is expected");
}

void read_distortion(const Calibration& from, Camera& camera) {
  const auto [name, node] = from.find({"distortion_coefficients", "D", "distCoeffs", "dist_coeffs",
                                       "Distortion_Coefficients", "D1"});
  if (name.empty()) return;
  camera.distortion = from.numbers(node, name).values;
  if (!camera.model->takes(camera.distortion.size()))
    from.fail(fmt::format("`{}` has {} coefficients", name, camera.distortion.size()),
              camera.model->count_rule());
}

void read_size(const Calibration& from, Camera& camera) {
  const auto [w_name, w] = from.find({"image_width", "image_Width", "width"});
  const auto [h_name, h] = from.find({"image_height", "image_Height", "height"});
  const auto [s_name, s] = from.find({"image_size", "imageSize", "size"});
  double width = 0, height = 0;
  if (!w_name.empty() && !h_name.empty()) {
    width = from.number(w, w_name), height = from.number(h, h_name);
  } else if (!s_name.empty()) {
    const Numbers size = from.numbers(s, s_name);
    if (size.values.size() != 2)
      from.fail(fmt::format("`{}` has {} numbers", s_name, size.values.size()),
                "width and height are expected");
    width = size.values[0], height = size.values[1];
  } else {
    return;
  }
  if (!(width >= 1 && width <= 100000 && height >= 1 && height <= 100000) ||
      width != std::floor(width) || height != std::floor(height))
    from.fail(fmt::format("the picture size is {} x {}", width, height),
              "whole numbers of pixels from 1 to 100000 are expected");
  camera.width = static_cast<int>(width), camera.height = static_cast<int>(height);
}

bool read_pose(const Calibration& from, Camera& camera) {
  const auto [r_name, r_node] = from.find({"R", "rotation", "rotation_matrix", "rvec"});
  const auto [t_name, t_node] = from.find({"T", "t", "translation", "translation_vector", "tvec"});
  if (r_name.empty() && t_name.empty()) return false;
  if (r_name.empty() || t_name.empty())
    from.fail("the pose is incomplete", "both rotation `R` and translation `T` are needed");
  const Numbers r = from.numbers(r_node, r_name), t = from.numbers(t_node, t_name);
  if (t.values.size() != 3)
    from.fail(fmt::format("`{}` has {} numbers", t_name, t.values.size()), "three are expected");
  camera.t = Eigen::Map<const Eigen::Vector3d>(t.values.data());
  if (r.values.size() == 3) {
    const Eigen::Map<const Eigen::Vector3d> w(r.values.data());
    if (w.norm() > 0) camera.R = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
  } else if (r.values.size() == 9) {
    camera.R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r.values.data());
    const std::string fault = make_rotation(camera.R);
    if (!fault.empty()) from.fail(fmt::format("`{}` {}", r_name, fault), rotation_rule);
  } else {
    from.fail(fmt::format("`{}` has {} numbers", r_name, r.values.size()),
              "nine (a matrix) or three (a rotation vector) are expected");
  }
  return true;
}

Camera read(const std::filesystem::path& file, bool& has_pose) {
  const std::string text = read_text(file);
  if (text.size() > (size_t{16} << 20))
    throw InputError({file.string()}, "the calibration is larger than 16 MiB",
                     "a calibration has a few kilobytes");
  Camera camera;
  camera.name = file.stem().string();
  try {
    cv::FileStorage storage(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
    if (!storage.isOpened())
      throw InputError({file.string()}, "this is not an OpenCV file",
                       "write it with cv::FileStorage (yml, xml or json)");
    const Calibration from(storage, file.string());
    read_intrinsics(from, camera);
    read_model(from, camera);
    read_distortion(from, camera);
    read_size(from, camera);
    has_pose = read_pose(from, camera);
  } catch (const cv::Exception&) {
    throw InputError({file.string()}, "this is not an OpenCV file",
                     "write it with cv::FileStorage (yml, xml or json)");
  }
  return camera;
}

std::string answer(Unpacker& request) {
  bool has_pose = false;
  const Camera camera = read(request.take<std::string>(), has_pose);
  Packer out;
  pack(out, camera);
  return out.put(has_pose).take();
}

}  // namespace
}  // namespace hookeye

int main() { return hookeye::serve(hookeye::answer); }
