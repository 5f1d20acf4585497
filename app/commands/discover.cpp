// hookeye discover: fit, diagnose, add, until what is left is noise.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <utility>

#include "app/commands/add_step.h"
#include "app/commands/commands.h"
#include "app/commands/run_support.h"
#include "estimation/step_json.h"

namespace hookeye {
namespace {

struct DiscoverArguments {
  std::string capture, run;
  std::vector<std::string> without;
};

DiscoverEvents events(Run& run, const Bench& bench, bool first_is_recorded) {
  auto recorded = std::make_shared<bool>(first_is_recorded);
  DiscoverEvents events;
  events.step = [&run, &bench, recorded](const Step& step) {
    if (*recorded)
      record_diagnosis(run, step);
    else
      record(run, step);
    *recorded = false;
    spdlog::info("{}: chi {} fitted, {} held out (floor {:.3f})", name_of(step),
                 chi_text(step.fitted.evaluation.chi(false)),
                 chi_text(step.fitted.evaluation.chi(true)), step.diagnosis.floor.chi);
    bool announced = false;
    for (const auto& effect : step.diagnosis.effects) {
      if (!nameable(effect, step.diagnosis)) continue;
      if (!std::exchange(announced, true))
        spdlog::info("  what stands out, guessed from one linear step (refits decide):");
      spdlog::info("  {}: evidence {:.1f}, {}", effect.effect, effect.evidence, effect.why);
    }
  };
  events.tried = [](const Racer& racer) {
    spdlog::info("trial of {}: {} fitted, {} held out, {}", racer.effect,
                 times_floor(racer.trial.chi_fit, racer.trial.floor),
                 times_floor(racer.trial.chi_validate, racer.trial.floor),
                 racer.trial.floor > 0.0 ? "times the floor of half-size photos"
                                         : "chi of half-size photos");
  };
  events.refitting = [](const std::string& effect) { spdlog::info("refit with {}", effect); };
  events.refitted = [](const std::string& effect,
                       const std::variant<Fitted, NumericalFailure>& result) {
    if (const auto* fitted = std::get_if<Fitted>(&result))
      spdlog::info("  {}: chi {} fitted, {} held out", effect,
                   chi_text(fitted->evaluation.chi(false)), chi_text(fitted->evaluation.chi(true)));
    else if (const auto& failure = std::get<NumericalFailure>(result);
             failure.reason != "cancelled")
      spdlog::info("  {}: given up, {}{}", effect, failure.reason,
                   failure.example.empty() ? "" : fmt::format(" in '{}'", failure.example));
  };
  return events;
}

void run_discover(const DiscoverArguments& arguments, Session& session) {
  for (const std::string& name : arguments.without) check_effect(name);
  Bench bench = open_capture(arguments.capture, session);
  Run run = create_run(arguments.run, bench.scene->capture.file);
  DiscoverOptions options = discover_options();
  options.diagnosis.without = arguments.without;
  const bool resumed = !run.steps().empty();
  for (const auto& step : run.timeline().value("steps", nlohmann::json::array())) {
    if (auto tied = tied_in(step); tied.size() > 1) options.tie = std::move(tied);
    options.past.push_back(contested_in(step));
  }
  const DiscoverEvents on = events(run, bench, resumed);
  const ModelForm form = base_form(bench.scene);
  const Discovery found =
      value_or_fail(resumed ? discover_from(bench.workspace, newest_step(run, bench), options, on)
                            : discover(bench.workspace, form, form.initial(), options, on));
  // What held-out photos alone show there are the values.
  std::string hint = found.all ? "" : too_little_to_name(found.steps.back().diagnosis);
  if (const auto high = high_floor(found.floor); !high.empty())
    hint += (hint.empty() ? "" : ". ") + high;
  run.update([&](nlohmann::json& timeline) {
    timeline["verdict"] = to_string(found.verdict);
    timeline["sentence"] = found.sentence;
    timeline["missing"] = found.missing;
    timeline["tie"] = found.tie;
    timeline["hint"] = hint;
    timeline.erase("fitted_to_all");
    if (found.all) timeline["fitted_to_all"] = to_json(*found.all);
    tell_floor(timeline, found.floor);
  });
  session.document = run.timeline();
  const auto& steps = run.timeline().at("steps");
  session.say("{}", steps_table(run.timeline()));
  for (size_t i = 1; i < steps.size(); ++i)
    session.say("{}", choice_table(steps[i - 1], steps[i],
                                   run.timeline().at("floor").at("chi").get<double>()));
  const Fitted& last = found.steps.back().fitted;
  session.say("\n{}", parameter_table(last));
  if (const auto said = not_converged(last.converged, last.iterations); !said.empty())
    session.warn(said);
  if (const auto& note = found.steps.back().diagnosis.mesh_note; !note.empty())
    session.say("{}", wrapped(note));
  session.say("\n{}", wrapped(fmt::format("{}: {}", to_string(found.verdict), found.sentence)));
  if (!hint.empty()) session.say("{}", wrapped(hint));
  if (found.verdict == Verdict::unexplained)
    tell_free_form(run, bench, found.steps.back(), session);
  say_pictures(run.steps().back(), session);
  session.say("run: {}\n", arguments.run);
}

}  // namespace

void add_discover(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand(
      "discover", "Fit, diagnose, add, until what is left is noise; resumes a run");
  const auto arguments = std::make_shared<DiscoverArguments>();
  command->add_option("CAPTURE", arguments->capture, "Capture folder or its yaml")->required();
  command->add_option("-o,--out", arguments->run, "Run folder")->required();
  command->add_option("--without", arguments->without, "Effects to leave out of the catalogue");
  command->callback([&chosen, arguments] {
    chosen = [arguments](Session& session) { run_discover(*arguments, session); };
  });
}

}  // namespace hookeye
