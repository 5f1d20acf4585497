// What the diagnosis uses of an effect, S = dq/dt at its null, against equilibria solved again.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "estimation/effects/catalogue.h"
#include "estimation/search/extension.h"
#include "estimation/search/swaps.h"
#include "estimation/solved_sensitivity.h"
#include "meshing/interpolation.h"
#include "support/temporary_folder.h"

namespace hookeye::test {

namespace {

/// Step that moves the nodes by 1e-4 mm (root of the sum of squares): what moves them less is lost
/// in the rounding of solved positions. 0: nothing moves.
double seen_step(const Evaluation& evaluation, int column) {
  double most = 0.0;
  for (const auto& example : evaluation.examples)
    most = std::max(most, example.S.col(column).norm());
  return most > 0.0 ? 1e-4 / most : 0.0;
}

/// Candidates of one effect, scored at the null of the base model.
void check_candidates(const std::string& name, double step, double relative) {
  const ModelForm base = base_form(block_scene());
  const VectorXd p = base.initial();
  const States start = solve(base, p, {});
  const Effect& effect = *find_effect(name);
  const auto candidates = effect.candidates(with_states(base.realise(p)), nullptr);
  ASSERT_FALSE(candidates.empty());
  const Evaluation evaluation = evaluated(base, p, candidates);
  int column = base.size(), moving = 0;
  // of many alike candidates (fibres, blobs) a few stand for all
  const size_t stride = candidates.size() > 8 ? 4 : 1;
  for (size_t c = 0; c < candidates.size(); ++c) {
    const auto& one = candidates[c];
    if (c % stride != 0 && name != "floor_contact") {
      column += static_cast<int>(one->parameters().size());
      continue;
    }
    const ModelForm form = extended(base, one);
    const auto parameters = one->parameters();
    const VectorXd at_null = with_values(form, null_values(*one));
    for (size_t i = 0; i < parameters.size(); ++i, ++column) {
      const double h = std::max(step * parameters[i].typical, seen_step(evaluation, column));
      const int k = base.size() + static_cast<int>(i);
      const States solved =
          solved_sensitivity(form, at_null, k, h, parameters[i].low == parameters[i].value, start);
      if (::testing::Test::HasFailure() || solved.empty()) return;
      const std::string label = name + " [" + one->variant() + "] " + parameters[i].name;
      const bool moves = expect_same(evaluation, column, solved, h, relative, label);
      EXPECT_TRUE(moves || name == "floor_contact") << label << ": nothing moves";
      moving += moves;
    }
  }
  EXPECT_GT(moving, 0) << "the test would prove nothing";
}

TEST(Sensitivity, StrainStiffening) { check_candidates("strain_stiffening", 1e-3, 1e-4); }
TEST(Sensitivity, Compressibility) { check_candidates("compressibility", 1e-3, 1e-4); }
TEST(Sensitivity, Anisotropy) { check_candidates("anisotropy", 1e-3, 1e-4); }
TEST(Sensitivity, Asymmetry) { check_candidates("tension_compression_asymmetry", 1e-3, 1e-4); }
TEST(Sensitivity, StiffnessField) { check_candidates("stiffness_field", 1e-3, 1e-4); }
TEST(Sensitivity, Gravity) { check_candidates("gravity", 1e-3, 1e-4); }
TEST(Sensitivity, Swelling) { check_candidates("swelling", 1e-2, 1e-4); }
TEST(Sensitivity, LoadDirection) { check_candidates("load_direction", 1e-2, 1e-4); }
TEST(Sensitivity, Pressure) { check_candidates("pressure", 1e-3, 1e-4); }
TEST(Sensitivity, SoftClamp) { check_candidates("soft_clamp", 1e-3, 1e-3); }
TEST(Sensitivity, GripSlip) { check_candidates("grip_slip", 1e-3, 1e-4); }
TEST(Sensitivity, FloorContact) { check_candidates("floor_contact", 1e-2, 1e-3); }
TEST(Sensitivity, Creep) { check_candidates("creep", 1e-3, 1e-4); }
TEST(Sensitivity, Softening) { check_candidates("softening", 1e-3, 1e-4); }

/// Away from the null the tangent of a pressure on an open patch is unsymmetric.
TEST(Sensitivity, OfAllParametersUnderAPressure) {
  const ModelForm base = base_form(block_scene());
  int patches = 0, moving = 0;
  for (const auto& one :
       find_effect("pressure")->candidates(base.realise(base.initial()), nullptr)) {
    const ModelForm form = extended(base, one);
    const VectorXd p = with_values(form, VectorXd::Constant(1, 4 * one->parameters()[0].typical));
    const States start = solve(form, p, {});
    if (::testing::Test::HasFailure()) return;
    const Evaluation evaluation = evaluated(form, p, {});
    for (const auto& example : evaluation.examples)
      patches += example.equilibrium->W_ff.nonZeros() > 0;
    const auto parameters = form.parameters();
    for (int k = 0; k < form.size(); ++k) {
      const double h = 1e-3 * (parameters[k].positive ? p[k] : parameters[k].typical);
      const std::string label = one->variant() + ": " + parameters[k].name;
      moving += expect_same(evaluation, k, solved_sensitivity(form, p, k, h, false, start), h, 1e-5,
                            label);
    }
  }
  EXPECT_GT(patches, 0);
  EXPECT_GE(moving, 4);
}

/// At s = 1 the surface goes where the finer mesh has it, and the grip's force changes as much.
TEST(Sensitivity, MeshResolutionIsTheFinerMesh) {
  const ModelForm base = base_form(block_scene());
  const VectorXd p = base.initial();
  const Model model = base.realise(p);
  const Effect& effect = *find_effect("mesh_resolution");
  const auto candidates = effect.candidates(model, nullptr);
  ASSERT_EQ(candidates.size(), 1u);
  const Evaluation evaluation = evaluated(base, p, candidates);
  VectorXd none;
  const auto finer_form = effect.refit_form(model, candidates.front(), none).form;
  const auto scene = effect.refit_scene(*block_scene(), finer_form->variant());
  ASSERT_GT(scene->body->mesh.nodes(), 1.5 * block_scene()->body->mesh.nodes());
  const auto [form, values] = transfer(model, scene, catalogue());
  const Model finer = form.realise(values);
  EXPECT_EQ(values, p);
  double moved = 0.0, error = 0.0;
  for (const auto& example : evaluation.examples) {
    const int e = example.example;
    const auto solved =
        solve_equilibrium(scene->body->mesh, finer.energy_of(e), finer.examples[e].loading);
    const Equilibrium& there = *solved;
    const BoundaryLocator locator(scene->body->mesh);
    for (int node : block_scene()->body->mesh.boundary.reshaped()) {
      SurfacePoint point;
      locator.locate(block_scene()->body->mesh.X.col(node), &point);
      const VectorXd N = shape_functions(2, point.barycentric);
      Vector3d x = Vector3d::Zero();
      for (int a = 0; a < N.size(); ++a)
        x += N[a] * there.q.segment<3>(3 * scene->body->mesh.elements(a, point.element));
      const Vector3d change = x - example.equilibrium->q.segment<3>(3 * node);
      moved = std::max(moved, change.norm());
      const Vector3d S = example.S.col(base.size()).segment<3>(3 * node);
      error = std::max(error, (S - change).norm());
    }
    for (const auto& measured : example.measured) {
      const Vector3d change =
          support_force(there, scene->body->regions.at("grip")) -
          support_force(*example.equilibrium, block_scene()->body->regions.at("grip"));
      EXPECT_GT(change.norm(), 0.0);
      EXPECT_LT((0.1 * measured.J.col(base.size()) - change).norm(), 1e-6 * change.norm());
    }
  }
  EXPECT_GT(moved, 0.01);  // mm: the mesh is coarse on purpose
  EXPECT_LT(error, 0.02 * moved);
}

/// The column of mesh_resolution at mu times `factor`, by example.
std::vector<VectorXd> finer_mesh_at(const std::shared_ptr<const Scene>& scene, double factor) {
  const ModelForm base = base_form(scene);
  VectorXd p = base.initial();
  p[0] *= factor;
  const Effect& effect = *find_effect("mesh_resolution");
  const Evaluation evaluation = evaluated(base, p, effect.candidates(base.realise(p), nullptr));
  std::vector<VectorXd> out;
  for (const auto& example : evaluation.examples) out.push_back(example.S.col(base.size()));
  return out;
}

/// What a finer mesh changes follows from the model alone, not from those that were asked before.
TEST(Sensitivity, AFinerMeshKnowsOfNoOtherModel) {
  const auto one = std::make_shared<const Scene>(*block_scene());
  const auto other = std::make_shared<const Scene>(*block_scene());
  const auto before = finer_mesh_at(one, 1.0);
  const auto second = finer_mesh_at(one, 0.8), alone = finer_mesh_at(other, 0.8);
  double changed = 0.0;
  for (size_t e = 0; e < alone.size(); ++e) {
    EXPECT_LT((second[e] - alone[e]).norm(), 1e-9 * alone[e].norm() + 1e-12) << e;
    changed = std::max(changed, (alone[e] - before[e]).norm() / std::max(alone[e].norm(), 1e-9));
  }
  EXPECT_GT(changed, 0.05);  // the next model is another one
}

/// The base form on the mesh of mesh_resolution's refit, with `share` of its change on top.
std::pair<ModelForm, VectorXd> on_finer_mesh(const ModelForm& base, double share) {
  const Model model = base.realise(base.initial());
  const Effect& effect = *find_effect("mesh_resolution");
  VectorXd none;
  const auto finer = effect.refit_form(model, effect.candidates(model, nullptr).front(), none).form;
  auto [form, p] = on_its_mesh(model, *finer);
  p[form.size() - 1] = share;
  return {form, p};
}

/// Written and read, the finer mesh is there again.
TEST(Sensitivity, AFinerMeshIsReadBack) {
  const auto [form, p] = on_finer_mesh(base_form(block_scene()), 0.4);
  const TemporaryFolder folder;
  const auto file = folder / "model.yaml";
  std::ofstream(file) << write_model(form, p, catalogue());
  const auto [again, values] = read_model(file, block_scene(), catalogue());
  EXPECT_EQ(values, p);
  EXPECT_EQ(again.scene->body->mesh.nodes(), form.scene->body->mesh.nodes());
  EXPECT_EQ(again.ingredients.back()->name(), "mesh_resolution");
  EXPECT_EQ(again.scene->photos.size(), block_scene()->photos.size());
}

/// What the refinement of a mesh changed in a body that hangs is not what it changes in one that
/// does not: where the weight leaves the model, it is worked out anew.
TEST(Sensitivity, WhatARefinementChangedKnowsOfNoEffectThatLeft) {
  const auto gravity = find_effect("gravity")->candidates(base_model(), nullptr).front();
  auto [form, p] = on_finer_mesh(extended(base(), gravity), 0.4);
  p.segment(base().size(), gravity->parameters().size()) = some_values(*gravity);
  work_out_anew(form, p);  // with the weight
  const VectorXd q = form.scene->body->mesh.X.reshaped();
  const size_t at = form.ingredients.size() - 2;
  ASSERT_EQ(form.ingredients[at]->name(), "gravity");
  Fitted fitted;
  fitted.form = form, fitted.p = p;
  const Parted left = parted_from(fitted, at);

  const auto [alone, share] = on_finer_mesh(base(), 0.4);
  ASSERT_EQ(left.p, share);
  ModelForm told = form;
  told.ingredients.erase(told.ingredients.begin() + static_cast<std::ptrdiff_t>(at));
  const VectorXd right = signature(alone.realise(share), q);
  const double error = (signature(left.form.realise(left.p), q) - right).norm();
  const double before = (signature(told.realise(share), q) - right).norm();
  EXPECT_GT(before, 0.0);
  EXPECT_LT(error, 1e-3 * before);
}

/// Bounds scale with the model that an effect was added to; the refit moves that model, and the
/// values with it. What a step wrote is read back, bounds and all.
TEST(Sensitivity, EveryEffectIsReadBackAtItsBoundsFromASofterModel) {
  const ModelForm base = base_form(block_scene());
  const Model model = base.realise(base.initial());
  const TemporaryFolder folder;
  const auto file = folder / "model.yaml";
  int bounded = 0;
  for (const Effect* effect : catalogue()) {
    const auto candidates = effect->candidates(model, nullptr);
    if (candidates.empty()) continue;
    const ModelForm form = extended(base, candidates.front());
    VectorXd p = with_values(form, some_values(*candidates.front()));
    p[0] *= 0.5;
    const auto own = candidates.front()->parameters();
    const Eigen::Index first = p.size() - static_cast<Eigen::Index>(own.size());
    for (size_t k = 0; k < own.size(); ++k) {
      const double end =
          std::isfinite(own[k].low) && own[k].low < own[k].value ? own[k].low : own[k].high;
      if (std::isfinite(end)) p[first + static_cast<Eigen::Index>(k)] = end, ++bounded;
    }
    std::ofstream(file) << write_model(form, p, catalogue());
    const auto [again, values] = read_model(file, block_scene(), catalogue());
    EXPECT_EQ(values, p) << effect->name();
    const auto read = again.ingredients.back()->parameters();
    ASSERT_EQ(read.size(), own.size()) << effect->name();
    for (size_t k = 0; k < own.size(); ++k) {
      EXPECT_EQ(read[k].low, own[k].low) << own[k].name;
      EXPECT_EQ(read[k].high, own[k].high) << own[k].name;
    }
  }
  EXPECT_GT(bounded, 10);
}

/// What the finer mesh changed, added once more by a share, takes it nearer to a far finer one; the
/// share's derivative is that of the re-solved equilibrium.
TEST(Sensitivity, TheFinerMeshReachesForTheLimit) {
  const ModelForm base = base_form(block_scene());
  auto [form, p] = on_finer_mesh(base, 0.0);
  const int s = form.size() - 1;
  const Evaluation at_null = evaluated(form, p, {});
  p[s] = 0.7;
  const States start = solve(form, p, {});
  ASSERT_FALSE(::testing::Test::HasFailure());
  const States solved = solved_sensitivity(form, p, s, 1e-2, false, start);
  EXPECT_TRUE(expect_same(evaluated(form, p, {}), s, solved, 1e-2, 1e-3, "mesh_resolution.s"));

  const auto limit_scene = remeshed(*block_scene(), 0.35, 0, false);
  const auto [limit_form, limit_p] =
      transfer(base.realise(base.initial()), limit_scene, catalogue());
  const Model limit = limit_form.realise(limit_p);
  const TetMesh &mesh = form.scene->body->mesh, &finest = limit_scene->body->mesh;
  const auto there = interpolation(finest, mesh.X);
  double before = 0.0, along = 0.0, length = 0.0;
  for (const auto& example : at_null.examples) {
    const int e = example.example;
    const auto far = solve_equilibrium(finest, limit.energy_of(e), limit.examples[e].loading);
    const Matrix3Xd u = (far->q.reshaped(3, finest.nodes()) - finest.X) * there.transpose();
    const VectorXd off = (mesh.X + u).reshaped() - example.equilibrium->q;
    const VectorXd step = example.S.col(s);
    before += off.squaredNorm();
    along += off.dot(step);
    length += step.squaredNorm();
  }
  // The share that serves best, and what it takes of the error in mean square. Where errors fall in
  // proportion to the edge, which is the slowest, it is 0.7/(1 - 0.7).
  EXPECT_GT(along / length, 0.2);
  EXPECT_LT(along / length, 0.7 / (1.0 - 0.7));
  EXPECT_GT(along * along / length, 0.3 * before) << along / length;
}

/// A set-up that is turned hangs otherwise; one that is moved, or turned about its weight, does
/// not.
TEST(Sensitivity, PlacementTurnsTheBodyAgainstItsWeight) {
  const ModelForm told = base_form(block_scene());
  const Model model = told.realise(told.initial());
  const ModelForm base = extended(told, find_effect("gravity")->candidates(model, nullptr).front());
  const VectorXd p = with_values(base, 3e3 * Vector3d(0.6, 0.0, -0.8));
  const auto placement = find_effect("placement")->candidates(model, nullptr);
  const States start = solve(base, p, {});
  const Evaluation evaluation = evaluated(base, p, placement);
  const ModelForm form = extended(base, placement.front());
  VectorXd at_null(form.size());
  at_null << p, null_values(*placement.front());
  const auto parameters = placement.front()->parameters();
  for (int i = 0; i < 6; ++i) {
    const double h = parameters[i].typical;
    const States solved = solved_sensitivity(form, at_null, base.size() + i, h, false, start);
    EXPECT_EQ(expect_same(evaluation, base.size() + i, solved, h, 1e-3, parameters[i].name), i < 3)
        << parameters[i].name;
  }
}

/// Effects of the photo and the sensor move no equilibrium.
TEST(Sensitivity, MeasurementMovesNothing) {
  const ModelForm base = base_form(block_scene());
  for (const Effect* effect : catalogue()) {
    if (effect->group() != EffectGroup::measurement) continue;
    const auto candidates = effect->candidates(base.realise(base.initial()), nullptr);
    const Evaluation evaluation = evaluated(base, base.initial(), candidates);
    for (const auto& example : evaluation.examples)
      EXPECT_EQ(example.S.rightCols(evaluation.columns - base.size()).norm(), 0.0)
          << effect->name();
  }
}

}  // namespace

}  // namespace hookeye::test
