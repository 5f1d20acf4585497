// How far a region went along a direction of the world: a jaw's travel. The mean over its nodes of
// their displacement from where they are in the body as it was given.
#include "estimation/evaluation/sensor.h"

namespace hookeye {

SensorPrediction sensors::travel_of(const MeasuredSpec& measured, const Sensed& seen) {
  const auto& nodes = seen.scene.body->regions.at(measured.region).nodes;
  const Matrix3Xd& X = seen.scene.body->mesh.X;
  const double each = 1.0 / static_cast<double>(nodes.size());
  const Eigen::RowVector3d along = measured.direction.transpose() * seen.model.placement.linear();
  SensorPrediction out;
  Vector3d u = Vector3d::Zero();
  if (seen.columns) out.J.setZero(1, seen.S.cols());
  for (const int node : nodes) {
    u += each * (seen.equilibrium.q.segment<3>(3 * node) - X.col(node));
    if (seen.columns) out.J += each * along * seen.S.middleRows(3 * node, 3);
  }
  out.value = along * u;
  for (Eigen::Index j = 0; j < out.J.cols(); ++j)
    out.J(0, j) += measured.direction.dot(
        Eigen::Map<const Eigen::Matrix3d>(seen.columns->d_placement.col(j).data()) * u);
  return out;
}

}  // namespace hookeye
