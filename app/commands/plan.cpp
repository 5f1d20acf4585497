// hookeye plan: which further load or view would best separate what is still confused.
#include <CLI/CLI.hpp>
#include <algorithm>

#include "app/commands/commands.h"
#include "app/commands/run_support.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/validators.h"
#include "core/json_file.h"
#include "estimation/diagnosis/diagnosis_json.h"
#include "estimation/effects/catalogue.h"
#include "estimation/plan/plan_json.h"
#include "estimation/search/verdict.h"
#include "runs/add_step.h"
#include "runs/run_limits.h"

namespace hookeye {
namespace {

using nlohmann::json;

struct PlanArguments {
  std::string run;
  std::vector<std::string> between;
  bool grid = false;
  size_t most = 8;
};

/// Index of the step whose model lacks what is still confused, and the effects: the newest one, or
/// the one before an addition that other effects tied with. Where none leads, those of which the
/// verdict says that they stand out by more than chance and cannot be named.
struct Question {
  size_t step = 0;
  std::vector<std::string> effects;
};

Question question_of(const json& timeline, const Diagnosis& newest, const PlanArguments& arguments,
                     const Limits& limits) {
  const json& steps = timeline.at("steps");
  Question out{steps.size() - 1, arguments.between};
  if (!out.effects.empty()) return out;
  out.effects = confused_effects(newest);
  if (out.effects.size() > 1) return out;
  for (size_t i = steps.size() - 1; i > 0; --i) {
    const std::vector<std::string> tied = tied_in(steps[i], limits);
    if (tied.size() > 1) return {i - 1, tied};
  }
  if (!out.effects.empty()) return out;
  out.effects = cannot_be_told(newest);
  if (out.effects.size() > kMostConfused) out.effects.resize(kMostConfused);
  if (out.effects.size() == 1) out.effects.clear();
  return out;
}

/// The run's model of a step, and what it lacks: as written, else diagnosed now.
struct PlannedStep {
  Fitted fitted;
  Diagnosis diagnosis;
};

PlannedStep open_step(const Run& run, Bench& bench, size_t index) {
  const auto folder = run.steps().at(index);
  auto [form, p] = read_model(folder / "model.yaml", bench.scene, catalogue());
  PlannedStep out;
  out.fitted = value_or_fail(assess(bench.workspace, form, p, fit_options()));
  const auto file = folder / "diagnosis.json";
  if (std::filesystem::exists(file)) {
    out.diagnosis = diagnosis_from_json(read_json(file), form.realise(p), file);
  } else {
    out.diagnosis = value_or_fail(diagnose(bench.workspace, out.fitted, diagnosis_options()));
  }
  return out;
}

void check_between(const std::vector<std::string>& between, const Diagnosis& diagnosis) {
  for (const auto& name : between) {
    check_effect(name);
    const auto score = std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(),
                                    [&](const auto& one) { return one.effect == name; });
    if (score == diagnosis.effects.end())
      throw InputError({name}, "the step's diagnosis left this effect out",
                       "run `hookeye diagnose RUN`, which tests the whole catalogue, and again");
    if (!score->best)
      throw InputError({name}, "cannot be planned for: " + score->why_not, "another effect");
  }
  if (between.size() == 1)
    throw InputError({between.front()}, "one effect alone is not confused with anything",
                     "--between gravity,swelling");
}

std::string plan_table(const Plan& plan, size_t most) {
  const bool pair = plan.confused.size() > 1;
  std::vector<std::vector<std::string>> rows = {
      {"", "load or view", "photos", "angle", "evidence", "differ by", "would also test"}};
  std::string impossible;
  for (const auto& rating : plan.ratings) {
    if (!rating.why_not.empty()) {
      impossible += fmt::format("  {}: {}\n", rating.candidate.name, rating.why_not);
      continue;
    }
    if (rows.size() > most) continue;
    std::string tests;
    for (const auto& name : rating.makes_testable)
      if (tests.size() < 14) tests += (tests.empty() ? "" : ", ") + name;
    rows.push_back({fmt::format("{}", rows.size()), rating.candidate.name.substr(0, 20),
                    fmt::format("{}", rating.photos),
                    pair ? fmt::format("{:.0f} deg", rating.worst.angle_deg()) : "-",
                    pair ? fmt::format("{:.1f}", rating.worst.margin) : "-",
                    pair ? fmt::format("{:.2g} px", rating.px) : "-", tests.substr(0, 24)});
  }
  return table(rows) + (impossible.empty() ? "" : "not rated\n" + impossible);
}

void run_plan(const PlanArguments& arguments, Session& session) {
  const Run run = open_run(arguments.run, false);
  if (run.steps().empty())
    throw InputError({arguments.run}, "the run has no finished step",
                     "run 'hookeye fit CAPTURE -o RUN' first");
  Bench bench = open_capture(run.capture(), session, limits_of(run.timeline()));
  if (bench.scene->capture.cameras.empty())
    throw InputError(
        {run.capture().string()},
        "the capture has no camera, and further photos are what `plan` rates",
        "add the cameras that could look (`cameras:`), also where no photo is there yet");
  PlannedStep step = open_step(run, bench, run.steps().size() - 1);
  const Question question =
      question_of(run.timeline(), step.diagnosis, arguments, *bench.scene->limits);
  if (question.step + 1 != run.steps().size()) step = open_step(run, bench, question.step);
  check_between(arguments.between, step.diagnosis);
  PlanOptions options;
  options.between = question.effects;
  options.grid_too = arguments.grid;
  options.cancel = &interrupted();
  Progress progress("plan", 0);
  options.progress = [&progress](int done, int of) { progress.set(done, of, "loads and views"); };
  const Plan found = value_or_fail(plan(step.fitted, step.diagnosis, options));
  Progress::clear_line();
  session.document = to_json(found);
  session.document["step"] = run.steps().at(question.step).filename().string();
  const bool helps = found.confused.size() > 1 ||
                     std::any_of(found.ratings.begin(), found.ratings.end(),
                                 [](const auto& one) { return !one.makes_testable.empty(); });
  if (helps && !found.ratings.empty()) session.say("{}", plan_table(found, arguments.most));
  session.say("{}\n", found.sentence);
  if (helps && !found.ratings.empty() && found.ratings.front().why_not.empty() &&
      !found.ratings.front().candidate.told)
    session.say("in capture.yaml:\n{}", capture_lines(found.ratings.front().candidate));
}

}  // namespace

void add_plan(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("plan", "Which further load or view would separate what is confused");
  const auto arguments = std::make_shared<PlanArguments>();
  command->add_option("RUN", arguments->run, "Run folder")->required();
  command
      ->add_option("--between", arguments->between,
                   "Effects to tell apart (default: what the diagnosis confuses)")
      ->delimiter(',');
  command->add_flag("--grid", arguments->grid,
                    "Rate the grid also where the capture tells candidates");
  command->add_option("--most", arguments->most, "Lines of the table (default: 8)")
      ->check(counting_number());
  command->callback([&chosen, arguments] {
    chosen = [arguments](Session& session) { run_plan(*arguments, session); };
  });
}

}  // namespace hookeye
