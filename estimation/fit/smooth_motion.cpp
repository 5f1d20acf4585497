#include "estimation/fit/smooth_motion.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace hookeye {

namespace {

/// Monomials of a cell's place up to `degree`, over the field's extent.
Eigen::VectorXd monomials(const FlowField& flow, const FlowCell& cell, int degree) {
  const auto& first = flow.cells.front().centre_px;
  const double x = (cell.centre_px.x() - first.x()) / 300.0;
  const double y = (cell.centre_px.y() - first.y()) / 300.0;
  Eigen::VectorXd out((degree + 1) * (degree + 2) / 2);
  int k = 0;
  for (int n = 0; n <= degree; ++n)
    for (int i = 0; i <= n; ++i) out[k++] = std::pow(x, n - i) * std::pow(y, i);
  return out;
}

/// The basis of a cell's motion and brightness: 3 x numbers.
Eigen::MatrixXd basis_of(const FlowField& flow, const FlowCell& cell, int degree) {
  const Eigen::VectorXd phi = monomials(flow, cell, degree);
  Eigen::MatrixXd basis(3, 3 * phi.size());
  for (int k = 0; k < phi.size(); ++k)
    basis.middleCols<3>(3 * k) = phi[k] * Eigen::Matrix3d::Identity();
  return basis;
}

}  // namespace

int smooth_degree(const FlowField& flow, const FloorLimits& limits) {
  int degree = -1;
  while (degree < limits.most_degree && (degree + 2) * (degree + 3) / 2 * limits.cells_a_term <=
                                            static_cast<int>(flow.cells.size()))
    ++degree;
  return degree;
}

SmoothPart smooth_part(const FlowField& flow, int degree) {
  const int size = 3 * (degree + 1) * (degree + 2) / 2;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
  for (const auto& cell : flow.cells) {
    const Eigen::MatrixXd basis = basis_of(flow, cell, degree);
    A += basis.transpose() * cell.information * basis;
    b += basis.transpose() * (cell.information * cell.estimate);
  }
  const auto whole = A.completeOrthogonalDecomposition();
  const Eigen::VectorXd found = whole.solve(b);
  const auto brightness = Eigen::seqN(2, size / 3, 3);
  const Eigen::VectorXd b_bright = b(brightness);
  const auto bright = Eigen::MatrixXd(A(brightness, brightness)).completeOrthogonalDecomposition();
  const double explained = b.dot(found);
  return {explained, explained - b_bright.dot(bright.solve(b_bright)), static_cast<double>(size),
          static_cast<double>(whole.rank() - bright.rank()), found};
}

FlowField without_smooth(FlowField flow, const SmoothPart& smooth, int degree) {
  const FlowField whole = flow;  // monomials are over its extent
  for (FlowCell& cell : flow.cells) {
    const Eigen::Vector3d moved = basis_of(whole, cell, degree) * smooth.coefficients;
    cell.estimate -= moved;
    cell.z -=
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(cell.information).operatorSqrt() * moved;
  }
  return flow;
}

double motion_information(const FlowField& flow) {
  double sum = 0.0;
  for (const FlowCell& cell : flow.cells)
    sum += Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(cell.information.topLeftCorner<2, 2>(),
                                                          Eigen::EigenvaluesOnly)
               .eigenvalues()[1];
  return sum;
}

}  // namespace hookeye
