// How searches end where names compete: what ties, what is dropped, what has no name.
#include <gmock/gmock.h>

#include "estimation/search/discover.h"
#include "estimation/search/refit.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

using test::SmallScene;
using testing::ElementsAre;

const char* const kWeight =
    "hidden:\n  - {effect: gravity, values: {gravity.x: 4000, gravity.z: -9650}}\n";

/// A swollen body explains part of a weight. Once the weight is found it does nothing, and goes.
TEST(Discover, AnEarlierEffectThatALaterOneMakesIdleIsDropped) {
  const SmallScene small({.hidden = kWeight});
  Workspace workspace(small.scene);
  Step step;
  step.fitted = test::base_fit(workspace);
  step.diagnosis = diagnose(workspace, step.fitted, test::of_alone({"swelling"})).value();
  const auto swelling =
      std::find_if(step.diagnosis.effects.begin(), step.diagnosis.effects.end(),
                   [](const EffectScore& score) { return score.effect == "swelling"; });
  ASSERT_NE(swelling, step.diagnosis.effects.end());
  Step wrong;
  wrong.name = wrong.added = "swelling";
  wrong.fitted = add_effect(workspace, step.fitted, *swelling, {}).value();
  ASSERT_LT(wrong.fitted.evaluation.chi(false), step.fitted.evaluation.chi(false));
  const auto found = discover_from(workspace, std::move(wrong), {}, {});
  const Discovery& discovery = *found;
  EXPECT_THAT(discovery.missing, ElementsAre("gravity")) << discovery.sentence;
  EXPECT_EQ(discovery.verdict, Verdict::explained) << discovery.sentence;
  bool dropped = false;
  for (const Step& one : discovery.steps)
    dropped = dropped || std::count(one.dropped.begin(), one.dropped.end(), "swelling");
  EXPECT_TRUE(dropped);
}

/// One load is misaligned and the body gives in volume: that all loads are turned explains a little
/// more of the fitted photos and spoils the held-out ones; that a load is turned which moves
/// nothing spoils none, and is no rival.
TEST(Discover, AMisalignedLoadBesideAnotherEffect) {
  const SmallScene small(
      {.hidden = "hidden:\n  - {effect: load_direction, variant: in pull, values: "
                 "{load_direction.pull.angle1: 0.07, load_direction.pull.angle2: -0.03}}\n  - "
                 "{effect: compressibility, values: {compressibility.poisson: 0.36}}\n"});
  const Discovery discovery = test::discover(small);
  for (const EffectScore& score : discovery.steps.front().diagnosis.effects)
    if (score.other_form) {
      EXPECT_GT(score.other_form->explains, 0.5 * score.explains);
    }
  EXPECT_THAT(discovery.missing,
              testing::UnorderedElementsAre("load_direction", "compressibility"));
  EXPECT_EQ(discovery.verdict, Verdict::explained) << discovery.sentence;
}

/// Without its name in the catalogue, and without those that are easily taken for it, no other may
/// stand for it.
TEST(Discover, WhatTheCatalogueDoesNotHaveEndsUnexplained) {
  const SmallScene small({.hidden = kWeight});
  DiscoverOptions options;
  options.diagnosis.without = {"gravity", "placement", "swelling", "pressure", "stiffness_field"};
  options.max_effects = 1;
  const Discovery discovery = test::discover(small, options);
  EXPECT_EQ(discovery.verdict, Verdict::unexplained) << discovery.sentence;
  for (const std::string& name : options.diagnosis.without)
    EXPECT_THAT(discovery.missing, testing::Not(testing::Contains(name)));
  EXPECT_GT(discovery.steps.back().fitted.evaluation.chi(false), 1.3 * discovery.floor.chi);
}

/// What is wrong at rest as well is no noise of the rest photos: chance does not reach as far as
/// it.
TEST(Diagnose, APhotoThatIsTooBrightFromTheStartIsNoCorrelatedNoise) {
  for (const char* hidden : {"exposure, variant: cam1 from the start",
                             "light_direction, variant: "
                             "sun from the start"}) {
    const SmallScene small(
        {.hidden = std::string("hidden:\n  - {effect: ") + hidden + ", rms_px: 1.5}\n"});
    Workspace workspace(small.scene);
    const Diagnosis found = test::base_step(workspace).diagnosis;
    EXPECT_LT(found.gate, 0.1 * found.effects[0].evidence) << hidden;
    EXPECT_THAT(leaders(found), ElementsAre(found.effects[0].effect));
    EXPECT_THAT(hidden, testing::StartsWith(found.effects[0].effect));
  }
}

}  // namespace
}  // namespace hookeye
