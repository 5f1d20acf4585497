// hookeye add: refit with an effect (or without it again); the next step of the run.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/commands/run_support.h"
#include "app/interrupt.h"
#include "estimation/step_json.h"

namespace hookeye {
namespace {

struct AddArguments {
  std::string run, effect;
  bool take_back = false;
};

[[noreturn]] void unknown_effect(const std::string& wanted) {
  std::vector<std::string> known;
  for (const Effect* effect : catalogue()) known.push_back(effect->name());
  const std::string near = nearest_name(wanted, known);
  throw InputError({wanted}, "there is no such effect",
                   near.empty() ? fmt::format("one of: {}", fmt::join(known, ", "))
                                : fmt::format("did you mean '{}'?", near));
}

Step with_effect(Bench& bench, const Step& current, const std::string& name, Session& session) {
  DiagnosisOptions options;
  options.cancel = &interrupted();
  const Diagnosis diagnosis = value_or_fail(diagnose(bench.workspace, current.fitted, options));
  for (const auto& score : diagnosis.effects) {
    if (score.effect != name) continue;
    if (!score.best)
      throw InputError({name}, "cannot be added: " + score.why_not, "another effect");
    if (!score.testable) session.warn(name + ": " + score.why_not);
    session.say("predicted: removes {:.0f} % of the misfit\n", 100.0 * score.explains);
    Step step;
    step.name = step.added = name;
    step.fitted = value_or_fail(add_effect(bench.workspace, current.fitted, score, fit_options()));
    return step;
  }
  unknown_effect(name);
}

Step without_effect(Bench& bench, const Step& current, const std::string& name) {
  ModelForm form = current.fitted.form;
  std::vector<double> p;
  int offset = 0;
  bool found = false;
  form.ingredients.clear();
  for (const auto& ingredient : current.fitted.form.ingredients) {
    const int n = static_cast<int>(ingredient->parameters().size());
    if (ingredient->name() == name) {
      found = true;
    } else {
      form.ingredients.push_back(ingredient);
      for (int i = 0; i < n; ++i) p.push_back(current.fitted.p[offset + i]);
    }
    offset += n;
  }
  if (!found)
    throw InputError({name}, "the newest step does not have this effect",
                     "take back an effect that was added");
  Step step;
  step.name = "without-" + name;
  FitOptions options = fit_options();
  options.coarse_to_fine = false;
  step.fitted = value_or_fail(
      fit(bench.workspace, form, Eigen::Map<const VectorXd>(p.data(), p.size()), options));
  return step;
}

/// Did it pay? On the photos that no fit has seen, where there are such.
void say_outcome(const Step& before, const Step& after, const Floor& floor, Session& session) {
  auto removed = [&](bool held) {
    const double f2 = floor.chi * floor.chi;
    const double was = std::pow(before.fitted.evaluation.chi(held), 2) - f2;
    const double is = std::pow(after.fitted.evaluation.chi(held), 2) - f2;
    return was > 0.0 ? 100.0 * (1.0 - std::max(is, 0.0) / was) : 0.0;
  };
  session.say("outcome:   removed {:.0f} % on the fitted photos (chi {:.3f} -> {:.3f})",
              removed(false), before.fitted.evaluation.chi(false),
              after.fitted.evaluation.chi(false));
  const double held = before.fitted.evaluation.chi(true);
  if (held > 0.0) {
    session.say(", {:.0f} % on the held-out ones ({:.3f} -> {:.3f})", removed(true), held,
                after.fitted.evaluation.chi(true));
    if (after.fitted.evaluation.chi(true) >= held)
      session.warn(after.name + " does not pay on the held-out photos; take it back with "
                   "--take-back");
  }
  session.say("\n");
}

void run_add(const AddArguments& arguments, Session& session) {
  if (!find_effect(arguments.effect)) unknown_effect(arguments.effect);
  Run run = Run::open(arguments.run, true);
  Bench bench = open_capture(run.capture(), session);
  const Step current = newest_step(run, bench);
  const Step step = arguments.take_back
                        ? without_effect(bench, current, arguments.effect)
                        : with_effect(bench, current, arguments.effect, session);
  const auto folder = record(run, *bench.scene, step);
  const Floor floor = measure_floor(*bench.scene, step.fitted.evaluation);
  session.document = run.timeline()["steps"].back();
  say_outcome(current, step, floor, session);
  session.say("{}written to {}\n", parameter_table(step.fitted), folder.string());
}

}  // namespace

void add_add(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("add", "Refit with an effect; the next step of the run");
  const auto arguments = std::make_shared<AddArguments>();
  command->add_option("RUN", arguments->run, "Run folder")->required();
  command->add_option("EFFECT", arguments->effect, "Name of the effect")->required();
  command->add_flag("--take-back", arguments->take_back, "Refit without the effect again");
  command->callback([&chosen, arguments] {
    chosen = [arguments](Session& session) { run_add(*arguments, session); };
  });
}

}  // namespace hookeye
