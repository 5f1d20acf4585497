// transforms.json of nerfstudio, instant-ngp and Blender's exporters: one camera a frame.
//
// transform_matrix maps camera to world, the camera's axes are OpenGL's (x right, y up, z back):
//   x_world = M diag(1, -1, -1) x_in_camera + c. The centre of the first pixel is (0.5, 0.5).
// Lens: OpenCV's k1 k2 p1 p2 k3, or cv::fisheye's k1 .. k4.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json_file.h"
#include "importers/detail.h"

namespace hookeye {
namespace {

using nlohmann::json;

/// A frame's own value, else the file's.
const json* find(const json& frame, const json& all, const char* key) {
  if (frame.contains(key)) return &frame[key];
  return all.contains(key) ? &all[key] : nullptr;
}

class Frame {
 public:
  Frame(const json& frame, const json& all, std::string file, size_t index)
      : frame_(frame), all_(all), file_(std::move(file)), index_(index) {}

  [[noreturn]] void fail(const std::string& wrong, const std::string& right) const {
    throw InputError({file_}, fmt::format("frame {}: {}", index_, wrong), right);
  }
  bool has(const char* key) const { return find(frame_, all_, key) != nullptr; }
  double number(const char* key, double otherwise) const {
    const json* value = find(frame_, all_, key);
    if (!value) return otherwise;
    if (!value->is_number()) fail(fmt::format("`{}` is no number", key), "a number");
    return value->get<double>();
  }
  std::string text(const char* key) const {
    const json* value = find(frame_, all_, key);
    return value && value->is_string() ? value->get<std::string>() : "";
  }
  bool flag(const char* key) const {
    const json* value = find(frame_, all_, key);
    return value && value->is_boolean() && value->get<bool>();
  }

  Camera camera() const {
    Camera camera;
    read_size(camera);
    read_lens(camera);
    read_focal(camera);
    camera.cx = number("cx", camera.width / 2.0), camera.cy = number("cy", camera.height / 2.0);
    detail::move_pixel_centre(camera);
    read_pose(camera);
    return camera;
  }

 private:
  void read_size(Camera& camera) const {
    const double w = number("w", 0), h = number("h", 0);
    if (w != std::floor(w) || h != std::floor(h) || w < 1 || h < 1 || w > 100000 || h > 100000)
      fail(fmt::format("the picture size `w`, `h` is {} x {}", w, h),
           "write \"w\" and \"h\" of the photos [px] at the top of the file");
    camera.width = static_cast<int>(w), camera.height = static_cast<int>(h);
  }

  void read_focal(Camera& camera) const {
    const auto of_angle = [&](const char* key, int side) {
      const double half = number(key, 0) / 2;
      return half > 0 && half < 1.57 ? side / 2.0 / std::tan(half) : 0;
    };
    camera.fx = number("fl_x", of_angle("camera_angle_x", camera.width));
    camera.fy = number("fl_y", of_angle("camera_angle_y", camera.height));
    if (!(camera.fy > 0) && !has("fl_y")) camera.fy = camera.fx;
    if (!(camera.fx > 0) && !has("fl_x")) camera.fx = camera.fy;
    if (!(camera.fx > 0 && camera.fy > 0))
      fail("there is no focal length", "`fl_x` [px], or `camera_angle_x` [rad]");
  }

  void read_lens(Camera& camera) const {
    const std::string model = text("camera_model");
    const double k[] = {number("k1", 0), number("k2", 0), number("k3", 0), number("k4", 0)};
    const double p1 = number("p1", 0), p2 = number("p2", 0);
    if (model == "OPENCV_FISHEYE" || flag("is_fisheye")) {
      if (p1 != 0 || p2 != 0) fail("a fisheye has p1 or p2", "k1 .. k4 alone");
      camera.model = &camera_model("fisheye");
      camera.distortion = {k[0], k[1], k[2], k[3]};
      return;
    }
    const bool known = model.empty() || model == "OPENCV" || model == "PINHOLE" ||
                       model == "SIMPLE_PINHOLE" || model == "PERSPECTIVE";
    if (!known)
      fail(fmt::format("camera_model is `{}`", model),
           "OPENCV, PINHOLE, SIMPLE_PINHOLE or OPENCV_FISHEYE is read");
    if (k[3] != 0)
      fail("`k4` is not zero, and no camera of a capture has this term",
           "calibrate with k1, k2, k3, p1, p2");
    camera.distortion = {k[0], k[1], p1, p2, k[2]};
  }

  void read_pose(Camera& camera) const {
    std::vector<std::vector<double>> rows;
    try {
      rows = frame_.at("transform_matrix").get<std::vector<std::vector<double>>>();
    } catch (const json::exception&) {
      fail("there is no `transform_matrix`", "four rows of four numbers");
    }
    const detail::Motion world_from_gl =
        detail::motion_of(rows, {file_}, fmt::format("frame {}: transform_matrix", index_));
    const Eigen::Matrix3d world_from_camera =
        world_from_gl.R * Eigen::Vector3d(1, -1, -1).asDiagonal();
    camera.R = world_from_camera.transpose();
    camera.t = -camera.R * world_from_gl.t;
  }

  const json& frame_;
  const json& all_;
  std::string file_;
  size_t index_;
};

class Transforms final : public Importer {
 public:
  std::string name() const override { return "transforms"; }
  std::string title() const override {
    return "transforms.json of nerfstudio, instant-ngp or Blender";
  }
  bool recognises(const Sources& sources) const override {
    const std::string head = detail::head_of(sources.front());
    return detail::has_ending(sources.front(), {".json"}) &&
           (head.find("\"transform_matrix\"") != std::string::npos ||
            head.find("\"frames\"") != std::string::npos);
  }

  Imported read(const Sources& sources, const ImportOptions&) const override {
    const std::filesystem::path& file = detail::only_one(sources);
    const json all = read_json(file);
    if (!all.is_object() || !all.contains("frames") || !all["frames"].is_array())
      throw InputError({file.string()}, "there is no list `frames`",
                       "a transforms.json with one entry a photo");
    Imported out;
    std::vector<std::string> paths;
    for (size_t i = 0; i < all["frames"].size(); ++i) {
      const json& one = all["frames"][i];
      const Frame frame(one, all, file.string(), i);
      if (!one.is_object())
        frame.fail("it is no map", "{\"file_path\": .., \"transform_matrix\": ..}");
      const std::string path = frame.text("file_path");
      paths.push_back(path.empty() ? fmt::format("frame_{}", i) : path);
      out.cameras.push_back(frame.camera());
    }
    const std::vector<std::string> names = detail::photo_names(paths);
    for (size_t i = 0; i < names.size(); ++i) out.cameras[i].name = names[i];
    out.world = "the file's own frame";
    out.said.push_back(
        "the file tells no unit: --scale takes the length of the capture that its unit measures; "
        "body and cameras must be brought into one frame");
    return out;
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_IMPORTER(transforms, Transforms)
