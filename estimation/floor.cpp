#include "estimation/floor.h"

#include <cmath>

namespace hookeye {

namespace {

/// 1, x, y, x^2, xy, y^2 of the cell's place, over the field's extent.
Eigen::Matrix<double, 6, 1> quadratic(const FlowField& flow, const FlowCell& cell) {
  const auto& first = flow.cells.front().centre_px;
  const double x = (cell.centre_px.x() - first.x()) / 300.0;
  const double y = (cell.centre_px.y() - first.y()) / 300.0;
  return (Eigen::Matrix<double, 6, 1>() << 1.0, x, y, x * x, x * y, y * y).finished();
}

/// Sum of |z|^2 that is left when motion and brightness follow the best quadratic of the place:
/// weight, swelling, placement and exposure are smooth, what a renderer gets wrong is not.
void add_rough_part(const FlowField& flow, double& sum, double& count) {
  if (flow.cells.size() < 20) return;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(18, 18);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(18);
  double z2 = 0.0;
  for (const auto& cell : flow.cells) {
    const auto phi = quadratic(flow, cell);
    Eigen::Matrix<double, 3, 18> basis = Eigen::Matrix<double, 3, 18>::Zero();
    for (int k = 0; k < 6; ++k) basis.middleCols<3>(3 * k) = phi[k] * Eigen::Matrix3d::Identity();
    A += basis.transpose() * cell.information * basis;
    b += basis.transpose() * (cell.information * cell.estimate);
    z2 += cell.z.squaredNorm();
  }
  const double smooth = b.dot(A.completeOrthogonalDecomposition().solve(b));
  sum += std::max(z2 - smooth, 0.0);
  count += 3.0 * static_cast<double>(flow.cells.size()) - 18.0;
}

}  // namespace

Floor measure_floor(const Scene& scene, const Evaluation& evaluation) {
  Floor floor;
  double r2 = 0.0, count = 0.0, cells = 0.0, cell_count = 0.0, inflation = 0.0, photos = 0.0;
  for (const auto& example : evaluation.examples) {
    if (!is_rest(scene.capture.examples[example.example])) continue;
    for (const auto& photo : example.photos) {
      add_rough_part(photo.aligned, cells, cell_count);
      inflation += flow_statistics(photo.aligned).inflation;
      photos += 1.0;
      for (const auto& cell : photo.aligned.cells) {
        r2 += cell.r2 - cell.explained;
        count += cell.pixels - 3.0;  // three numbers were fitted to each cell
      }
    }
  }
  // A hundred cells' worth of pixels at least, else the told noise is the better witness.
  if (count < 1000.0) return floor;
  floor.chi = std::sqrt(r2 / count);
  floor.source = "rest photos";
  floor.cell_inflation = std::max(1.0, inflation / photos);
  if (cell_count > 0.0) floor.cell_variance = std::max(1.0, cells / cell_count);
  return floor;
}

}  // namespace hookeye
