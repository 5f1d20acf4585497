#include "estimation/inspection/flip.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hookeye::inspection {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// OpenGL's camera axes in OpenCV's: y up, z backwards.
const Matrix3d kGl = Vector3d(1.0, -1.0, -1.0).asDiagonal();

Camera posed(Camera camera, const Matrix3d& R, const Vector3d& t) {
  camera.R = R, camera.t = t;
  return camera;
}
Camera scaled(Camera camera, double s) { return posed(camera, camera.R, s * camera.t); }

Camera inverted(const Camera& c) { return posed(c, c.R.transpose(), -c.R.transpose() * c.t); }
Camera from_gl(const Camera& c) { return posed(c, kGl * c.R, kGl * c.t); }
Camera inverted_gl(const Camera& c) { return from_gl(inverted(c)); }
Camera transposed(const Camera& c) { return posed(c, c.R.transpose(), c.t); }
Camera centred(const Camera& c) { return posed(c, c.R, -c.R * c.t); }
Camera inverted_centred(const Camera& c) { return centred(transposed(c)); }

std::vector<Flip> make_flips() {
  using Of = Flip::Of;
  const std::string to_camera = "`pose` maps world to camera, x right, y down, z forward: ";
  const std::string one_length = "`translation` is in the length unit of the body: ";
  const std::string by_size = "`intrinsics` hold for the size of the photos: ";
  std::vector<Flip> all = {
      {"camera_to_world", "the pose maps camera to world", to_camera + "write R^T and -R^T t",
       Of::pose, inverted},
      {"opengl_axes", "the camera's axes are OpenGL's (y up, z backwards)",
       to_camera + "change the signs of the second and third rows of R and t", Of::pose, from_gl},
      {"opengl_camera_to_world",
       "the pose maps camera to world with OpenGL's axes (Blender's matrix_world)",
       to_camera + "write R^T and -R^T t, then change the signs of the second and third rows",
       Of::pose, inverted_gl},
      {"rotation_transposed", "the rotation is transposed", to_camera + "write the rows of R^T",
       Of::pose, transposed},
      {"centre_for_translation", "the translation is the camera's centre",
       to_camera + "the translation is -R times the centre", Of::pose, centred},
      {"camera_to_world_rotation",
       "the rotation maps camera to world and the translation is the centre",
       to_camera + "write R^T, and -R^T times the centre", Of::pose, inverted_centred},
      {"translation_1000_times_small", "the translation is 1000 times as long",
       one_length + "m for mm?", Of::pose, [](const Camera& c) { return scaled(c, 1000.0); }},
      {"translation_1000_times_large", "the translation is a thousandth as long",
       one_length + "mm for m?", Of::pose, [](const Camera& c) { return scaled(c, 0.001); }},
      {"translation_10_times_small", "the translation is 10 times as long",
       one_length + "cm for mm?", Of::pose, [](const Camera& c) { return scaled(c, 10.0); }},
      {"translation_10_times_large", "the translation is a tenth as long",
       one_length + "mm for cm?", Of::pose, [](const Camera& c) { return scaled(c, 0.1); }},
      {"translation_100_times_small", "the translation is 100 times as long",
       one_length + "m for cm?", Of::pose, [](const Camera& c) { return scaled(c, 100.0); }},
      {"translation_100_times_large", "the translation is a hundredth as long",
       one_length + "cm for m?", Of::pose, [](const Camera& c) { return scaled(c, 0.01); }},
      {"intrinsics_of_twice_the_size", "fx, fy, cx and cy are halved",
       by_size + "they are those of pictures twice as large", Of::intrinsics,
       [](const Camera& c) { return c.resized(0.5); }},
      {"intrinsics_of_half_the_size", "fx, fy, cx and cy are doubled",
       by_size + "they are those of pictures half as large", Of::intrinsics,
       [](const Camera& c) { return c.resized(2.0); }}};
  const std::string as_calibrated = "hand over the photos as the calibration saw them";
  const std::pair<Turn, const char*> turns[] = {{Turn::half, "turned by 180 degrees"},
                                                {Turn::mirrored, "mirrored left to right"},
                                                {Turn::upside_down, "mirrored top to bottom"},
                                                {Turn::left, "turned by 90 degrees to the left"},
                                                {Turn::right, "turned by 90 degrees to the right"}};
  for (const auto& [turn, how] : turns) {
    std::string name = std::string("photo ") + how;
    std::replace(name.begin(), name.end(), ' ', '_');
    all.push_back(
        {name, std::string("the photo is ") + how, as_calibrated, Of::photo, nullptr, turn});
  }
  all.push_back({"texture_upside_down", "the texture is mirrored top to bottom",
                 "v = 0 is the bottom row of the texture: write 1 - v, or mirror the picture",
                 Of::texture, nullptr, Turn::none, true});
  return all;
}

template <Camera (*pose)(const Camera&), int numerator, int denominator>
Camera scaled_and(const Camera& c) {
  return pose(scaled(c, double(numerator) / denominator));
}

template <Camera (*pose)(const Camera&)>
void add_pairs(const Flip& of, std::vector<Flip>* all) {
  all->push_back({of.name + "_1000_times_small",
                  of.seen + " and its lengths are 1000 times as long",
                  of.right + "; and lengths in the unit of the body: m for mm?", Flip::Of::pose,
                  scaled_and<pose, 1000, 1>});
  all->push_back({of.name + "_1000_times_large",
                  of.seen + " and its lengths are a thousandth as long",
                  of.right + "; and lengths in the unit of the body: mm for m?", Flip::Of::pose,
                  scaled_and<pose, 1, 1000>});
}

std::vector<Flip> make_pairs() {
  std::vector<Flip> all;
  const std::vector<Flip>& single = usual_flips();
  add_pairs<inverted>(single[0], &all);
  add_pairs<from_gl>(single[1], &all);
  add_pairs<inverted_gl>(single[2], &all);
  add_pairs<transposed>(single[3], &all);
  add_pairs<centred>(single[4], &all);
  add_pairs<inverted_centred>(single[5], &all);
  return all;
}

/// Where a pixel of the turned picture comes from; `width`, `height` of the picture before.
std::pair<int, int> source(Turn turn, int x, int y, int width, int height) {
  switch (turn) {
    case Turn::none:
      return {x, y};
    case Turn::half:
      return {width - 1 - x, height - 1 - y};
    case Turn::left:  // counter-clockwise
      return {width - 1 - y, x};
    case Turn::right:
      return {y, height - 1 - x};
    case Turn::mirrored:
      return {width - 1 - x, y};
    case Turn::upside_down:
      return {x, height - 1 - y};
  }
  return {x, y};
}

bool on_its_side(Turn turn) { return turn == Turn::left || turn == Turn::right; }

template <class T>
std::vector<T> turned_values(const std::vector<T>& values, int width, int height, Turn turn) {
  const int w = on_its_side(turn) ? height : width, h = on_its_side(turn) ? width : height;
  std::vector<T> out(values.size());
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const auto [u, v] = source(turn, x, y, width, height);
      out[static_cast<size_t>(y) * w + x] = values[static_cast<size_t>(v) * width + u];
    }
  return out;
}

}  // namespace

Camera Flip::meant(const Camera& told) const {
  Camera out = camera ? camera(told) : told;
  if (!on_its_side(turn)) return out;
  // The principal point was told for the picture as it lies, or as the sensor saw it.
  const double as_it_lies =
      std::abs(out.cx - 0.5 * out.width) + std::abs(out.cy - 0.5 * out.height);
  const double as_seen = std::abs(out.cx - 0.5 * out.height) + std::abs(out.cy - 0.5 * out.width);
  if (as_it_lies < as_seen) std::swap(out.cx, out.cy), std::swap(out.fx, out.fy);
  std::swap(out.width, out.height);
  return out;
}

const Flip& as_told() {
  static const Flip none;
  return none;
}

const std::vector<Flip>& usual_flips() {
  static const std::vector<Flip> all = make_flips();
  return all;
}

const std::vector<Flip>& paired_flips() {
  static const std::vector<Flip> all = make_pairs();
  return all;
}

Image turned(const Image& image, Turn turn) {
  Image out = image;
  if (on_its_side(turn)) std::swap(out.width, out.height);
  out.values = turned_values(image.values, image.width, image.height, turn);
  return out;
}

std::vector<unsigned char> turned(const std::vector<unsigned char>& values, int width, int height,
                                  Turn turn) {
  return values.empty() ? values : turned_values(values, width, height, turn);
}

}  // namespace hookeye::inspection
