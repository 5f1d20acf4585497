// Where a point of the surface is, in the world: the frame that cameras stand in.
#include "estimation/evaluation/sensor.h"
#include "meshing/body.h"

namespace hookeye {

SensorPrediction sensors::position_of(const MeasuredSpec& measured, const Sensed& seen) {
  const TetMesh& mesh = seen.scene.body->mesh;
  SurfacePoint point;
  locate_on_boundary(mesh, measured.point, &point);
  const VectorXd N = shape_functions(mesh.order, point.barycentric);
  SensorPrediction out;
  Vector3d x = Vector3d::Zero();
  if (seen.columns) out.J.setZero(3, seen.S.cols());
  for (int a = 0; a < N.size(); ++a) {
    const int node = mesh.elements(a, point.element);
    x += N[a] * seen.equilibrium.q.segment<3>(3 * node);
    if (seen.columns)
      out.J += N[a] * seen.model.placement.linear() * seen.S.middleRows(3 * node, 3);
  }
  out.value = seen.model.placement * x;
  for (Eigen::Index j = 0; j < out.J.cols(); ++j)
    out.J.col(j) += Eigen::Map<const Eigen::Matrix3d>(seen.columns->d_placement.col(j).data()) * x +
                    seen.columns->d_placement.col(j).tail<3>();
  return out;
}

}  // namespace hookeye
