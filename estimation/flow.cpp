#include "estimation/flow.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

namespace hookeye {

namespace {

struct CellSums {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double r2 = 0.0;
  int pixels = 0;
};

/// Fourth-order central difference where its neighbours count, else NaN: the second-order one is
/// 7 % short on speckle of ten pixels, and every motion would come out that much too long.
Eigen::Vector2d gradient(const Image& model, const Image& residual, int x, int y) {
  auto along = [&](int dx, int dy) {
    for (int k : {-2, -1, 1, 2})
      if (std::isnan(residual.at(x + k * dx, y + k * dy))) return std::nan("");
    return (8.0 * (model.at(x + dx, y + dy) - model.at(x - dx, y - dy)) -
            (model.at(x + 2 * dx, y + 2 * dy) - model.at(x - 2 * dx, y - 2 * dy))) /
           12.0;
  };
  return {along(1, 0), along(0, 1)};
}

FlowCell solve_cell(const CellSums& sums, int column, int row) {
  FlowCell cell{};
  cell.column = column;
  cell.row = row;
  cell.pixels = sums.pixels;
  cell.centre_px = sums.position / sums.pixels;
  cell.information = sums.A;
  cell.r2 = sums.r2;
  // A weak direction has no estimate, but A + tiny keeps z defined.
  constexpr double kKnown =
      1e-6;  // of all information: a contour tells nothing of motions along it
  const Eigen::Vector3d information =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sums.A, Eigen::EigenvaluesOnly).eigenvalues();
  cell.known = static_cast<int>((information.array() > kKnown * sums.A.trace()).count());
  const Eigen::Matrix3d A = sums.A + 1e-9 * sums.A.trace() * Eigen::Matrix3d::Identity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(A);
  cell.z = eigen.operatorInverseSqrt() * sums.b;
  cell.estimate = A.ldlt().solve(sums.b);
  cell.explained = cell.z.squaredNorm();
  const Eigen::Matrix3d covariance = A.inverse();
  cell.reliable = covariance(0, 0) < 1.0 && covariance(1, 1) < 1.0;
  return cell;
}

}  // namespace

FlowField residual_flow(const Image& model, const Image& residual, const Image& sigma, bool gain,
                        int cell_px) {
  FlowField field;
  field.cell_px = cell_px;
  std::map<std::pair<int, int>, CellSums> cells;
  for (int y = 2; y + 2 < model.height; ++y)
    for (int x = 2; x + 2 < model.width; ++x) {
      if (std::isnan(residual.at(x, y))) continue;
      const Eigen::Vector2d g = gradient(model, residual, x, y);
      if (!g.allFinite()) continue;
      const double s = sigma.at(x, y);
      const Eigen::Vector3d d(g.x() / s, g.y() / s, gain ? model.at(x, y) / s : 0.0);
      CellSums& sums = cells[{y / cell_px, x / cell_px}];
      const double r = residual.at(x, y);
      sums.A += d * d.transpose();
      sums.b += d * r;
      sums.r2 += r * r;
      sums.position += Eigen::Vector2d(x, y);
      ++sums.pixels;
    }
  // A quarter of the cell at least, of a band along a contour an eighth.
  const int least = cell_px * cell_px / (gain ? 4 : 8);
  for (const auto& [index, sums] : cells)
    if (sums.pixels >= least && sums.A.trace() > 0.0)
      field.cells.push_back(solve_cell(sums, index.second, index.first));
  return field;
}

double FlowField::rms_px() const {
  double sum = 0.0, noise = 0.0, n = 0.0;
  for (const auto& cell : cells) {
    if (!cell.reliable) continue;
    const Eigen::Matrix3d covariance = cell.information.inverse();
    sum += cell.estimate.head<2>().squaredNorm();
    noise += covariance(0, 0) + covariance(1, 1);
    n += 1.0;
  }
  return n > 0.0 ? std::sqrt(std::max(0.0, (sum - noise) / n)) : 0.0;
}

FlowStatistics flow_statistics(const FlowField& flow) {
  FlowStatistics out;
  std::map<std::pair<int, int>, const FlowCell*> at;
  for (const auto& cell : flow.cells) {
    at[{cell.row, cell.column}] = &cell;
    out.variance += cell.z.squaredNorm();
    out.count += cell.known;
  }
  if (out.count == 0.0) return out;
  out.variance /= out.count;
  // Autocovariance ring by ring (Chebyshev distance). Its sum ends where a ring is
  // indistinguishable from zero: the sum over all lags is that of one number squared. The sum of
  // squares goes over all lags, less what noise alone gives: a bend is correlated across the body
  // and changes sign along it, so that neither the mean of a ring nor its first zero tells where
  // correlation ends.
  double sum_cov = out.variance, sum_rho2 = 1.0, q = 0.0;
  bool correlated = true;
  for (int ring = 1; ring <= 40; ++ring) {
    double ring_product = 0.0, ring_pairs = 0.0;
    for (int dy = -ring; dy <= ring; ++dy)
      for (int dx = -ring; dx <= ring; ++dx) {
        if (std::max(std::abs(dx), std::abs(dy)) != ring) continue;
        double product = 0.0, pairs = 0.0;
        for (const auto& cell : flow.cells) {
          const auto other = at.find({cell.row + dy, cell.column + dx});
          if (other == at.end()) continue;
          product += cell.z.dot(other->second->z);
          pairs += std::min(cell.known, other->second->known);
        }
        if (pairs == 0.0) continue;
        const double rho = product / pairs / out.variance;
        sum_rho2 += (rho * rho * pairs - 1.0) / out.count;  // 1: mean of white noise
        ring_product += product;
        ring_pairs += pairs;
      }
    if (ring_pairs == 0.0) break;
    // Each pair is met twice, so pairs/2 independent products of variance 1/(pairs/2).
    const double deviation = ring_product / ring_pairs / out.variance * std::sqrt(ring_pairs / 2.0);
    if (ring == 1) q = deviation * deviation;
    correlated = correlated && deviation >= 2.0;
    if (correlated) sum_cov += ring_product / out.count;
  }
  out.inflation = std::max(1.0, sum_cov);
  out.effective = std::clamp(out.count / sum_rho2, 1.0, out.count);
  // Unit variance: sqrt(2 count)-normal; neighbours: chi^2 of one degree.
  const double excess = (out.variance - 1.0) * std::sqrt(out.count / 2.0);
  const double p_variance = 0.5 * std::erfc(excess / std::sqrt(2.0));
  const double p_neighbours = std::erfc(std::sqrt(q / 2.0));
  out.whiteness_p = std::min(1.0, 2.0 * std::min(p_variance, p_neighbours));
  return out;
}

}  // namespace hookeye
