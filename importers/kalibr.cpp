// Kalibr's camchain: cam0, cam1, ... each with the map from the camera before it.
//
// x_in_n = T_cn_cnm1 x_in_(n-1), of points; pinhole: [fu fv pu pv]; radtan: OpenCV's k1 k2 p1 p2;
// equidistant: cv::fisheye's k1 k2 k3 k4.
#include <fmt/format.h>

#include "capture_io/yaml_file.h"
#include "importers/detail.h"

namespace hookeye {
namespace {

const YamlNode& need(const YamlNode& camera, const std::string& name, const char* key) {
  const YamlNode* value = camera.find(key);
  if (!value)
    throw InputError(camera.place, fmt::format("`{}` lacks `{}`", name, key),
                     "the whole camchain as Kalibr wrote it");
  return *value;
}

std::vector<double> need_numbers(const YamlNode& camera, const std::string& name, const char* key,
                                 size_t count) {
  const YamlNode& node = need(camera, name, key);
  const std::string what = fmt::format("{} of `{}`", key, name);
  std::vector<double> numbers = read_numbers(node, what);
  if (numbers.size() != count)
    unexpected(node, what, fmt::format("{} numbers are expected", count));
  return numbers;
}

Camera read_camera(const YamlNode& node, const std::string& name) {
  Camera camera;
  camera.name = name;
  const YamlNode& model = need(node, name, "camera_model");
  if (model.text != "pinhole")
    unexpected(model, fmt::format("camera_model of `{}`", name),
               "pinhole is read: calibrate with --models pinhole-radtan or pinhole-equi");
  const std::vector<double> k = need_numbers(node, name, "intrinsics", 4);
  camera.fx = k[0], camera.fy = k[1], camera.cx = k[2], camera.cy = k[3];
  const YamlNode* lens = node.find("distortion_model");
  const std::string told = lens ? lens->text : "none";
  if (told == "equidistant")
    camera.model = &camera_model("fisheye");
  else if (told != "radtan" && told != "none")
    unexpected(*lens, fmt::format("distortion_model of `{}`", name),
               "radtan, equidistant or none is expected");
  if (told != "none") camera.distortion = need_numbers(node, name, "distortion_coeffs", 4);
  const YamlNode& size = need(node, name, "resolution");
  const std::string what = fmt::format("resolution of `{}`", name);
  if (size.items.size() != 2) unexpected(size, what, "[width, height] is expected");
  camera.width = read_integer(size.items[0], what);
  camera.height = read_integer(size.items[1], what);
  return camera;
}

detail::Motion read_motion(const YamlNode& node, const std::string& name) {
  const YamlNode& rows = need(node, name, "T_cn_cnm1");
  const std::string what = fmt::format("T_cn_cnm1 of `{}`", name);
  std::vector<std::vector<double>> numbers;
  for (const YamlNode& row : read_list(rows, what, "four rows of four numbers are expected"))
    numbers.push_back(read_numbers(row, "a row of " + what));
  return detail::motion_of(numbers, rows.place, what);
}

class Kalibr final : public Importer {
 public:
  std::string name() const override { return "kalibr"; }
  std::string title() const override { return "Kalibr's camchain (yaml)"; }

  bool recognises(const Sources& sources) const override {
    const std::string head = detail::head_of(sources.front());
    return detail::has_ending(sources.front(), {".yml", ".yaml"}) &&
           head.find("cam0:") != std::string::npos && head.find("intrinsics") != std::string::npos;
  }

  Imported read(const Sources& sources, const ImportOptions&) const override {
    const std::string file = detail::only_one(sources).string();
    YamlLimits limits;
    limits.holds = "camchain";
    limits.begins = "a camchain begins with `cam0:`";
    const YamlNode root = load_yaml(file, file, limits);
    Imported out;
    for (int n = 0;; ++n) {
      const std::string name = fmt::format("cam{}", n);
      const YamlNode* node = root.find(name);
      if (!node) break;
      Camera camera = read_camera(*node, name);
      if (n > 0) {
        const detail::Motion step = read_motion(*node, name);
        const Camera& last = out.cameras.back();
        camera.R = step.R * last.R;
        camera.t = step.R * last.t + step.t;
      }
      out.cameras.push_back(std::move(camera));
    }
    if (out.cameras.empty()) throw InputError(root.place, "there is no `cam0`", limits.begins);
    out.world = "the axes of cam0";
    out.said.push_back("Kalibr counts in metres: --scale 1000 makes millimetres of them");
    return out;
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_IMPORTER(kalibr, Kalibr)
