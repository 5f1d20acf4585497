#include "capture_io/distortion.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>

namespace hookeye {
namespace {

/// Coefficients by name; those that a shorter model leaves out are zero.
struct Model {
  double k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tx, ty;

  explicit Model(const std::vector<double>& c) {
    std::array<double, 14> a{};
    std::copy_n(c.begin(), std::min<size_t>(c.size(), a.size()), a.begin());
    k1 = a[0], k2 = a[1], p1 = a[2], p2 = a[3], k3 = a[4], k4 = a[5], k5 = a[6], k6 = a[7];
    s1 = a[8], s2 = a[9], s3 = a[10], s4 = a[11], tx = a[12], ty = a[13];
  }
};

/// The homography of a tilted sensor: diag-like part [[R33,0,-R13],[0,R33,-R23],[0,0,1]] times
/// R(tx, ty), as on OpenCV's page; with its derivatives.
struct Tilt {
  Eigen::Matrix3d h, by_tx, by_ty;

  Tilt(double tx, double ty) {
    Eigen::Matrix3d about_x, about_y, turn_x, turn_y;
    about_x << 1, 0, 0, 0, std::cos(tx), std::sin(tx), 0, -std::sin(tx), std::cos(tx);
    about_y << std::cos(ty), 0, -std::sin(ty), 0, 1, 0, std::sin(ty), 0, std::cos(ty);
    turn_x << 0, 0, 0, 0, -std::sin(tx), std::cos(tx), 0, -std::cos(tx), -std::sin(tx);
    turn_y << -std::sin(ty), 0, -std::cos(ty), 0, 0, 0, std::cos(ty), 0, -std::sin(ty);
    const Eigen::Matrix3d r = about_y * about_x, r_tx = about_y * turn_x, r_ty = turn_y * about_x;
    h = back(r, 1) * r;
    by_tx = back(r_tx, 0) * r + back(r, 1) * r_tx;
    by_ty = back(r_ty, 0) * r + back(r, 1) * r_ty;
  }

 private:
  static Eigen::Matrix3d back(const Eigen::Matrix3d& r, double last) {
    Eigen::Matrix3d out;
    out << r(2, 2), 0, -r(0, 2), 0, r(2, 2), -r(1, 2), 0, 0, last;
    return out;
  }
};

}  // namespace

Eigen::Vector2d distort(const std::vector<double>& coefficients, const Eigen::Vector2d& ideal,
                        Eigen::Matrix2d* d_dideal) {
  const Model m(coefficients);
  const double x = ideal.x(), y = ideal.y();
  const double r2 = x * x + y * y, r4 = r2 * r2, r6 = r4 * r2;
  const double above = 1 + m.k1 * r2 + m.k2 * r4 + m.k3 * r6;
  const double below = 1 + m.k4 * r2 + m.k5 * r4 + m.k6 * r6;
  const double radial = above / below;
  Eigen::Vector2d out(
      x * radial + 2 * m.p1 * x * y + m.p2 * (r2 + 2 * x * x) + m.s1 * r2 + m.s2 * r4,
      y * radial + m.p1 * (r2 + 2 * y * y) + 2 * m.p2 * x * y + m.s3 * r2 + m.s4 * r4);
  Eigen::Matrix2d jacobian;
  // d radial / d r2, with dr2/dx = 2x and dr4/dr2 = 2 r2.
  const double dradial =
      ((m.k1 + 2 * m.k2 * r2 + 3 * m.k3 * r4) - radial * (m.k4 + 2 * m.k5 * r2 + 3 * m.k6 * r4)) /
      below;
  const double prism_x = m.s1 + 2 * m.s2 * r2, prism_y = m.s3 + 2 * m.s4 * r2;
  const double shared = 2 * x * y * dradial + 2 * m.p1 * x + 2 * m.p2 * y;
  jacobian(0, 0) = radial + 2 * x * x * dradial + 2 * m.p1 * y + 6 * m.p2 * x + 2 * x * prism_x;
  jacobian(0, 1) = shared + 2 * y * prism_x;
  jacobian(1, 0) = shared + 2 * x * prism_y;
  jacobian(1, 1) = radial + 2 * y * y * dradial + 6 * m.p1 * y + 2 * m.p2 * x + 2 * y * prism_y;
  if (m.tx != 0 || m.ty != 0) {
    const Eigen::Matrix3d h = Tilt(m.tx, m.ty).h;
    const Eigen::Vector3d tilted = h * out.homogeneous();
    out = tilted.head<2>() / tilted.z();
    const Eigen::Matrix2d d_tilt =
        (h.topLeftCorner<2, 2>() - out * h.bottomLeftCorner<1, 2>()) / tilted.z();
    jacobian = (d_tilt * jacobian).eval();
  }
  if (d_dideal) *d_dideal = jacobian;
  return out;
}

Eigen::Matrix2Xd distortion_derivative(const std::vector<double>& coefficients,
                                       const Eigen::Vector2d& ideal) {
  const Model m(coefficients);
  const double x = ideal.x(), y = ideal.y();
  const double r2 = x * x + y * y, r4 = r2 * r2, r6 = r4 * r2;
  const double below = 1 + m.k4 * r2 + m.k5 * r4 + m.k6 * r6;
  const double radial = (1 + m.k1 * r2 + m.k2 * r4 + m.k3 * r6) / below;
  const Eigen::Vector2d by_above = ideal / below, by_below = -radial / below * ideal;
  Eigen::Matrix<double, 2, 14> all = Eigen::Matrix<double, 2, 14>::Zero();
  all.col(0) = r2 * by_above, all.col(1) = r4 * by_above, all.col(4) = r6 * by_above;
  all.col(2) << 2 * x * y, r2 + 2 * y * y;
  all.col(3) << r2 + 2 * x * x, 2 * x * y;
  all.col(5) = r2 * by_below, all.col(6) = r4 * by_below, all.col(7) = r6 * by_below;
  all.col(8).x() = all.col(10).y() = r2;
  all.col(9).x() = all.col(11).y() = r4;
  if (coefficients.size() > 12) {
    std::vector<double> upright(coefficients.begin(), coefficients.begin() + 12);
    const Tilt tilt(m.tx, m.ty);
    const Eigen::Vector3d before = distort(upright, ideal).homogeneous(), after = tilt.h * before;
    const Eigen::Vector2d out = after.head<2>() / after.z();
    const auto flattened = [&](const auto& d) {
      return ((d.template topRows<2>() - out * d.row(2)) / after.z()).eval();
    };
    all.leftCols<12>() = (flattened(tilt.h.leftCols<2>().eval()) * all.leftCols<12>()).eval();
    all.col(12) = flattened((tilt.by_tx * before).eval());
    all.col(13) = flattened((tilt.by_ty * before).eval());
  }
  return all.leftCols(static_cast<Eigen::Index>(coefficients.size()));
}

Eigen::Vector2d undistort(const std::vector<double>& coefficients,
                          const Eigen::Vector2d& distorted) {
  // The fixed point x <- x - (distort(x) - target) settles on the branch that contains the optical
  // axis; Newton alone could jump to a folded branch of the polynomial.
  Eigen::Vector2d x = distorted;
  for (int i = 0; i < 5; ++i) x -= distort(coefficients, x) - distorted;
  if (!x.allFinite() || (x - distorted).norm() > 0.5 * (1 + distorted.norm())) x = distorted;
  for (int i = 0; i < 50; ++i) {
    Eigen::Matrix2d jacobian;
    const Eigen::Vector2d miss = distort(coefficients, x, &jacobian) - distorted;
    if (!miss.allFinite()) break;
    x -= jacobian.inverse() * miss;
    // Newton squares the error: the step just taken leaves rounding only.
    if (miss.norm() <= 1e-9 * (1 + distorted.norm())) return x;
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {nan, nan};
}

}  // namespace hookeye
