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

}  // namespace

RayGrid::RayGrid(const Camera& camera, const PixelFilter& filter)
    : camera_(at_origin(camera)),
      n_(filter.n),
      margin_(filter.margin),
      columns_(camera.width * filter.n + 2 * filter.margin) {
  const int rows = camera.height * n_ + 2 * margin_;
  const auto centred = [&](int i) { return (i - margin_ - (n_ - 1) / 2.0) / n_; };
  const auto shift = [&](int i) { return PixelFilter::shift(i - margin_, n_) / n_; };
  for (int i = 0; i < columns_; ++i) {
    x_.push_back((centred(i) - camera_.cx) / camera_.fx);
    y_shift_.push_back(shift(i) / camera_.fy);
  }
  for (int i = 0; i < rows; ++i) {
    y_.push_back((centred(i) - camera_.cy) / camera_.fy);
    x_shift_.push_back(shift(i) / camera_.fx);
  }
  if (camera.straight()) return;
  undone_.resize(static_cast<size_t>(rows) * columns_);
  zoom_.resize(undone_.size());
  for (int iy = 0; iy < rows; ++iy)
    for (int ix = 0; ix < columns_; ++ix) {
      const Ray ray = camera_.ray({centred(ix) + shift(iy), centred(iy) + shift(ix)});
      const Vector2d h = camera.model->central()
                             ? Vector2d(ray.direction.head<2>() / ray.direction.z())
                             : Vector2d(ray.origin.head<2>());
      const size_t at = static_cast<size_t>(iy) * columns_ + ix;
      undone_[at] = h.cast<float>();
      Camera::Jacobian3 by_point;
      Camera::Jacobian7 by_camera;
      camera_.project(h.homogeneous(), &by_point, &by_camera);
      const Eigen::Matrix2d by_h = by_point.leftCols<2>();
      zoom_[at] = Vector2d(by_h.inverse() * by_camera.col(6)).cast<float>();
    }
}

bool RayGrid::serves(const Camera& c, const PixelFilter& filter) const {
  return filter.n == n_ && filter.margin == margin_ && camera_.same_optics(c);
}

View::View(const Camera& c, const Matrix3Xd& x, const std::vector<std::array<int, 3>>& triangles)
    : camera(c),
      local(at_origin(c)),
      central(c.model->central()),
      eye(c.centre()),
      p((c.R * x).colwise() + c.t) {
  start = p.row(2).minCoeff();
  // and by more than floats round, where the body is flat as seen from here
  start -= 0.01 * (p.row(2).maxCoeff() - start) + 1e-6 * p.row(2).cwiseAbs().maxCoeff();
  front.resize(triangles.size());
  for (size_t f = 0; f < triangles.size(); ++f) {
    Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = p.col(triangles[f][k]);
    if (!central) corners.row(2).setOnes();
    const double det = corners.determinant();
    // Normals point outwards: seen from the front, the corners turn clockwise in image axes.
    front[f] = det < 0 ? 1 : det > 0 ? -1 : 0;
  }
  Vector2d low(1e30, 1e30), high = -low;
  for (int v = 0; v < p.cols(); ++v) {
    const Vector2d px = local.project(p.col(v));
    if (!px.allFinite()) {  // Behind the camera or past its lens: no bound.
      low.setConstant(-1e30), high.setConstant(1e30);
      break;
    }
    low = low.cwiseMin(px), high = high.cwiseMax(px);
  }
  const double pad = c.straight() ? 2 : 6;  // filter, and edges that the lens bends
  x0 = static_cast<int>(std::clamp(std::floor(low.x() - pad), 0.0, double(c.width)));
  y0 = static_cast<int>(std::clamp(std::floor(low.y() - pad), 0.0, double(c.height)));
  x1 = static_cast<int>(std::clamp(std::ceil(high.x() + pad + 1), double(x0), double(c.width)));
  y1 = static_cast<int>(std::clamp(std::ceil(high.y() + pad + 1), double(y0), double(c.height)));
}

}  // namespace hookeye
