// By which angle a region turned about an axis of the body: what a torsion machine's encoder tells.
// The angle that brings its rest positions, seen along the axis and about their mean, nearest to
// where they are (planar Procrustes: tan = sum axis.(a x b) / sum a.b).
#include <cmath>
#include <numbers>

#include "estimation/evaluation/sensor.h"

namespace hookeye {

SensorPrediction sensors::rotation_of(const MeasuredSpec& measured, const Sensed& seen) {
  const auto& nodes = seen.scene.body->regions.at(measured.region).nodes;
  const Matrix3Xd& X = seen.scene.body->mesh.X;
  const Vector3d& axis = measured.direction;
  Vector3d centre = Vector3d::Zero();
  for (const int node : nodes) centre += X.col(node) / static_cast<double>(nodes.size());
  // Both sums are linear in q: rest offsets a have no mean, so that of q drops out.
  double sine = 0.0, cosine = 0.0;
  Eigen::RowVectorXd d_sine, d_cosine;
  if (seen.columns) d_sine.setZero(seen.S.cols()), d_cosine.setZero(seen.S.cols());
  for (const int node : nodes) {
    Vector3d a = X.col(node) - centre;
    a -= axis * axis.dot(a);
    const Eigen::RowVector3d turned = axis.cross(a).transpose();
    const Vector3d q = seen.equilibrium.q.segment<3>(3 * node);
    sine += turned * q, cosine += a.dot(q);
    if (!seen.columns) continue;
    const auto S = seen.S.middleRows(3 * node, 3);
    d_sine += turned * S, d_cosine += a.transpose() * S;
  }
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  SensorPrediction out;
  out.value = VectorXd::Constant(1, kDegrees * std::atan2(sine, cosine));
  // Of the turns that give the same picture, the one nearest to what was told.
  out.value[0] += 360.0 * std::round((measured.value[0] - out.value[0]) / 360.0);
  if (seen.columns)
    out.J = kDegrees * (cosine * d_sine - sine * d_cosine) / (sine * sine + cosine * cosine);
  return out;
}

}  // namespace hookeye
