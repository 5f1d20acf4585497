// Engineering strain between two points of the body: the change of their distance over that at
// rest, as a strain gauge or an extensometer has it. Either may lie inside.
#include "estimation/evaluation/sensor.h"
#include "estimation/model/gauges.h"

namespace hookeye {

SensorPrediction sensors::strain_of(const MeasuredSpec& measured, const Sensed& seen) {
  using Span = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  const TetMesh& mesh = seen.scene.body->mesh;
  const Span span = gauge_span(mesh, measured);
  Vector3d rest = Vector3d::Zero(), now = rest;
  Eigen::MatrixXd d_now;
  if (seen.columns) d_now.setZero(3, seen.S.cols());
  for (Span::InnerIterator one(span, 0); one; ++one) {
    const Eigen::Index node = one.col();
    rest += one.value() * mesh.X.col(node);
    now += one.value() * seen.equilibrium.q.segment<3>(3 * node);
    if (seen.columns) d_now += one.value() * seen.S.middleRows(3 * node, 3);
  }
  SensorPrediction out;
  out.value = VectorXd::Constant(1, now.norm() / rest.norm() - 1.0);
  if (seen.columns) out.J = now.normalized().transpose() * d_now / rest.norm();
  return out;
}

}  // namespace hookeye
