#include "estimation/effects/other_mesh.h"

#include <tbb/task_arena.h>

#include <Eigen/LU>

#include "core/input_error.h"
#include "core/work_clock.h"
#include "estimation/effects/catalogue.h"
#include "meshing/interpolation.h"

namespace hookeye {

struct OtherBody {
  std::shared_ptr<const Scene> scene;
  Eigen::SparseMatrix<double, Eigen::RowMajor> from_here, to_here;  ///< nodal values there, here
  std::mutex mutex;                                                 ///< of what follows
  std::unique_ptr<EquilibriumSolver> solver;                        ///< null: nobody is solving

  OtherBody(const Scene& here, double factor, int order)
      : scene(remeshed(here, factor, order, false)),
        from_here(interpolation(here.body->mesh, scene->body->mesh.X)),
        to_here(interpolation(scene->body->mesh, here.body->mesh.X)) {}
};

namespace {

/// That of the scene: meshed when first asked for, and kept for as long as the scene is there.
std::shared_ptr<OtherBody> other_body(const std::shared_ptr<const Scene>& here, double factor,
                                      int order) {
  struct Known {
    std::weak_ptr<const Scene> here;
    double factor;
    int order;
    std::shared_ptr<OtherBody> body;
  };
  static std::mutex mutex;
  static std::vector<Known> known;
  const std::lock_guard lock(mutex);
  std::erase_if(known, [](const Known& one) { return one.here.expired(); });
  for (const Known& one : known)
    if (one.here.lock() == here && one.factor == factor && one.order == order) return one.body;
  auto body = std::make_shared<OtherBody>(*here, factor, order);
  known.push_back({here, factor, order, body});
  return body;
}

}  // namespace

OtherMesh::OtherMesh(const Model& model, double factor, int order)
    : model_(model),
      factor_(factor),
      order_(order),
      forces_(model.examples.size()),
      done_(model.examples.size()) {}

const VectorXd& OtherMesh::force(int example) {
  Slot& slot = forces_[example];
  // A thread that waits for its own solve must not take another example up meanwhile: that would
  // want what this one has locked, or pile solve upon solve on one stack.
  std::call_once(slot.once, [&] {
    tbb::this_task_arena::isolate([&] {
      const Working part(WorkPart::finer_mesh);
      try {
        slot.force = compute(example);
      } catch (const InputError&) {  // a surface that cannot be filled
        slot.force = VectorXd::Zero(3 * model_.scene->body->mesh.nodes());
      }
    });
  });
  return slot.force;
}

/// After `example`, the mutex held. A fit asks for the fitted examples, a diagnosis for all.
void OtherMesh::drop_idle_solver(int example) {
  const auto& examples = model_.scene->capture.examples;
  done_[example] = true;
  const bool held_out_too = examples[example].validate || asked_held_out_;
  asked_held_out_ = held_out_too;
  for (size_t e = 0; e < done_.size(); ++e)
    if (!done_[e] && (held_out_too || !examples[e].validate)) return;
  body_->solver.reset();
}

void OtherMesh::realise_there() {
  std::call_once(once_, [&] {
    auto body = other_body(model_.scene, factor_, order_);
    const auto [form, p] = transfer(model_, body->scene, catalogue());
    other_ = form.realise(p);
    body_ = std::move(body);
  });
}

Result<Equilibrium> OtherMesh::solve_there(int example, const Equilibrium& here) {
  const TetMesh &mesh = model_.scene->body->mesh, &theirs = body_->scene->body->mesh;
  const Matrix3Xd u = here.q.reshaped(3, mesh.nodes()) - mesh.X;
  const VectorXd start = (theirs.X + u * body_->from_here.transpose()).reshaped();
  EquilibriumOptions options;
  options.tolerance = 1e-6;  // what a mesh changes need not be known to more than a per mille
  options.factored = false;
  const std::lock_guard lock(body_->mutex);
  if (!body_->solver) body_->solver = std::make_unique<EquilibriumSolver>(body_->scene->mesh());
  auto there = body_->solver->solve(other_.energy_of(example), other_.examples[example].loading,
                                    options, &start);
  body_->solver->forget();
  drop_idle_solver(example);
  return there;
}

/// With its tangent.
Result<Equilibrium> OtherMesh::solve_here(int example) const {
  const TetMesh& mesh = model_.scene->body->mesh;
  const EnergyModel energy = model_.energy_of(example);
  const Loading& loading = model_.examples[example].loading;
  const auto known =
      static_cast<size_t>(example) < model_.states.size() ? model_.states[example] : nullptr;
  if (!known) return solve_equilibrium(mesh, energy, loading);
  Equilibrium here = *known;
  here.K = tangent(mesh, energy, loading, here.q);
  return here;
}

VectorXd OtherMesh::compute(int example) {
  const TetMesh& mesh = model_.scene->body->mesh;
  const Loading& loading = model_.examples[example].loading;
  const VectorXd none = VectorXd::Zero(3 * mesh.nodes());
  const auto solved = solve_here(example);
  if (!solved) return none;
  const Equilibrium& here = *solved;
  realise_there();
  const auto result = solve_there(example, here);
  if (!result) return none;
  const Equilibrium& there = *result;
  const TetMesh& theirs = body_->scene->body->mesh;
  // Moved as a whole, not at the surface alone: there would be an element's thickness of wild
  // strain in between.
  const Matrix3Xd u_there = there.q.reshaped(3, theirs.nodes()) - theirs.X;
  const Matrix3Xd u_here = here.q.reshaped(3, mesh.nodes()) - mesh.X;
  VectorXd du = (u_there * body_->to_here.transpose() - u_here).reshaped();
  for (int unknown : loading.prescribed) du[unknown] = 0.0;
  VectorXd reaction = none;
  for (const auto& measured : model_.scene->capture.examples[example].measured)
    if (is_reaction(measured)) add_reaction(measured.region, here, there, reaction);
  VectorXd f = here.K * du;
  for (int unknown : loading.prescribed) f[unknown] -= reaction[unknown];
  return f;
}

/// Change of the support's force and moment, as the smallest nodal forces that have both.
void OtherMesh::add_reaction(const std::string& name, const Equilibrium& here,
                             const Equilibrium& there, VectorXd& reaction) const {
  const Region& region = model_.scene->body->regions.at(name);
  const Region& theirs = body_->scene->body->regions.at(name);
  const double count = static_cast<double>(region.nodes.size());
  Vector3d centre = Vector3d::Zero();
  for (int node : region.nodes) centre += here.q.segment<3>(3 * node) / count;
  const Vector3d F = support_force(there, theirs) - support_force(here, region);
  const Vector3d M = support_moment(there, theirs, centre) - support_moment(here, region, centre);
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (int node : region.nodes) {
    const Vector3d r = here.q.segment<3>(3 * node) - centre;
    inertia += r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose();
  }
  const Vector3d b = inertia.fullPivLu().solve(M);
  for (int node : region.nodes)
    reaction.segment<3>(3 * node) =
        F / count + b.cross(Vector3d(here.q.segment<3>(3 * node) - centre));
}

}  // namespace hookeye
