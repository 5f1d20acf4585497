// hookeye add: refit with an effect (or without it again); the next step of the run.
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "app/commands/commands.h"
#include "app/commands/run_support.h"
#include "app/interrupt.h"
#include "capture_io/seen_in_words.h"
#include "estimation/effects/catalogue.h"
#include "estimation/model/effect.h"
#include "estimation/output/step_json.h"
#include "estimation/search/refit_score.h"
#include "runs/add_step.h"
#include "runs/kept_work.h"
#include "runs/run_limits.h"
#include "runs/text.h"

namespace hookeye {
namespace {

struct AddArguments {
  std::string run;
  AddRequest request;
};

/// "removed 83 % of the excess misfit on the fitted photos (residual 5.1 -> 1.3)", or how much came
/// back.
std::string outcome(const Step& before, const Step& after, const Floor& floor, bool held_out) {
  const double was = before.fitted.evaluation.chi(held_out);
  const double is = after.fitted.evaluation.chi(held_out);
  const double f2 = floor.chi * floor.chi;
  const double share =
      was * was > f2 ? (was * was - std::max(is * is, f2)) / (was * was - f2) : 0.0;
  return fmt::format("{} on the {} {} (residual {:.3f} -> {:.3f})",
                     was * was <= f2 ? std::string("nothing to remove")
                     : share >= 0.0  ? fmt::format("removed {:.{}f} % of the excess misfit",
                                                   100.0 * share, share > 0.99 ? 1 : 0)
                                     : fmt::format("misfit {:.2g} times as large", 1.0 - share),
                     held_out ? "held-out" : "fitted",
                     seen_in_words(after.fitted.form.scene->capture), was, is);
}

/// Did it pay? On the held-out photos, where there are such.
void say_outcome(const Step& before, const Step& after, const Floor& floor, bool taken_back,
                 Session& session) {
  const bool held_out = before.fitted.evaluation.chi(true) > 0.0;
  session.say("{}",
              wrapped(fmt::format("outcome:   {}{}", outcome(before, after, floor, false),
                                  held_out ? ", " + outcome(before, after, floor, true) : "")));
  if (!taken_back && !held_out_allows(after.fitted, before.fitted, floor,
                                      least_fall(before.diagnosis, after.added)))
    session.warn(fmt::format("{} does not pay on the held-out {}; take it back with --take-back",
                             after.name, seen_in_words(after.fitted.form.scene->capture)));
}

void run_add(const AddArguments& arguments, Session& session) {
  check_effect(arguments.request.effect);
  Run run = open_run(arguments.run, true);
  check_stands(run, arguments.request);
  Bench bench = open_capture(run.capture(), session, limits_of(run.timeline()));
  const KeptWork kept(run, bench, &interrupted());
  Step current = newest_step(run, bench);
  check_form(current.fitted, arguments.request);
  AddOptions options;
  options.fit = fit_options();
  options.diagnosis.cancel = &interrupted();
  if (auto stored = stored_diagnosis(run, current.fitted)) {
    current.diagnosis = std::move(*stored);
  } else if (!arguments.request.take_back) {
    spdlog::info("diagnosing the newest step");
    diagnose_newest(run, bench, current, options.diagnosis);
  }
  options.doing = [](const std::string& work) { spdlog::info("{}", work); };
  options.note = [&session](const std::string& sentence) { session.say("{}", wrapped(sentence)); };
  Step step = next_step(bench, current, arguments.request, options);
  const auto folder = record(run, step, invocation());
  const Floor floor = measure_floor(*step.fitted.form.scene, step.fitted.evaluation);
  spdlog::info("diagnosing the new step");
  diagnose_newest(run, bench, step, options.diagnosis);
  record_all_pixels(run, bench, step, options.fit);
  session.document = run.timeline()["steps"].back();
  say_answer(run, session);
  if (!arguments.request.take_back)
    if (const auto form = form_taken(step.fitted, arguments.request.effect); !form.empty())
      session.say("{}", wrapped(form));
  say_outcome(current, step, floor, arguments.request.take_back, session);
  if (const auto said = not_converged(step.fitted.converged, step.fitted.iterations); !said.empty())
    session.warn(said);
  session.say("{}{}", parameter_table(step.fitted), wrapped(conclusion(step.diagnosis)));
  session.say("written to {}\n", folder.string());
}

}  // namespace

void add_add(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand("add", "Refit with an effect; the next step of the run");
  const auto arguments = std::make_shared<AddArguments>();
  command->add_option("RUN", arguments->run, "Run folder")->required();
  command->add_option("EFFECT", arguments->request.effect, "Name of the effect")->required();
  command->add_option("--as", arguments->request.form,
                      "Form, as `hookeye effects NAME` names it (default: what refits find)");
  command->add_flag("--take-back", arguments->request.take_back, "Refit without the effect again");
  std::vector<std::string> names;
  for (const Effect* effect : catalogue()) names.push_back(effect->name());
  command->footer(wrapped(fmt::format("Effects: {}", fmt::join(names, ", "))));
  command->callback([&chosen, arguments] {
    chosen = [arguments](Session& session) { run_add(*arguments, session); };
  });
}

}  // namespace hookeye
