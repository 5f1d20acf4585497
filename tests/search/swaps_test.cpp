// Effects of earlier steps that a later one shows to be wrong, and ties that it ends.
#include "estimation/search/swaps.h"

#include <gmock/gmock.h>

#include <stdexcept>

#include "estimation/fit/at_floor.h"
#include "estimation/search/last_questions.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

/// The model with these fitted, one after the other, and what was diagnosed before the last.
Step with_effects(Workspace& workspace, const std::vector<std::string>& effects) {
  Step step;
  step.fitted = test::base_fit(workspace);
  for (const std::string& effect : effects) {
    step.diagnosis = diagnose(workspace, step.fitted, test::of_alone({effect})).value();
    const auto score = std::find_if(step.diagnosis.effects.begin(), step.diagnosis.effects.end(),
                                    [&](const EffectScore& one) { return one.effect == effect; });
    if (score == step.diagnosis.effects.end()) throw std::runtime_error("no score of " + effect);
    step.fitted = add_effect(workspace, step.fitted, *score, {}).value();
  }
  return step;
}

/// Creep stands, a camera was knocked too. Of two loads softening is creep's double, but leaves the
/// held-out photos worse: beside the same effects it is asked for once.
TEST(Swaps, ARefusedOneIsNotAskedTwice) {
  const test::SmallScene small(
      {.hidden =
           "hidden:\n  - {effect: camera_pose, variant: cam0 from twist on, values: "
           "{camera_pose.cam0 from twist on.rx: -0.0005, camera_pose.cam0 from twist on.tx: -0.08}}"
           "\n  - {effect: creep, variant: steadily with the order, values: {creep.c: 0.812}}\n",
       .seed = 3});
  Workspace workspace(small.scene);
  const size_t first = base_form(small.scene).ingredients.size();
  const Step step = with_effects(workspace, {"creep", "gravity"});
  RefusedSwaps refused;
  const auto asked = [&] {
    std::vector<std::string> words;
    DiscoverEvents events;
    events.refitting = [&](const std::string& one) { words.push_back(one); };
    swap_for_better(workspace, step.fitted, step.diagnosis.floor, first, refused, {}, events);
    return words;
  };
  EXPECT_THAT(asked(), testing::Contains("softening in place of creep"));
  ASSERT_FALSE(refused.empty());
  EXPECT_THAT(asked(), testing::Not(testing::Contains("softening in place of creep")));
  // Nor where a tie asks for it: what came of it is remembered.
  const auto tie = [&](const RefusedSwaps& known, int* refits) {
    DiscoverEvents events;
    events.refitting = [&](const std::string&) { ++*refits; };
    const auto of = ask_tie_again(workspace, step.fitted, {"creep", "softening"},
                                  step.diagnosis.floor, first, known, {}, events);
    return of.has_value() && of->tie.empty() && !of->better;
  };
  int with = 0, without = 0;
  EXPECT_TRUE(tie(refused, &with));
  EXPECT_TRUE(tie({}, &without));
  EXPECT_EQ(with, 0);
  EXPECT_EQ(without, 1);
}

/// Swelling beside the weight that is all there is: its interval holds its null, and the photos do
/// without it.
TEST(Swaps, WhatIsNotSupportedLeaves) {
  const test::SmallScene small(
      {.hidden = "hidden:\n  - {effect: gravity, values: {gravity.x: 4000, gravity.z: -9000}}\n"});
  Workspace workspace(small.scene);
  const size_t first = base_form(small.scene).ingredients.size();
  const Step step = with_effects(workspace, {"gravity", "swelling"});
  ASSERT_THAT(effects_in(step.fitted.form), testing::ElementsAre("gravity", "swelling"));
  const Floor floor = step.diagnosis.floor;
  const auto lighter = drop_unsupported(workspace, step.fitted, floor, first, {});
  ASSERT_TRUE(lighter.has_value());
  EXPECT_EQ(lighter->effect, "swelling");
  EXPECT_THAT(effects_in(lighter->fitted.form), testing::ElementsAre("gravity"));
  // nor would it have been named
  Step weight;
  weight.fitted = lighter->fitted;
  weight.diagnosis = step.diagnosis;
  Refit named{"swelling", step.fitted, 0.0};
  EXPECT_EQ(refused_by(weight, named).why, Refusal::Why::may_be_nothing);
  named.fitted.low = named.fitted.high = named.fitted.p;
  EXPECT_NE(refused_by(weight, named).why, Refusal::Why::may_be_nothing);
  // nothing leaves that is alone, nor what the photos need
  EXPECT_FALSE(drop_unsupported(workspace, lighter->fitted, floor, first, {}).has_value());
  // what cannot be asked is no tie
  const std::atomic<bool> cancel{true};
  DiscoverOptions stopped;
  stopped.fit.cancel = stopped.diagnosis.cancel = &cancel;
  const auto asked =
      ask_tie_again(workspace, step.fitted, {"gravity", "pressure"}, floor, first, {}, stopped, {});
  EXPECT_FALSE(asked.has_value());
  Fitted wide = step.fitted;
  wide.low.setConstant(-1e9), wide.high.setConstant(1e9);
  EXPECT_EQ(drop_unsupported(workspace, wide, floor, first, {})->effect, "swelling");
}

/// Who stands out beside the model may be kept from being added by what the mesh may err by. In the
/// place of the name that stands for it nobody says that it is small.
TEST(Swaps, WhoStandsOutBesideANameIsAskedForInItsPlace) {
  const test::SmallScene small(
      {.hidden = "hidden:\n  - {effect: gravity, values: {gravity.x: 4000, gravity.z: -9000}}\n"});
  Workspace workspace(small.scene);
  const size_t first = base_form(small.scene).ingredients.size();
  Step base = with_effects(workspace, {}), wrong = with_effects(workspace, {"pressure"});
  wrong.added = "pressure";
  wrong.diagnosis = diagnose(workspace, wrong.fitted).value();
  const Floor floor = wrong.diagnosis.floor;
  AskedAgain asked;
  const auto again = [&](const Step& last) {
    return contests_again(workspace, {base, last}, first, asked, {}, {}, {});
  };
  const TieAsked found = again(wrong);
  ASSERT_TRUE(found.better.has_value());
  EXPECT_EQ(found.better->out, "pressure");
  EXPECT_THAT(effects_in(found.better->in.fitted.form), testing::ElementsAre("gravity"));
  EXPECT_TRUE(at_floor(found.better->in.fitted, floor));
  // each once; who was refitted in the contest of the newest name has lost it; and at the floor
  // nobody is asked
  EXPECT_FALSE(again(wrong).better.has_value());
  asked.clear();
  Step lost = wrong;
  for (const EffectScore& score : lost.diagnosis.effects) lost.rivals.push_back({score.effect});
  EXPECT_FALSE(again(lost).better.has_value());
  wrong.diagnosis.floor.chi = 100.0;
  EXPECT_FALSE(again(wrong).better.has_value());
  EXPECT_TRUE(asked.empty());
}

}  // namespace
}  // namespace hookeye
