// The material effects on top of an additive base model: null is bit-equal, derivatives are right,
// forces of the base are unchanged in kind.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "estimation/additive_material.h"
#include "estimation/effects_scene.h"
#include "estimation/fit.h"
#include "simulation/equilibrium.h"
#include "support/derivative.h"

namespace hookeye::test {
namespace {

/// The block made of an additive material with anisotropy and couplings, none of it fitted.
std::shared_ptr<const Scene> additive_block(std::vector<std::string> fit) {
  auto scene = std::make_shared<Scene>(*block_scene());
  MaterialSpec& spec = scene->capture.materials.at(0);
  spec.law = "additive";
  spec.parameters.clear();
  const auto tell = [&](const std::string& key, std::vector<double> numbers) {
    spec.parameters[key] = {std::move(numbers), spec.place};
  };
  tell("I1bar.at", {0, 0.4});
  tell("I1bar.stiffness", {0.05, 0.08});
  tell("J.at", {-0.1, 0.1});
  tell("J.stiffness", {0.6, 0.5});
  tell("E33.at", {-0.1, 0, 0.2});
  tell("E33.stiffness", {0.02, 0.03, 0.06});
  tell("E11.at", {0});
  tell("E11.stiffness", {0.02});
  tell("E11_E33.at", {0});
  tell("E11_E33.at_2", {0});
  tell("E11_E33.stiffness", {0.01});
  tell("barrier.modulus", {0.5});
  tell("barrier.below", {0.3});
  scene->capture.fit_places.assign(fit.size(), spec.place);
  scene->capture.fit = std::move(fit);
  return scene;
}

const std::vector<std::string>& material_effects() {
  static const std::vector<std::string> all = {"strain_stiffening", "anisotropy",
                                               "tension_compression_asymmetry", "compressibility",
                                               "stiffness_field"};
  return all;
}

TEST(EffectsOnAdditive, NullIsBitEqualAndDerivativesHold) {
  const auto scene = additive_block({});
  const ModelForm base = base_form(scene);
  const VectorXd p0 = base.initial();
  const Model model = base.realise(p0);
  const VectorXd q = deformed_state(*scene);
  const VectorXd before = signature(model, q);
  Equilibrium at;
  at.q = q;
  for (const std::string& name : material_effects()) {
    const Effect& effect = *find_effect(name);
    std::string why_not;
    const auto candidates = effect.candidates(model, &why_not);
    ASSERT_FALSE(candidates.empty()) << name << ": " << why_not;
    const auto& one = candidates.front();
    const ModelForm form = extended(base, one);
    const VectorXd null = with_values(form, null_values(*one));
    EXPECT_EQ(signature(form.realise(null), q), before) << name;
    const auto R = [&](int k, double h) {
      VectorXd moved = null;
      moved[p0.size() + k] += h;
      const Model there = form.realise(moved);
      return residual(scene->body->mesh, there.energy_of(1), there.examples[1].loading, q);
    };
    const auto parameters = one->parameters();
    for (int k = 0; k < static_cast<int>(parameters.size()); ++k) {
      const double h = 1e-3 * parameters[k].typical;
      MechanicsDerivative out;
      if (one->mechanics_derivative(null_values(*one), model, 1, at, k, out)) {
        expect_derivative([&](double t) { return R(k, t); }, out.dR_dt, h, 1e-6, name);
      } else {
        EXPECT_GT((R(k, h) - R(k, -h)).norm(), 0.0) << name;
      }
    }
    EXPECT_FALSE(effect.sentence(model, *one, some_values(*one)).empty());
    VectorXd values = some_values(*one);
    const auto larger = effect.refit_form(model, one, values);
    EXPECT_EQ(values.size(), static_cast<int>(larger->parameters().size())) << name;
    const VectorXd after =
        signature(extended(base, larger).realise(with_values(extended(base, larger), values)), q);
    EXPECT_GT((after - before).norm(), 0.0) << name;
    EXPECT_TRUE(after.allFinite()) << name;
  }
}

TEST(EffectsOnAdditive, PoissonsRatioIsThatOfTheWholeMaterial) {
  const auto scene = additive_block({});
  const ModelForm base = base_form(scene);
  const Model model = base.realise(base.initial());
  const Effect& effect = *find_effect("compressibility");
  const auto one = effect.candidates(model, nullptr).front();
  const VectorXd nu = VectorXd::Constant(1, null_values(*one)[0] - 0.05);
  const ModelForm form = extended(base, one);
  const Model moved = form.realise(with_values(form, nu));
  const Matrix9d D = moved.energy.parts[0].term->dP_dF(Matrix3d::Identity());
  const double mu = D(3, 3), kappa = D(0, 0) - 4.0 / 3.0 * mu, ratio = kappa / mu;
  EXPECT_NEAR((3 * ratio - 2) / (6 * ratio + 2), nu[0], 1e-9);
}

TEST(EffectsOnAdditive, AFittedVolumeAddendLeavesNothingToFree) {
  for (const auto& fit : {std::vector<std::string>{"additive"}, std::vector<std::string>{"J"}}) {
    const auto scene = additive_block(fit);
    const ModelForm base = base_form(scene);
    ASSERT_GT(base.size(), 0);
    std::string why_not;
    EXPECT_TRUE(
        find_effect("compressibility")->candidates(base.realise(base.initial()), &why_not).empty());
    EXPECT_FALSE(why_not.empty());
  }
  // A neo-Hookean capture that a fit has made additive: the told ratio no longer means anything.
  const ModelForm base = base_form(block_scene());
  const auto [form, p] = to_additive(base, base.initial());
  EXPECT_TRUE(find_effect("compressibility")->candidates(form.realise(p), nullptr).empty());
}

TEST(EffectsOnAdditive, ControlValuesKeepTheirDerivativesUnderAField) {
  const auto scene = additive_block({"additive"});
  const ModelForm base = base_form(scene);
  const auto field =
      find_effect("stiffness_field")->candidates(base.realise(base.initial()), nullptr)[0];
  const ModelForm form = extended(base, field);
  const VectorXd p = with_values(form, some_values(*field));
  const Model now = form.realise(p);
  Equilibrium at;
  at.q = deformed_state(*scene);
  int moving = 0;
  for (int k = 0; k < base.size(); ++k) {
    MechanicsDerivative out;
    ASSERT_TRUE(form.ingredients[0]->mechanics_derivative(p.head(base.size()), now, 1, at, k, out));
    if (out.dR_dt.isZero(0.0)) continue;  // the hat of a strain that this state does not visit
    ++moving;
    expect_derivative(
        [&](double h) {
          VectorXd moved = p;
          moved[k] += h;
          const Model there = form.realise(moved);
          return residual(scene->body->mesh, there.energy_of(1), there.examples[1].loading, at.q);
        },
        out.dR_dt, 1e-3, 1e-8, std::to_string(k));
  }
  EXPECT_GE(moving, 3);
}

TEST(EffectsOnAdditive, AnAddendsNameStandsForItsControlValues) {
  const auto scene = additive_block({"E33", "J.2"});
  const ModelForm base = base_form(scene);
  std::vector<std::string> names;
  for (const auto& parameter : base.parameters()) names.push_back(parameter.name);
  EXPECT_EQ(names, (std::vector<std::string>{"E33.1", "E33.2", "E33.3", "J.2"}));
}

TEST(Fit, WithoutAnythingToFitToIsAnError) {
  auto scene = std::make_shared<Scene>(*block_scene());
  for (auto& photos : scene->photos) photos.clear();
  for (ExampleSpec& example : scene->capture.examples)
    example.photos.clear(), example.measured.clear();
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  EXPECT_THROW(fit(workspace, form, form.initial()), InputError);
}

TEST(NamedAddends, AFitStaysConvex) {
  auto scene = std::make_shared<Scene>(*additive_block({"E11_E33"}));
  for (auto& photos : scene->photos) photos.clear();
  for (ExampleSpec& example : scene->capture.examples) {
    example.photos.clear();
    // Twice the force that the block gives: the coupling would grow without end.
    for (MeasuredSpec& measured : example.measured) measured.value = Vector3d(0, 0, 6);
  }
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto result = fit(workspace, form, form.initial());
  ASSERT_TRUE(std::holds_alternative<Fitted>(result)) << std::get<NumericalFailure>(result).reason;
  const Fitted& fitted = std::get<Fitted>(result);
  EXPECT_FALSE(not_convex(fitted.form.realise(fitted.p)));
  // E11 has 0.02, and so has E33 at its softest: up to the root of their product.
  EXPECT_NEAR(std::abs(fitted.p[0]), 0.02, 0.005);
}

}  // namespace
}  // namespace hookeye::test
