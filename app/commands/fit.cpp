// hookeye fit: the base model, step 0 of a run.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/commands/run_support.h"
#include "estimation/step_json.h"

namespace hookeye {
namespace {

struct FitArguments {
  std::string capture, run, model;
};

void run_fit(const FitArguments& arguments, Session& session) {
  Bench bench = open_capture(arguments.capture, session);
  Run run = Run::create(arguments.run, bench.scene->capture.file);
  if (!run.steps().empty()) {
    session.say("{}: the base model is fitted already\n", arguments.run);
    session.document = run.timeline();
    return;
  }
  ModelForm form = base_form(bench.scene);
  VectorXd start = form.initial();
  if (!arguments.model.empty()) std::tie(form, start) = read_model(arguments.model, bench.scene);
  Step step;
  step.name = "base";
  step.fitted = value_or_fail(fit(bench.workspace, form, start, fit_options()));
  const auto folder = record(run, step);
  const Floor floor = measure_floor(*bench.scene, step.fitted.evaluation);
  run.update([&](nlohmann::json& timeline) { timeline["floor"] = to_json(floor); });
  session.document = run.timeline();
  session.say("{}", parameter_table(step.fitted));
  session.say("chi {:.3f} on the fitted photos, {:.3f} on the held-out ones; floor {:.3f} ({})\n",
              step.fitted.evaluation.chi(false), step.fitted.evaluation.chi(true), floor.chi,
              floor.source);
  session.say("written to {}\n", folder.string());
}

}  // namespace

void add_fit(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand("fit", "Fit the base model; step 0 of a run");
  const auto arguments = std::make_shared<FitArguments>();
  command->add_option("CAPTURE", arguments->capture, "Capture folder or its yaml")->required();
  command->add_option("-o,--out", arguments->run, "Run folder")->required();
  command->add_option("-m,--model", arguments->model, "Start from this model.yaml");
  command->callback([&chosen, arguments] {
    chosen = [arguments](Session& session) { run_fit(*arguments, session); };
  });
}

}  // namespace hookeye
