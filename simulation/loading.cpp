#include "simulation/loading.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/input_error.h"
#include "simulation/rigid_modes.h"

namespace hookeye {
namespace {

/// Merges unknown -> displacement into the sorted lists; new values win.
void merge(const std::map<int, double>& added, Loading& loading) {
  std::map<int, double> all = added;
  for (size_t i = 0; i < loading.prescribed.size(); ++i)
    all.emplace(loading.prescribed[i], loading.displacement[static_cast<Eigen::Index>(i)]);
  loading.prescribed.clear();
  loading.displacement.resize(static_cast<Eigen::Index>(all.size()));
  for (const auto& [unknown, u] : all) {
    loading.displacement[static_cast<Eigen::Index>(loading.prescribed.size())] = u;
    loading.prescribed.push_back(unknown);
  }
}

}  // namespace

void Loading::prescribe(const TetMesh&, const Region& region, int component, double displacement_) {
  std::map<int, double> added;
  for (int a : region.nodes) added[3 * a + component] = displacement_;
  merge(added, *this);
}

void Loading::prescribe_rigid(const TetMesh& mesh, const Region& region,
                              const RigidMotion& motion) {
  std::map<int, double> added;
  for (int a : region.nodes) {
    const Vector3d X = mesh.X.col(a), u = motion.apply(X) - X;
    for (int i = 0; i < 3; ++i) added[3 * a + i] = u[i];
  }
  merge(added, *this);
  std::erase_if(turns, [&](const Turn& turn) { return turn.nodes == region.nodes; });
  if (motion.degrees != 0.0) turns.push_back({region.nodes, motion});
}

double Loading::displacement_at(const Matrix3Xd& X, size_t i, double s) const {
  const int node = prescribed[i] / 3, component = prescribed[i] % 3;
  double u = s * displacement[static_cast<Eigen::Index>(i)];
  for (const Turn& turn : turns)
    if (std::binary_search(turn.nodes.begin(), turn.nodes.end(), node)) {
      const Vector3d x = X.col(node);
      u += (turn.motion.part(s).apply(x) - x - s * (turn.motion.apply(x) - x))[component];
    }
  return u;
}

bool Loading::winds() const {
  constexpr double kHalfTurn = 180.0;
  return std::any_of(turns.begin(), turns.end(),
                     [](const Turn& turn) { return std::abs(turn.motion.degrees) >= kHalfTurn; });
}

double Loading::first_step() const {
  constexpr double kAtOnce = 30.0;
  double step = 1.0;
  for (const Turn& turn : turns)
    step = std::min(step, kAtOnce / std::max(std::abs(turn.motion.degrees), kAtOnce));
  return step;
}

void Loading::release(const Region& region) {
  std::vector<int> kept;
  std::vector<double> values;
  for (size_t i = 0; i < prescribed.size(); ++i) {
    if (std::binary_search(region.nodes.begin(), region.nodes.end(), prescribed[i] / 3)) continue;
    kept.push_back(prescribed[i]);
    values.push_back(displacement[static_cast<Eigen::Index>(i)]);
  }
  prescribed = std::move(kept);
  displacement = Eigen::Map<VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Loading make_loading(const Capture&, const ExampleSpec& example, const TetMesh& mesh,
                     const RegionSet& regions) {
  Loading loading;
  loading.name = example.name;
  for (const SupportSpec& support : example.supports) {
    const Region& region = regions.at(support.region);
    if (support.kind == SupportSpec::Kind::components) {
      for (int i = 0; i < 3; ++i)
        if (support.displacement[i]) loading.prescribe(mesh, region, i, *support.displacement[i]);
    } else {
      loading.prescribe_rigid(
          mesh, region, support.kind == SupportSpec::Kind::rigid ? support.rigid : RigidMotion{});
    }
  }
  for (const LoadSpec& load : example.loads) {
    const Region& region = regions.at(load.region);
    if (!(region.area > 0.0))
      throw InputError(
          load.place,
          fmt::format("the load of example `{}` acts on region `{}`, which has no area",
                      example.name, load.region),
          "a region that is a patch of the surface, not a point or a line of it");
    if (load.force) loading.forces.push_back(dead_force(region, *load.force));
    if (load.pressure) loading.forces.push_back(follower_pressure(region, *load.pressure));
  }
  return loading;
}

namespace {

/// Rows of A's span in reduced echelon form: the tidiest numbers to show to people.
Eigen::MatrixXd tidy(Eigen::MatrixXd A) {
  int row = 0;
  for (int column = 0; column < A.cols() && row < A.rows(); ++column) {
    Eigen::Index pivot;
    if (A.col(column).tail(A.rows() - row).cwiseAbs().maxCoeff(&pivot) < 1e-6) continue;
    A.row(row).swap(A.row(row + pivot));
    A.row(row) /= A(row, column);
    for (int i = 0; i < A.rows(); ++i)
      if (i != row) A.row(i) -= Eigen::RowVectorXd(A(i, column) * A.row(row));
    ++row;
  }
  return A.topRows(row);
}

/// What is nothing beside `size` is rounding.
std::string point_text(Vector3d v, double size) {
  for (double& x : v)
    if (std::abs(x) < 1e-6 * std::max(size, v.cwiseAbs().maxCoeff())) x = 0;
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v[0], v[1], v[2]);
}

/// `size`: the body's [length].
std::string motion_text(const Vector3d& move, const Vector3d& turn, const Vector3d& center,
                        double size) {
  if (turn.norm() < 1e-6) return "translation along " + point_text(move.normalized(), 1.0);
  const double w2 = turn.squaredNorm(), pitch = move.dot(turn) / w2;
  const Vector3d through = center + turn.cross(move) / w2;
  std::string text = "rotation about " + point_text(turn.normalized(), 1.0) + " through " +
                     point_text(through, size);
  if (std::abs(pitch) > 1e-6 * size)
    text += fmt::format(" with an advance of {:.4g} a radian", pitch);
  return text;
}

}  // namespace

std::vector<std::string> free_rigid_motions(const TetMesh& mesh, const Loading& loading) {
  const RigidModes modes(mesh);
  const Eigen::MatrixXd null = modes.free(loading.prescribed);
  Eigen::MatrixXd free(null.cols(), 6);
  // Rotations first, so that the echelon form leaves pure translations where it can.
  free << null.bottomRows<3>().transpose(), null.topRows<3>().transpose();
  const Eigen::MatrixXd basis = tidy(free);
  std::vector<std::string> names;
  for (Eigen::Index k = 0; k < basis.rows(); ++k)
    names.push_back(motion_text(basis.row(k).tail<3>().transpose() * modes.size,
                                basis.row(k).head<3>().transpose(), modes.center, modes.size));
  return names;
}

}  // namespace hookeye
