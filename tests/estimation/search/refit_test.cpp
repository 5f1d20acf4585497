// An effect in two forms: what the fitted photos show most of, and what the held-out ones ask for.
#include "estimation/search/refit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "estimation/diagnosis/diagnosis_json.h"
#include "estimation/effects/catalogue.h"
#include "estimation/output/step_json.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

/// All loads are turned alike; the scored form turns those of one example only.
class TwoForms : public testing::Test {
 protected:
  void SetUp() override {
    test::SmallCapture capture;
    capture.same_renderer = true;
    capture.hidden =
        "hidden:\n  - {effect: load_direction, variant: \"in all\", values: "
        "{load_direction.all.angle1: 0.08, load_direction.all.angle2: -0.06}}\n";
    small_ = std::make_unique<test::SmallScene>(capture);
    workspace_ = std::make_unique<Workspace>(small_->scene);
    const ModelForm form = base_form(small_->scene);
    base_ = fit(*workspace_, form, form.initial()).value();
    score_ = form_of("in pull");
    score_.other_form = std::make_shared<EffectScore>(form_of("in all"));
  }
  EffectScore form_of(const std::string& variant) const {
    EffectScore score;
    score.effect = "load_direction";
    score.best = find_effect(score.effect)->candidate(base_.form.realise(base_.p), variant);
    score.dof = static_cast<int>(score.best->parameters().size());
    score.values = VectorXd::Constant(score.dof, 0.01);
    score.base_step = VectorXd::Constant(base_.p.size(), 1e-5);
    score.standard_error = VectorXd::Constant(score.dof, 0.01);
    return score;
  }
  std::unique_ptr<test::SmallScene> small_;
  std::unique_ptr<Workspace> workspace_;
  Fitted base_;
  EffectScore score_;
};

TEST_F(TwoForms, TheOneThatGetsFartherIsRefitted) {
  const auto result = add_effect(*workspace_, base_, score_, {});
  ASSERT_TRUE(result.has_value());
  const Fitted& fitted = *result;
  ASSERT_EQ(fitted.form.ingredients.back()->variant(), "in all");
  EXPECT_LT(fitted.evaluation.chi(false), 1.1);
  EXPECT_LT(fitted.evaluation.chi(true), 1.1);
  EXPECT_NEAR(fitted.p[fitted.p.size() - 3], 0.08, 0.005);
  EXPECT_NEAR(fitted.p[fitted.p.size() - 2], -0.06, 0.005);
}

/// What ends a refit is bounded: an equilibrium that is not there is sought for hundreds of steps.
TEST_F(TwoForms, ARivalsEquilibriumIsNotSoughtForEver) {
  FitOptions options;
  options.most_iterations = 2;
  Workspace from_rest(small_->scene);
  const auto result = assess(from_rest, base_.form, base_.p, options);
  ASSERT_TRUE(!result);
  EXPECT_NE(result.error().reason.find("no equilibrium within"), std::string::npos)
      << result.error().reason;
  options.most_iterations = kRivalIterations;
  EXPECT_TRUE(assess(from_rest, base_.form, base_.p, options).has_value());
}

TEST_F(TwoForms, BothAreWrittenAndReadBack) {
  Diagnosis diagnosis;
  diagnosis.effects = {score_};
  diagnosis.floor.by_camera = {{"cam0", 1.25}};
  diagnosis.floor.moved_at_rest = {{"cam0", 0.5}};
  const Diagnosis again =
      diagnosis_from_json(to_json(diagnosis), base_.form.realise(base_.p), "diagnosis.json");
  ASSERT_TRUE(again.effects.at(0).other_form);
  EXPECT_EQ(again.effects[0].other_form->best->variant(), "in all");
  EXPECT_EQ(again.effects[0].other_form->values, score_.other_form->values);
  EXPECT_EQ(again.effects[0].base_step, score_.base_step);
  EXPECT_EQ(again.floor.by_camera, diagnosis.floor.by_camera);
  EXPECT_EQ(again.floor.moved_at_rest, diagnosis.floor.moved_at_rest);
}

/// The first explains nearly all: who promises little does not run.
TEST_F(TwoForms, TheRaceEndsWhereTheFirstLeavesNothing) {
  EffectScore first = form_of("in all");
  first.explains = 0.95, first.evidence = 200.0, first.fall = 1e3;
  EffectScore second = first;
  second.effect = "gravity";
  second.best = find_effect("gravity")->candidates(base_.form.realise(base_.p), nullptr).front();
  second.values.setZero(second.best->parameters().size());
  second.evidence = 100.0;
  const auto tried = [&](double explains, double evidence) {
    second.explains = explains, second.evidence = evidence;
    Diagnosis diagnosis;
    diagnosis.effects = {first, second};
    std::map<std::string, int> steps;
    const auto raced =
        race(*workspace_, base_, diagnosis, {}, [&](const Racer& racer) { ++steps[racer.effect]; });
    EXPECT_EQ(raced->front().effect, "load_direction");
    EXPECT_EQ(steps["load_direction"], 2);
    return steps["gravity"];
  };
  EXPECT_EQ(tried(0.1, 100.0), 0);
  EXPECT_EQ(tried(0.9, 100.0), 2);
  EXPECT_EQ(tried(0.1, 199.0), 2);  // as much evidence says more than two steps
}

/// What a step may bring is judged by what is over the floor, fitted and held out: 10 % is nearly
/// all.
TEST(Racer, RunsAheadWhileItConverges) {
  TrialScale start;
  start.chi = 2.0, start.chi_validate = 3.0, start.floor = 0.2;
  const auto left = [](double share_fit, double share_validate) {
    return Trial{{},
                 std::sqrt(0.04 + share_fit * (4.0 - 0.04)),
                 std::sqrt(0.04 + share_validate * (9.0 - 0.04)),
                 0.2};
  };
  const SearchLimits limits;
  // 0.5 to 0.2 goes on to 0.08, 0.3 to 0.2 to 0.13.
  EXPECT_TRUE(brings_nearly_all(left(0.5, 0.5), left(0.2, 0.2), start, limits));
  EXPECT_FALSE(brings_nearly_all(left(0.3, 0.3), left(0.2, 0.2), start, limits));
  EXPECT_FALSE(brings_nearly_all(left(0.5, 0.3), left(0.2, 0.2), start, limits));
  // What is there already need not come, and both there is the end.
  EXPECT_TRUE(brings_nearly_all(left(0.09, 0.5), left(0.08, 0.2), start, limits));
  EXPECT_FALSE(brings_nearly_all(left(0.5, 0.5), left(0.08, 0.08), start, limits));
  EXPECT_FALSE(brings_nearly_all(left(0.2, 0.2), left(0.3, 0.3), start, limits));
}

TEST(Racer, IsJudgedByWhatIsNoNoise) {
  const auto left = [](double fit, double validate, double floor) {
    Racer racer;
    racer.form.scene = std::make_shared<const Scene>();  // whose limits count
    racer.trial = {{}, fit, validate, floor};
    return racer.structured();
  };
  EXPECT_DOUBLE_EQ(left(0.5, 0.0, 0.0), 0.5);  // no rest photos: all of it counts
  EXPECT_DOUBLE_EQ(left(0.5, 1.3, 0.3), 0.4 + std::sqrt(1.3 * 1.3 - 0.09));
  // At the floor all are equal, below it too.
  EXPECT_DOUBLE_EQ(left(0.3, 0.31, 0.3), left(0.29, 0.3, 0.3));
  EXPECT_GT(left(0.3, 0.3, 0.3), 0.0);
  // 1.4 times the floor is no tie of what is there, although the whole is but 1.4 times as large.
  EXPECT_GT(left(0.42, 0.42, 0.3), 1.5 * left(0.3, 0.3, 0.3));
}

}  // namespace
}  // namespace hookeye
