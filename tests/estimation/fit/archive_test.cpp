// What was worked out is known: asked the same again, whoever asks, and nothing else.
#include "estimation/fit/archive.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "estimation/effects/catalogue.h"
#include "estimation/fit/archived.h"
#include "estimation/search/race.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

using nlohmann::json;

bool knows(Archive& archive, const Question& question) {
  json ignored;
  return archive.find(question, ignored);
}

TEST(Archive, AgreesToRounding) {
  Archive archive;
  const double inf = std::numeric_limits<double>::infinity();
  archive.keep({"fit", "a form", {1.0, 1e-9, inf}}, {{"answer", inf}});
  json answer;
  ASSERT_TRUE(archive.find({"fit", "a form", {1.0 + 1e-9, 0.0, inf}}, answer));
  EXPECT_EQ(answer.at("answer"), inf);
  for (const Question& other :
       {Question{"trial", "a form", {1.0, 1e-9, inf}}, Question{"fit", "another", {1.0, 1e-9, inf}},
        Question{"fit", "a form", {1.00001, 1e-9, inf}}, Question{"fit", "a form", {1.0, 1e-9}},
        Question{"fit", "a form", {1.0, 1e-9, 5.0}}})
    EXPECT_FALSE(knows(archive, other)) << other.kind << other.text;
  EXPECT_EQ(archive.tallies().at("fit").kept, 1);
  EXPECT_EQ(archive.tallies().at("fit").found, 1);
}

TEST(Archive, OutlivesItsProcess) {
  const test::TemporaryFolder folder;
  const auto file = folder / "archive";
  {
    Archive archive(std::make_unique<Journal>(file, "a capture"));
    EXPECT_TRUE(archive.empty());
    archive.keep({"fit", "a form", {1.0 / 3.0}}, {{"p", {0.1, 2.0 / 3.0}}});
  }
  Archive again(std::make_unique<Journal>(file, "a capture"));
  EXPECT_FALSE(again.empty());
  json answer;
  ASSERT_TRUE(again.find({"fit", "a form", {1.0 / 3.0}}, answer));
  EXPECT_EQ(answer.at("p").at(1), 2.0 / 3.0) << "all digits";
  EXPECT_TRUE(Archive(std::make_unique<Journal>(file, "another capture")).empty());
}

/// A weight that is not told.
class KeptFits : public testing::Test {
 protected:
  KeptFits() : small_({.hidden = kHidden, .told = "0.021"}), workspace_(small_.scene) {
    workspace_.keep_in(archive_);
  }
  ModelForm form() const { return base_form(small_.scene); }
  ModelForm with(const std::string& effect, const std::string& variant) const {
    ModelForm out = form();
    const Model model = out.realise(out.initial());
    out.ingredients.push_back(find_effect(effect)->candidate(model, variant));
    return out;
  }
  int count(const std::string& kind, int Archive::Tally::*which) const {
    const auto found = archive_->tallies().find(kind);
    return found == archive_->tallies().end() ? 0 : found->second.*which;
  }
  int kept(const std::string& kind) const { return count(kind, &Archive::Tally::kept); }
  int found(const std::string& kind) const { return count(kind, &Archive::Tally::found); }

  static constexpr const char* kHidden =
      "hidden:\n  - {effect: gravity, values: {gravity.x: 4000, gravity.z: -9000}}\n";
  const test::SmallScene small_;
  const std::shared_ptr<Archive> archive_ = std::make_shared<Archive>();
  Workspace workspace_;
};

TEST_F(KeptFits, AQuestionIsOfOneFormOnOneMesh) {
  const ModelForm base = form(), gravity = with("gravity", "");
  const auto ask = [](const ModelForm& form, double by = 1.0) {
    const Question question = question_of("fit", form, by * form.initial());
    return question.text + fmt::format("{::.6g}", question.numbers);
  };
  std::set<std::string> asked = {ask(base), ask(base, 1.01), ask(gravity)};
  asked.insert(ask(with("load_direction", "in all")));
  asked.insert(ask(with("load_direction", "in pull")));
  auto bounds = gravity.ingredients.back()->parameters();
  std::vector<std::pair<double, double>> half;
  for (const Parameter& one : bounds)  // a weight's own are without end
    half.emplace_back(one.value - one.typical, one.value + one.typical);
  ModelForm bounded = gravity;
  if (const auto other = gravity.ingredients.back()->with_bounds(half)) {
    bounded.ingredients.back() = other;
    asked.insert(ask(bounded));
  }
  auto none_held_out = std::make_shared<Scene>(*small_.scene);
  for (ExampleSpec& example : none_held_out->capture.examples) example.validate = false;
  asked.insert(ask(base_form(none_held_out)));
  asked.insert(ask(base_form(remeshed(*small_.scene, 0.8, 0, false))));
  EXPECT_EQ(asked.size(), 8U);
  // Written and read back it is the same model; so it is when it is made anew.
  const test::TemporaryFolder folder;
  std::ofstream(folder / "model.yaml") << write_model(gravity, gravity.initial(), catalogue());
  const auto [again, p] = read_model(folder / "model.yaml", small_.scene, catalogue());
  EXPECT_EQ(ask(again), ask(gravity));
  EXPECT_EQ(ask(base_form(small_.scene)), ask(base));
}

TEST_F(KeptFits, NoFitIsDoneTwice) {
  const ModelForm base = form();
  const VectorXd start = base.initial();
  const Fitted first = fit(workspace_, base, start).value();
  ASSERT_EQ(kept("fit"), 1);
  ASSERT_EQ(kept("state"), 1);
  Workspace another(small_.scene);  // as of another process
  another.keep_in(archive_);
  int steps = 0;
  FitOptions options;
  options.progress = [&](const FitProgress& progress) { steps += progress.stage != "final"; };
  const Fitted second = fit(another, base, start, options).value();
  EXPECT_EQ(steps, 0);
  EXPECT_EQ(found("fit"), 1);
  EXPECT_EQ(kept("fit"), 1);
  EXPECT_EQ(second.p, first.p);
  EXPECT_EQ(second.iterations, first.iterations);
  EXPECT_EQ(second.converged, first.converged);
  for (const bool held_out : {false, true})
    EXPECT_EQ(second.evaluation.chi(held_out), first.evaluation.chi(held_out));
  const auto here = workspace_.place(), there = another.place();
  EXPECT_EQ(here.q, there.q) << "what is asked next begins at the same bits";
  EXPECT_NEAR(second.low[0], first.low[0], 1e-6 * first.low[0]);
  options.coarse_to_fine = false;
  fit(another, base, start, options);
  EXPECT_EQ(kept("fit"), 2);
  options.max_iterations = 3;
  fit(another, base, start, options);
  EXPECT_EQ(kept("fit"), 3);
  fit(another, base, 1.001 * start, options);
  EXPECT_EQ(kept("fit"), 4);
}

TEST_F(KeptFits, WhatWasStoppedIsNotKept) {
  std::atomic<bool> cancel{false};
  FitOptions options;
  options.cancel = &cancel;
  options.progress = [&](const FitProgress&) { cancel = true; };
  const auto stopped = fit(workspace_, form(), form().initial(), options);
  ASSERT_TRUE(cancelled(stopped.error()));
  EXPECT_EQ(kept("fit"), 0);
  cancel = false;
  options.progress = nullptr;
  EXPECT_TRUE(fit(workspace_, form(), form().initial(), options).has_value());
}

TEST_F(KeptFits, WhatHasNoEquilibriumIsNotSoughtTwice) {
  FitOptions options;
  options.most_iterations = 1;
  const VectorXd start = 0.02 * form().initial();
  for (int i = 0; i < 2; ++i) {
    const auto failed = assess(workspace_, form(), start, options);
    ASSERT_FALSE(failed);
    EXPECT_THAT(failed.error().reason, testing::HasSubstr("no equilibrium"));
  }
  EXPECT_EQ(kept("state"), 1);
  EXPECT_EQ(found("state"), 1);
}

/// Tomorrow there may be more; what has no equilibrium has none.
TEST_F(KeptFits, WhatFoundNoMemoryIsTriedAgain) {
  const ModelForm base = form();
  const VectorXd p = base.initial();
  const auto asked = [&](NumericalFailure::Kind kind) {
    int worked = 0;
    for (int i = 0; i < 2; ++i)
      archived<Fitted>(
          {workspace_, base, p, nullptr,
           [&] { return question_of(fmt::format("kind {}", static_cast<int>(kind)), base, p); }},
          [&]() -> Result<Fitted> {
            ++worked;
            return no_result({"pull", 0.5, "it failed", kind});
          },
          [](const Fitted&) { return json(); },
          [](const json&) { return std::optional<Result<Fitted>>(); });
    return worked;
  };
  EXPECT_EQ(asked(NumericalFailure::Kind::numbers), 1);
  EXPECT_EQ(asked(NumericalFailure::Kind::no_memory), 2);
}

TEST_F(KeptFits, ADiagnosisAndTheTrialsOfItComeBack) {
  const Fitted base = fit(workspace_, form(), form().initial()).value();
  const Diagnosis first = diagnose(workspace_, base).value();
  Diagnosis second = diagnose(workspace_, base).value();
  EXPECT_EQ(kept("diagnosis"), 1);
  ASSERT_EQ(first.effects.size(), second.effects.size());
  EXPECT_EQ(first.mesh_shift, second.mesh_shift);
  EXPECT_EQ(first.floor.cell_inflation, second.floor.cell_inflation);
  EXPECT_EQ(conclusion(first), conclusion(second));
  for (size_t i = 0; i < first.effects.size(); ++i) {
    const EffectScore &a = first.effects[i], &b = second.effects[i];
    EXPECT_EQ(a.effect, b.effect);
    EXPECT_EQ(a.evidence, b.evidence);
    EXPECT_EQ(a.pictured, b.pictured);
    EXPECT_EQ(a.values, b.values);
    EXPECT_EQ(a.base_step, b.base_step);
    EXPECT_EQ(nameable(a, first), nameable(b, second));
    if (a.best) {
      EXPECT_EQ(a.best->variant(), b.best->variant());
    }
  }
  // What it draws is worked out where it is wanted.
  EXPECT_FALSE(lacks_displaced(first));
  ASSERT_TRUE(lacks_displaced(second));
  EXPECT_TRUE(displace_again(workspace_, base, nullptr, second).has_value());
  EXPECT_FALSE(lacks_displaced(second));
  for (size_t i = 0; i < first.effects.size(); ++i)
    for (const auto& [example, q] : first.effects[i].displaced)
      EXPECT_LT((q - second.effects[i].displaced.at(example)).norm(), 1e-6 * q.norm())
          << first.effects[i].effect;

  const auto before = workspace_.place().q;
  const auto raced = race(workspace_, base, first, {});
  EXPECT_EQ(workspace_.place().q, before) << "trials leave the workspace where it was";
  const int trials = kept("trial");
  ASSERT_GT(trials, 1);
  const auto again = race(workspace_, base, second, {});
  EXPECT_EQ(kept("trial"), trials);
  EXPECT_EQ(again->front().trial.p, raced->front().trial.p);
}

}  // namespace
}  // namespace hookeye
