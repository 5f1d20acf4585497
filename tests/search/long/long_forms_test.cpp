// Whole searches that end in forms which the first refit does not have.
#include <gmock/gmock.h>

#include "estimation/fit/at_floor.h"
#include "estimation/search/discover.h"
#include "tests/search/hiding.h"

namespace hookeye {
namespace {

using test::hiding;
using test::kPressAndTwist;
using testing::ElementsAre;

const char* const kMoreForces =
    "  lift: {force: [0, 0, 0.2]}\n  bend: {force: [-0.01, 0.004, 0.1]}\n  twist: {rotate: 20}\n";

/// The whole search names `effect` alone, in the form `variant`, and comes to the floor.
Fitted found(const std::string& hidden, const std::string& effect, const std::string& variant,
             const char* more = kPressAndTwist) {
  const test::SmallScene small(hiding(hidden, more));
  const Discovery discovery = test::discover(small);
  EXPECT_THAT(discovery.missing, ElementsAre(effect));
  EXPECT_EQ(discovery.verdict, Verdict::explained) << discovery.sentence;
  const Fitted& last = discovery.steps.back().fitted;
  EXPECT_TRUE(at_floor(last, discovery.floor));
  EXPECT_THAT(last.form.ingredients.back()->variant(), testing::StartsWith(variant));
  return last;
}

TEST(Widening, FibresThatOnlyPullAndStiffen) {
  const Fitted fitted = found(
      "{effect: anisotropy, variant: \"free pulling around (0.300, 0.200, 0.933)\", values: "
      "{anisotropy.k: 0.01, anisotropy.k2: 5}}",
      "anisotropy", "free pulling");
  EXPECT_NEAR(fitted.p[1], 0.01, 3e-4);
  EXPECT_NEAR(fitted.p[2], 5.0, 0.5);
}

/// As FEM codes have it: engineering constants, linear between second Piola-Kirchhoff stress and
/// Green strain, where the told law is neo-Hooke's.
TEST(Widening, OrthotropyThatReplacesTheToldLaw) {
  const Fitted fitted = found(
      "{effect: anisotropy, variant: \"free orthotropic, linear in the Green strain, around "
      "(0.300, "
      "0.200, 0.933)\", values: {anisotropy.c11: 0.03, anisotropy.c22: -0.006, anisotropy.c33: "
      "0.004, anisotropy.g12: 0.004, anisotropy.g13: -0.003, anisotropy.linear: 1}}",
      "anisotropy", "free orthotropic, linear in the Green strain");
  EXPECT_NEAR(fitted.p[12], 1.0, 0.1);
}

TEST(Widening, CreepThatLevelsOff) {
  const Fitted fitted = found(
      "{effect: creep, variant: free levelling off of the stiffness, values: {creep.c: 0.6, "
      "creep.tau: 1.2}}",
      "creep", "free levelling off of the stiffness", kMoreForces);
  EXPECT_NEAR(fitted.p[1], 0.6, 0.01);
  EXPECT_NEAR(fitted.p[2], 1.2, 0.05);
}

/// Two loads tell one ratio of stiffnesses: softening, creep that only grows and creep that levels
/// off explain them alike. The held-out photos tell which came nearest, and that with other values
/// it would explain them too.
TEST(Widening, CreepOfTwoLoadsIsNotLeftToSoftening) {
  const test::SmallScene small(
      hiding("{effect: creep, variant: free levelling off of the compliance, values: "
             "{creep.c: 0.2, creep.tau: 1.2}}",
             kPressAndTwist));
  const Discovery discovery = test::discover(small);
  EXPECT_THAT(discovery.missing, ElementsAre("creep"));
  EXPECT_THAT(discovery.steps.back().fitted.form.ingredients.back()->variant(),
              testing::StartsWith("free levelling off"));
  EXPECT_EQ(discovery.verdict, Verdict::explained) << discovery.sentence;
  EXPECT_THAT(discovery.sentence, testing::HasSubstr("creep.tau"));
  ASSERT_TRUE(discovery.all);
  EXPECT_NEAR(discovery.all->fitted.p[1], 0.2, 0.01);
  EXPECT_NEAR(discovery.all->fitted.p[2], 1.2, 0.1);
}

/// Softened before loads whose motion is told: no fitted photo shows it, their forces do, and the
/// held-out photos. Forces know its value less well than photos would: those that are held out are
/// missed by as much as that makes.
TEST(Forces, TellOfASofteningThatNoFittedPhotoShows) {
  const test::SmallScene small(hiding(
      "{effect: softening, variant: from press on, values: {softening.d: 0.12}}", kPressAndTwist));
  const Discovery discovery = test::discover(small);
  EXPECT_THAT(discovery.missing, ElementsAre("softening")) << discovery.sentence;
  const Fitted& last = discovery.steps.back().fitted;
  EXPECT_LT(last.low[1], 0.12);
  EXPECT_GT(last.high[1], 0.12);
  EXPECT_GT(last.low[1], 0.05);
  EXPECT_EQ(discovery.verdict, Verdict::explained) << discovery.sentence;
  if (at_floor(last, discovery.floor)) return;  // as noise has it
  ASSERT_TRUE(discovery.all) << discovery.sentence;
  EXPECT_NEAR(discovery.all->fitted.p[1], 0.12, 0.002);
}

TEST(Widening, SwellingFromOneSide) {
  const Fitted fitted = found(
      "{effect: swelling, variant: free gradient, values: {swelling.s: 0.01, swelling.gx: 0.04, "
      "swelling.gz: -0.03}}",
      "swelling", "free gradient");
  EXPECT_NEAR(fitted.p[2], 0.04, 1e-3);
  EXPECT_NEAR(fitted.p[3], 0.0, 1e-3);
  EXPECT_NEAR(fitted.p[4], -0.03, 1e-3);
}

TEST(Widening, TwoLayers) {
  const Fitted fitted = found(
      "{effect: stiffness_field, variant: \"free layers across (0.300, 0.200, 0.933)\", values: "
      "{stiffness_field.a: 0.9, stiffness_field.offset: 2, stiffness_field.thickness: 0.5}}",
      "stiffness_field", "free layers");
  EXPECT_NEAR(fitted.p[1], 0.9, 0.03);
  EXPECT_NEAR(fitted.p[4], 2.0, 0.2);
}

/// A stiffness that is linear along a direction: its logarithm bends.
TEST(Widening, GradedStiffness) {
  const Fitted fitted = found(
      "{effect: stiffness_field, variant: free gradient, values: {stiffness_field.gx: 0.8, "
      "stiffness_field.gz: 1.2, stiffness_field.bend: -0.5}}",
      "stiffness_field", "free gradient");
  EXPECT_NEAR(fitted.p[1], 0.8, 0.02);
  EXPECT_NEAR(fitted.p[3], 1.2, 0.02);
}

}  // namespace
}  // namespace hookeye
