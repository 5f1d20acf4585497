// Held-out photos that are missed: by values that are hardly known, or by a wrong model?
#include "estimation/search/fit_to_all.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/distributions.h"
#include "estimation/effects/catalogue.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/fit/at_floor.h"
#include "estimation/fit/evidence.h"
#include "estimation/model/effect.h"
#include "estimation/output/step_json.h"
#include "estimation/search/contest.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

/// Before its last load the body has softened. Photos of a motion that is told hardly show that,
/// its force does.
test::SmallScene softened(const std::string& last) {
  return test::SmallScene({.hidden = "hidden:\n  - {effect: softening, variant: from press on, "
                                     "values: {softening.d: 0.12}}\n",
                           .seed = 7,
                           .loads = "  press: {" + last + "}\n"});
}

/// The capture's own model, fitted, and the effect from its null in the form `variant`.
Fitted fitted_with(Workspace& workspace, const std::string& effect, const std::string& variant) {
  const Fitted base = test::base_fit(workspace);
  ModelForm with = base.form;
  with.ingredients.push_back(find_effect(effect)->candidate(realised(base), variant));
  VectorXd start(base.p.size() + 1);
  start << base.p, 0.05;
  return fit(workspace, with, start).value();
}

double held_out_r2(Workspace& workspace, const Fitted& fitted, const VectorXd& p) {
  const auto there = assess(workspace, fitted.form, p).value();
  return std::pow(there.evaluation.chi(true), 2);
}

/// The softening that a told motion hardly shows, fitted: made once, for two tests.
struct HardlyKnown {
  test::SmallScene small = softened("move: [0, 0, -0.06]");
  Workspace workspace{small.scene};
  const Fitted fitted = fitted_with(workspace, "softening", "from press on");
};
HardlyKnown& hardly_known() {
  static HardlyKnown made;
  return made;
}

TEST(FitToAll, TheSpreadIsWhatHeldOutPhotosShowOfTheValuesErrors) {
  auto& [small, workspace, fitted] = hardly_known();
  const auto V =
      parameter_covariance(fitted.evaluation, fitted.form.parameters(), fitted.p).determined;
  // One value is hardly known: a standard deviation of it, with what goes with it of the others.
  const Eigen::Index d = fitted.p.size() - 1;
  const VectorXd one = V.col(d) / std::sqrt(V(d, d));
  const double here = held_out_r2(workspace, fitted, fitted.p);
  const double there = 0.5 * (held_out_r2(workspace, fitted, fitted.p + one) +
                              held_out_r2(workspace, fitted, fitted.p - one));
  ASSERT_GT(there - here, 0.5);  // of noise's one: it shows
  EXPECT_NEAR(spread_of_photos(fitted, true) / chi2_quantile(1.0 - Limits{}.floor.chance, 1.0),
              there - here, 0.2 * (there - here));
  // Those that are fitted hold the values: an error that they allow hardly shows in them.
  EXPECT_LT(spread_of_photos(fitted, false), 0.01 * (there - here));
}

TEST(FitToAll, ValuesThatAreHardlyKnownAreNoMissingEffect) {
  auto& [small, workspace, made] = hardly_known();
  Fitted fitted = made;
  Diagnosis diagnosis;
  const Floor& floor = diagnosis.floor = measure_floor(*small.scene, fitted.evaluation);
  // Two standard deviations off, as one of twenty captures is.
  const auto V =
      parameter_covariance(fitted.evaluation, fitted.form.parameters(), fitted.p).determined;
  const Eigen::Index d = fitted.p.size() - 1;
  const double away = fitted.p[d] > 0.12 ? 1.0 : -1.0;
  const VectorXd off = away * 2.0 * V.col(d) / std::sqrt(V(d, d));
  fitted = assess(workspace, fitted.form, fitted.p + off).value();
  ASSERT_TRUE(spoils_held_out(fitted, floor));
  const auto result = fit_to_all(workspace, fitted, diagnosis, {});
  const auto& all = *result;
  ASSERT_TRUE(all);
  EXPECT_NEAR(all->fitted.p[d], 0.12, 0.002);
  EXPECT_LT(all->chi_fit, Limits{}.floor.at * floor.chi);
  EXPECT_LT(all->chi_validate, Limits{}.floor.at * floor.chi);
  EXPECT_THAT(all->hardly_known, testing::ElementsAre(testing::StartsWith("softening.d 0.1")));
  const nlohmann::json told = to_json(*all);
  EXPECT_EQ(told.at("chi_validate"), all->chi_validate);
  EXPECT_EQ(told.at("parameters").back().at("name"), "softening.d");
  EXPECT_EQ(told.at("parameters").back().at("value"), all->fitted.p[d]);
  // Had the fitted photos been explained far better, these values would give that up.
  for (auto& example : fitted.evaluation.examples)
    for (auto& photo : example.photos)
      if (!example.held_out) photo.r2 *= 0.5;
  const auto again = fit_to_all(workspace, fitted, diagnosis, {});
  EXPECT_FALSE(*again);
}

/// The photos of a free load know the softening: what held-out ones are missed by then is another
/// matter, and no refit excuses it.
TEST(FitToAll, ValuesThatAreWellKnownExcuseNothing) {
  const test::SmallScene small = softened("force: [0, 0.01, 0.2]");
  Workspace workspace(small.scene);
  const Fitted wrong = fitted_with(workspace, "creep", "steadily with the order");
  Diagnosis diagnosis;
  Floor& floor = diagnosis.floor = measure_floor(*small.scene, wrong.evaluation);
  // As if the fitted photos were explained: they are not by this.
  floor.chi = std::max(floor.chi, wrong.evaluation.chi(false) / Limits{}.floor.at * 1.001);
  ASSERT_GT(wrong.evaluation.chi(true), Limits{}.floor.at * floor.chi);
  EXPECT_GT(over_floor(wrong, floor, true), spread_of_photos(wrong, true));
  const auto result = fit_to_all(workspace, wrong, diagnosis, {});
  EXPECT_FALSE(*result);
}

/// The held-out load pulls 0.7 degrees aside, of which nobody was told: the softening, hardly
/// known, could make its photos miss by as much, but not like this.
TEST(FitToAll, WhatNoValueExplainsIsNotLetOff) {
  const test::SmallScene small = softened("move: [0, 0, -0.06]");
  auto scene = std::make_shared<Scene>(*small.scene);
  for (ExampleSpec& example : scene->capture.examples)
    if (example.validate)
      for (LoadSpec& load : example.loads)
        *load.force += 0.012 * load.force->norm() * Vector3d::UnitX();
  Workspace workspace(scene);
  const Fitted fitted = fitted_with(workspace, "softening", "from press on");
  Diagnosis diagnosis;
  const Floor& floor = diagnosis.floor = measure_floor(*scene, fitted.evaluation);
  ASSERT_TRUE(spoils_held_out(fitted, floor));
  EXPECT_LT(over_floor(fitted, floor, true), spread_of_photos(fitted, true));
  const auto result = fit_to_all(workspace, fitted, diagnosis, {});
  EXPECT_FALSE(*result);
}

/// Creep that levels off, two loads of it.
class CreepOfTwoLoads : public testing::Test {
 protected:
  CreepOfTwoLoads()
      : small_({.hidden = "hidden:\n  - {effect: creep, variant: free levelling off of the "
                          "compliance, values: {creep.c: 0.2, creep.tau: 1.2}}\n",
                .seed = 7,
                .loads = ""}),
        workspace_(small_.scene) {}
  Fitted fitted_with(const std::string& effect, const std::string& variant) {
    return hookeye::fitted_with(workspace_, effect, variant);
  }
  test::SmallScene small_;
  Workspace workspace_;
};

/// Softening explains those and, whatever its value, not the third; it knows its value well.
TEST_F(CreepOfTwoLoads, IsNoSoftening) {
  const Fitted wrong = fitted_with("softening", "from side on");
  Diagnosis diagnosis;
  const Floor& floor = diagnosis.floor = measure_floor(*small_.scene, wrong.evaluation);
  ASSERT_TRUE(spoils_held_out(wrong, floor));
  EXPECT_GT(over_floor(wrong, floor, true), spread_of_photos(wrong, true));
  const auto result = fit_to_all(workspace_, wrong, diagnosis, {});
  EXPECT_FALSE(*result);
}

/// Where all are fitted creep does better than the softening that had won; who stands there is not
/// asked for its own place, nor who explained nothing.
TEST_F(CreepOfTwoLoads, TellsItsRivalsApartWhereAllAreFitted) {
  auto scene = std::make_shared<Scene>(*small_.scene);
  for (ExampleSpec& example : scene->capture.examples) example.validate = false;
  Workspace workspace(scene);
  FitToAll all;
  all.fitted = hookeye::fitted_with(workspace, "softening", "from side on");
  const Floor floor = measure_floor(*scene, all.fitted.evaluation);
  const size_t base = base_form(scene).ingredients.size();
  const auto tie = [&](const std::vector<Contested>& past) {
    return tie_of_all(workspace, all, past, {}, floor, base, {}, {});
  };
  /// A step of a run, as far as its contest tells.
  const auto won = [](const std::string& added, std::vector<Rival> rivals,
                      std::vector<std::string> dropped = {}) {
    Contested out;
    out.added = added;
    out.rivals = std::move(rivals);
    out.dropped = std::move(dropped);
    return out;
  };
  const Rival creep{"creep", -1.0, floor.chi, 5.0}, far{"creep", -1.0, 9.0, 9.0};
  EXPECT_THAT(tie({won("softening", {creep})}), testing::ElementsAre("softening", "creep"));
  EXPECT_THAT(tie({won("softening", {far})}), testing::IsEmpty());
  EXPECT_THAT(tie({won("gravity", {creep})}), testing::IsEmpty());
  // Whoever took the winner's place answers for it.
  EXPECT_THAT(tie({won("gravity", {creep}), won("softening", {}, {"gravity"})}),
              testing::ElementsAre("softening", "creep"));
  all.fitted = hookeye::fitted_with(workspace, "creep", "steadily with the order");
  EXPECT_THAT(tie({won("creep", {{"softening", -1.0, floor.chi, 5.0}})}), testing::IsEmpty());
}

TEST(FitToAll, WhereNothingIsHeldOutNothingIsAsked) {
  const test::SmallScene small({});
  auto scene = std::make_shared<Scene>(*small.scene);
  scene->capture.examples.back().validate = false;
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const Fitted fitted = assess(workspace, form, form.initial()).value();
  EXPECT_EQ(spread_of_photos(fitted, true), 0.0);
  Diagnosis diagnosis;
  diagnosis.floor = measure_floor(*scene, fitted.evaluation);
  const auto result = fit_to_all(workspace, fitted, diagnosis, {});
  EXPECT_FALSE(*result);
}

}  // namespace
}  // namespace hookeye
