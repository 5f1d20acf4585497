// VIC-3D's calibration or project (xml, older and newer).
//
// As DICe reads it: <camera> cx cy fx fy skew k1 k2 k3 <orientation> alpha beta gamma tx ty tz;
// x_in_camera = R x + t, R = Rz(gamma) Ry(beta) Rx(alpha); pixel = (fx u + skew v + cx, fy v + cy).
// Newer files have <intrinsics> cx cy fx fy skew, <distortion> with nine numbers, the last three of
// them radial, and <orientation>. The formula of the radial ones is not published.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/input_error.h"
#include "core/text_file.h"
#include "core/xml_file.h"
#include "importers/detail.h"
#include "importers/lens_of_dic.h"
#include "meshing/file_cursor.h"

namespace hookeye {
namespace {

const char* const kWholeProject = "a calibration or project as VIC-3D writes it";

std::vector<double> numbers(const XmlNode& node, const XmlFile& file, size_t at_least) {
  const std::string_view text = node.text();
  std::vector<double> out;
  for (size_t at = 0; (at = text.find_first_not_of(" \t\r\n", at)) != std::string_view::npos;) {
    const size_t end = std::min(text.find_first_of(" \t\r\n", at), text.size());
    double value = 0;
    if (!detail::is_real(text.substr(at, end - at), value))
      throw InputError(file.place(node),
                       fmt::format("`{}` is no number", text.substr(at, end - at)), kWholeProject);
    out.push_back(value);
    at = end;
  }
  if (out.size() < at_least)
    throw InputError(file.place(node), fmt::format("<{}> has {} numbers", node.name(), out.size()),
                     fmt::format("{} of them", at_least));
  return out;
}

Camera read_camera(const XmlNode& node, const XmlFile& file, const ImportOptions& options) {
  const XmlNode newer = node.child("intrinsics"), orientation = node.child("orientation");
  if (!orientation)
    throw InputError(file.place(node), "a <camera> has no <orientation>", kWholeProject);
  const std::vector<double> k = newer ? numbers(newer, file, 5) : numbers(node, file, 8);
  std::array<double, 5> lens{};
  if (!newer) {
    std::copy_n(k.begin() + 5, 3, lens.begin());
  } else if (const XmlNode distortion = node.child("distortion")) {
    const std::vector<double> all = numbers(distortion, file, 9);
    if (std::any_of(all.begin(), all.begin() + 6, [](double one) { return one != 0; }))
      throw InputError(file.place(distortion), "a term before the radial ones is not zero",
                       "undistorted photos: the formula of these terms is not published");
    std::copy_n(all.begin() + 6, 3, lens.begin());
  }
  Camera camera;
  camera.name = "cam" + std::string(node.attribute("id"));
  camera.cx = k[0], camera.cy = k[1], camera.fx = k[2], camera.fy = k[3], camera.skew = k[4];
  if (!(camera.fx > 0 && camera.fy > 0))
    throw InputError(file.place(node), "the focal lengths are not above zero", kWholeProject);
  camera.distortion = detail::unpublished_lens(lens, "VIC-3D", options, file.place(node));
  const std::vector<double> pose = numbers(orientation, file, 6);
  camera.R = detail::cardan(pose[0], pose[1], pose[2]);
  camera.t = {pose[3], pose[4], pose[5]};
  return camera;
}

/// Of the areas of interest, where they agree.
void read_size(const XmlFile& file, Imported& out) {
  std::pair<int, int> size{0, 0};
  for (const XmlNode& mask : file.top().all("polygonmask")) {
    double w = 0, h = 0;
    if (!detail::is_real(mask.attribute("width"), w) ||
        !detail::is_real(mask.attribute("height"), h) || w < 1 || h < 1 || w > 100000 || h > 100000)
      throw InputError(file.place(mask), "the size of the picture is no number", kWholeProject);
    const std::pair<int, int> one{static_cast<int>(w), static_cast<int>(h)};
    if (size.first != 0 && one != size)
      throw InputError(file.place(mask),
                       fmt::format("pictures of {} x {} and of {} x {} px", size.first, size.second,
                                   one.first, one.second),
                       "export the calibration alone, and give --size");
    size = one;
  }
  for (Camera& camera : out.cameras) camera.width = size.first, camera.height = size.second;
}

class Vic3d final : public Importer {
 public:
  std::string name() const override { return "vic3d"; }
  std::string title() const override { return "VIC-3D's calibration or project (xml)"; }
  bool recognises(const Sources& sources) const override {
    const std::string head = detail::head_of(sources.front());
    return head.find("<!doctype vpml") != std::string::npos ||
           (head.find("<calibration") != std::string::npos &&
            head.find("<orientation") != std::string::npos);
  }

  Imported read(const Sources& sources, const ImportOptions& options) const override {
    const std::string path = detail::only_one(sources).string();
    const XmlFile file(read_text(path), path, kWholeProject);
    Imported out;
    const XmlNode top = file.top();
    const XmlNode calibration = top.name() == "calibration" ? top : top.child("calibration");
    for (const XmlNode& node : calibration.children())
      if (node.name() == "camera") out.cameras.push_back(read_camera(node, file, options));
    if (out.cameras.empty())
      throw InputError(file.place(calibration ? calibration : top),
                       "there is no <calibration> with cameras", kWholeProject);
    read_size(file, out);
    out.world = "VIC-3D's";
    return out;
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_IMPORTER(vic3d, Vic3d)
