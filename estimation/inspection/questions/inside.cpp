// Does a camera stand inside the body?
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "estimation/inspection/question.h"

namespace hookeye::inspection {

namespace {

/// Solid angle of a closed surface from a point, over that of the sphere: 1 inside, 0 outside (Van
/// Oosterom and Strackee 1983).
double winding(const SurfaceMesh& surface, const Vector3d& point) {
  double sum = 0.0;
  for (const auto& t : surface.triangles) {
    const Vector3d a = surface.X.col(t[0]) - point, b = surface.X.col(t[1]) - point,
                   c = surface.X.col(t[2]) - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2.0 * std::atan2(a.dot(b.cross(c)),
                            la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(sum) / (4.0 * EIGEN_PI);
}

}  // namespace

void ask_inside(Sight& sight, Warnings& warnings) {
  const Scene& scene = sight.scene();
  for (const Camera& camera : scene.capture.cameras) {
    if (!camera.model->central() || sight.doubted(camera.name)) continue;
    if (winding(scene.body->surface.mesh, camera.centre()) < 0.5) continue;
    const Vector3d centre = camera.centre();
    warnings.say(
        warnings.place({"cameras", camera.name, "pose"}),
        fmt::format("camera `{}` stands inside the body, at ({:.4g}, {:.4g}, {:.4g}) {}",
                    camera.name, centre.x(), centre.y(), centre.z(), scene.capture.units.length),
        "x_camera = R x_world + t, `translation` in the length unit of the body");
    sight.doubt(camera.name);
  }
}

}  // namespace hookeye::inspection
