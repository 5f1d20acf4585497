// plan: what is confused, the grid of loads and views, and their rating on a body whose weight and
// a pressure on its top one photo at rest cannot tell apart.
#include "estimation/plan/plan.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <random>

#include "capture_io/capture_reader.h"
#include "capture_io/yaml_tree.h"
#include "estimation/diagnosis/diagnosis_json.h"
#include "estimation/effects/catalogue.h"
#include "estimation/effects_scene.h"
#include "estimation/evaluation/photo_evaluation.h"
#include "estimation/plan/plan_json.h"
#include "estimation/plan/plan_prediction.h"
#include "estimation/plan/planned_scene.h"

namespace hookeye::test {

namespace {

EffectScore score(const std::string& name, double evidence) {
  EffectScore out;
  out.effect = name;
  out.evidence = evidence;
  out.fall = 1.0;
  return out;
}

TEST(Confused, TiesComeFirstThenWhatLooksAlike) {
  Diagnosis diagnosis;
  EXPECT_TRUE(confused_effects(diagnosis).empty());
  diagnosis.effects = {score("gravity", 40.0), score("swelling", 38.5), score("creep", 20.0)};
  EXPECT_THAT(confused_effects(diagnosis), ::testing::ElementsAre("gravity", "swelling"));
  diagnosis.effects[1].evidence = 30.0;
  EXPECT_THAT(confused_effects(diagnosis), ::testing::ElementsAre("gravity"));
  diagnosis.effects[0].confused_with = {{"placement", 0.97}};
  EXPECT_THAT(confused_effects(diagnosis), ::testing::ElementsAre("gravity", "placement"));
  for (auto& one : diagnosis.effects) one.evidence = 1.0;  // nothing can be named
  EXPECT_TRUE(confused_effects(diagnosis).empty());
}

/// What the diagnosis lists as alike is no question while none of it stands out.
TEST(Confused, TheSentenceGoesWithTheTable) {
  Diagnosis diagnosis;
  diagnosis.effects = {score("gravity", 1.0), score("swelling", 0.5)};
  diagnosis.effects[0].confused_with = {{"swelling", 0.99}};
  const auto none = plan(Fitted(), diagnosis).value();
  EXPECT_THAT(none.sentence, ::testing::StartsWith("no effect stands out"));
  EXPECT_THAT(none.sentence, ::testing::HasSubstr("`confused with`"));
  diagnosis.effects[0] = score("gravity", 40.0);
  const auto one = plan(Fitted(), diagnosis).value();
  EXPECT_THAT(one.sentence, ::testing::StartsWith("gravity leads"));
  EXPECT_THAT(one.sentence, ::testing::Not(::testing::HasSubstr("`confused with`")));
  diagnosis.effects[1].confused_with = {{"creep", 0.95}};
  const auto others = plan(Fitted(), diagnosis).value();
  EXPECT_THAT(others.sentence, ::testing::StartsWith("gravity leads"));
  EXPECT_THAT(others.sentence, ::testing::HasSubstr("`confused with`"));
}

/// The block at rest in one photo, which is the model's own with gravity in it, and noise.
std::shared_ptr<const Scene> sagging_scene() {
  static const auto scene = [] {
    auto out = std::make_shared<Scene>(*block_scene());
    Capture& capture = out->capture;
    for (auto& material : capture.materials) material.parameters.at("mu").numbers = {0.05};
    capture.examples.resize(1);  // rest
    capture.examples[0].photos.resize(1);
    out->photos.assign(1, {});
    ModelForm form = base_form(out);
    form.ingredients.push_back(find_effect("gravity")->candidate(form.realise(form.initial()), ""));
    VectorXd p = form.initial();
    p.tail<3>() = Vector3d(0.0, 0.0, -9650.0);
    const Model truth = form.realise(p);
    const auto solved =
        solve_equilibrium(out->body->mesh, truth.energy_of(0), truth.examples[0].loading);
    RenderOptions options = render_options(*out);
    options.derivatives = false;
    Photo photo = block_scene()->photos[0][0];
    photo.planes[0] = PhotoComparer(out, 0).render(truth, solved->q, nullptr, 0, 0, options).I;
    std::mt19937 engine(5);
    std::normal_distribution<double> normal;
    Image& plane = photo.planes[0].own();
    for (size_t i = 0; i < plane.pixels(); ++i) {
      float& I = plane.values[i];
      const double sigma = photo.noise.sigma(I);
      photo.sigma[0].own().values[i] = static_cast<float>(sigma);
      I += static_cast<float>(normal(engine) * sigma);
    }
    photo.valid = std::vector<unsigned char>(plane.pixels(), 1);
    out->photos[0].push_back(std::move(photo));
    return out;
  }();
  return scene;
}

struct Diagnosed {
  Fitted fitted;
  Diagnosis diagnosis;
};

const Diagnosed& diagnosed() {
  static const Diagnosed one = [] {
    Workspace workspace(sagging_scene());
    const ModelForm form = base_form(sagging_scene());
    Diagnosed out;
    out.fitted = assess(workspace, form, form.initial()).value();
    out.diagnosis = diagnose(workspace, out.fitted).value();
    return out;
  }();
  return one;
}

TEST(PlanCandidates, GridHasLoadsTiltsAndViews) {
  const ModelForm form = base_form(block_scene());
  const auto all = plan_candidates(form.realise(form.initial()));
  std::vector<std::string> names;
  for (const auto& one : all) names.push_back(one.name);
  EXPECT_THAT(names, ::testing::IsSupersetOf({"pull_again", "pull_half", "pull_more", "pull_back",
                                              "pull_turned", "twist_back", "bend_turned", "tilt_1",
                                              "tilt_4", "view_180", "view_raised"}));
  // held out, and at rest
  for (const char* none : {"press_half", "rest_half"})
    EXPECT_EQ(std::count(names.begin(), names.end(), none), 0) << none;
  // 'side' stands a quarter turn from 'front': no third camera is put there
  const Camera& side = block_scene()->capture.cameras[1];
  for (const auto& one : all) {
    EXPECT_FALSE(one.words.empty());
    if (one.kind == PlanCandidate::Kind::load) continue;
    EXPECT_GT(std::acos(std::min(1.0, one.view.R.row(2).dot(side.R.row(2)))), 0.3) << one.name;
    const Vector3d middle(0, 0, 20);
    EXPECT_NEAR((one.view.project(middle) - Eigen::Vector2d(31.5, 23.5)).norm(), 0.0, 1e-9);
    EXPECT_NEAR(one.view.depth(middle), 200.0, 1e-9);
  }
}

TEST(PlanCandidates, WhatTheCaptureTellsComesBeforeTheGrid) {
  auto scene = std::make_shared<Scene>(*block_scene());
  scene->capture.examples[3].photos.clear();  // bend
  scene->photos[3].clear();
  const ModelForm form = base_form(scene);
  const Model model = form.realise(form.initial());
  const auto all = plan_candidates(model);
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all.front().name, "bend");
  EXPECT_TRUE(all.front().told);
  EXPECT_EQ(all.front().load.photos.size(), 2u);
  for (size_t i = 1; i < all.size(); ++i) EXPECT_EQ(all[i].kind, PlanCandidate::Kind::view);
  EXPECT_GT(plan_candidates(model, true).size(), all.size());
}

TEST(PlanCandidates, LinesCanBePutIntoACapture) {
  const ModelForm form = base_form(block_scene());
  for (const auto& one : plan_candidates(form.realise(form.initial()))) {
    const std::string lines = capture_lines(one);
    EXPECT_EQ(lines.rfind("  " + one.name + ":\n", 0), 0u);
    if (one.name == "tilt_1") {
      EXPECT_THAT(lines, ::testing::HasSubstr("{region: base, rigid: {rotate: {axis: ["));
    }
    if (one.name == "pull_half") {
      EXPECT_THAT(lines, ::testing::HasSubstr("{region: grip, force: [0.15, 0.05, 2]}"));
    }
    if (one.name == "bend_turned") {
      EXPECT_THAT(lines, ::testing::HasSubstr("force: [-0.2, 0.5, 0]"));
    }
  }
}

/// The lines of a view, put into a capture, are a camera that sees what the candidate does.
TEST(PlanCandidates, LinesOfAViewAreACamera) {
  const ModelForm form = base_form(block_scene());
  int views = 0;
  for (const auto& one : plan_candidates(form.realise(form.initial()))) {
    if (one.kind != PlanCandidate::Kind::view) continue;
    const YamlNode root = parse_yaml("cameras:\n" + capture_lines(one), "lines");
    const auto here = std::filesystem::temp_directory_path();
    const auto cameras =
        read_cameras(YamlSection(root, "lines", {"cameras"}).need("cameras", ""), {here, here});
    ASSERT_EQ(cameras.size(), 1u);
    const Vector3d middle(1, -2, 20);
    EXPECT_NEAR((cameras[0].project(middle) - one.view.project(middle)).norm(), 0.0, 1e-2);
    ++views;
  }
  EXPECT_GT(views, 0);
}

/// Another photo by the same camera of the same state says as much again: twice the sums, twice the
/// effective residuals.
TEST(Plan, ATwinOfACameraDoublesWhatIsKnown) {
  const Diagnosed& now = diagnosed();
  PlanOptions options;
  options.between = {"gravity", "pressure"};
  const auto predicted = predict(now.fitted, now.diagnosis, options.between, {}, options);
  const Prediction& prediction = *predicted;
  double per_pixel = 0.0;
  for (const auto& photos : prediction.photos) {
    double pixels = 0.0;
    for (const auto& view : photos.views) pixels += view.count;
    if (pixels == 0.0) continue;
    per_pixel = std::max(per_pixel, photos.count / pixels);
  }
  const auto& photo = now.fitted.evaluation.examples[0].photos[0];
  EXPECT_NEAR(per_pixel, prediction.count / photo.count, 1e-9);
}

TEST(Plan, ATiltedBaseSplitsGravityFromPressure) {
  const Diagnosed& now = diagnosed();
  PlanOptions options;
  options.between = {"gravity", "pressure"};
  const Plan found = plan(now.fitted, now.diagnosis, options).value();
  ASSERT_GE(found.ratings.size(), 5u);  // the base tilted to four sides, and a view
  const PlanRating& best = found.ratings.front();
  EXPECT_EQ(best.candidate.name.rfind("tilt_", 0), 0u) << best.sentence;
  EXPECT_LT(found.now.angle_deg(), 15.0) << "they are told apart already";
  // Pictures of 64 px have few effective residuals, and evidence grows with the log of a misfit.
  EXPECT_GT(best.worst.margin, std::max(Limits{}.diagnosis.tie, 3.0 * found.now.margin));
  EXPECT_GT(best.worst.angle_deg(), found.now.angle_deg());
  EXPECT_GT(best.px, 0.0);
  EXPECT_THAT(found.sentence, ::testing::HasSubstr(best.candidate.words));
  // rated best first, and every further photo only adds
  for (size_t i = 0; i + 1 < found.ratings.size(); ++i)
    if (found.ratings[i + 1].why_not.empty()) {
      EXPECT_GE(found.ratings[i].worst.margin, found.ratings[i + 1].worst.margin);
      EXPECT_GE(found.ratings[i + 1].worst.margin, found.now.margin * (1.0 - 1e-6));
    }
  const nlohmann::json document = to_json(found);
  EXPECT_EQ(document["candidates"].size(), found.ratings.size());
  EXPECT_EQ(document["confused"][0], "gravity");
}

/// What the pair's pictures are said to differ by is what two equilibria differ by.
TEST(Plan, PixelsAreThoseOfTheModelSolvedAgain) {
  const Diagnosed& now = diagnosed();
  const auto gravity = std::find_if(now.diagnosis.effects.begin(), now.diagnosis.effects.end(),
                                    [](const auto& one) { return one.effect == "gravity"; });
  ASSERT_NE(gravity, now.diagnosis.effects.end());
  const Prediction prediction =
      predict(now.fitted, now.diagnosis, {"gravity", "swelling"}, {}, PlanOptions{}).value();
  const auto tilt = std::find_if(prediction.photos.begin(), prediction.photos.end(),
                                 [](const auto& one) { return one.candidate.name == "tilt_1"; });
  ASSERT_NE(tilt, prediction.photos.end());
  ASSERT_EQ(tilt->views.size(), 1u);
  const PlanHypothesis& weight = prediction.confused.front();
  VectorXd step = VectorXd::Zero(prediction.H.rows());
  step.segment(weight.first, weight.step.size()) = weight.step;
  const Difference predicted = difference_of(*tilt, step);

  // Solved again with the weight, projected by the camera.
  const auto scene = with_load(*sagging_scene(), tilt->candidate);
  ModelForm form = base_form(scene);
  form.ingredients.push_back(gravity->best);
  VectorXd p = form.initial();
  const Model without = form.realise(p);
  p.tail<3>() = gravity->values;
  const Model with = form.realise(p);
  const TetMesh& mesh = scene->body->mesh;
  Matrix3Xd x[2];
  for (const Model* model : {&without, &with}) {
    const auto solved = solve_equilibrium(mesh, model->energy_of(1), model->examples[1].loading);
    x[model == &with] = scene->body->surface.deformed(mesh, solved->q);
  }
  const Camera& camera = scene->capture.cameras[0];
  double sum = 0.0, seen = 0.0;
  for (int v = 0; v < x[0].cols(); ++v) {
    const Eigen::Vector2d a = camera.project(x[0].col(v)), b = camera.project(x[1].col(v));
    if (a.minCoeff() < 0 || a.x() > camera.width - 1 || a.y() > camera.height - 1) continue;
    sum += (b - a).squaredNorm();
    seen += 1.0;
  }
  const double px = std::sqrt(sum / seen);
  EXPECT_GT(px, 0.05);
  EXPECT_NEAR(predicted.px, px, 0.1 * px);  // linear against solved
}

TEST(Plan, NothingConfusedNothingPlanned) {
  const Diagnosed& now = diagnosed();
  Diagnosis nothing = now.diagnosis;
  nothing.effects.clear();
  const Plan found = plan(now.fitted, nothing).value();
  EXPECT_TRUE(found.ratings.empty());
  EXPECT_THAT(found.sentence, ::testing::HasSubstr("no effect stands out"));
}

TEST(DiagnosisJson, ReadsBackWhatItWrote) {
  const Diagnosed& now = diagnosed();
  const auto document = to_json(now.diagnosis);
  const Diagnosis again =
      diagnosis_from_json(document, now.fitted.form.realise(now.fitted.p), "diagnosis.json");
  ASSERT_EQ(again.effects.size(), now.diagnosis.effects.size());
  for (size_t i = 0; i < again.effects.size(); ++i) {
    const EffectScore &a = now.diagnosis.effects[i], &b = again.effects[i];
    EXPECT_EQ(a.effect, b.effect);
    EXPECT_EQ(a.best == nullptr, b.best == nullptr) << a.effect;
    if (!a.best) continue;
    EXPECT_EQ(a.best->variant(), b.best->variant());
    EXPECT_EQ((a.values - b.values).norm(), 0.0);
  }
  EXPECT_THROW(diagnosis_from_json({{"floor", 1}}, now.fitted.form.realise(now.fitted.p), "x.json"),
               InputError);
}

}  // namespace

}  // namespace hookeye::test
