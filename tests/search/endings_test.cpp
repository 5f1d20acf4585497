// How searches end where names compete: what ties, what is dropped, what has no name.
#include <fmt/format.h>
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
  Step step = test::base_step(workspace);
  const auto swelling =
      std::find_if(step.diagnosis.effects.begin(), step.diagnosis.effects.end(),
                   [](const EffectScore& score) { return score.effect == "swelling"; });
  ASSERT_NE(swelling, step.diagnosis.effects.end());
  Step wrong;
  wrong.name = wrong.added = "swelling";
  wrong.fitted = std::get<Fitted>(add_effect(workspace, step.fitted, *swelling, {}));
  ASSERT_LT(wrong.fitted.evaluation.chi(false), step.fitted.evaluation.chi(false));
  const auto found = discover_from(workspace, std::move(wrong), {}, {});
  const Discovery& discovery = std::get<Discovery>(found);
  EXPECT_THAT(discovery.missing, ElementsAre("gravity")) << discovery.sentence;
  EXPECT_EQ(discovery.verdict, Verdict::explained) << discovery.sentence;
  bool dropped = false;
  for (const Step& one : discovery.steps)
    dropped = dropped || std::count(one.dropped.begin(), one.dropped.end(), "swelling");
  EXPECT_TRUE(dropped);
}

/// Creep with the logarithm of the order or steadily with it: three loads and a free modulus cannot
/// tell, the held-out one can, and what is added is its form.
TEST(Discover, HeldOutPhotosTellTheFormsOfAnEffectApart) {
  struct Hidden {
    const char* variant;
    double c;
    unsigned seed;
  };
  // Of the second, one step from where the base model ended favours the wrong form, the next does
  // not.
  for (const Hidden& hidden : {Hidden{"steadily with the order", 0.81, 5},
                               Hidden{"with the logarithm of the order", 0.5035, 11}}) {
    const SmallScene small(
        {.hidden =
             fmt::format("hidden:\n  - {{effect: creep, variant: {}, values: {{creep.c: {}}}}}\n",
                         hidden.variant, hidden.c),
         .seed = hidden.seed});
    const Discovery discovery = test::discover(small);
    EXPECT_THAT(discovery.missing, ElementsAre("creep"));
    EXPECT_EQ(discovery.verdict, Verdict::explained) << discovery.sentence;
    const Fitted& last = discovery.steps.back().fitted;
    EXPECT_EQ(last.form.ingredients.back()->variant(), hidden.variant);
    EXPECT_NEAR(last.p[last.p.size() - 1], hidden.c, 0.01);
  }
}

/// A modulus that is a third too high has made up for a wall: with the wall it has to fall at once,
/// or the wall is refused as worse than nothing.
TEST(Discover, WhatTheModulusHadMadeUpForIsFound) {
  const SmallScene small(
      {.hidden = "hidden:\n  - {effect: floor_contact, variant: \"plane at +z side, position "
                 "34.215\", values: {floor_contact.k: 4.94e-4}}\n",
       .seed = 11});
  const Discovery discovery = test::discover(small);
  EXPECT_GT(discovery.steps.front().fitted.p[0], 0.025);
  EXPECT_THAT(discovery.missing, ElementsAre("floor_contact"));
  EXPECT_EQ(discovery.verdict, Verdict::explained) << discovery.sentence;
  const VectorXd& p = discovery.steps.back().fitted.p;
  EXPECT_NEAR(p[0], 0.02, 2e-4);
  EXPECT_NEAR(p[1], 34.215, 0.05);
  EXPECT_NEAR(p[2], 4.94e-4, 0.3e-4);
}

/// A wall that stops the pull resembles a body that was stiffer until then, and gets farther in two
/// steps; softening ties with creep in evidence, and is refitted for that.
TEST(Discover, WhoTiesInEvidenceIsRefittedHoweverSlow) {
  const SmallScene small(
      {.hidden = "hidden:\n  - {effect: softening, variant: from side on, values: {softening.d: "
                 "0.412937}}\n",
       .seed = 11});
  const Discovery discovery = test::discover(small);
  EXPECT_THAT(discovery.missing, ElementsAre("softening"));
  EXPECT_EQ(discovery.verdict, Verdict::explained) << discovery.sentence;
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

/// The same effect twice, each with numbers of its own: two cameras, one of them later.
TEST(Discover, BothCamerasWereKnocked) {
  const SmallScene small(
      {.hidden =
           "hidden:\n  - {effect: camera_pose, variant: cam0 from side on, values: "
           "{\"camera_pose.cam0 from side on.ry\": 0.004}}\n  - {effect: camera_pose, variant: "
           "cam1 from the start, values: {camera_pose.cam1.tx: 0.4}}\n"});
  const Discovery discovery = test::discover(small);
  EXPECT_THAT(discovery.missing, ElementsAre("camera_pose"));
  EXPECT_EQ(discovery.verdict, Verdict::explained) << discovery.sentence;
  EXPECT_EQ(discovery.steps.size(), 3u);
  const Fitted& last = discovery.steps.back().fitted;
  const auto parameters = last.form.parameters();
  const auto value = [&](const std::string& name) {
    for (size_t i = 0; i < parameters.size(); ++i)
      if (parameters[i].name == name) return last.p[static_cast<Eigen::Index>(i)];
    return 0.0;
  };
  EXPECT_NEAR(value("camera_pose.cam0 from side on.ry"), 0.004, 4e-4);
  EXPECT_NEAR(value("camera_pose.cam1.tx"), 0.4, 0.05);
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

/// Held-out photos have exposures too, which no other photo tells: they are fitted to their own,
/// and the search does not end at the misfit that they would leave.
TEST(Discover, HeldOutPhotosHaveTheirOwnExposure) {
  const SmallScene small({.hidden = R"(hidden:
  - effect: exposure
    variant: each photo, held-out ones too
    values: {exposure.pull.cam0: 0.06, exposure.pull.cam1: 0.05, exposure.side.cam0: -0.05,
             exposure.twist.cam1: 0.08, exposure.poke.cam0: -0.07, exposure.poke.cam1: 0.09}
)"});
  const Discovery found = test::discover(small);
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
  EXPECT_THAT(found.missing, ElementsAre("exposure"));
  const Fitted& last = found.steps.back().fitted;
  EXPECT_LT(last.evaluation.chi(true), 1.15 * found.floor.chi);
  const auto parameters = last.form.parameters();
  const auto at = std::find_if(parameters.begin(), parameters.end(),
                               [](const auto& one) { return one.name == "exposure.poke.cam1"; });
  ASSERT_NE(at, parameters.end());
  EXPECT_NEAR(last.p[at - parameters.begin()], 0.09, 0.005);
}

}  // namespace
}  // namespace hookeye
