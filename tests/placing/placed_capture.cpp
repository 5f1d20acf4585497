#include "placing/placed_capture.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "placing/edit.h"
#include "render/renderer.h"

namespace hookeye::test {

namespace {

using Eigen::Vector2d;

constexpr int kSides = 48;

/// A closed prism: the polygon at z = 0, scaled by `top` and lifted by height + slant x above it.
std::string prism(const std::vector<Vector2d>& polygon, double height, double slant, double top,
                  const std::vector<std::array<int, 3>>& cap) {
  std::string text;
  const int n = static_cast<int>(polygon.size());
  for (const Vector2d& p : polygon) text += fmt::format("v {} {} 0\n", p.x(), p.y());
  for (const Vector2d& p : polygon)
    text += fmt::format("v {} {} {}\n", top * p.x(), top * p.y(), height + slant * p.x());
  for (const auto& t : cap) {
    text += fmt::format("f {} {} {}\n", t[0] + 1, t[2] + 1, t[1] + 1);
    text += fmt::format("f {} {} {}\n", n + t[0] + 1, n + t[1] + 1, n + t[2] + 1);
  }
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    text += fmt::format("f {0} {1} {2}\nf {0} {2} {3}\n", i + 1, j + 1, n + j + 1, n + i + 1);
  }
  return text;
}

std::string obj_of(Shape shape) {
  if (shape == Shape::bracket)
    return prism({{0, 0}, {40, 0}, {40, 10}, {12, 10}, {12, 28}, {0, 28}}, 16, 0.3, 1,
                 {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}});
  if (shape == Shape::brick)
    return prism({{0, 0}, {40, 0}, {40, 24}, {0, 24}}, 14, 0, 1, {{0, 1, 2}, {0, 2, 3}});
  std::vector<Vector2d> circle;
  std::vector<std::array<int, 3>> cap;
  for (int i = 0; i < kSides; ++i)
    circle.emplace_back(15 * std::cos(2 * EIGEN_PI * i / kSides),
                        15 * std::sin(2 * EIGEN_PI * i / kSides));
  for (int i = 1; i + 1 < kSides; ++i) cap.push_back({0, i, i + 1});
  return prism(circle, 36, 0, 0.6, cap);
}

/// Looks at the origin of the cameras' frame from `centre`; world's z is up.
Camera camera_at(const std::string& name, const Vector3d& centre, const Eigen::Vector2i& size) {
  Camera camera;
  camera.name = name;
  camera.width = size.x(), camera.height = size.y();
  camera.fx = camera.fy = 1.9 * size.x();
  camera.cx = 0.5 * size.x() - 0.5, camera.cy = 0.5 * size.y() - 0.5;
  const Vector3d z = -centre.normalized(), x = z.cross(Vector3d::UnitZ()).normalized();
  camera.R.row(0) = x.transpose();
  camera.R.row(1) = z.cross(x).transpose();
  camera.R.row(2) = z.transpose();
  camera.t = -camera.R * centre;
  return camera;
}

std::string camera_lines(const Camera& c) {
  std::string rows;
  for (int i = 0; i < 3; ++i)
    rows += fmt::format("{}[{}, {}, {}]", i ? ", " : "", c.R(i, 0), c.R(i, 1), c.R(i, 2));
  return fmt::format(
      "  {}:\n    size: [{}, {}]\n    intrinsics: {{fx: {}, fy: {}, cx: {}, cy: {}}}\n"
      "    pose: {{rotation: [{}], translation: [{}, {}, {}]}}\n",
      c.name, c.width, c.height, c.fx, c.fy, c.cx, c.cy, rows, c.t.x(), c.t.y(), c.t.z());
}

ToldPlacement told_of(const Isometry3d& pose) {
  ToldPlacement out;
  out.R = pose.linear(), out.t = pose.translation();
  return out;
}

/// The body as the camera sees it at a place: coverage, or shaded grey.
Image photo_of(const SurfaceMesh& surface, const Camera& camera, const Isometry3d& place,
               bool silhouette) {
  std::vector<Camera> cameras{camera};
  take_to_body(told_of(place), cameras);
  PhotoState state;
  state.camera = cameras.front();
  state.ambient = 0.35, state.sun = Vector3d(0.3, -0.4, 0.5);
  RenderOptions options;
  options.derivatives = false, options.smooth_normals = false;
  Texture texture;
  texture.albedo = 0.8;
  Renderer renderer(surface);
  const Rendering picture = renderer.render(surface.X, nullptr, texture, state, options, true);
  return silhouette ? picture.coverage : picture.I;
}

}  // namespace

Isometry3d PlacedCapture::true_place() {
  Isometry3d place = Isometry3d::Identity();
  place.linear() = Eigen::AngleAxisd(0.7, Vector3d(0.3, -0.5, 0.8).normalized()).toRotationMatrix();
  place.translation() = Vector3d(-12, -9, -8);
  return place;
}

Vector3d middle_of(Shape shape) {
  const TemporaryFolder folder;
  std::ofstream(folder / "body.obj") << obj_of(shape);
  return placed_body(read_surface(folder / "body.obj"), "mm").middle;
}

PlacedCapture::PlacedCapture(const PlacedSetup& setup, const Isometry3d& off) : off_(off) {
  std::ofstream(folder_ / "body.obj") << obj_of(setup.shape);
  const SurfaceMesh surface = read_surface(folder_ / "body.obj");
  const Vector3d centres[] = {{30, -210, 60}, {190, 70, 90}, {-120, -90, 150}};
  std::string cameras, photos;
  for (int c = 0; c < setup.cameras; ++c) {
    const Camera camera = camera_at(fmt::format("cam{}", c), centres[c], setup.size);
    cameras += camera_lines(camera);
    photos += fmt::format("      cam{0}: cam{0}.png\n", c);
    const Image photo = photo_of(surface, camera, true_place(), setup.silhouettes);
    write_image(folder_ / fmt::format("cam{}.png", c), photo);
  }
  told_ = told_of(true_place() * off.inverse());
  std::ofstream(file()) << "hookeye: 1\nunits: {length: mm, force: N}\nbody:\n  surface: body.obj\n"
                           "  mesh: {edge: 12, order: 1}\n  placement: "
                        << placement_text(told_)
                        << "\nmodel:\n  material: {law: neo-hookean, mu: 0.05, kappa: 0.5}\n"
                           "cameras:\n"
                        << cameras << "photos: {"
                        << (setup.silhouettes ? "kind: silhouette"
                                              : "encoding: linear, background: black, noise: 0.004")
                        << "}\nexamples:\n  rest:\n    photos:\n"
                        << photos;
  scene_ = load_scene(read_capture(file()));
}

Eigen::Vector2d PlacedCapture::truly_seen(size_t c, const Vector3d& X) const {
  return capture().cameras[c].project(off_ * X);
}

double PlacedCapture::off(const Isometry3d& found) const {
  const Matrix3Xd& X = scene_->body->surface.mesh.X;
  double sum = 0.0;
  for (Eigen::Index i = 0; i < X.cols(); ++i) sum += (found * X.col(i) - off_ * X.col(i)).norm();
  return sum / double(X.cols());
}

Isometry3d random_motion(const Vector3d& middle, double degrees, double length,
                         std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto direction = [&]() -> Vector3d {
    const double x = normal(random), y = normal(random), z = normal(random);
    return Vector3d(x, y, z).normalized();
  };
  const Vector3d axis = direction(), shift = length * direction();
  const Eigen::AngleAxisd turn(degrees * EIGEN_PI / 180.0, axis);
  return Eigen::Translation3d(shift + middle) * turn * Eigen::Translation3d(-middle);
}

}  // namespace hookeye::test
