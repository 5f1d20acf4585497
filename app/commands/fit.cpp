// hookeye fit: the base model, step 0 of a run.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/commands/kept_work.h"
#include "app/commands/limit_options.h"
#include "app/commands/run_support.h"
#include "app/commands/tables.h"
#include "capture_io/json_file.h"
#include "estimation/effects/catalogue.h"
#include "estimation/model/additive_material.h"
#include "estimation/output/step_json.h"
#include "estimation/search/progressive.h"

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

/// The textbook law first, where it can move; then the same energy told additively, refined.
Fitted fit_additive(Bench& bench, const ModelForm& form, const VectorXd& p,
                    const FitOptions& fit_options) {
  const bool own = has_additive(form);
  std::vector<AdditiveStart> starts = {own ? AdditiveStart(form, p) : to_additive(form, p)};
  if (!own && form.size() > 0) {
    const Fitted base = value_or_fail(fit(bench.workspace, form, p, fit_options));
    for (int i = 0; i < base.p.size(); ++i)
      spdlog::info("the law by itself: {} {:.5g} {}", form.parameters()[i].name, base.p[i],
                   form.parameters()[i].unit);
    starts.insert(starts.begin(), to_additive(form, base.p));
  }
  ProgressiveOptions options;
  options.fit = fit_options;
  return value_or_fail(fit_progressive(bench.workspace, starts, options));
}

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
  Bench bench = open_capture(arguments.capture, session, limits_for(arguments.run, arguments.set));
  Run run = create_run(arguments.run, bench.scene->capture.file);
  keep_limits(run, *bench.scene->limits);
  const KeptWork kept(run, bench);
  if (!run.steps().empty()) {
    if (!arguments.model.empty() || !arguments.material.empty())
      throw InputError({arguments.run},
                       "the base model of this run is fitted already, from another start",
                       "name a new folder, or leave -m and --material out to see what is there");
    session.say("{}: the base model is fitted already\n", arguments.run);
    session.document = run.timeline();
    return;
  }
  ModelForm form = base_form(bench.scene);
  VectorXd start = form.initial();
  if (!arguments.model.empty())
    std::tie(form, start) = read_model(arguments.model, bench.scene, catalogue());
  Step step;
  step.name = "base";
  const bool additive = arguments.material == "additive" || has_additive(form);
  const FitOptions options = arguments.options();
  step.fitted = additive ? fit_additive(bench, form, start, options)
                         : value_or_fail(fit(bench.workspace, form, start, options));
  const auto folder = record(run, step);
  const Floor floor = measure_floor(*step.fitted.form.scene, step.fitted.evaluation);
  run.update([&](nlohmann::json& timeline) { tell_floor(timeline, floor); });
  session.document = run.timeline();
  warn_of_lost_ellipticity(folder, session);
  say_answer(run, session);
  session.say("{}", parameter_table(step.fitted));
  if (additive) say_refinements(step.fitted, session);
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
