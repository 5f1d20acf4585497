#include "placing/placing.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "meshing/extent.h"

namespace hookeye {
namespace {

constexpr double kHalfTurn = EIGEN_PI, kDegree = kHalfTurn / 180.0;

std::string vector_words(const Vector3d& v) {
  const auto plain = [](double x) { return std::abs(x) < 0.005 ? 0.0 : x; };
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", plain(v.x()), plain(v.y()), plain(v.z()));
}

}  // namespace

PlacedBody placed_body(const SurfaceMesh& surface, const std::string& length) {
  PlacedBody out;
  out.surface = &surface;
  out.length = length;
  out.extent = extent(surface.X);
  double area = 0.0;
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const auto& t : surface.triangles) {
    const Vector3d a = surface.X.col(t[0]), b = surface.X.col(t[1]), c = surface.X.col(t[2]);
    const double part = 0.5 * (b - a).cross(c - a).norm();
    const Vector3d m = (a + b + c) / 3.0;
    area += part;
    out.middle += part * m;
    // exact for flat triangles
    second += part / 12.0 *
              (a * a.transpose() + b * b.transpose() + c * c.transpose() + 9.0 * m * m.transpose());
  }
  out.middle /= area;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(second / area -
                                                              out.middle * out.middle.transpose());
  for (int i = 0; i < 3; ++i) {
    out.axes.col(i) = solver.eigenvectors().col(2 - i);
    out.spread[i] = std::sqrt(std::max(solver.eigenvalues()[2 - i], 0.0));
  }
  if (out.axes.determinant() < 0.0) out.axes.col(2) *= -1.0;
  return out;
}

double angle_of(const Isometry3d& motion) { return Eigen::AngleAxisd(motion.linear()).angle(); }

double shift_of(const Isometry3d& motion, const Vector3d& middle) {
  return (motion * middle - middle).norm();
}

bool apart(const Isometry3d& a, const Isometry3d& b, const Vector3d& middle, double radians,
           double length) {
  const Eigen::Matrix3d between = a.linear().transpose() * b.linear();
  return Eigen::AngleAxisd(between).angle() > radians || (a * middle - b * middle).norm() > length;
}

void set_errors(const Matrix6d& information, const PlacedBody& body, Placing* placing) {
  constexpr double kOpen = 0.15;  // of the body's radius: known no better than by a look
  const double radius = 0.5 * body.extent;
  // Turns as lengths at the body's radius, so that both kinds of numbers compare.
  Vector6d scale;
  scale << Vector3d::Constant(1.0 / radius), Vector3d::Ones();
  const Matrix6d in_lengths = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(in_lengths);
  Matrix6d covariance = Matrix6d::Zero();
  for (int i = 0; i < 6; ++i) {
    const Vector6d direction = solver.eigenvectors().col(i);
    const double value = solver.eigenvalues()[i];
    const double error = value > 0.0 ? 1.0 / std::sqrt(value) : INFINITY;
    const double kept = std::min(error, radius);
    covariance += kept * kept * direction * direction.transpose();
    if (error < kOpen * radius) continue;
    const Vector3d turn = direction.head<3>(), shift = direction.tail<3>();
    const bool turns = turn.norm() > shift.norm();
    placing->warnings.push_back(fmt::format(
        "{} is left open, it may be off by {}: the body looks alike after it, or nothing that was "
        "told shows it; a further view or point does",
        turns ? "a turn about " + vector_words(turn.normalized())
              : "a shift along " + vector_words(shift.normalized()),
        turns ? fmt::format("{:.0f} degrees", std::min(error / radius, kHalfTurn) / kDegree)
              : fmt::format("{:.3g} {}", kept, body.length)));
  }
  placing->covariance = scale.asDiagonal() * covariance * scale.asDiagonal();
}

void warn_of_others(const PlacedBody& body, Placing* placing) {
  for (const OtherPlace& other : placing->others) {
    const Isometry3d between = placing->motion.inverse() * other.motion;
    const Eigen::AngleAxisd turn(between.linear());
    placing->warnings.push_back(fmt::format(
        "ambiguous: turned by a further {:.0f} degrees about {} of the body and shifted by {:.3g} "
        "{} it fits about as well ({:.3g} against {:.3g} {}); the place nearer to the told one is "
        "taken",
        turn.angle() / kDegree, vector_words(turn.axis()), shift_of(between, body.middle),
        body.length, other.misfit, placing->misfit, placing->misfit_unit));
  }
}

ToldPlacement placed(const ToldPlacement& told, const Isometry3d& motion) {
  ToldPlacement out = told;
  out.R = told.R * motion.linear();
  out.t = told.R * motion.translation() + told.t;
  return out;
}

std::vector<Isometry3d> likely_symmetries(const PlacedBody& body) {
  constexpr double kAlike = 0.1;  // of a spread
  std::vector<Isometry3d> all;
  const auto add = [&](int axis, double degrees) {
    const Eigen::AngleAxisd turn(degrees * kDegree, body.axes.col(axis));
    all.push_back(Eigen::Translation3d(body.middle) * turn * Eigen::Translation3d(-body.middle));
  };
  for (int i = 0; i < 3; ++i) {
    add(i, 180.0);
    const double a = body.spread[(i + 1) % 3], b = body.spread[(i + 2) % 3];
    if (std::abs(a - b) < kAlike * std::max(a, b)) add(i, 90.0), add(i, -90.0);
  }
  return all;
}

std::vector<Eigen::Matrix3d> cube_turns() {
  std::vector<Eigen::Matrix3d> all;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (const int signs : {0, 1, 2, 3}) {
        if (i == j) continue;
        Eigen::Matrix3d R;
        R.col(0) = (signs & 1 ? -1.0 : 1.0) * Vector3d::Unit(i);
        R.col(1) = (signs & 2 ? -1.0 : 1.0) * Vector3d::Unit(j);
        R.col(2) = R.col(0).cross(R.col(1));
        all.push_back(R);
      }
  return all;
}

}  // namespace hookeye
