// What a verdict asks for, and how it is told.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <utility>

#include "estimation/effects/catalogue.h"
#include "estimation/effects/toolbox.h"
#include "estimation/effects_scene.h"
#include "estimation/fit/at_floor.h"
#include "estimation/search/contest.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

using test::SmallScene;

/// One fitted photo of 100 pixels.
Fitted with_one_photo(double r2) {
  Fitted fitted;
  fitted.evaluation.examples.resize(1);
  fitted.evaluation.examples[0].photos.resize(1);
  PhotoEvaluation& photo = fitted.evaluation.examples[0].photos[0];
  photo.count = 100.0, photo.r2 = r2;
  return fitted;
}

/// What is smaller than the mesh's own error is not named, but the user hears what would show it.
TEST(Verdict, SaysWhatOnlyAFinerMeshWouldShow) {
  Fitted fitted = with_one_photo(200.0);
  Diagnosis diagnosis;
  diagnosis.effects.resize(1);
  EffectScore& weight = diagnosis.effects[0];
  weight.effect = "gravity", weight.evidence = 50.0, weight.fall = 0.2;
  weight.mesh_fall = diagnosis.mesh_fall = 0.4;
  std::string why;
  EXPECT_EQ(judge(fitted, diagnosis, {}, &why), Verdict::unexplained);
  EXPECT_THAT(why, testing::HasSubstr("gravity stands out by less than a mesh finer still"));
  weight.fall = 0.6;
  judge(fitted, diagnosis, {}, &why);
  EXPECT_THAT(why, testing::HasSubstr("and gravity still stands out"));
  weight.fall = 0.2, fitted.evaluation.examples[0].photos[0].r2 = 110.0;
  EXPECT_EQ(judge(fitted, diagnosis, {}, &why), Verdict::explained);
  EXPECT_THAT(why, testing::EndsWith("the noise floor"));
  fitted.evaluation.examples[0].photos[0].r2 = 140.0;
  EXPECT_EQ(judge(fitted, diagnosis, {}, &why), Verdict::explained);
  EXPECT_THAT(why, testing::EndsWith("over 1.1: what the mesh or the renderer may err by, or "
                                     "something small that is not named"));
}

/// The base model with a ball of this amplitude.
struct WithBall {
  explicit WithBall(double amplitude) {
    const auto ball = find_effect("stiffness_field")->candidate(test::base_model(), "free ball");
    fitted.form = test::extended(test::base(), ball);
    VectorXd values = test::some_values(*ball);
    values[0] = amplitude;
    first = fitted.form.size() - values.size();
    fitted.p = test::with_values(fitted.form, values);
  }
  Fitted fitted;
  Eigen::Index first = 0;  ///< of the ball's values
};

/// What a bound gave is no measurement.
TEST(Verdict, AValueAtTheEndOfWhatIsTriedIsToldAsThat) {
  const auto said = [](double amplitude) {
    return effects_in_words(WithBall(amplitude).fitted).at(0);
  };
  EXPECT_THAT(said(3.9), testing::Not(testing::HasSubstr("ended at")));
  EXPECT_THAT(said(4.0),
              testing::HasSubstr("; the log of the stiffness factor ended at the largest "
                                 "that is tried, 4: how large it is, is not known"));
}

/// The ranges of a place, and what its photos do not know of it.
TEST(Verdict, APlaceIsToldWithItsRanges) {
  auto [fitted, a] = WithBall(std::log(2.0));
  EXPECT_THAT(effects_in_words(fitted).at(0), testing::Not(testing::HasSubstr("ranges")));
  fitted.low = fitted.high = fitted.p;
  fitted.low[a] = std::log(1.5), fitted.high[a] = std::log(3.0);
  EXPECT_THAT(effects_in_words(fitted).at(0),
              testing::AllOf(testing::HasSubstr("a ball 2 (1.5 to 3) times as stiff"),
                             testing::Not(testing::HasSubstr("somewhere"))));
  fitted.low[a + 1] = -1e3, fitted.high[a + 1] = 1e3;
  EXPECT_THAT(effects_in_words(fitted).at(0), testing::HasSubstr("around (somewhere along x, "));
}

/// A small effect near the floor: what stays and has no name must not be more than what it took.
TEST(Verdict, ANameThatTakesLessThanWhatStaysIsNotEnough) {
  Fitted fitted;
  fitted.evaluation.examples.resize(2);
  const auto leave = [&](double fit, double held_out) {
    for (auto& example : fitted.evaluation.examples) {
      example.held_out = &example == &fitted.evaluation.examples[1];
      example.photos.resize(1);
      example.photos[0].count = 100.0;
      example.photos[0].r2 = 100.0 * (example.held_out ? held_out : fit);
    }
  };
  Diagnosis diagnosis;
  leave(1.3, 1.3);
  EXPECT_THAT(more_stays(fitted, diagnosis, {0.2, 0.1}),
              testing::HasSubstr("more than what was named has taken"));
  EXPECT_EQ(more_stays(fitted, diagnosis, {0.35, 0.1}), "") << "of the fitted photos it took more";
  EXPECT_EQ(more_stays(fitted, diagnosis, {0.2, 0.35}), "") << "of the held-out ones";
  EXPECT_EQ(more_stays(fitted, diagnosis, {0.0, 0.0}), "") << "nothing was named";
  EXPECT_EQ(more_stays(fitted, diagnosis, {0.2, 0.1, 50.0}), "") << "sensors speak for it";
  leave(1.2, 1.2);
  EXPECT_EQ(more_stays(fitted, diagnosis, {0.1, 0.1}), "") << "as little as renderers leave";
  leave(1.3, 1.3);
  diagnosis.effects.resize(1);
  EffectScore& mesh = diagnosis.effects[0];
  mesh.effect = "mesh_resolution", mesh.evidence = 50.0, mesh.fall = 0.2, mesh.testable = true;
  EXPECT_THAT(more_stays(fitted, diagnosis, {0.2, 0.1}),
              testing::HasSubstr("A finer mesh would tell"));
}

/// A gloss is in the rest photos' floor too: a lamp that is named in its place may be part of it.
TEST(Verdict, BrightnessMustTakeMoreThanStaysOverTheToldNoise) {
  Fitted fitted = with_one_photo(410.0);
  PhotoEvaluation& photo = fitted.evaluation.examples[0].photos[0];
  Diagnosis diagnosis;
  diagnosis.floor.chi = 2.0;
  IngredientSpec lamp;
  lamp.name = "light_direction", lamp.touches.photos = true;
  lamp.apply = [](const VectorXd&, Model&) {};
  IngredientSpec weight = lamp;
  weight.name = "gravity", weight.touches = {}, weight.touches.loading = true;
  fitted.form.ingredients = {make_ingredient(lamp)};
  EXPECT_THAT(more_stays(fitted, diagnosis, {2.9}),
              testing::HasSubstr("less than what stays over the told noise (2.00 times it in the"));
  EXPECT_EQ(more_stays(fitted, diagnosis, {3.2}), "");
  fitted.form.ingredients.push_back(make_ingredient(weight));
  EXPECT_EQ(more_stays(fitted, diagnosis, {2.9}), "") << "the body moves, the floor does not";
  fitted.form.ingredients.pop_back();
  diagnosis.floor.chi = 1.05, photo.r2 = 120.0;
  EXPECT_EQ(more_stays(fitted, diagnosis, {0.1}), "") << "as little as renderers leave";
}

TEST(Verdict, WhatAFinerMeshTakesNoNameHasTaken) {
  Floor floor;
  floor.chi = 2.0;
  std::vector<Contested> steps(4);
  const auto left = [&](int step, const char* added, double chi_fit, double chi_validate) {
    steps[step].added = added;
    steps[step].chi_fit = chi_fit, steps[step].chi_validate = chi_validate;
  };
  left(0, "", 5.0, 4.0), steps[0].measured_r2 = 9.0;
  left(1, "mesh_resolution", 4.0, 3.5), steps[1].measured_r2 = 8.0;
  left(2, "gravity", 3.0, 3.0), steps[2].measured_r2 = 5.0;
  left(3, "exposure", 1.5, 2.5), steps[3].measured_r2 = 6.0;
  const TakenByNames taken = taken_by_names(steps, floor);
  EXPECT_DOUBLE_EQ(taken.fit, 12.0) << "down to the floor's 4 of 16";
  EXPECT_DOUBLE_EQ(taken.held_out, 6.0);
  EXPECT_DOUBLE_EQ(taken.measured, 2.0);
  steps.push_back(steps[2]);  // exposure taken back
  steps.back().added = "", steps.back().dropped = {"exposure"};
  EXPECT_DOUBLE_EQ(taken_by_names(steps, floor).fit, 7.0);
}

/// Two that leave as much are a choice where that is little, and no answer where it is much.
TEST(Verdict, WhoLedAndCouldNotBeFittedIsToldUnlessItStands) {
  Contested first, second;
  first.added = "swelling", first.not_compared = {"stiffness_field", "creep"};
  second.added = "creep", second.not_compared = {"stiffness_field"};
  EXPECT_EQ(not_compared({first, second}, {"swelling", "creep"}),
            "; not compared: stiffness_field, which stood out as much and could not be fitted");
  EXPECT_EQ(not_compared({first, second}, {"stiffness_field", "creep"}), "");
}

TEST(Verdict, ATieIsAmbiguousOnlyAtTheFloor) {
  Fitted fitted = with_one_photo(110.0);
  PhotoEvaluation& photo = fitted.evaluation.examples[0].photos[0];
  const Diagnosis nothing_stands_out;
  const std::vector<std::string> tie = {"creep", "softening"};
  EXPECT_EQ(judge(fitted, nothing_stands_out, tie, nullptr), Verdict::ambiguous);
  photo.r2 = 8000.0;
  EXPECT_EQ(judge(fitted, nothing_stands_out, tie, nullptr), Verdict::unexplained);
}

TEST(Verdict, TheSentenceSaysWhatIsMissingAndOnWhichMesh) {
  EXPECT_EQ(say(Verdict::explained, {"gravity", "creep"}, {}, "little is left", ""),
            "missing: gravity and creep; with them, little is left");
  EXPECT_EQ(say(Verdict::explained, {"gravity", "mesh_resolution"}, {}, "little is left", ""),
            "missing: gravity; with it on a finer mesh (mesh_resolution), little is left");
  EXPECT_EQ(say(Verdict::explained, {"mesh_resolution"}, {}, "little is left", ""),
            "nothing is missing but a finer mesh (mesh_resolution): on it, little is left");
  EXPECT_EQ(say(Verdict::explained, {}, {}, "little is left", ""),
            "nothing is missing: little is left");
  EXPECT_EQ(
      say(Verdict::explained, {}, {}, "little is left", "creep was refused"),
      "nothing that is missing pays for itself: little is left; nothing more was added: creep "
      "was refused");
  EXPECT_EQ(say(Verdict::unexplained, {}, {}, "much is left", ""),
            "not in the catalogue: much is left");
  EXPECT_EQ(say(Verdict::unexplained, {"gravity"}, {}, "much is left", ""),
            "named, but not enough: gravity; with it, much is left");
  EXPECT_EQ(say(Verdict::unexplained, {"mesh_resolution"}, {}, "much is left", "creep was refused"),
            "nothing that was tried explains it: even on a finer mesh (mesh_resolution), much is "
            "left; nothing more was added: creep was refused");
  EXPECT_EQ(
      say(Verdict::ambiguous, {"gravity", "creep"}, {"creep", "softening"}, "little is left", ""),
      "missing: gravity and either creep or softening (these photos cannot tell which); with them, "
      "little is left");
  EXPECT_EQ(
      say(Verdict::ambiguous, {"creep"}, {"creep", "softening"}, "little is left", ""),
      "missing: either creep or softening (these photos cannot tell which); with it, little is "
      "left");
}

/// Many would explain what is left and none has the evidence: that is no word about the catalogue.
TEST(Verdict, SaysWherePhotosCannotTell) {
  Diagnosis diagnosis;
  diagnosis.effects.resize(3);
  const char* const names[] = {"stiffness_field", "pressure", "creep"};
  for (int i = 0; i < 3; ++i) {
    EffectScore& score = diagnosis.effects[i];
    score.effect = names[i], score.evidence = 3.0 - i, score.explains = 0.3;
  }
  diagnosis.gate = 1.5;
  EXPECT_THAT(cannot_be_told(diagnosis), testing::ElementsAre("stiffness_field", "pressure"));
  EXPECT_EQ(
      say(Verdict::unexplained, {}, {}, "much is left", "", cannot_be_told(diagnosis)),
      "not told by these photos: much is left; stiffness_field or pressure stand out by more than "
      "chance, but these photos hold too little to tell");
  EXPECT_EQ(any_of_them({"a", "b", "c", "d"}), "a, b, c or d");
  EXPECT_EQ(any_of_them({"a", "b", "c", "d", "e"}), "a, b, c or 2 other effects");
  diagnosis.effects[0].evidence = 50.0;
  EXPECT_THAT(cannot_be_told(diagnosis), testing::ElementsAre("pressure"));
  diagnosis.effects[1].explains = 0.03;
  EXPECT_THAT(cannot_be_told(diagnosis), testing::IsEmpty()) << "nearly all of it is another's";
}

/// The told model of a capture that hides nothing, nothing diagnosed.
std::pair<Fitted, Diagnosis> at_its_floor(const SmallScene& small) {
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  Fitted fitted = assess(workspace, form, form.initial()).value();
  Diagnosis diagnosis;
  diagnosis.floor = measure_floor(*small.scene, fitted.evaluation);
  return {std::move(fitted), std::move(diagnosis)};
}

TEST(Verdict, WhatMovesABodyThatNothingMovesIsNotExplained) {
  Fitted fitted = with_one_photo(140.0);
  PhotoEvaluation& photo = fitted.evaluation.examples[0].photos[0];
  Diagnosis diagnosis;
  diagnosis.floor.per_px2 = 100.0;
  EXPECT_EQ(moved_at_rest(fitted, diagnosis), "");
  diagnosis.floor.moved_at_rest = {{"left", 0.005}, {"right", 0.1}};
  EXPECT_THAT(moved_at_rest(fitted, diagnosis),
              testing::HasSubstr("'right' still show the body moved, by 0.032 px"));
  diagnosis.floor.moved_at_rest["right"] = 0.03;
  EXPECT_EQ(moved_at_rest(fitted, diagnosis), "") << "of the 0.4 that stay little";
  diagnosis.floor.moved_at_rest["right"] = 0.1;
  photo.r2 = 120.0;
  EXPECT_EQ(moved_at_rest(fitted, diagnosis), "") << "as little as renderers leave";
  photo.r2 = 160.0, diagnosis.floor.chi = 1.06;
  EXPECT_EQ(moved_at_rest(fitted, diagnosis), "") << "the renderer leaves 0.12";
  diagnosis.floor.chi = 1.0, photo.r2 = 140.0;
  diagnosis.floor.moved_at_rest["right"] = 0.005;
  EXPECT_EQ(moved_at_rest(fitted, diagnosis), "") << "0.01 px are nobody's";
}

/// In the mean over both cameras photos are at the floor; one camera alone is not.
TEST(Verdict, WantsEveryCameraExplained) {
  const SmallScene small({.same_renderer = true});
  auto [fitted, diagnosis] = at_its_floor(small);
  const auto& own = diagnosis.floor.by_camera;
  ASSERT_THAT(own, testing::SizeIs(2));
  EXPECT_NEAR(own.at("cam0"), 1.0, 0.1);
  EXPECT_NEAR(own.at("cam1"), 1.0, 0.1);
  std::string why;
  EXPECT_EQ(judge(fitted, diagnosis, {}, &why), Verdict::explained) << why;
  const auto& examples = small.scene->capture.examples;
  for (auto& example : fitted.evaluation.examples)
    for (auto& photo : example.photos)
      if (examples[example.example].photos[photo.photo].camera == "cam1") photo.r2 *= 2.1;
  ASSERT_TRUE(at_floor(fitted, diagnosis.floor));
  EXPECT_EQ(judge(fitted, diagnosis, {}, &why), Verdict::unexplained);
  EXPECT_THAT(why, testing::ContainsRegex("floor .*, but 1.[45][0-9] times its own in the [a-z-]+ "
                                          "photos of camera 'cam1', more than 1.3"));
  const double of_cam1 = diagnosis.floor.by_camera["cam1"];
  diagnosis.floor.by_camera["cam1"] = 1.45 * of_cam1;
  EXPECT_EQ(judge(fitted, diagnosis, {}, &why), Verdict::explained) << "its rest photos are as bad";
  diagnosis.floor.by_camera["cam1"] = 0.0;
  EXPECT_EQ(most_over_floor(fitted, diagnosis.floor).camera, "cam0")
      << "of 0 nothing is a multiple";
  diagnosis.floor.by_camera["cam1"] = of_cam1;
  const double chi = std::exchange(diagnosis.floor.chi, 1.6);
  EXPECT_EQ(judge(fitted, diagnosis, {}, &why), Verdict::explained)
      << "a renderer leaves more at rest, and may leave it in either camera";
  diagnosis.floor.chi = chi;
  for (auto& example : fitted.evaluation.examples)
    for (auto& photo : example.photos) {
      const bool cam1 = examples[example.example].photos[photo.photo].camera == "cam1";
      photo.r2 *= cam1 ? 1.75 / 2.1 : 1.45;
    }
  ASSERT_TRUE(at_floor(fitted, diagnosis.floor));
  EXPECT_GT(most_over_floor(fitted, diagnosis.floor).times, Limits{}.floor.at);
  EXPECT_EQ(judge(fitted, diagnosis, {}, &why), Verdict::explained)
      << "the other camera is nearly as bad: what is wrong is no camera's";
}

/// Fitted photos at their floor cannot tell what the held-out ones lack; the user hears which
/// would.
TEST(Verdict, SaysWhichHeldOutLoadShowsWhatIsMissing) {
  const SmallScene small({.same_renderer = true});
  auto [fitted, diagnosis] = at_its_floor(small);
  std::string why, held_out;
  for (auto& example : fitted.evaluation.examples)
    if (example.held_out) {
      held_out = small.scene->capture.examples[example.example].name;
      for (auto& photo : example.photos) photo.r2 *= 9.0;
    }
  ASSERT_NE(held_out, "");
  EXPECT_EQ(judge(fitted, diagnosis, {}, &why), Verdict::unexplained);
  EXPECT_THAT(why,
              testing::EndsWith(
                  "what is missing shows in held-out photos alone, most in '" + held_out +
                  "': no values that the fitted ones allow were found to "
                  "explain it. Fit it too (without use: validate), with another load held out"));
}

/// An effect has to take a tenth of what is over the floor, of the fitted photos or of the held-out
/// ones (something else may show there) or of what sensors are off by; near the floor, too, where a
/// field took 3 % of what another renderer had left and was named. Below it nothing is to be taken.
TEST(Contest, WhatTakesLittleOfTheMisfitIsRefused) {
  const SmallScene small({.same_renderer = true});
  const auto [fitted, diagnosis] = at_its_floor(small);
  const auto left = [&](double fit, double held_out) {
    Fitted out = fitted;
    for (auto& example : out.evaluation.examples)
      for (auto& photo : example.photos) photo.r2 *= example.held_out ? held_out : fit;
    out.low = out.high = VectorXd::Constant(out.p.size(), 1e6);  // what is not there is no answer
    return out;
  };
  Step step;
  step.diagnosis = diagnosis;
  const auto refused = [&](double fit, double held_out) {
    return why_refused(step, 0.0, {"gravity", left(fit, held_out), 100.0}).words();
  };
  step.fitted = left(100.0, 100.0);
  EXPECT_THAT(refused(95.0, 93.0), testing::HasSubstr("leaves 93 % of what is over the floor"));
  EXPECT_EQ(refused(85.0, 99.0), "");
  EXPECT_EQ(refused(98.0, 85.0), "");
  const auto forces_off = [](Fitted one, double by) {
    for (auto& example : one.evaluation.examples)
      for (auto& measured : example.measured) measured.r.setConstant(by);
    return one;
  };
  const auto with_forces = [&](double by) {
    return why_refused(step, 0.0, {"gravity", forces_off(left(99.0, 99.0), by), 100.0}).words();
  };
  step.fitted = forces_off(left(100.0, 100.0), 100.0);
  EXPECT_EQ(with_forces(90.0), "") << "of the sum of squares 19 % are gone";
  EXPECT_THAT(with_forces(97.0), testing::HasSubstr("leaves 94 %"));
  step.fitted = left(1.6, 1.6);
  EXPECT_THAT(refused(1.57, 1.57), testing::HasSubstr("leaves 9")) << "explained, by its size";
  EXPECT_EQ(refused(1.4, 1.6), "");
  step.fitted = left(0.8, 0.8);
  EXPECT_EQ(refused(0.7, 0.7), "") << "nothing is over the floor";
  const auto may_be_nothing = [&] {
    Refit refit{"gravity", left(0.7, 0.7), 100.0};
    refit.fitted.low.setConstant(-1e6);
    return why_refused(step, 0.0, refit).why == Refusal::Why::may_be_nothing;
  };
  EXPECT_TRUE(may_be_nothing());
  step.fitted = left(100.0, 100.0);
  EXPECT_FALSE(may_be_nothing()) << "without it much is left";
}

/// A force 100 deviations off is not explained by photos that are at their floor.
TEST(Verdict, WantsTheMeasuredValuesExplainedToo) {
  const SmallScene small({.same_renderer = true});
  auto [fitted, diagnosis] = at_its_floor(small);
  std::string why;
  EXPECT_EQ(judge(fitted, diagnosis, {}, &why), Verdict::explained) << why;
  for (auto& example : fitted.evaluation.examples)
    for (auto& measured : example.measured) measured.r.z() += 100.0;
  EXPECT_EQ(judge(fitted, diagnosis, {}, &why), Verdict::unexplained);
  EXPECT_THAT(why, testing::ContainsRegex("the force measured on 'grip' in '[a-z]+' is 1?[0-9]+ "
                                          "times its told noise off"));
  // what a finer mesh would change by as much is the mesh's
  diagnosis.mesh_in_measured = 1e4;
  EXPECT_EQ(judge(fitted, diagnosis, {}, &why), Verdict::explained) << why;
}

}  // namespace
}  // namespace hookeye
