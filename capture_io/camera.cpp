#include "capture_io/camera.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

namespace hookeye {
namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace

Eigen::Vector2d Camera::project(const Eigen::Vector3d& x_in_world) const {
  return project(x_in_world, nullptr, nullptr);
}

Eigen::Vector2d Camera::project(const Eigen::Vector3d& x_in_world, Jacobian3* d_dx,
                                Jacobian7* d_dcamera) const {
  const Eigen::Vector3d x = R * x_in_world + t;
  Jacobian3 dplane_dx;  // by camera coordinates
  const bool derivatives = d_dx || d_dcamera;
  const Eigen::Vector2d plane =
      model->to_plane(distortion, x, derivatives ? &dplane_dx : nullptr, nullptr);
  const Eigen::Vector2d from_centre(fx * plane.x() + skew * plane.y(), fy * plane.y());
  if (derivatives) {
    Jacobian3 dpixel_dx;
    dpixel_dx.row(0) = fx * dplane_dx.row(0) + skew * dplane_dx.row(1);
    dpixel_dx.row(1) = fy * dplane_dx.row(1);
    if (d_dx) *d_dx = dpixel_dx * R;
    if (d_dcamera) {
      // x' = exp([w]x) x + v: dx'/dw = -[x]x at w = 0.
      d_dcamera->leftCols<3>() = -dpixel_dx * cross_matrix(x);
      d_dcamera->middleCols<3>(3) = dpixel_dx;
      d_dcamera->col(6) = from_centre;
    }
  }
  return from_centre + Eigen::Vector2d(cx, cy);
}

Eigen::Matrix2Xd Camera::d_dintrinsics(const Eigen::Vector3d& x_in_world) const {
  Eigen::Matrix2Xd d_dlens;
  const Eigen::Vector2d plane = model->to_plane(distortion, R * x_in_world + t, nullptr, &d_dlens);
  Eigen::Matrix2d pixel_by_plane;
  pixel_by_plane << fx, skew, 0, fy;
  Eigen::Matrix2Xd out(2, 5 + d_dlens.cols());
  out << plane.x(), 0, 1, 0, plane.y(), pixel_by_plane.row(0) * d_dlens,  //
      0, plane.y(), 0, 1, 0, pixel_by_plane.row(1) * d_dlens;
  return out;
}

std::vector<Intrinsic> Camera::intrinsics() const {
  const std::string unit = model->central() ? "px" : "px/length";
  std::vector<Intrinsic> all = {
      {"fx", unit, fx}, {"fy", unit, fy}, {"cx", "px", cx}, {"cy", "px", cy}, {"skew", unit, skew}};
  const std::vector<CameraModel::LensNumber> numbers = model->lens_numbers();
  for (size_t i = 0; i < distortion.size(); ++i)
    all.push_back({numbers.at(i).name, numbers[i].unit, distortion[i]});
  return all;
}

Ray Camera::ray(const Eigen::Vector2d& pixel) const {
  const double v = (pixel.y() - cy) / fy;
  const Eigen::Vector2d h = model->ray(distortion, {(pixel.x() - cx - skew * v) / fx, v});
  if (!model->central())
    return {R.transpose() * (Eigen::Vector3d(h.x(), h.y(), 0) - t),
            R.transpose() * Eigen::Vector3d::UnitZ()};
  return {centre(), R.transpose() * Eigen::Vector3d(h.x(), h.y(), 1).normalized()};
}

double Camera::length_per_px(const Eigen::Vector3d& x_in_world) const {
  return model->unit_at(distortion, R * x_in_world + t) / fx;
}

bool Camera::same_optics(const Camera& o) const {
  return width == o.width && height == o.height && model == o.model && fx == o.fx && fy == o.fy &&
         cx == o.cx && cy == o.cy && skew == o.skew && distortion == o.distortion;
}

Camera Camera::moved(const Eigen::Vector3d& w_rad, const Eigen::Vector3d& v) const {
  Camera result = *this;
  const double angle = w_rad.norm();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (angle > 0) turn = Eigen::AngleAxisd(angle, w_rad / angle).toRotationMatrix();
  result.R = turn * R;
  result.t = turn * t + v;
  return result;
}

Camera Camera::of_colour(int colour) const {
  const double log_factor = colour == 0 ? colour_zoom[0] : colour == 2 ? colour_zoom[1] : 0.0;
  return log_factor == 0.0 ? *this : zoomed(log_factor);
}

Camera Camera::zoomed(double log_factor) const {
  Camera result = *this;
  result.fx *= std::exp(log_factor);
  result.fy *= std::exp(log_factor);
  result.skew *= std::exp(log_factor);
  return result;
}

std::string intrinsics_text(const Camera& c, const std::function<std::string(double)>& number) {
  std::string text = fmt::format("{{fx: {}, fy: {}, cx: {}, cy: {}", number(c.fx), number(c.fy),
                                 number(c.cx), number(c.cy));
  if (c.skew != 0) text += ", skew: " + number(c.skew);
  std::string lens;
  for (const double k : c.distortion) lens += (lens.empty() ? "" : ", ") + number(k);
  if (!lens.empty()) text += ", distortion: [" + lens + "]";
  return text + "}";
}

Camera Camera::resized(double factor) const {
  Camera result = *this;
  result.fx *= factor, result.fy *= factor, result.skew *= factor;
  result.cx = (cx + 0.5) * factor - 0.5;
  result.cy = (cy + 0.5) * factor - 0.5;
  return result;
}

}  // namespace hookeye
