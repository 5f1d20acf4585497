#include "proposal/lab_folder.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <cmath>
#include <random>

#include "capture_io/capture.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye::test {
namespace {

constexpr int kWidth = 64, kHeight = 96;

/// A block as ASCII STL.
std::string bar_stl(double x, double y, double z) {
  const auto corner = [&](int i) {
    return Vector3d((i & 1 ? 0.5 : -0.5) * x, (i & 2 ? 0.5 : -0.5) * y, i & 4 ? z : 0.0);
  };
  const int sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  std::string out = "solid bar\n";
  for (const auto& side : sides)
    for (const auto& t :
         {std::array{side[0], side[1], side[2]}, std::array{side[0], side[2], side[3]}}) {
      out += "facet normal 0 0 0\nouter loop\n";
      for (const int i : t)
        out += fmt::format("vertex {} {} {}\n", corner(i).x(), corner(i).y(), corner(i).z());
      out += "endloop\nendfacet\n";
    }
  return out + "endsolid bar\n";
}

/// Waves of 9 to 20 px in all directions: like nothing else nearby.
double speckle(double x, double y) {
  double sum = 0;
  for (int i = 0; i < 16; ++i) {
    const double angle = 2.4 * i, pace = 0.31 + 0.024 * i;
    sum += std::sin(pace * (x * std::cos(angle) + y * std::sin(angle)) + 1.7 * i * i);
  }
  return sum;
}

/// As cv::FileStorage writes a camera; it stands at (side, -200, 15) and looks along y.
std::string opencv_camera(double side) {
  return fmt::format(
      "%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\ncamera_matrix: !!opencv-matrix\n"
      "   rows: 3\n   cols: 3\n   dt: d\n   data: [ 400., 0., 31.5, 0., 400., 47.5, 0., 0., 1. ]\n"
      "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
      "   data: [ 0., 0., 0., 0., 0. ]\n"
      "R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [ 1., 0., 0., 0., 0., -1., 0., 1., 0. ]\n"
      "T: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ {}, 15., 200. ]\n",
      kWidth, kHeight, -side);
}

}  // namespace

LabFolder::LabFolder() {
  write("bar.stl", bar_stl(10, 10, 30));
  write("cam0.yml", opencv_camera(-5));
  write("cam1.yml", opencv_camera(5));
}

void LabFolder::write(const std::string& name, const std::string& text) const {
  std::filesystem::create_directories((folder_ / name).parent_path());
  write_text(folder_ / name, text);
}

void LabFolder::photo(const std::string& name, double moved_px, const std::string& time,
                      const std::string& fraction) const {
  std::filesystem::create_directories((folder_ / name).parent_path());
  std::mt19937 random(std::hash<std::string>()(name));
  std::normal_distribution<float> noise(0.0f, 0.004f);
  std::vector<float> values;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      values.push_back(static_cast<float>(0.5 + 0.04 * speckle(x, y + moved_px)) + noise(random));
    }
  OIIO::ImageSpec spec(kWidth, kHeight, 1, OIIO::TypeDesc::UINT16);
  if (!time.empty()) spec.attribute("Exif:DateTimeOriginal", time);
  if (!fraction.empty()) spec.attribute("Exif:SubsecTimeOriginal", fraction);
  const std::string file = (folder_ / name).string();
  const auto out = OIIO::ImageOutput::create(file);
  if (!out || !out->open(file, spec) || !out->write_image(OIIO::TypeDesc::FLOAT, values.data()) ||
      !out->close())
    throw std::runtime_error("cannot write " + file);
}

void LabFolder::photos(const std::vector<double>& moved_px) const {
  for (size_t k = 0; k < moved_px.size(); ++k)
    for (const char* camera : {"cam0", "cam1"})
      photo(fmt::format("photos/{}_{:04}.tif", camera, k + 1), moved_px[k]);
}

Proposal LabFolder::proposal(const Questions::Answers& answers) const {
  return propose(look_at(path()), answers, path() / "capture.yaml");
}

std::string LabFolder::complaint(const Questions::Answers& answers) const {
  try {
    proposal(answers);
    return "";
  } catch (const InputError& error) {
    std::string text = error.what();
    for (size_t at; (at = text.find(path().string() + "/")) != std::string::npos;)
      text.erase(at, path().string().size() + 1);
    return text;
  }
}

Capture LabFolder::stored(const Proposal& proposal) const {
  store(proposal, path() / "capture.yaml", false);
  return read_capture(path() / "capture.yaml");
}

std::vector<RampRow> ramp(size_t still, size_t moving, double zero) {
  std::vector<RampRow> rows;
  for (size_t i = 0; i < still + moving; ++i) {
    const double step = i < still ? 0.0 : static_cast<double>(i - still + 1);
    const double noise = 0.002 * ((i * 7) % 5 - 2.0);
    rows.push_back({0.5 * static_cast<double>(i), 0.2 * step, 0.4 * step + zero + noise});
  }
  return rows;
}

std::string plain_table(const std::vector<RampRow>& rows) {
  std::string out = "Time [s],Stroke [mm],Force [N]\n";
  for (const RampRow& row : rows)
    out += fmt::format("{:.3f},{:.4f},{:.4f}\n", row.time, row.travel, row.force);
  return out;
}

bool any_says(const std::vector<std::string>& texts, const std::string& piece) {
  for (const std::string& text : texts)
    if (text.find(piece) != std::string::npos) return true;
  return false;
}

}  // namespace hookeye::test
