#include "exporters/solver_model.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>

#include "estimation/model/base_ingredients.h"
#include "simulation/equilibrium.h"

namespace hookeye {
namespace {

/// A region that turns is written in steps that turn it by no more.
constexpr double kTurnOfAStep = 30.0;  // degrees

/// Of letters, digits, - and _, told apart by a number.
std::string file_name(const std::string& name, std::set<std::string>& taken) {
  std::string out;
  for (const char c : name)
    out += std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' ? c : '_';
  out = out.substr(0, 60);
  std::string unique = out;
  for (int i = 2; !taken.insert(unique).second; ++i) unique = fmt::format("{}_{}", out, i);
  return unique;
}

std::vector<double> shares_of(const Loading& loading) {
  double largest = 0.0;
  for (const auto& turn : loading.turns) largest = std::max(largest, std::abs(turn.motion.degrees));
  const int steps = std::max(1, static_cast<int>(std::ceil(largest / kTurnOfAStep - 1e-9)));
  std::vector<double> out;
  for (int k = 1; k <= steps; ++k) out.push_back(static_cast<double>(k) / steps);
  return out;
}

SolverCase solver_case(const Model& model, size_t index, std::set<std::string>& files) {
  const Scene& scene = *model.scene;
  const TetMesh& mesh = scene.body->mesh;
  const ExampleModel& example = model.examples[index];
  SolverCase out;
  out.name = scene.capture.examples[index].name;
  out.file = file_name(out.name, files);
  out.use = scene.capture.examples[index].use();
  for (const LoadSpec& load : scene.capture.examples[index].loads)
    if (load.force) out.loaded.push_back(load.region);
  out.stiffness = example.stiffness;
  out.loading = example.loading;
  out.shares = shares_of(example.loading);
  const VectorXd X = mesh.X.reshaped();
  VectorXd dead = VectorXd::Zero(X.size());
  for (const auto& force : example.loading.forces) {
    if (force->dead()) force->add_residual(mesh, X, 1.0, dead);  // residual = -force
    if (auto pressure = as_pressure(*force)) out.pressures.push_back(*std::move(pressure));
    if (auto springs = as_foundation(*force)) out.foundations.push_back(*std::move(springs));
    if (auto floor = as_floor(*force)) out.floors.push_back(*std::move(floor));
  }
  out.nodal_force = -dead;
  out.gravity = model.placement.linear().transpose() * model.gravity;
  if (!out.gravity.isZero(0.0)) {
    const double largest = dead.cwiseAbs().maxCoeff();
    self_weight(mesh, density_or_one(scene.capture), out.gravity)
        ->add_residual(mesh, X, -1.0, dead);
    // What rounding leaves of the difference is no force.
    out.nodal_force = (dead.array().abs() > 1e-12 * largest).select(-dead, 0.0);
  }
  out.strains = !out.nodal_force.isZero(0.0) || !out.gravity.isZero(0.0) ||
                !example.loading.displacement.isZero(0.0) || !example.loading.turns.empty() ||
                !out.pressures.empty() || !out.floors.empty() || model.energy.swelling.size() > 0;
  for (const FoundationOn& springs : out.foundations) out.strains |= springs.target != X;
  if (out.foundations.empty()) out.free_motions = free_rigid_motions(mesh, example.loading);
  return out;
}

}  // namespace

SolverModel solver_model(const Model& model) {
  const Capture& capture = model.scene->capture;
  SolverModel out;
  out.title = capture.title;
  out.units = capture.units;
  out.density = density_or_one(capture);
  out.density_told = capture.body.density > 0.0;
  out.body = model.scene->body;
  out.energy = model.energy;
  out.materials = solver_materials(model.energy, out.mesh(), out.lacks);
  for (const auto& [name, region] : out.body->regions.all())
    if (!region.nodes.empty()) out.regions.emplace_back(name, &region);
  std::set<std::string> files;
  for (size_t e = 0; e < model.examples.size(); ++e)
    out.cases.push_back(solver_case(model, e, files));
  return out;
}

Loading clamped(const SolverModel& model, const SolverCase& one) {
  Loading out = one.loading;
  for (const FoundationOn& bed : one.foundations)
    for (const auto& [face, fraction] : bed.faces)
      for (const int node : model.mesh().boundary.col(face)) {
        Region alone;
        alone.nodes = {node};
        for (int i = 0; i < 3; ++i)
          out.prescribe(model.mesh(), alone, i, bed.target[3 * node + i] - model.mesh().X(i, node));
      }
  return out;
}

std::optional<double> logarithm_difference(const SolverModel& model) {
  std::optional<double> out;
  for (const SolverCase& one : model.cases)
    for (const double J : {one.lowest_J, one.highest_J})
      if (one.displacement && J > 0 && J != 1.0)
        out = std::max(out.value_or(0.0), std::abs(std::log(J) / (J * (J - 1)) - 1));
  return out;
}

void set_found(SolverModel& model, int index, const VectorXd& q) {
  SolverCase& one = model.cases.at(static_cast<size_t>(index));
  one.displacement = q - model.mesh().X.reshaped();
  for (const Matrix3d& F : deformation_gradients(model.mesh(), q)) {
    one.lowest_J = std::min(one.lowest_J, F.determinant());
    one.highest_J = std::max(one.highest_J, F.determinant());
  }
}

}  // namespace hookeye
