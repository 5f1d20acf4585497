// The main path on small captures: fit, diagnose, race, add, judge.
#include "estimation/search/discover.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "estimation/fit/trial.h"
#include "estimation/search/contest.h"
#include "estimation/search/refit_score.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

using test::discover;
using test::SmallCapture;
using test::SmallScene;
using test::value_of;

TEST(Fit, ReachesTheTruthFromPixelsAway) {
  const SmallScene small({.told = "0.013"});
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  const auto before = assess(workspace, form, form.initial());
  ASSERT_GT(before->evaluation.rms_px(false), 2.0);
  const auto result = fit(workspace, form, form.initial());
  const Fitted& fitted = *result;
  EXPECT_TRUE(fitted.converged);
  EXPECT_NEAR(fitted.p[0], 0.02, 0.02 * 2e-3);
  EXPECT_LE(fitted.low[0], 0.02 * (1 + 1e-3));
  EXPECT_GE(fitted.high[0], 0.02 * (1 - 1e-3));
  // the truth is photographed with other rays, so that contours keep a little more than noise
  const Floor floor = measure_floor(*small.scene, fitted.evaluation);
  EXPECT_LT(fitted.evaluation.chi(false), 1.3 * floor.chi);
  EXPECT_LT(fitted.evaluation.chi(true), 1.3 * floor.chi);
  // Gauss-Newton on the motion converges in a few steps from anywhere that the flow can follow; on
  // pixels it used up its 20 at full size alone.
  EXPECT_LT(fitted.iterations, 20);
}

/// Of the first of these the told load has no equilibrium; of the others the pictures have nothing
/// in common with the photos but the base.
TEST(Fit, ComesHomeFromAModulusThatIsAGuess) {
  for (const char* told : {"0.0003", "0.004", "0.3"}) {
    const SmallScene small({.told = told, .same_renderer = true});
    Workspace workspace(small.scene);
    const ModelForm form = base_form(small.scene);
    const auto result = fit(workspace, form, form.initial());
    ASSERT_TRUE(result.has_value()) << told;
    EXPECT_NEAR(result->p[0], 0.02, 0.02 * 2e-3) << told;
  }
}

/// The truth is solved on a finer mesh, and the fitted modulus makes up for it.
TEST(Intervals, ReachForTheFinerMesh) {
  const SmallScene small({.told = "0.021", .truth_mesh = "0.5", .same_renderer = true});
  Workspace workspace(small.scene);
  Fitted fitted = test::base_fit(workspace);
  const Diagnosis diagnosis = diagnose(workspace, fitted).value();
  ASSERT_EQ(diagnosis.mesh_shift.size(), 1);
  const double off = 0.02 - fitted.p[0], low = fitted.low[0], high = fitted.high[0];
  const SmallScene same({.told = "0.021", .truth_mesh = "1", .same_renderer = true});
  Workspace of_same(same.scene);
  const double other = 0.02 - test::base_fit(of_same).p[0];
  ASSERT_GT(std::abs(off), 3.0 * std::abs(other)) << "not the mesh's error: this proves nothing";
  // to the limit of ever finer meshes; the truth's is half as fine, 1.33 times to there
  EXPECT_GT(diagnosis.mesh_shift[0] / off, 0.8) << diagnosis.mesh_note;
  EXPECT_LT(diagnosis.mesh_shift[0] / off, 2.5) << diagnosis.mesh_note;
  reach_for_mesh(fitted, diagnosis);
  EXPECT_EQ(fitted.low[0] < low, off < 0.0);
  EXPECT_EQ(fitted.high[0] > high, off > 0.0);
  EXPECT_LE(fitted.low[0], 0.02);
  EXPECT_GE(fitted.high[0], 0.02);
}

/// A weight that nobody has told moves the photo at rest by several pixels, and not as a polynomial
/// would at the rims. That is misfit, not noise.
TEST(Floor, KnowsLargeMotionsAtRestFromNoise) {
  const SmallScene small({.hidden = "hidden:\n  - {effect: gravity, values: {gravity.x: 12000, "
                                    "gravity.z: -27000}}\n"});
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  const Fitted base = assess(workspace, form, form.initial()).value();
  ASSERT_GT(base.evaluation.rms_px(false), 2.0);
  EXPECT_LT(measure_floor(*small.scene, base.evaluation).chi, 2.0);  // 6.2 by polynomials
}

/// Errors of the renderer in the photos, however large, are none of the sensors': their misfit
/// counts as told, or a force zero would never pay.
TEST(RefitScore, ForcesCountByTheirOwnNoise) {
  const SmallScene small({});
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  const Fitted right = assess(workspace, form, form.initial()).value();
  Fitted wrong = right;
  int moved = 0;
  for (auto& example : wrong.evaluation.examples)
    for (auto& measured : example.measured) measured.r.z() += 6.0, ++moved;
  ASSERT_GT(moved, 0);
  Floor exact, rough;
  rough.cell_variance = 100.0;
  const auto loss = [&](const Floor& floor) {
    const Yardstick yardstick{&right, &floor, 1.0};
    return refit_score(right, yardstick) - refit_score(wrong, yardstick);
  };
  EXPECT_NEAR(loss(exact), 0.5 * moved * 36.0, 0.1 * moved * 36.0);  // r^2 / 2 over noise of 1
  EXPECT_NEAR(loss(rough), loss(exact), 1e-9);
}

/// While much is missing, held-out photos miss by several times as much as fitted ones. A fifth
/// less on the fitted ones is worth more than an eighth on those, however large theirs are.
TEST(RefitScore, HeldOutPhotosHaveAVarianceOfTheirOwn) {
  const SmallScene small({});
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  const Fitted right = assess(workspace, form, form.initial()).value();
  const auto missing = [&](double times, double times_held_out) {
    Fitted out = right;
    for (auto& example : out.evaluation.examples)
      for (auto& photo : example.photos)
        for (FlowCell& cell : photo.flow.cells) cell.z *= example.held_out ? times_held_out : times;
    return out;
  };
  const Floor floor;
  const Yardstick yardstick{&right, &floor, 1.0};
  const auto score = [&](double times, double times_held_out) {
    return refit_score(missing(times, times_held_out), yardstick);
  };
  EXPECT_GT(score(8.0, 34.0),
            score(10.0, 30.0) + Limits{}.diagnosis.nameable);  // not of one variance for all
  EXPECT_GT(score(10.0, 24.0), score(9.5, 30.0) + Limits{}.diagnosis.tie);  // and they are heard
}

/// A trial whose held-out example has no equilibrium, not even at its start, is out of the race.
/// It was told as cancelled, and that ended the whole search.
TEST(Race, AHeldOutExampleWithoutEquilibriumIsNoEnd) {
  const SmallScene small({});
  const auto scene = std::make_shared<Scene>(*small.scene);
  for (ExampleSpec& example : scene->capture.examples)
    if (example.validate)
      for (LoadSpec& load : example.loads) *load.force *= -1e4;
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto scale = trial_scale(workspace, form, form.initial(), {});
  ASSERT_TRUE(scale.has_value());
  const auto result = try_step(workspace, form, form.initial(), *scale, {});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().example, "poke");
  EXPECT_FALSE(cancelled(result.error()));
}

/// Noise alone: with other rays than the fit's the pixel filter differs by a hair, and `defocus`
/// says so (bench/statistics --other-renderer).
TEST(Discover, NothingIsMissingWhereNothingIsHidden) {
  const Discovery found = discover(SmallScene({.told = "0.023", .same_renderer = true}));
  EXPECT_EQ(found.verdict, Verdict::explained);
  EXPECT_EQ(found.steps.size(), 1u);
  EXPECT_THAT(found.sentence, testing::HasSubstr("nothing is missing"));
}

TEST(Discover, NamesTheHiddenWeightAndTheErrorFalls) {
  const Discovery found =
      discover(SmallScene({.hidden = "hidden:\n  - {effect: gravity, values: {gravity.x: 4000, "
                                     "gravity.z: -9000}}\n",
                           .told = "0.021"}));
  ASSERT_EQ(found.steps.size(), 2u) << found.sentence;
  EXPECT_EQ(found.steps[1].added, "gravity");
  EXPECT_THAT(found.missing, testing::ElementsAre("gravity"));
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
  EXPECT_TRUE(found.tie.empty());
  const Fitted& base = found.steps[0].fitted;
  const Fitted& last = found.steps[1].fitted;
  EXPECT_GT(base.evaluation.chi(false), 2.0);
  EXPECT_LT(last.evaluation.chi(false), 1.3 * found.floor.chi);
  EXPECT_LT(last.evaluation.chi(true), base.evaluation.chi(true));
  EXPECT_TRUE(held_out_allows(last, base, found.floor));
  EXPECT_TRUE(held_out_allows(last, last, found.floor));  // no change is no word against it
  EXPECT_FALSE(held_out_allows(base, last, found.floor));
  // No word either: what meshes and renderers err by, were that as much as the base is worse.
  const double rise =
      std::pow(base.evaluation.chi(true), 2) - std::pow(last.evaluation.chi(true), 2);
  EXPECT_TRUE(held_out_allows(base, last, found.floor, 1.01 * rise));
  EXPECT_FALSE(held_out_allows(base, last, found.floor, 0.99 * rise));
  EXPECT_NEAR(value_of(last, "gravity.z"), -9000.0, 300.0);
  EXPECT_NEAR(value_of(last, "gravity.x"), 4000.0, 300.0);
}

/// Seven deviations of one measured force, and nothing in any photo: few values pay for what they
/// alone can show.
TEST(Discover, NamesAForceZeroOfAFewDeviations) {
  const Discovery found =
      discover(SmallScene({.hidden = "hidden:\n  - {effect: force_zero, values: {force_zero.x: "
                                     "-0.08, force_zero.y: 0.06, force_zero.z: 0.1}}\n",
                           .same_renderer = true}));
  double r2 = 0.0;
  for (const auto& example : found.steps[0].fitted.evaluation.examples)
    for (const auto& measured : example.measured) r2 += measured.r.squaredNorm();
  ASSERT_GT(r2, 30.0);
  ASSERT_LT(r2, 100.0);
  EXPECT_THAT(found.missing, testing::ElementsAre("force_zero")) << found.sentence;
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
}

/// Tetrahedra far too coarse to bend as the body does: a dozen effects stand out. The finer mesh
/// takes them away, and what it leaves is the next finer one's and nobody else's.
TEST(Discover, AMeshThatLeavesNothingRacesWithNobody) {
  const Discovery found = discover(SmallScene({.told = "0.021", .truth_mesh = "0.4"}));
  ASSERT_EQ(found.steps.size(), 2u) << found.sentence;
  EXPECT_EQ(found.steps[1].added, "mesh_resolution");
  EXPECT_EQ(found.steps[1].raced.size(), 1u);
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
  // The told modulus' interval reaches for the finer mesh, the refined one's for a still finer one.
  for (const Step& step : found.steps) {
    EXPECT_LE(step.fitted.low[0], 0.02) << step.name;
    EXPECT_GE(step.fitted.high[0], 0.02) << step.name;
  }
  EXPECT_LT(found.steps[1].fitted.high[0] - found.steps[1].fitted.low[0],
            0.5 * (found.steps[0].fitted.high[0] - found.steps[0].fitted.low[0]));
}

TEST(Discover, CancelledSaysSo) {
  const SmallScene small({.told = "0.02"});
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  std::atomic<bool> cancel{true};
  DiscoverOptions options;
  options.fit.cancel = options.diagnosis.cancel = &cancel;
  const auto result = hookeye::discover(workspace, form, form.initial(), options);
  ASSERT_FALSE(result);
  EXPECT_TRUE(cancelled(result.error()));
}

/// Whoever stops a search that has its steps and still asks about them gets no verdict.
TEST(Discover, StoppedAtItsLastQuestionsHasNoVerdict) {
  const SmallScene small({.same_renderer = true});
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  std::atomic<bool> cancel{false};
  DiscoverOptions options;
  options.fit.cancel = options.diagnosis.cancel = &cancel;
  DiscoverEvents events;
  events.step = [&](const Step&) { cancel = true; };
  const auto result = hookeye::discover(workspace, form, form.initial(), options, events);
  ASSERT_FALSE(result);
  EXPECT_TRUE(cancelled(result.error()));
}

}  // namespace
}  // namespace hookeye
