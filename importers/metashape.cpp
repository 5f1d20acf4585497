// Cameras as Agisoft Metashape exports them (xml).
//
// Its manual, camera models: axes x right, y down, z ahead; with x = X/Z, y = Y/Z, r^2 = x^2 + y^2
//   x' = x (1 + K1 r^2 + K2 r^4 + K3 r^6 + K4 r^8) + P1 (r^2 + 2 x^2) + 2 P2 x y
//   y' = y (1 + ...) + P2 (r^2 + 2 y^2) + 2 P1 x y
//   u = w/2 + cx + x' f + x' B1 + y' B2, v = h/2 + cy + y' f
// so P1 and P2 are OpenCV's p2 and p1. A fisheye has x, y turned to the angle off the axis before.
// The centre of the first pixel is (0.5, 0.5). <transform> of a camera maps camera to chunk, that
// of its component or chunk, with a scale, chunk to world.
#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <map>

#include "capture_io/camera_pose.h"
#include "core/text_file.h"
#include "core/xml_file.h"
#include "importers/detail.h"
#include "meshing/file_cursor.h"

namespace hookeye {
namespace {

const char* const kMetashapeFile = "cameras as Metashape exports them (File, Export, Cameras: xml)";

class MetashapeReader {
 public:
  explicit MetashapeReader(const std::filesystem::path& file)
      : file_(read_text(file), file.string(), kMetashapeFile) {}

  Imported read() {
    const XmlNode chunk = file_.top().child("chunk");
    if (!chunk) fail(file_.top(), "there is no <chunk>", kMetashapeFile);
    if (chunk.next("chunk"))
      fail(chunk.next("chunk"), "there is a second chunk", "one chunk alone");
    for (const XmlNode& sensor : chunk.child("sensors").all("sensor"))
      sensors_.emplace(sensor.attribute("id"), sensor);
    chunk_ = placed(chunk.child("transform"));
    for (const XmlNode& one : chunk.child("components").all("component"))
      components_.emplace(one.attribute("id"), placed(one.child("transform")));
    size_t lost = 0;
    for (const XmlNode& one : chunk.child("cameras").all("camera")) {
      if (!one.child("transform")) {
        ++lost;
        continue;
      }
      names_.emplace_back(one.attribute("label"));
      out_.cameras.push_back(camera(one));
    }
    if (out_.cameras.empty()) fail(chunk, "there is no aligned camera", kMetashapeFile);
    const std::vector<std::string> names = detail::photo_names(names_);
    for (size_t i = 0; i < names.size(); ++i) out_.cameras[i].name = names[i];
    if (lost > 0)
      out_.said.push_back(fmt::format("{} photos that are not aligned are left out", lost));
    tell_world(chunk);
    return std::move(out_);
  }

 private:
  /// x_in_world = s R x + t.
  struct Placed {
    detail::Motion motion;
    double scale = 1;
    bool told = false;
  };

  [[noreturn]] void fail(const XmlNode& node, const std::string& wrong,
                         const std::string& right) const {
    throw InputError(file_.place(node), wrong, right);
  }

  std::vector<double> values(const XmlNode& node, size_t count) const {
    const std::string_view text = node.text();
    std::vector<double> out;
    for (size_t at = 0; (at = text.find_first_not_of(" \t\r\n", at)) != std::string_view::npos;) {
      const size_t end = std::min(text.find_first_of(" \t\r\n", at), text.size());
      out.push_back(0);
      if (!detail::is_real(text.substr(at, end - at), out.back()))
        fail(node, fmt::format("`{}` is no number", text.substr(at, end - at)), "numbers");
      at = end;
    }
    if (out.size() != count)
      fail(node, fmt::format("<{}> has {} numbers", node.name(), out.size()),
           fmt::format("{} of them", count));
    return out;
  }

  double value(const XmlNode& of, const char* name) const {
    const XmlNode node = of.child(name);
    return node ? values(node, 1)[0] : 0.0;
  }

  Placed placed(const XmlNode& node) const {
    Placed out;
    if (!node.child("rotation")) return out;
    const std::vector<double> r = values(node.child("rotation"), 9);
    for (int i = 0; i < 9; ++i) out.motion.R(i / 3, i % 3) = r[static_cast<size_t>(i)];
    if (const std::string fault = make_rotation(out.motion.R); !fault.empty())
      fail(node, "the rotation of the chunk " + fault, rotation_rule);
    if (const XmlNode t = node.child("translation")) {
      const std::vector<double> v = values(t, 3);
      out.motion.t = {v[0], v[1], v[2]};
    }
    if (const XmlNode s = node.child("scale")) out.scale = values(s, 1)[0];
    if (!(out.scale > 0)) fail(node, "the scale of the chunk is not above zero", "a scale");
    out.told = true;
    return out;
  }

  Camera camera(const XmlNode& node) {
    const auto sensor = sensors_.find(std::string(node.attribute("sensor_id")));
    if (sensor == sensors_.end()) fail(node, "there is no sensor of this camera", kMetashapeFile);
    Camera camera = optics(sensor->second);
    const std::vector<double> m = values(node.child("transform"), 16);
    std::vector<std::vector<double>> rows;
    for (size_t i = 0; i < 16; i += 4) rows.push_back({m[i], m[i + 1], m[i + 2], m[i + 3]});
    const detail::Motion to_chunk =
        detail::motion_of(rows, file_.place(node.child("transform")), "the transform of a camera");
    const auto own = components_.find(std::string(node.attribute("component_id")));
    const Placed& world = own != components_.end() && own->second.told ? own->second : chunk_;
    scaled_ |= world.told;
    camera.R = to_chunk.R.transpose() * world.motion.R.transpose();
    camera.t = -camera.R * world.motion.t - world.scale * to_chunk.R.transpose() * to_chunk.t;
    return camera;
  }

  /// What Metashape found, rather than what it was given.
  XmlNode calibration(const XmlNode& sensor) const {
    XmlNode out;
    for (const XmlNode& one : sensor.all("calibration"))
      if (!out || one.attribute("class") == "adjusted") out = one;
    if (!out) fail(sensor, "the sensor has no <calibration>", "aligned photos");
    return out;
  }

  Camera optics(const XmlNode& sensor) {
    const XmlNode told = calibration(sensor);
    const std::string type(told.attribute("type"));
    const bool fisheye = type == "fisheye" || type == "equidistant_fisheye";
    if (!fisheye && type != "frame")
      fail(told, fmt::format("cameras of type `{}` are not read", type), "frame or fisheye");
    if (!told.child("f"))
      fail(told, "there is no focal length <f>", "an export of Metashape 1.2 or newer");
    Camera camera;
    size(told.child("resolution") ? told.child("resolution") : sensor.child("resolution"), camera);
    const double f = value(told, "f"), k4 = value(told, "k4"), p1 = value(told, "p1"),
                 p2 = value(told, "p2");
    if (!(f > 0)) fail(told, "the focal length is not above zero", "f [px]");
    if (value(told, "p3") != 0 || value(told, "p4") != 0)
      fail(told, "p3 or p4 is not zero", "optimise the cameras without p3 and p4");
    camera.fx = f + value(told, "b1"), camera.fy = f, camera.skew = value(told, "b2");
    camera.cx = camera.width / 2.0 + value(told, "cx");
    camera.cy = camera.height / 2.0 + value(told, "cy");
    detail::move_pixel_centre(camera);
    const double k[] = {value(told, "k1"), value(told, "k2"), value(told, "k3")};
    if (fisheye) {
      if (p1 != 0 || p2 != 0)
        fail(told, "a fisheye has p1 or p2", "optimise the cameras without p1 and p2");
      camera.model = &camera_model("fisheye");
      camera.distortion = {k[0], k[1], k[2], k4};
    } else {
      if (k4 != 0) fail(told, "k4 is not zero", "optimise the cameras without k4");
      camera.distortion = {k[0], k[1], p2, p1, k[2]};
    }
    return camera;
  }

  void size(const XmlNode& node, Camera& camera) const {
    double sides[2] = {0, 0};
    const char* const names[] = {"width", "height"};
    for (int i = 0; i < 2; ++i)
      if (!detail::is_real(node.attribute(names[i]), sides[i]) || sides[i] < 1 ||
          sides[i] > 100000 || sides[i] != std::floor(sides[i]))
        fail(node, "the picture size is missing", "<resolution width=\"...\" height=\"...\"/>");
    camera.width = static_cast<int>(sides[0]), camera.height = static_cast<int>(sides[1]);
  }

  void tell_world(const XmlNode& chunk) {
    out_.world = scaled_ ? "the chunk's coordinates, in its own length" : "the chunk's own axes";
    if (!scaled_)
      out_.said.push_back(
          "the chunk has no scale: give it one in Metashape, or measure one distance and give "
          "--scale");
    const std::string_view reference = chunk.child("reference").text();
    if (!reference.empty() && !reference.starts_with("LOCAL_CS"))
      out_.said.push_back(
          "the chunk has coordinates of the earth: the cameras are in geocentric ones, a mesh is "
          "exported in others. Choose local coordinates in Metashape");
  }

  XmlFile file_;
  std::map<std::string, XmlNode> sensors_;
  std::map<std::string, Placed> components_;
  Placed chunk_;
  bool scaled_ = false;
  std::vector<std::string> names_;
  Imported out_;
};

class MetashapeImporter final : public Importer {
 public:
  std::string name() const override { return "metashape"; }
  std::string title() const override { return "Agisoft Metashape's cameras (xml)"; }
  bool recognises(const Sources& sources) const override {
    const std::string head = detail::head_of(sources.front());
    return head.find("<document") != std::string::npos &&
           head.find("<chunk") != std::string::npos && head.find("<sensor") != std::string::npos;
  }
  Imported read(const Sources& sources, const ImportOptions&) const override {
    return MetashapeReader(detail::only_one(sources)).read();
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_IMPORTER(metashape, MetashapeImporter)
