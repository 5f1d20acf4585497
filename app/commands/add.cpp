// hookeye add: refit with an effect (or without it again); the next step of the run.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "app/commands/add_step.h"
#include "app/commands/commands.h"
#include "app/interrupt.h"
#include "estimation/step_json.h"

namespace hookeye {
namespace {

struct AddArguments {
  std::string run;
  AddRequest request;
};

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
    if (!held_out_allows(after.fitted, before.fitted, floor, least_fall(before.diagnosis)))
      session.warn(after.name +
                   " does not pay on the held-out photos; take it back with "
                   "--take-back");
  }
  session.say("\n");
}

void run_add(const AddArguments& arguments, Session& session) {
  check_effect(arguments.request.effect);
  Run run = Run::open(arguments.run, true);
  check_stands(run, arguments.request);
  Bench bench = open_capture(run.capture(), session);
  Step current = newest_step(run, bench);
  if (auto stored = stored_diagnosis(run, current.fitted)) current.diagnosis = std::move(*stored);
  AddOptions options;
  options.fit = fit_options();
  options.diagnosis.cancel = &interrupted();
  options.doing = [](const std::string& work) { spdlog::info("{}", work); };
  options.note = [&session](const std::string& sentence) { session.say("{}", wrapped(sentence)); };
  const Step step = next_step(bench, current, arguments.request, options);
  const auto folder = record(run, step);
  const Floor floor = measure_floor(*bench.scene, step.fitted.evaluation);
  session.document = run.timeline()["steps"].back();
  say_outcome(current, step, floor, session);
  session.say("{}written to {}\n", parameter_table(step.fitted), folder.string());
}

}  // namespace

void add_add(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand("add", "Refit with an effect; the next step of the run");
  const auto arguments = std::make_shared<AddArguments>();
  command->add_option("RUN", arguments->run, "Run folder")->required();
  command->add_option("EFFECT", arguments->request.effect, "Name of the effect")->required();
  command->add_flag("--take-back", arguments->request.take_back, "Refit without the effect again");
  command->callback([&chosen, arguments] {
    chosen = [arguments](Session& session) { run_add(*arguments, session); };
  });
}

}  // namespace hookeye
