#include "exporters/seen_motion.h"

#include <cmath>

namespace hookeye::detail {

void MotionCells::add(const FlowField& flow) {
  cell_px_ = flow.cell_px;
  for (const FlowCell& cell : flow.cells) {
    if (!cell.reliable) continue;
    // What is left of the motion's information once the brightness of the cell is free.
    Eigen::Matrix2d information = cell.information.topLeftCorner<2, 2>();
    if (cell.information(2, 2) > 0.0)
      information -= cell.information.block<2, 1>(0, 2) * cell.information.block<1, 2>(2, 0) /
                     cell.information(2, 2);
    const std::pair at{cell.column, cell.row};
    cells_[at].push_back({cell.estimate.head<2>(), information});
    centres_[at] = cell.centre_px;
  }
}

std::optional<MotionCells::Motion> MotionCells::at(const Eigen::Vector2d& px) const {
  constexpr double kLeast = 0.25;  // weight; less lies outside of what the cells cover
  const int column = static_cast<int>(std::floor(px.x() / cell_px_));
  const int row = static_cast<int>(std::floor(px.y() / cell_px_));
  double sum = 0.0;
  Motion out{Eigen::Vector2d::Zero(), Eigen::Matrix2d::Zero()};
  for (int i = column - 1; i <= column + 1; ++i)
    for (int j = row - 1; j <= row + 1; ++j) {
      const auto cell = cells_.find({i, j});
      if (cell == cells_.end()) continue;
      const Eigen::Vector2d off = (px - centres_.at({i, j})).cwiseAbs() / cell_px_;
      if (off.maxCoeff() >= 1.0) continue;
      const double weight = (1.0 - off.x()) * (1.0 - off.y());
      // Channels of one photo are one measurement: their mean, with the information of one.
      const double each = weight / static_cast<double>(cell->second.size());
      for (const Motion& one : cell->second)
        out.u += each * one.u, out.information += each * one.information;
      sum += weight;
    }
  if (sum < kLeast) return {};
  out.u /= sum, out.information /= sum;
  return out;
}

SpaceMotion motion_in_space(const std::vector<std::pair<const Camera*, MotionCells::Motion>>& seen,
                            const Vector3d& x) {
  constexpr double kKnown = 1e-3;  // of the best direction's information: 30 times its sigma
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Vector3d g = Vector3d::Zero();
  for (const auto& [camera, motion] : seen) {
    Camera::Jacobian3 d_dx;
    Camera::Jacobian7 unused;
    camera->project(x, &d_dx, &unused);
    if (!d_dx.allFinite()) continue;
    H += d_dx.transpose() * motion.information * d_dx;
    g += d_dx.transpose() * motion.information * motion.u;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(H);
  SpaceMotion out;
  const double best = eigen.eigenvalues()[2];
  if (!(best > 0.0)) return out;
  for (int k = 0; k < 3; ++k) {
    const double information = eigen.eigenvalues()[k];
    if (information < kKnown * best) continue;
    const Vector3d direction = eigen.eigenvectors().col(k);
    out.u += direction * direction.dot(g) / information;
    out.sigma = std::max(out.sigma, 1.0 / std::sqrt(information));
    ++out.known;
  }
  return out;
}

}  // namespace hookeye::detail
