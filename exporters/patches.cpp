#include "exporters/patches.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <set>

namespace hookeye {
namespace {

double area_of(const TetMesh& mesh, int face) {
  const Vector3d a = mesh.X.col(mesh.boundary(0, face));
  const Vector3d b = mesh.X.col(mesh.boundary(1, face)), c = mesh.X.col(mesh.boundary(2, face));
  return 0.5 * (b - a).cross(c - a).norm();
}

Patch patch_of(const TetMesh& mesh, const std::string& name,
               const std::vector<std::pair<int, double>>& faces, std::set<std::string>& lacks) {
  Patch out;
  out.name = name;
  for (const auto& [face, fraction] : faces) {
    if (fraction < 1 - 1e-9)
      lacks.insert(fmt::format(
          "region {} cuts through faces: those count whole that are in it by more than half",
          name));
    if (fraction <= 0.5) continue;
    out.faces.push_back(face);
    out.area += area_of(mesh, face);
  }
  std::sort(out.faces.begin(), out.faces.end());
  return out;
}

/// "(a*x+b*y+c*z+d)"; gradients of displacement that are round-off become 0.
std::string form(const Vector3d& a, double d) {
  const auto clean = [](double value) { return std::abs(value) < 1e-12 ? 0.0 : value; };
  return fmt::format("({:.12g}*x+{:.12g}*y+{:.12g}*z+{:.12g})", clean(a.x()), clean(a.y()),
                     clean(a.z()), d + 0.0);
}

/// u = a.X + b over nodes, nearest by least squares; the largest error.
struct Affine {
  Vector3d a = Vector3d::Zero();
  double b = 0.0, error = 0.0;
};

Affine affine(const Matrix3Xd& X, const VectorXd& u) {
  const Vector3d middle = X.rowwise().mean();
  const double mean = u.mean();
  const Eigen::MatrixXd A = (X.colwise() - middle).transpose();
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(1e-9);
  Affine out;
  out.a = svd.solve(VectorXd(u.array() - mean));
  out.b = mean - out.a.dot(middle);
  out.error = ((out.a.transpose() * X).transpose().array() + out.b - u.array()).abs().maxCoeff();
  return out;
}

/// The turn that all of the nodes follow; null: none.
const Loading::Turn* turn_of(const Loading& loading, const std::vector<int>& nodes) {
  for (const auto& turn : loading.turns)
    if (std::includes(turn.nodes.begin(), turn.nodes.end(), nodes.begin(), nodes.end()))
      return &turn;
  return nullptr;
}

/// Component i of a motion that ends as `end`: straight there, or by the turn's angle.
std::string expression(const Affine& end, int i, const Loading::Turn* turn) {
  if (!turn) return fmt::format("t*{}", form(end.a, end.b));
  const RigidMotion& m = turn->motion;
  const Vector3d k = m.axis.normalized();
  Eigen::Matrix3d K;
  K << 0, -k.z(), k.y(), k.z(), 0, -k.x(), -k.y(), k.x(), 0;
  const Eigen::Matrix3d K2 = K * K;
  const double angle = m.degrees * M_PI / 180;
  const Vector3d first = K.row(i), second = K2.row(i);
  // What the turn does at its end is taken from the end; it comes back by the angle.
  const Vector3d turned = std::sin(angle) * first + (1 - std::cos(angle)) * second;
  return fmt::format("sin({0:.12g}*t)*{1}+(1-cos({0:.12g}*t))*{2}+t*{3}", angle,
                     form(first, -first.dot(m.center)), form(second, -second.dot(m.center)),
                     form(end.a - turned, end.b + turned.dot(m.center)));
}

std::vector<HeldPatch> held_patches(const SolverModel& model, const SolverCase& one,
                                    std::set<std::string>& lacks) {
  const TetMesh& mesh = model.mesh();
  const Loading loading = clamped(model, one);
  std::map<int, double> left;
  for (size_t i = 0; i < loading.prescribed.size(); ++i)
    left[loading.prescribed[i]] = loading.displacement[static_cast<Eigen::Index>(i)];
  const auto all = left;
  const double size = (mesh.X.rowwise().maxCoeff() - mesh.X.rowwise().minCoeff()).norm();
  std::vector<HeldPatch> out;
  for (size_t r = 0; r < model.regions.size(); ++r) {
    const std::vector<int>& nodes = model.regions[r].second->nodes;
    HeldPatch patch{r, {}};
    for (int i = 0; i < 3; ++i) {
      if (!std::all_of(nodes.begin(), nodes.end(), [&](int n) { return all.count(3 * n + i) > 0; }))
        continue;
      VectorXd u(static_cast<Eigen::Index>(nodes.size()));
      for (size_t k = 0; k < nodes.size(); ++k)
        u[static_cast<Eigen::Index>(k)] = all.at(3 * nodes[k] + i);
      const Affine end = affine(mesh.X(Eigen::all, nodes), u);
      if (end.error > 1e-8 * size) continue;
      patch.motion[static_cast<size_t>(i)] = expression(end, i, turn_of(loading, nodes));
      for (const int n : nodes) left.erase(3 * n + i);
    }
    if (std::any_of(patch.motion.begin(), patch.motion.end(),
                    [](const std::string& m) { return !m.empty(); }))
      out.push_back(patch);
  }
  if (!left.empty())
    lacks.insert(
        fmt::format("load case {}: {} prescribed displacements are those of no region as "
                    "a whole and are left out",
                    one.name, left.size()));
  return out;
}

/// Total forces of the loaded regions whose even spread is the nodal force.
std::vector<std::pair<size_t, Vector3d>> tractions(const SolverModel& model, const SolverCase& one,
                                                   const std::vector<Patch>& patches,
                                                   std::set<std::string>& lacks) {
  std::vector<std::pair<size_t, Vector3d>> out;
  const std::set<std::string> loaded(one.loaded.begin(), one.loaded.end());
  Eigen::MatrixXd spread(model.mesh().nodes(), static_cast<Eigen::Index>(loaded.size()));
  Eigen::Index column = 0;
  for (size_t r = 0; r < model.regions.size(); ++r) {
    if (!loaded.count(model.regions[r].first)) continue;
    const Region& region = *model.regions[r].second;
    spread.col(column++) = region.nodal_area / region.area;
    out.emplace_back(r, Vector3d::Zero());
  }
  const Eigen::MatrixXd force =
      one.nodal_force.reshaped(3, model.mesh().nodes()).transpose();  // nodes x 3
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(spread.cols(), 3);
  if (spread.cols() > 0) total = spread.colPivHouseholderQr().solve(force);
  if ((spread * total - force).norm() > 1e-6 * force.norm())
    lacks.insert(fmt::format(
        "load case {}: forces at nodes that are no even load of a region are left out", one.name));
  for (size_t k = 0; k < out.size(); ++k) {
    const double area = patches[out[k].first].area;
    if (area > 0) out[k].second = total.row(static_cast<Eigen::Index>(k)).transpose() / area;
  }
  return out;
}

}  // namespace

Patches patches_of(const SolverModel& model) {
  const TetMesh& mesh = model.mesh();
  Patches out;
  std::set<std::string> lacks, unused;
  for (const auto& [name, region] : model.regions)
    out.all.push_back(patch_of(mesh, name, region->faces, unused));
  for (const SolverCase& one : model.cases) {
    CasePatches c;
    c.held = held_patches(model, one, lacks);
    c.tractions = tractions(model, one, out.all, lacks);
    for (const auto& held : c.held)
      patch_of(mesh, model.regions[held.patch].first, model.regions[held.patch].second->faces,
               lacks);
    for (const auto& [patch, t] : c.tractions)
      patch_of(mesh, model.regions[patch].first, model.regions[patch].second->faces, lacks);
    for (size_t p = 0; p < one.pressures.size(); ++p) {
      double whole = 0.0;
      for (const auto& [face, fraction] : one.pressures[p].faces)
        whole += fraction * area_of(mesh, face);
      Patch patch =
          patch_of(mesh, fmt::format("of pressure {}", p + 1), one.pressures[p].faces, lacks);
      if (!(patch.area > 0)) continue;
      const auto same = std::find_if(out.all.begin(), out.all.end(), [&](const Patch& other) {
        return other.faces == patch.faces;
      });
      const double pressure = one.pressures[p].pressure * whole / patch.area;
      c.pressures.emplace_back(static_cast<size_t>(same - out.all.begin()), pressure);
      if (same == out.all.end()) out.all.push_back(std::move(patch));
    }
    out.cases.push_back(std::move(c));
  }
  if (mesh.order == 2) {
    double bent = 0.0;
    constexpr int edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}};
    for (int e = 0; e < mesh.size(); ++e)
      for (int k = 0; k < 6; ++k) {
        const Vector3d a = mesh.X.col(mesh.elements(edges[k][0], e));
        const Vector3d b = mesh.X.col(mesh.elements(edges[k][1], e));
        const Vector3d middle = mesh.X.col(mesh.elements(4 + k, e));
        bent = std::max(bent, (middle - 0.5 * (a + b)).norm() / (b - a).norm());
      }
    if (bent > 1e-6)
      lacks.insert(fmt::format(
          "edges are curved by up to {:.2g} of their length and are taken straight", bent));
  }
  out.lacks.assign(lacks.begin(), lacks.end());
  return out;
}

}  // namespace hookeye
