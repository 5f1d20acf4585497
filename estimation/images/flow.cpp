#include "estimation/images/flow.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

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

/// Cells in rows, left to right, and the pixels of each that count and have a slope.
struct CellRows {
  int cell_px, columns, rows;
  CellRows(const Image& picture, int px)
      : cell_px(px), columns((picture.width - 1) / px + 1), rows((picture.height - 1) / px + 1) {}
  size_t size() const { return static_cast<size_t>(columns) * rows; }
  /// visit(cell, x, y, slope)
  template <class Visit>
  void for_each_pixel(const Image& model, const Image& residual, const Visit& visit) const {
    for (int y = 2; y + 2 < model.height; ++y)
      for (int x = 2; x + 2 < model.width; ++x) {
        if (std::isnan(residual.at(x, y))) continue;
        const Eigen::Vector2d slope = gradient(model, residual, x, y);
        if (slope.allFinite())
          visit(static_cast<size_t>(y / cell_px) * columns + x / cell_px, x, y, slope);
      }
  }
};

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
  const CellRows grid(model, cell_px);
  std::vector<CellSums> cells(grid.size());
  grid.for_each_pixel(model, residual, [&](size_t at, int x, int y, const Eigen::Vector2d& g) {
    const double s = sigma.at(x, y), r = residual.at(x, y);
    const Eigen::Vector3d d(g.x() / s, g.y() / s, gain ? model.at(x, y) / s : 0.0);
    CellSums& sums = cells[at];
    sums.A += d * d.transpose();
    sums.b += d * r;
    sums.r2 += r * r;
    sums.position += Eigen::Vector2d(x, y);
    ++sums.pixels;
  });
  // A quarter of the cell at least, of a band along a contour an eighth.
  const int least = cell_px * cell_px / (gain ? 4 : 8);
  for (size_t i = 0; i < cells.size(); ++i)
    if (cells[i].pixels >= least && cells[i].A.trace() > 0.0)
      field.cells.push_back(solve_cell(cells[i], static_cast<int>(i) % grid.columns,
                                       static_cast<int>(i) / grid.columns));
  return field;
}

double variance_after_free_motion(const Image& model, const Image& residual, const Image& sigma,
                                  int cell_px) {
  constexpr int kFree = 5;  // motion, brightness, background, sharpness
  struct Cell {
    Eigen::Matrix<double, kFree, kFree> A = Eigen::Matrix<double, kFree, kFree>::Zero();
    Eigen::Matrix<double, kFree, 1> b = Eigen::Matrix<double, kFree, 1>::Zero();
    double r2 = 0.0;
    int pixels = 0;
  };
  const CellRows grid(model, cell_px);
  std::vector<Cell> cells(grid.size());
  grid.for_each_pixel(model, residual, [&](size_t at, int x, int y, const Eigen::Vector2d& g) {
    const double here = model.at(x, y), r = residual.at(x, y);
    const double sharpness = model.at(x + 1, y) + model.at(x - 1, y) + model.at(x, y + 1) +
                             model.at(x, y - 1) - 4.0 * here;
    Eigen::Matrix<double, kFree, 1> d(g.x(), g.y(), here, 1.0, sharpness);
    d /= sigma.at(x, y);
    Cell& cell = cells[at];
    cell.A += d * d.transpose();
    cell.b += d * r;
    cell.r2 += r * r;
    ++cell.pixels;
  });
  std::vector<double> left;
  for (const Cell& cell : cells) {
    if (cell.pixels < cell_px * cell_px / 4) continue;
    const auto solved = cell.A.completeOrthogonalDecomposition();
    left.push_back(std::max(0.0, cell.r2 - cell.b.dot(solved.solve(cell.b))) /
                   static_cast<double>(cell.pixels - solved.rank()));
  }
  if (left.empty()) return 1.0;
  const auto middle = left.begin() + static_cast<std::ptrdiff_t>(left.size() / 2);
  std::nth_element(left.begin(), middle, left.end());
  return *middle;
}

double FlowField::rms_px() const {
  double sum = 0.0, noise = 0.0, n = 0.0;
  for (const auto& cell : cells) {
    const bool rim = cell.information(2, 2) == 0.0;  // no brightness: it tells of one direction
    if (!cell.reliable && !rim) continue;
    if (rim) {
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(
          cell.information.topLeftCorner<2, 2>());
      if (eigen.eigenvalues()[1] < 1.0) continue;
      sum += std::pow(eigen.eigenvectors().col(1).dot(cell.estimate.head<2>()), 2);
      noise += 1.0 / eigen.eigenvalues()[1];
    } else {
      const Eigen::Matrix3d covariance = cell.information.inverse();
      sum += cell.estimate.head<2>().squaredNorm();
      noise += covariance(0, 0) + covariance(1, 1);
    }
    n += 1.0;
  }
  return n > 0.0 ? std::sqrt(std::max(0.0, (sum - noise) / n)) : 0.0;
}

namespace {

/// The cells of a photo by row and column.
class CellGrid {
 public:
  explicit CellGrid(const FlowField& flow) : cells_(flow.cells) {
    for (const auto& cell : cells_)
      rows_ = std::max(rows_, cell.row + 1), columns_ = std::max(columns_, cell.column + 1);
    at_.assign(static_cast<size_t>(rows_) * columns_, nullptr);
    for (const auto& cell : cells_)
      at_[static_cast<size_t>(cell.row) * columns_ + cell.column] = &cell;
  }
  struct Lag {
    double product = 0.0, pairs = 0.0;
  };
  /// Sums over all pairs of cells so far apart.
  Lag lag(int dy, int dx) const {
    Lag out;
    for (const auto& cell : cells_) {
      const int row = cell.row + dy, column = cell.column + dx;
      if (row < 0 || row >= rows_ || column < 0 || column >= columns_) continue;
      const FlowCell* other = at_[static_cast<size_t>(row) * columns_ + column];
      if (!other) continue;
      out.product += cell.z.dot(other->z);
      out.pairs += std::min(cell.known, other->known);
    }
    return out;
  }
  /// Sums over the cells that another channel of the photo has too.
  Lag same_cells(const FlowField& channel) const {
    Lag out;
    for (const auto& cell : channel.cells) {
      if (cell.row >= rows_ || cell.column >= columns_) continue;
      const FlowCell* own = at_[static_cast<size_t>(cell.row) * columns_ + cell.column];
      if (!own) continue;
      out.product += cell.z.dot(own->z);
      out.pairs += std::min(cell.known, own->known);
    }
    return out;
  }

 private:
  const std::vector<FlowCell>& cells_;
  int rows_ = 0, columns_ = 0;
  std::vector<const FlowCell*> at_;
};

}  // namespace

FlowStatistics flow_statistics(const FlowField& flow) {
  FlowStatistics out;
  for (const auto& cell : flow.cells) {
    out.variance += cell.z.squaredNorm();
    out.count += cell.known;
  }
  if (out.count == 0.0) return out;
  out.variance /= out.count;
  const CellGrid grid(flow);
  // Autocovariance ring by ring (Chebyshev distance). Its sum ends where a ring is
  // indistinguishable from zero: the sum over all lags is that of one number squared. The sum of
  // squares goes over all lags, less what noise alone gives: a bend is correlated across the body
  // and changes sign along it, so that neither the mean of a ring nor its first zero tells where
  // correlation ends.
  double sum_cov = out.variance, sum_rho2 = 1.0, q = 0.0;
  bool correlated = true;
  for (int ring = 1; ring <= 40; ++ring) {
    double ring_product = 0.0, ring_pairs = 0.0;
    for (int dy = 0; dy <= ring; ++dy)
      for (int dx = dy == 0 ? 1 : -ring; dx <= ring; ++dx) {  // (-dy, -dx) has the same sums
        if (std::max(std::abs(dx), std::abs(dy)) != ring) continue;
        const CellGrid::Lag lag = grid.lag(dy, dx);
        if (lag.pairs == 0.0) continue;
        const double rho = lag.product / lag.pairs / out.variance;
        sum_rho2 += 2.0 * (rho * rho * lag.pairs - 1.0) / out.count;  // 1: mean of white noise
        ring_product += 2.0 * lag.product;
        ring_pairs += 2.0 * lag.pairs;
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

std::vector<FlowStatistics> flow_statistics(const std::vector<const FlowField*>& channels) {
  std::vector<FlowStatistics> alone;
  for (const FlowField* channel : channels) alone.push_back(flow_statistics(*channel));
  std::vector<FlowStatistics> out = alone;
  for (size_t i = 0; i < channels.size(); ++i) {
    const CellGrid grid(*channels[i]);
    double sum_rho = 1.0, sum_rho2 = 1.0;
    for (size_t j = 0; j < channels.size(); ++j) {
      if (j == i || alone[i].count == 0.0 || alone[j].count == 0.0) continue;
      const CellGrid::Lag lag = grid.same_cells(*channels[j]);
      if (lag.pairs == 0.0) continue;
      const double rho = lag.product / lag.pairs / std::sqrt(alone[i].variance * alone[j].variance);
      if (rho * std::sqrt(lag.pairs) < 2.0) continue;  // as rings of lags are judged
      sum_rho += std::min(rho, 1.0);
      sum_rho2 += std::min(rho * rho, 1.0);
    }
    out[i].inflation *= sum_rho;
    out[i].effective = std::max(1.0, out[i].effective / sum_rho2);
  }
  return out;
}

}  // namespace hookeye
