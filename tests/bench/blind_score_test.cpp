// What the blind benchmark counts, on runs that are told here.
#include <gmock/gmock.h>

#include "bench/blind/draw.h"
#include "bench/blind/score.h"
#include "estimation/synth/recipe.h"

namespace hookeye::blind {
namespace {

using nlohmann::json;
using testing::HasSubstr;

json truth_of(const std::string& effect, const json& values) {
  json truth = {{"material", {{"mu", {0.05}}, {"kappa_over_mu", {10.0}}}},
                {"hidden", json::array()}};
  if (effect != "none")
    truth["hidden"].push_back({{"effect", effect}, {"rms_px", 2.0}, {"values", values}});
  return truth;
}

json value_of(const std::string& name, const std::string& unit, double value, double half) {
  return {{"name", name},
          {"unit", unit},
          {"value", value},
          {"low", value - half},
          {"high", value + half}};
}

json run_of(const std::vector<std::string>& added, const json& parameters) {
  return {{"verdict", "explained"},
          {"floor", {{"chi", 1.0}}},
          {"missing", added},
          {"steps",
           {{{"chi_fit", 20.0}, {"chi_validate", 21.0}},
            {{"chi_fit", 1.1}, {"chi_validate", 1.2}, {"parameters", parameters}}}}};
}

const json kGravity = {{"gravity.x", 0.0}, {"gravity.y", 1000.0}, {"gravity.z", -2000.0}};
const json kFound = {value_of("mu", "MPa", 0.051, 0.002), value_of("gravity.x", "mm/s2", 30, 10),
                     value_of("gravity.y", "mm/s2", 1010, 20),
                     value_of("gravity.z", "mm/s2", -2000, 20)};

TEST(BlindScore, RightNameAndTheErrorsOfItsValues) {
  const Score s =
      score(run_of({"gravity", "mesh_resolution"}, kFound), truth_of("gravity", kGravity));
  EXPECT_EQ(s.first, "gravity");
  EXPECT_TRUE(s.right_first());
  EXPECT_TRUE(s.exact_set()) << "a finer mesh is no wrong name";
  EXPECT_NEAR(s.material_error.value(), 0.02, 1e-12);
  EXPECT_NEAR(s.effect_error.value(), 30.0 / 2000.0, 1e-12);
  EXPECT_EQ(s.values, 4);
  EXPECT_EQ(s.inside, 3) << "gravity.x: 0 lies outside 20 .. 40";
  EXPECT_EQ(s.held_before, 21.0);
  EXPECT_EQ(s.held_after, 1.2);
  EXPECT_THAT(summary({s}), HasSubstr("right name first      1 of 1"));
  EXPECT_THAT(summary({s}), HasSubstr("inside their 95 % intervals: 3 of 4"));
}

TEST(BlindScore, TheTableHasARowForEachEffect) {
  const Score right = score(run_of({"gravity"}, kFound), truth_of("gravity", kGravity));
  const Score wrong = score(run_of({"swelling"}, kFound), truth_of("gravity", kGravity));
  const Score none = score(run_of({}, kFound), truth_of("none", {}));
  const std::string rows = table({right, wrong, none});
  EXPECT_THAT(rows, HasSubstr("| gravity | 2 .. 2 px | 1 of 2 | 1 of 2 | 21.0 | 1.20 |\n"));
  EXPECT_THAT(rows, HasSubstr("| none | – | 1 of 1 | 1 of 1 | 21.0 | 1.20 |\n"));
  EXPECT_THAT(summary({right, wrong}),
              HasSubstr("held-out chi within 1.15 times the floor: 0 of 1"));
}

TEST(BlindScore, OtherVariantsHaveNoErrors) {
  json found = kFound;
  found.erase(3);
  const Score s = score(run_of({"gravity"}, found), truth_of("gravity", kGravity));
  EXPECT_FALSE(s.effect_error);
  EXPECT_TRUE(s.material_error);
  EXPECT_EQ(s.values, 1);
}

TEST(BlindScore, AnOpenEndHoldsEverything) {
  json found = kFound;
  found[1]["low"] = nullptr;
  EXPECT_EQ(score(run_of({"gravity"}, found), truth_of("gravity", kGravity)).inside, 4);
}

TEST(BlindScore, AWrongNameIsNotRightAndItsValuesDoNotCount) {
  const Score s = score(run_of({"swelling"}, kFound), truth_of("gravity", kGravity));
  EXPECT_FALSE(s.right_first());
  EXPECT_FALSE(s.right_or_tie());
  EXPECT_FALSE(s.exact_set());
  EXPECT_THAT(summary({s}), testing::Not(HasSubstr("intervals")));
}

TEST(BlindScore, ADeclaredTieCounts) {
  json run = run_of({"swelling"}, kFound);
  run["tie"] = {"gravity", "swelling"};
  const Score s = score(run, truth_of("gravity", kGravity));
  EXPECT_FALSE(s.right_first());
  EXPECT_TRUE(s.right_or_tie());
}

TEST(BlindScore, NothingHidden) {
  const json parameters = {value_of("mu", "MPa", 0.05, 0.001)};
  const Score quiet = score(run_of({"mesh_resolution"}, parameters), truth_of("none", {}));
  EXPECT_EQ(quiet.first, "none");
  EXPECT_TRUE(quiet.right_first());
  EXPECT_TRUE(quiet.exact_set());
  const Score alarm = score(run_of({"creep"}, parameters), truth_of("none", {}));
  EXPECT_FALSE(alarm.right_first());
  EXPECT_THAT(summary({quiet, alarm}), HasSubstr("false alarms          1 of 2"));
}

TEST(BlindScore, PairsWantBoth) {
  json truth = truth_of("gravity", kGravity);
  truth["hidden"].push_back({{"effect", "creep"}, {"rms_px", 1.0}, {"values", json::object()}});
  const Score one = score(run_of({"gravity"}, kFound), truth);
  EXPECT_EQ(one.hidden, "gravity+creep");
  EXPECT_TRUE(one.right_first());
  EXPECT_FALSE(one.exact_set());
  EXPECT_TRUE(score(run_of({"creep", "gravity"}, kFound), truth).exact_set());
}

TEST(BlindScore, LeftOutOfTheCatalogueNoNameMayExplainIt) {
  Score s = score(run_of({"creep"}, kFound), truth_of("gravity", kGravity));
  EXPECT_FALSE(s.explained_by_another()) << "gravity could have been named";
  s.left_out = true;
  EXPECT_FALSE(s.right_first());
  EXPECT_TRUE(s.explained_by_another());
  s.verdict = "unexplained";
  EXPECT_TRUE(s.right_first());
  EXPECT_FALSE(s.explained_by_another());
}

TEST(BlindScore, LeftOutADoubleIsWhatAWholeCatalogueFindsNothingBeside) {
  const json diagnosis = {{"effects",
                           {{{"effect", "gravity"}, {"named", true}},
                            {{"effect", "swelling"}, {"named", true}},
                            {{"effect", "creep"}, {"named", false}}}}};
  EXPECT_THAT(named_beside(diagnosis, {"gravity", "creep"}), testing::ElementsAre("gravity"));
  Score s = score(run_of({"creep"}, kFound), truth_of("gravity", kGravity));
  s.left_out = true;
  EXPECT_FALSE(s.explained_by_double()) << "nobody asked";
  EXPECT_THAT(csv({s}), testing::EndsWith(",1,?\n"));
  s.missed = named_beside(diagnosis, {"gravity"});
  EXPECT_FALSE(s.explained_by_double()) << "the weight is still seen";
  EXPECT_THAT(csv({s}), testing::EndsWith(",1,gravity\n"));
  EXPECT_THAT(summary({s}),
              HasSubstr("explained by another      1; to the photos it is the same: 0"));
  s.missed = named_beside(diagnosis, {"creep"});
  EXPECT_TRUE(s.explained_by_double());
  EXPECT_FALSE(s.right_first()) << "a wrong name all the same";
  EXPECT_THAT(summary({s}), HasSubstr("no other name explains 0 of 1"));
  EXPECT_THAT(summary({s}),
              HasSubstr("explained by another      1; to the photos it is the same: 1"));
}

TEST(BlindScore, FailedRunsAreCountedApart) {
  Score failed;
  failed.hidden = "gravity", failed.status = "discover 3";
  EXPECT_THAT(summary({failed}), HasSubstr("right name first      0 of 0"));
  EXPECT_THAT(summary({failed}), HasSubstr("failed                1"));
  EXPECT_THAT(csv({failed}), HasSubstr("gravity,0,discover 3"));
}

TEST(BlindDraw, IsGivenByTheSeed) {
  EXPECT_EQ(draw_recipe("gravity", 7, {}), draw_recipe("gravity", 7, {}));
  EXPECT_NE(draw_recipe("gravity", 7, {}), draw_recipe("gravity", 8, {}));
  Drawing tenth;
  tenth.size = 0.1;
  EXPECT_THAT(draw_recipe("gravity+creep", 7, tenth), HasSubstr("effect: creep, rms_px: 0."));
  EXPECT_THAT(effects_of("none"), testing::IsEmpty());
}

/// Small captures are of the same bodies, rigs and loads.
TEST(BlindDraw, SmallOrNotTheDiceFallAlike) {
  Drawing drawing;
  const Recipe large = parse_recipe(draw_recipe("pressure+creep", 7, drawing), "large");
  drawing.small = true;
  const Recipe small = parse_recipe(draw_recipe("pressure+creep", 7, drawing), "small");
  EXPECT_EQ(small.shape.size, large.shape.size);
  EXPECT_EQ(small.cameras.azimuth, large.cameras.azimuth);
  EXPECT_LT(small.examples.size(), large.examples.size());
  ASSERT_EQ(small.hidden.size(), 2u);
  EXPECT_EQ(small.hidden[1].rms_px, large.hidden[1].rms_px);
}

}  // namespace
}  // namespace hookeye::blind
