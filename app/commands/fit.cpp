// hookeye fit: the base model, step 0 of a run.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/commands/limit_options.h"
#include "app/commands/run_support.h"
#include "app/interrupt.h"
#include "core/json_file.h"
#include "estimation/effects/catalogue.h"
#include "runs/fit_base.h"
#include "runs/kept_work.h"
#include "runs/record.h"

namespace hookeye {
namespace {

struct FitArguments {
  std::string capture, run, model, material;
  std::optional<int> iterations;
  std::vector<std::string> set;
  FitOptions options() const {
    FitOptions options = fit_options();
    options.max_iterations = iterations;
    return options;
  }
};

void say_refinements(const Fitted& fitted, const Session& session) {
  std::vector<std::vector<std::string>> rows = {
      {"refinement", "values", "log BF", "misfit", "held out", ""}};
  for (const RefinementStage& stage : fitted.refinements)
    rows.push_back({stage.what, std::to_string(stage.values), fmt::format("{:.1f}", stage.evidence),
                    fmt::format("{:.6g}", stage.misfit_fit),
                    stage.misfit_held_out ? fmt::format("{:.6g}", *stage.misfit_held_out) : "-",
                    stage.kept ? "kept" : "refused"});
  session.say("{}", table(rows));
}

/// What the step's figures tell of the material beyond its misfit.
void warn_of_lost_ellipticity(const std::filesystem::path& step, Session& session) {
  const auto told = read_json(step / "metrics.json").at("ellipticity");
  if (told.is_null() || told.at("elements_lost") == 0) return;
  session.warn(fmt::format(
      "the material loses ellipticity at the strains of {} elements, most in {}: no resistance "
      "against wrinkles or shear bands there",
      told.at("elements_lost").get<int>(), told.at("example").get<std::string>()));
}

void run_fit(const FitArguments& arguments, Session& session) {
  Bench bench = open_capture(arguments.capture, session,
                             limits_for(arguments.run, told_limits(arguments.set)));
  Run run = create_run(arguments.run, bench.scene->capture.file);
  keep_limits(run, *bench.scene->limits);
  const KeptWork kept(run, bench, &interrupted());
  if (!run.steps().empty()) {
    if (!arguments.model.empty() || !arguments.material.empty())
      throw InputError({arguments.run},
                       "the base model of this run is fitted already, from another start",
                       "name a new folder, or leave -m and --material out to see what is there");
    // What stopped the last command may have stopped its look at all pixels, too.
    if (run.steps().size() == 1 && bench.scene->in_part()) {
      Step step = newest_step(run, bench, arguments.options());
      record_all_pixels(run, bench, step, arguments.options());
    }
    session.say("{}: the base model is fitted already\n", arguments.run);
    session.document = run.timeline();
    return;
  }
  BaseFit wanted;
  wanted.form = base_form(bench.scene);
  wanted.start = wanted.form.initial();
  if (!arguments.model.empty())
    std::tie(wanted.form, wanted.start) = read_model(arguments.model, bench.scene, catalogue());
  wanted.additive = arguments.material == "additive";
  wanted.command = invocation();
  const FitOptions options = arguments.options();
  const Step step = fit_base(run, bench, wanted, options);
  const auto folder = run.steps().back();
  session.document = run.timeline();
  warn_of_lost_ellipticity(folder, session);
  say_answer(run, session);
  session.say("{}", parameter_table(step.fitted));
  if (!step.fitted.refinements.empty()) say_refinements(step.fitted, session);
  session.say("written to {}\n", folder.string());
  const std::string unfinished = not_converged(step.fitted.converged, step.fitted.iterations);
  if (!unfinished.empty())
    fail(
        {"", 1.0,
         unfinished + fmt::format(". The step is written; to go on: hookeye fit {} -o A_NEW_FOLDER "
                                  "-m {} --iterations {}",
                                  arguments.capture, (folder / "model.yaml").string(),
                                  2 * options.iterations(*bench.scene))});
}

}  // namespace

void add_fit(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand("fit", "Fit the base model; step 0 of a run");
  const auto arguments = std::make_shared<FitArguments>();
  command->add_option("CAPTURE", arguments->capture, "Capture folder or its yaml")->required();
  command->add_option("-o,--out", arguments->run, "Run folder")->required();
  command->add_option("-m,--model", arguments->model, "Start from this model.yaml");
  command
      ->add_option("--iterations", arguments->iterations,
                   "Most iterations at full size (else option fit.max_iterations)")
      ->check(CLI::Range(1, 10000));
  add_limit_options(*command, arguments->set);
  command
      ->add_option("--material", arguments->material,
                   "additive: go on with the additive energy model from the fitted law")
      ->check(CLI::IsMember({"additive"}));
  command->callback([&chosen, arguments] {
    chosen = [arguments](Session& session) { run_fit(*arguments, session); };
  });
}

}  // namespace hookeye
