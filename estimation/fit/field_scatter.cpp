#include "estimation/fit/field_scatter.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "capture_io/component_sigmas.h"
#include "capture_io/field_start.h"
#include "estimation/fit/field_floor.h"

namespace hookeye {

namespace {

constexpr int kNear = 13, kFar = 49;

/// Median of chi^2 / dof (Wilson and Hilferty 1931).
double middle_of_chi2(double dof) { return std::pow(1.0 - 2.0 / (9.0 * dof), 3); }

double middle(std::vector<double>& values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Places in the tangent plane, over their extent: 2 x n. No columns: the surface is crooked there,
/// or another one lies behind it.
Eigen::Matrix2Xd in_tangent_plane(const Matrix3Xd& X) {
  constexpr double kFlat = 0.2;     // thickness over width, of an edge of the body 0.5
  constexpr double kStacked = 0.5;  // distance in the plane over that in space
  const Matrix3Xd apart = X.colwise() - X.rowwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(apart * apart.transpose());
  const Eigen::Vector3d width2 = axes.eigenvalues();  // rising; of a line the first two are none
  if (width2[0] > kFlat * kFlat * std::max(width2[1], 1e-9 * width2[2])) return {};
  Eigen::Matrix2Xd out = axes.eigenvectors().rightCols<2>().transpose() * apart;
  for (Eigen::Index i = 1; i < X.cols(); ++i)
    if ((out.col(i) - out.col(0)).norm() < kStacked * (X.col(i) - X.col(0)).norm()) return {};
  const double size = out.cwiseAbs().maxCoeff();
  if (size > 0.0) out /= size;
  return out;
}

/// What a surface of second order leaves of each component, per degree of freedom.
VectorXd left_by_second_order(const Eigen::Matrix2Xd& x, const Eigen::MatrixXd& values) {
  Eigen::MatrixXd basis(x.cols(), 6);
  basis.col(0).setOnes();
  basis.middleCols(1, 2) = x.transpose();
  basis.col(3) = x.row(0).cwiseAbs2().transpose();
  basis.col(4) = x.row(0).cwiseProduct(x.row(1)).transpose();
  basis.col(5) = x.row(1).cwiseAbs2().transpose();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(1e-6);
  qr.compute(basis);
  const Eigen::MatrixXd turned = qr.householderQ().adjoint() * values;
  const Eigen::Index dof = x.cols() - qr.rank();
  return turned.bottomRows(dof).colwise().squaredNorm().transpose() / static_cast<double>(dof);
}

/// By component: what is left, over all points asked.
using LeftAtPoints = std::vector<std::vector<double>>;

/// Adds what is left about one point; `order` is room for the points' numbers.
void add_left(const MeasuredSpec& spec, Eigen::Index at, std::vector<Eigen::Index>& order,
              std::array<LeftAtPoints, 2>& left) {
  const FieldSpec& field = *spec.field;
  const VectorXd d2 = (field.X.colwise() - field.X.col(at)).colwise().squaredNorm();
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::partial_sort(order.begin(), order.begin() + kFar, order.end(),
                    [&](Eigen::Index a, Eigen::Index b) { return d2[a] < d2[b]; });
  const std::vector<Eigen::Index> near(order.begin(), order.begin() + kFar);
  const Eigen::Map<const Eigen::MatrixXd> u(spec.value.data(), field.components, field.X.cols());
  const Eigen::MatrixXd values = u(Eigen::all, near).transpose();
  const Eigen::Matrix2Xd x = in_tangent_plane(field.X(Eigen::all, near));
  if (x.cols() == 0) return;
  const VectorXd small = left_by_second_order(x.leftCols(kNear), values.topRows(kNear));
  const VectorXd large = left_by_second_order(x, values);
  for (int c = 0; c < field.components; ++c) {
    left[0][static_cast<size_t>(c)].push_back(small[c]);
    left[1][static_cast<size_t>(c)].push_back(large[c]);
  }
}

}  // namespace

std::optional<LeastNoise> scatter_of_neighbours(const MeasuredSpec& spec) {
  constexpr Eigen::Index kMostPoints = 2000, kMostPairs = 20'000'000;
  constexpr size_t kLeastPoints = 20;
  const FieldSpec& field = *spec.field;
  const Eigen::Index n = field.X.cols();
  if (n < kFar || field.strain) return {};
  const Eigen::Index asked = std::clamp<Eigen::Index>(kMostPairs / n, 1, kMostPoints);
  const Eigen::Index step = (n + asked - 1) / asked;
  const LeftAtPoints none(static_cast<size_t>(field.components));
  std::array<LeftAtPoints, 2> left{none, none};
  std::vector<Eigen::Index> order(static_cast<size_t>(n));
  for (Eigen::Index at = 0; at < n; at += step) add_left(spec, at, order, left);
  const size_t points = left[0].front().size();
  if (points < kLeastPoints) return {};
  constexpr double kGrows = double(kFar) / kNear, kTerms = 6.0;
  LeastNoise out;
  for (size_t c = 0; c < left[0].size(); ++c) {
    const double small = middle(left[0][c]) / middle_of_chi2(kNear - kTerms);
    const double large = middle(left[1][c]) / middle_of_chi2(kFar - kTerms);
    out.sigma.push_back(std::sqrt(std::max(0.0, (kGrows * small - large) / (kGrows - 1.0))));
  }
  // Half a degree of freedom a point; a median knows two thirds of what a mean does; the difference
  // with what is large takes a factor of kGrows / (kGrows - 1).
  out.error = std::sqrt(1.5 / static_cast<double>(points)) * kGrows / (kGrows - 1.0);
  return out;
}

namespace {

/// What planes leave of numbers over their noise, by component in the field's unit.
std::optional<LeastNoise> rough_parts(const MeasuredSpec& spec, const VectorXd& over) {
  const FieldSpec& field = *spec.field;
  const VectorXd sigmas = component_sigmas(spec);
  LeastNoise out;
  for (int c = 0; c < field.components; ++c) {
    VectorXd one = VectorXd::Zero(over.size());
    for (Eigen::Index i = c; i < over.size(); i += field.components) one[i] = over[i];
    const RoughField rough = rough_field(field, one);
    if (!(rough.count > 0.0)) return {};
    // The others count, and have nothing.
    out.sigma.push_back(std::sqrt(double(field.components)) * rough.chi() * sigmas[c]);
    out.error = 1.0 / std::sqrt(2.0 * rough.count / field.components);
  }
  return out;
}

}  // namespace

std::optional<LeastNoise> scatter_in_pieces(const MeasuredSpec& field) {
  return rough_parts(field, field.value.cwiseQuotient(field.sigma));
}

std::optional<LeastNoise> scatter_of_repeats(const MeasuredSpec& one, const MeasuredSpec& other) {
  const FieldSpec &a = *one.field, &b = *other.field;
  const bool same = a.X.cols() == b.X.cols() && a.components == b.components &&
                    (a.strain != nullptr) == (b.strain != nullptr) &&
                    start_of(one) == start_of(other) && a.axes.isApprox(b.axes) &&
                    (a.X - b.X).cwiseAbs().maxCoeff() <= 1e-6 * a.spacing;
  if (!same || (a.strain && a.strain->measure != b.strain->measure)) return {};
  // A copy of the file is no second measurement.
  if (one.value == other.value) return {};
  return rough_parts(one, ((one.value - other.value) / std::sqrt(2.0)).cwiseQuotient(one.sigma));
}

}  // namespace hookeye
