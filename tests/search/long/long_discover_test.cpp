// Whole searches: what is named, in which form, beside what else.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "estimation/model/additive_material.h"
#include "estimation/search/discover.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

using test::SmallScene;
using testing::ElementsAre;

/// What is missing beside an additive material is named as beside a law of the textbooks.
TEST(Discover, NamesTheHiddenWeightBesideAnAdditiveMaterial) {
  const SmallScene small({.hidden = "hidden:\n  - {effect: gravity, values: {gravity.x: 4000, "
                                    "gravity.z: -9000}}\n",
                          .told = "0.021"});
  Workspace workspace(small.scene);
  const ModelForm base = base_form(small.scene);
  const auto [form, p] = to_additive(base, base.initial());
  const Discovery found = hookeye::discover(workspace, form, p, {}).value();
  EXPECT_THAT(found.missing, testing::ElementsAre("gravity")) << found.sentence;
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
  EXPECT_NEAR(test::value_of(found.steps.back().fitted, "gravity.z"), -9000.0, 300.0);
}

/// Stiffening's linear step shows a third of what it can do; the race gives it three.
TEST(Discover, NamesStiffeningAlthoughAFieldScoresHigher) {
  const Discovery found = test::discover(
      SmallScene({.hidden = "hidden:\n  - {effect: strain_stiffening, values: "
                            "{strain_stiffening.c2: 0.02, strain_stiffening.c3: 0.01}}\n",
                  .told = "0.021"}));
  ASSERT_GE(found.steps.size(), 2u) << found.sentence;
  EXPECT_EQ(found.steps[1].added, "strain_stiffening");
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
}

/// A small weight beside a mesh that is too coarse: on the mesh that has that error, whatever
/// resembles it would be refitted with it.
TEST(Discover, SettlesTheMeshBeforeASmallEffectIsNamed) {
  const Discovery found = test::discover(
      SmallScene({.hidden = "hidden:\n  - {effect: gravity, values: {gravity.x: 300, "
                            "gravity.z: -700}}\n",
                  .told = "0.021",
                  .truth_mesh = "0.5"}));
  ASSERT_EQ(found.steps.size(), 3u) << found.sentence;
  EXPECT_EQ(found.steps[1].added, "mesh_resolution");
  EXPECT_EQ(found.steps[1].rivals.size(), 1u);
  EXPECT_EQ(found.steps[2].added, "gravity");
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
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
  EXPECT_NEAR(test::value_of(last, "camera_pose.cam0 from side on.ry"), 0.004, 4e-4);
  EXPECT_NEAR(test::value_of(last, "camera_pose.cam1.tx"), 0.4, 0.05);
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
  EXPECT_NEAR(test::value_of(last, "exposure.poke.cam1"), 0.09, 0.005);
}

}  // namespace
}  // namespace hookeye
