// DICe's camera system (xml).
//
// DICe_Camera: x_in_camera = R x + (TX, TY, TZ), R = Rz(GAMMA) Ry(BETA) Rx(ALPHA) or its rows;
// where extrinsics_relative_camera_to_camera is set, those of CAMERA 1 count from CAMERA 0. Lens:
// OPENCV_LENS_DISTORTION is OpenCV's (FS has no part in it); K1R3_K2R5_K3R7 moves a point out by k1
// r^3 + k2 r^5 + k3 r^7, which is OpenCV's k1 k2 k3. The others are none of ours.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <vector>

#include "core/input_error.h"
#include "core/text_file.h"
#include "core/xml_file.h"
#include "importers/detail.h"
#include "importers/lens_of_dic.h"
#include "meshing/file_cursor.h"

namespace hookeye {
namespace {

const char* const kWholeSystem = "a camera system as DICe writes it";

/// "{ 1200, 1920 }".
std::vector<double> braced(const XmlNode& parameter, const XmlFile& file, size_t count) {
  std::string text(parameter.attribute("value"));
  for (char& c : text)
    if (c == '{' || c == '}' || c == ',') c = ' ';
  std::vector<double> out;
  for (size_t at = 0; (at = text.find_first_not_of(" \t\n", at)) != std::string::npos;) {
    const size_t end = std::min(text.find_first_of(" \t\n", at), text.size());
    double value = 0;
    if (!detail::is_real(std::string_view(text).substr(at, end - at), value))
      throw InputError(file.place(parameter),
                       fmt::format("`{}` is no list of numbers", parameter.attribute("value")),
                       kWholeSystem);
    out.push_back(value);
    at = end;
  }
  if (out.size() != count)
    throw InputError(file.place(parameter),
                     fmt::format("`{}` has {} numbers", parameter.attribute("name"), out.size()),
                     fmt::format("{} of them", count));
  return out;
}

/// One sublist "CAMERA n".
class DiceCamera {
 public:
  DiceCamera(const XmlNode& list, const XmlFile& file) : list_(list), file_(file) {}

  Camera read(std::vector<std::string>& said) const {
    Camera camera;
    camera.name =
        text("CAMERA_ID").empty() ? std::string(list_.attribute("name")) : text("CAMERA_ID");
    camera.fx = number("FX"), camera.fy = number("FY");
    camera.cx = number("CX"), camera.cy = number("CY");
    if (!(camera.fx > 0 && camera.fy > 0))
      fail("FX", "FX and FY are not both above zero", kWholeSystem);
    read_size(camera);
    read_lens(camera, said);
    read_pose(camera);
    return camera;
  }

 private:
  XmlNode find(const char* name) const { return list_.child("Parameter", "name", name); }
  std::string text(const char* name) const { return std::string(find(name).attribute("value")); }
  [[noreturn]] void fail(const char* name, const std::string& wrong,
                         const std::string& right) const {
    throw InputError(file_.place(find(name) ? find(name) : list_),
                     fmt::format("{}: {}", list_.attribute("name"), wrong), right);
  }
  /// What is not there is zero: DICe leaves zeros out.
  double number(const char* name) const {
    const XmlNode parameter = find(name);
    double value = 0;
    if (parameter && !detail::is_real(parameter.attribute("value"), value))
      fail(name, fmt::format("{} is `{}`", name, parameter.attribute("value")), "a finite number");
    return value;
  }

  void read_size(Camera& camera) const {
    const XmlNode size = find("IMAGE_HEIGHT_WIDTH");
    if (!size) return;
    const std::vector<double> sides = braced(size, file_, 2);
    for (const double side : sides)
      if (side < 0 || side > 100000)
        fail("IMAGE_HEIGHT_WIDTH", "no picture has this size", kWholeSystem);
    camera.height = static_cast<int>(sides[0]), camera.width = static_cast<int>(sides[1]);
  }

  void read_lens(Camera& camera, std::vector<std::string>& said) const {
    const char* const kKey = "LENS_DISTORTION_MODEL";
    const std::string model = text(kKey);
    const bool vic = model == "VIC3D_LENS_DISTORTION";
    if (vic)
      camera.skew = number("FS");
    else if (number("FS") != 0)
      said.push_back(fmt::format(
          "{} has a skew FS, which DICe does not use with this lens; nor does the capture",
          list_.attribute("name")));
    const std::array<double, 5> first{number("K1"), number("K2"), number("K3"), number("P1"),
                                      number("P2")};
    const bool k = first[0] != 0 || first[1] != 0 || first[2] != 0;
    if (model == "OPENCV_LENS_DISTORTION") {
      for (const char* name : {"T1", "T2"})
        if (number(name) != 0)
          fail(name, fmt::format("{} is not zero", name), "a lens without tilt");
      camera.distortion = {first[0],     first[1],     first[3],     first[4],
                           first[2],     number("K4"), number("K5"), number("K6"),
                           number("S1"), number("S2"), number("S3"), number("S4")};
    } else if (model == "K1R3_K2R5_K3R7") {
      camera.distortion = {first[0], first[1], 0, 0, first[2]};
    } else if (k && !model.empty() && model != "NO_LENS_DISTORTION") {
      fail(kKey, fmt::format("a capture has no lens like {}", model),
           "OPENCV_LENS_DISTORTION or K1R3_K2R5_K3R7, or undistorted photos");
    }
  }

  void read_pose(Camera& camera) const {
    camera.t = {number("TX"), number("TY"), number("TZ")};
    camera.R = detail::cardan(number("ALPHA"), number("BETA"), number("GAMMA"));
    const XmlNode rows = list_.child("ParameterList", "name", "rotation_3x3_matrix");
    if (!rows) return;
    std::vector<std::vector<double>> all;
    for (int i = 0; i < 3; ++i) {
      const XmlNode row = rows.child("Parameter", "name", fmt::format("ROW {}", i));
      if (!row)
        throw InputError(file_.place(rows), fmt::format("ROW {} is not there", i), kWholeSystem);
      all.push_back(braced(row, file_, 3));
      all.back().push_back(0);
    }
    camera.R = detail::motion_of(all, file_.place(rows), "rotation_3x3_matrix").R;
  }

  const XmlNode& list_;
  const XmlFile& file_;
};

class Dice final : public Importer {
 public:
  std::string name() const override { return "dice"; }
  std::string title() const override { return "DICe's camera system (xml)"; }
  bool recognises(const Sources& sources) const override {
    return detail::head_of(sources.front()).find("dice_xml_camera_system_file") !=
           std::string::npos;
  }

  Imported read(const Sources& sources, const ImportOptions&) const override {
    const std::string path = detail::only_one(sources).string();
    const XmlFile file(read_text(path), path, kWholeSystem);
    const XmlNode top = file.child("ParameterList");
    const auto value = [&](const char* name) {
      return top.child("Parameter", "name", name).attribute("value");
    };
    if (value("xml_file_format") != "DICe_xml_camera_system_file")
      throw InputError(file.place(top), "this is no DICe_xml_camera_system_file", kWholeSystem);
    Imported out;
    for (int n = 0;; ++n) {
      const XmlNode list = top.child("ParameterList", "name", fmt::format("CAMERA {}", n));
      if (!list) break;
      out.cameras.push_back(DiceCamera(list, file).read(out.said));
    }
    if (value("extrinsics_relative_camera_to_camera") == "true" && out.cameras.size() > 1) {
      if (out.cameras.size() > 2)
        throw InputError(file.place(top), "more than two cameras count from one another",
                         "extrinsics_relative_camera_to_camera is for two");
      const Camera& first = out.cameras[0];
      Camera& second = out.cameras[1];
      second.t += second.R * first.t;
      second.R *= first.R;
    }
    out.world = "DICe's, of which the extrinsics of CAMERA 0 count";
    return out;
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_IMPORTER(dice, Dice)
