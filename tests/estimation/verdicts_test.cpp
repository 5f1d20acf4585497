// How searches end where names compete: what ties, what is dropped, what has no name.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "estimation/contest.h"
#include "estimation/discover.h"
#include "estimation/effects/toolbox.h"
#include "estimation/refit.h"
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

/// What is smaller than the mesh's own error is not named, but the user hears what would show it.
TEST(Verdict, SaysWhatOnlyAFinerMeshWouldShow) {
  Fitted fitted;
  fitted.evaluation.examples.resize(1);
  fitted.evaluation.examples[0].photos.resize(1);
  fitted.evaluation.examples[0].photos[0].count = 100.0;
  fitted.evaluation.examples[0].photos[0].r2 = 200.0;
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
  Fitted fitted;
  fitted.evaluation.examples.resize(1);
  fitted.evaluation.examples[0].photos.resize(1);
  PhotoEvaluation& photo = fitted.evaluation.examples[0].photos[0];
  photo.count = 100.0, photo.r2 = 410.0;
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
TEST(Verdict, ATieIsAmbiguousOnlyAtTheFloor) {
  Fitted fitted;
  fitted.evaluation.examples.resize(1);
  fitted.evaluation.examples[0].photos.resize(1);
  PhotoEvaluation& photo = fitted.evaluation.examples[0].photos[0];
  photo.count = 100.0, photo.r2 = 110.0;
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

/// The told model of a capture that hides nothing, nothing diagnosed.
std::pair<Fitted, Diagnosis> at_its_floor(const SmallScene& small) {
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  Fitted fitted = std::get<Fitted>(assess(workspace, form, form.initial()));
  Diagnosis diagnosis;
  diagnosis.floor = measure_floor(*small.scene, fitted.evaluation);
  return {std::move(fitted), std::move(diagnosis)};
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
  for (auto& example : fitted.evaluation.examples)
    for (auto& photo : example.photos) {
      const bool cam1 = examples[example.example].photos[photo.photo].camera == "cam1";
      photo.r2 *= cam1 ? 1.75 / 2.1 : 1.45;
    }
  ASSERT_TRUE(at_floor(fitted, diagnosis.floor));
  EXPECT_GT(most_over_floor(fitted, diagnosis.floor).times, kAtFloor);
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

/// Far from the floor an effect has to take a tenth of what is over it, of the fitted photos or of
/// the held-out ones (something else may show there) or of what sensors are off by; at the floor it
/// has not.
TEST(Contest, WhatTakesLittleOfALargeMisfitIsRefused) {
  const SmallScene small({.same_renderer = true});
  const auto [fitted, diagnosis] = at_its_floor(small);
  const auto left = [&](double fit, double held_out) {
    Fitted out = fitted;
    for (auto& example : out.evaluation.examples)
      for (auto& photo : example.photos) photo.r2 *= example.held_out ? held_out : fit;
    return out;
  };
  Step step;
  step.diagnosis = diagnosis;
  const auto refused = [&](double fit, double held_out) {
    return why_refused(step, 0.0, {"gravity", left(fit, held_out), 100.0});
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
    return why_refused(step, 0.0, {"gravity", forces_off(left(99.0, 99.0), by), 100.0});
  };
  step.fitted = forces_off(left(100.0, 100.0), 100.0);
  EXPECT_EQ(with_forces(90.0), "") << "of the sum of squares 19 % are gone";
  EXPECT_THAT(with_forces(97.0), testing::HasSubstr("leaves 94 %"));
  step.fitted = left(1.6, 1.6);
  EXPECT_EQ(refused(1.55, 1.55), "") << "at the floor";
  step.fitted = left(1.8, 1.8);
  EXPECT_THAT(refused(1.75, 1.75), testing::HasSubstr("leaves 9")) << "not quite";
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
