// What a sensor that the program was given while it runs makes of where its points are, and went.
#include "estimation/evaluation/sensor.h"

#include <fmt/format.h>

#include "estimation/model/session_sensors.h"
#include "meshing/body.h"

namespace hookeye {
namespace {

/// A point as a sum of nodes.
struct SensedPoint {
  std::vector<int> nodes;
  std::vector<double> shares;
};

std::vector<SensedPoint> places_of(const SessionSensor& sensor, const Scene& scene,
                                   std::vector<int>& counts) {
  std::vector<SensedPoint> out;
  for (const std::string& region : sensor.regions()) {
    const auto& nodes = scene.body->regions.at(region).nodes;
    for (const int node : nodes) out.push_back({{node}, {1.0}});
    counts.push_back(static_cast<int>(nodes.size()));
  }
  if (!counts.empty()) return out;
  const TetMesh& mesh = scene.body->mesh;
  const Matrix3Xd points = sensor.points();
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    SurfacePoint found;
    locate_on_boundary(mesh, points.col(i), &found);
    const VectorXd N = shape_functions(mesh.order, found.barycentric);
    SensedPoint point;
    for (int a = 0; a < N.size(); ++a)
      point.nodes.push_back(mesh.elements(a, found.element)), point.shares.push_back(N[a]);
    out.push_back(std::move(point));
  }
  counts = {static_cast<int>(points.cols())};
  return out;
}

/// x = A q + b and u = A (q - X) for each point, A and b being the placement.
void move_point(const SensedPoint& point, Eigen::Index row, const Sensed& seen,
                SensedMotion& motion) {
  const Matrix3Xd& X = seen.scene.body->mesh.X;
  Vector3d at = Vector3d::Zero(), went = Vector3d::Zero();
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(3, motion.dx.cols());
  for (size_t a = 0; a < point.nodes.size(); ++a) {
    const int node = point.nodes[a];
    const Vector3d q = seen.equilibrium.q.segment<3>(3 * node);
    at += point.shares[a] * q, went += point.shares[a] * (q - X.col(node));
    if (seen.columns) S += point.shares[a] * seen.S.middleRows(3 * node, 3);
  }
  const Eigen::Matrix3d A = seen.model.placement.linear();
  motion.x.segment<3>(row) = seen.model.placement * at;
  motion.u.segment<3>(row) = A * went;
  for (Eigen::Index j = 0; j < S.cols(); ++j) {
    const Eigen::Matrix3d dA(seen.columns->d_placement.col(j).data());
    motion.du.col(j).segment<3>(row) = A * S.col(j) + dA * went;
    motion.dx.col(j).segment<3>(row) =
        A * S.col(j) + dA * at + seen.columns->d_placement.col(j).tail<3>();
  }
}

}  // namespace

SensorPrediction sensors::sensor(const MeasuredSpec& measured, const Sensed& seen) {
  const ExampleSpec& example = seen.scene.capture.examples[static_cast<size_t>(seen.example)];
  check_sensors(seen.scene.capture, example);  // it may have been taken out since
  const auto own = find_sensor(measured.region);
  SensedMotion motion;
  motion.example = example.name;
  const std::vector<SensedPoint> points = places_of(*own, seen.scene, motion.counts);
  const auto rows = static_cast<Eigen::Index>(3 * points.size());
  motion.x.resize(rows), motion.u.resize(rows);
  const Eigen::Index columns = seen.columns ? seen.S.cols() : 0;
  motion.dx.resize(rows, columns), motion.du.resize(rows, columns);
  for (size_t i = 0; i < points.size(); ++i)
    move_point(points[i], static_cast<Eigen::Index>(3 * i), seen, motion);
  SensorAnswer answer = own->answer(motion);
  if (answer.value.size() != measured.value.size())
    throw InputError(measured.place,
                     fmt::format("`value` has {} numbers, and the sensor `{}` predicts {}",
                                 measured.value.size(), measured.region, answer.value.size()),
                     "as many numbers as the sensor's predict() returns");
  return {std::move(answer.value), std::move(answer.J)};
}

}  // namespace hookeye
