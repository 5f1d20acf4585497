#include "render/view.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace hookeye {

namespace {

Camera at_origin(Camera camera) {
  camera.R.setIdentity();
  camera.t.setZero();
  return camera;
}

bool is_distorted(const Camera& camera) {
  return std::any_of(camera.distortion.begin(), camera.distortion.end(),
                     [](double k) { return k != 0; });
}

}  // namespace

RayGrid::RayGrid(const Camera& camera, const PixelFilter& filter)
    : camera_(at_origin(camera)),
      n_(filter.n),
      margin_(filter.margin),
      columns_(camera.width * filter.n + 2 * filter.margin) {
  if (!is_distorted(camera)) return;
  const int rows = camera.height * n_ + 2 * margin_;
  undone_.resize(static_cast<size_t>(rows) * columns_);
  for (int iy = 0; iy < rows; ++iy)
    for (int ix = 0; ix < columns_; ++ix) {
      const Ray ray = camera_.ray({px(ix - margin_, iy - margin_), px(iy - margin_, ix - margin_)});
      const Vector2d h = camera.projection == Camera::Projection::perspective
                             ? Vector2d(ray.direction.head<2>() / ray.direction.z())
                             : Vector2d(ray.origin.head<2>());
      undone_[static_cast<size_t>(iy) * columns_ + ix] = h.cast<float>();
    }
}

bool RayGrid::serves(const Camera& c, const PixelFilter& filter) const {
  return filter.n == n_ && filter.margin == margin_ && c.width == camera_.width &&
         c.height == camera_.height && c.projection == camera_.projection && c.fx == camera_.fx &&
         c.fy == camera_.fy && c.cx == camera_.cx && c.cy == camera_.cy &&
         c.distortion == camera_.distortion;
}

View::View(const Camera& c, const Matrix3Xd& x, const std::vector<std::array<int, 3>>& triangles)
    : camera(c),
      local(at_origin(c)),
      perspective(c.projection == Camera::Projection::perspective),
      distorted(is_distorted(c)),
      eye(c.centre()),
      p((c.R * x).colwise() + c.t) {
  start = p.row(2).minCoeff();
  start -= 0.01 * (p.row(2).maxCoeff() - start) + 1e-6;
  Q.resize(triangles.size());
  front.resize(triangles.size());
  for (size_t f = 0; f < triangles.size(); ++f) {
    Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = p.col(triangles[f][k]);
    if (!perspective) corners.row(2).setOnes();
    const double det = corners.determinant();
    // Normals point outwards: seen from the front, the corners turn clockwise in image axes.
    front[f] = det < 0 ? 1 : det > 0 ? -1 : 0;
    Q[f] = det != 0 ? Matrix3d(corners.inverse()) : Matrix3d(Matrix3d::Zero());
  }
  Vector2d low(1e30, 1e30), high = -low;
  for (int v = 0; v < p.cols(); ++v) {
    const Vector2d px = local.project(p.col(v));
    if (!px.allFinite()) {  // Behind the camera: no bound.
      low.setConstant(-1e30), high.setConstant(1e30);
      break;
    }
    low = low.cwiseMin(px), high = high.cwiseMax(px);
  }
  const double pad = distorted ? 6 : 2;  // filter, and edges that distortion bends
  x0 = static_cast<int>(std::clamp(std::floor(low.x() - pad), 0.0, double(c.width)));
  y0 = static_cast<int>(std::clamp(std::floor(low.y() - pad), 0.0, double(c.height)));
  x1 = static_cast<int>(std::clamp(std::ceil(high.x() + pad + 1), double(x0), double(c.width)));
  y1 = static_cast<int>(std::clamp(std::ceil(high.y() + pad + 1), double(y0), double(c.height)));
}

Vector3d View::barycentric(int triangle, const Vector2d& h) const {
  Vector3d b = Q[triangle] * h.homogeneous();
  b /= b.sum();
  if (b.minCoeff() >= 0) return b;
  if (!b.allFinite()) return Vector3d::Constant(1.0 / 3);
  // Embree decides in float which triangle is hit; stay on it.
  b = b.cwiseMax(0.0);
  return b / b.sum();
}

void View::set_ray(RayPacket& rays, int lane, const Vector2d& h,
                   const Vector3d& scene_centre) const {
  Vector3d origin, direction;
  if (perspective) {
    origin = eye - scene_centre;
    direction = camera.R.transpose() * h.homogeneous();
  } else {
    origin = camera.R.transpose() * (Vector3d(h.x(), h.y(), start) - camera.t) - scene_centre;
    direction = camera.R.row(2).transpose();
  }
  rays.org_x[lane] = float(origin.x());
  rays.org_y[lane] = float(origin.y());
  rays.org_z[lane] = float(origin.z());
  rays.dir_x[lane] = float(direction.x());
  rays.dir_y[lane] = float(direction.y());
  rays.dir_z[lane] = float(direction.z());
}

Vector2d View::zoom(const Vector2d& h) const {
  if (!distorted) return h;
  Camera::Jacobian3 by_point;
  Camera::Jacobian7 by_camera;
  local.project(h.homogeneous(), &by_point, &by_camera);
  const Eigen::Matrix2d by_h = by_point.leftCols<2>();
  return by_h.inverse() * by_camera.col(6);
}

}  // namespace hookeye
