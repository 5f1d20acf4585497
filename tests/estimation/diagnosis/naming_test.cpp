// What a diagnosis names: what leads, what ties with it, what is too little.
#include <gmock/gmock.h>

#include "estimation/diagnosis/diagnosis.h"
#include "estimation/search/mesh_first.h"
#include "estimation/search/verdict.h"

namespace hookeye {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

EffectScore scored(const std::string& effect, double evidence, double bic = 0.0) {
  EffectScore out;
  out.effect = effect;
  out.evidence = evidence;
  out.bic = bic;
  out.fall = 10.0;
  return out;
}

/// Scores by falling evidence, the gate of chance at 8.
Diagnosis of(std::vector<EffectScore> scores) {
  Diagnosis out;
  out.gate = 8.0;
  out.effects = std::move(scores);
  return out;
}

TEST(Naming, ChanceIsNotNamed) {
  EXPECT_THAT(leaders(of({scored("gravity", 7.9)})), IsEmpty());
  EXPECT_THAT(leaders(of({scored("gravity", 8.1)})), ElementsAre("gravity"));
  Diagnosis quiet = of({scored("gravity", 4.9)});
  quiet.gate = 1.0;  // chance reaches less, but less than nameable is not named either
  EXPECT_THAT(leaders(quiet), IsEmpty());
  EXPECT_EQ(conclusion(quiet), "nothing of the catalogue stands out");
}

TEST(Naming, WhatCannotBeTestedIsNotNamed) {
  EffectScore blind = scored("soft_clamp", 50.0);
  blind.testable = false;
  EXPECT_THAT(leaders(of({blind})), IsEmpty());
}

TEST(Naming, TiesAreDeclared) {
  const Diagnosis tie =
      of({scored("gravity", 50.0), scored("swelling", 50.0 - Limits{}.diagnosis.tie + 0.1),
          scored("pressure", 40.0)});
  EXPECT_THAT(leaders(tie), ElementsAre("gravity", "swelling"));
  EXPECT_THAT(conclusion(tie), testing::StartsWith("gravity stands out as missing, and swelling "
                                                   "cannot be told from it"));
  EXPECT_EQ(conclusion(of({scored("mesh_resolution", 90.0), scored("gravity", 58.0)})),
            "a finer mesh comes before any other effect (mesh_resolution)");
  // The information criterion of its best form puts one before the leader.
  EXPECT_THAT(leaders(of({scored("gravity", 50.0, 40.0), scored("pressure", 40.0, 41.0)})),
              ElementsAre("gravity", "pressure"));
}

TEST(Naming, NobodyWhoLeadsIsRefusedUnfitted) {
  // Physical effects among themselves: the mesh leads nobody, and chance leads nothing.
  const Diagnosis found =
      of({scored("mesh_resolution", 90.0), scored("stiffness_field", 60.0), scored("gravity", 58.0),
          scored("swelling", 50.0), scored("creep", 7.0)});
  std::vector<std::string> leading;
  for (const EffectScore& score : found.effects)
    if (leads(found, score)) leading.push_back(score.effect);
  EXPECT_THAT(leading, ElementsAre("stiffness_field", "gravity"));
  const Diagnosis quiet = of({scored("creep", 7.0)});
  EXPECT_FALSE(leads(quiet, quiet.effects[0]));
}

/// Why each effect is or is not named, with the number that it was held against.
TEST(Naming, EveryEffectHasADecision) {
  EffectScore blind = scored("soft_clamp", 50.0);
  blind.testable = false;
  blind.why_not = "untestable";
  const auto decisions =
      naming_decisions(of({scored("gravity", 60.0), blind, scored("creep", 7.0)}));
  ASSERT_EQ(decisions.size(), 3u);
  EXPECT_TRUE(decisions[0].accepted);
  EXPECT_EQ(decisions[0].by.option, "diagnosis.gate");
  EXPECT_EQ(decisions[1].why, "untestable");
  EXPECT_FALSE(decisions[2].accepted);
  EXPECT_EQ(decisions[2].by.value, 7.0);
  EXPECT_EQ(decisions[2].by.limit, 8.0);
  EXPECT_THAT(decisions[2].where, testing::StartsWith("estimation/diagnosis/naming.cpp:"));
}

TEST(Naming, TheMeshMayBeAllWhereItExplainsMoreThanHalf) {
  EffectScore mesh = scored("mesh_resolution", 50.0), weight = scored("gravity", 60.0);
  mesh.explains = 0.6, weight.explains = 0.9;
  EXPECT_TRUE(may_be_all("mesh_resolution", of({weight, mesh})));
  EXPECT_FALSE(may_be_all("gravity", of({weight, mesh}))) << "no error of the computation";
  mesh.explains = 0.4;
  EXPECT_FALSE(may_be_all("mesh_resolution", of({weight, mesh})));
  EXPECT_FALSE(may_be_all("mesh_resolution", of({weight})));
}

TEST(Naming, TheMeshTiesWithNobody) {
  EXPECT_THAT(leaders(of({scored("gravity", 50.0), scored("mesh_resolution", 49.0)})),
              ElementsAre("gravity"));
  EXPECT_THAT(leaders(of({scored("mesh_resolution", 50.0), scored("gravity", 49.0)})),
              ElementsAre("mesh_resolution"));
}

TEST(Naming, WhatRenderersErrByIsNotNamed) {
  Diagnosis found = of({scored("gravity", 50.0)});
  found.effects[0].fall = 0.9;
  found.floor.chi = std::sqrt(10.0 + 1.0);  // a tenth of what the rest photos keep over their noise
  EXPECT_NEAR(least_fall(found, "gravity"), 1.0, 1e-12);
  EXPECT_THAT(leaders(found), IsEmpty());
  found.effects[0].fall = 1.1;
  EXPECT_THAT(leaders(found), ElementsAre("gravity"));
}

TEST(Naming, WhatSensorsSpeakForIsNamedThoughNoPhotoMoves) {
  Diagnosis found = of({scored("softening", 50.0)});
  found.effects[0].fall = 0.0, found.floor.chi = 2.0;
  found.effects[0].measured_fall = 2.0 * Limits{}.diagnosis.nameable - 0.1;
  EXPECT_THAT(leaders(found), IsEmpty());
  found.effects[0].measured_fall = 2.0 * Limits{}.diagnosis.nameable + 0.1;
  EXPECT_THAT(leaders(found), ElementsAre("softening"));
  found.mesh_in_measured = 1.0;  // a finer mesh would change as much as they scatter
  EXPECT_THAT(leaders(found), IsEmpty());
}

/// Above the gate by chance once in twenty times; by chance held-out photos do not say the same.
TEST(Naming, WhatHeldOutPhotosAloneShowIsNamedByThem) {
  EffectScore faint = scored("softening", 4.0);
  faint.explains_held_out = 0.6;
  Diagnosis left = of({faint});
  left.gate = 3.0;
  EXPECT_THAT(leaders(left), IsEmpty()) << "fitted and held-out photos are missed, or neither";
  left.held_out_missed = true;
  EXPECT_THAT(leaders(left), ElementsAre("softening"));
  left.gate = 4.5;
  EXPECT_THAT(leaders(left), IsEmpty());
  left.gate = 3.0, left.effects[0].explains_held_out = 0.4;
  EXPECT_THAT(leaders(left), IsEmpty());
  faint.effect = "mesh_resolution", left.effects[0] = faint;
  EXPECT_THAT(leaders(left), IsEmpty());
}

/// What the next finer mesh would change in fitted photos hides an effect, unless held-out photos
/// show it by more than it would change there.
TEST(Naming, WhatTheMeshHidesIsNamedByHeldOutPhotos) {
  EffectScore creep = scored("creep", 800.0);
  creep.fall = 0.7, creep.mesh_fall = 0.8;
  creep.explains_held_out = 0.9, creep.fall_held_out = 30.0;
  Diagnosis left = of({creep});
  left.gate = 3.0, left.mesh_fall_held_out = 10.0;
  EXPECT_THAT(leaders(left), IsEmpty()) << "held-out photos are at the floor";
  left.held_out_over = true;
  EXPECT_THAT(leaders(left), ElementsAre("creep"));
  left.mesh_fall_held_out = 31.0;
  EXPECT_THAT(leaders(left), IsEmpty());
  left.mesh_fall_held_out = 10.0, left.effects[0].evidence = Limits{}.diagnosis.nameable - 0.1;
  EXPECT_THAT(leaders(left), IsEmpty());
  left.effects[0].evidence = 800.0, left.effects[0].explains_held_out = 0.5;
  EXPECT_THAT(leaders(left), IsEmpty()) << "not more than half";
}

/// Told as a hint alone, and only where photos that no score has seen speak for it.
TEST(Naming, WhatIsTooLittleToBeNamedIsAHint) {
  EffectScore small = scored("strain_stiffening", 50.0);
  small.fall = 0.1, small.explains = 0.3, small.explains_held_out = 0.6;
  Diagnosis left = of({small});
  left.floor.chi = 2.0;  // renderers err by 0.3
  EXPECT_THAT(leaders(left), IsEmpty());
  EXPECT_THAT(too_little_to_name(left), testing::HasSubstr("strain_stiffening would remove 30 %"));
  left.effects[0].explains_held_out = 0.4;
  EXPECT_EQ(too_little_to_name(left), "");
  left.effects[0] = small, left.effects[0].evidence = 7.0;
  EXPECT_EQ(too_little_to_name(left), "");
  left.effects[0] = small, left.effects[0].fall = 1.0;
  EXPECT_EQ(too_little_to_name(left), "");
}

}  // namespace
}  // namespace hookeye
