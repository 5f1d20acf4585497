// hookeye diagnose: the ranked missing effects of a run's newest step.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/commands/run_support.h"
#include "app/interrupt.h"
#include "capture_io/seen_in_words.h"
#include "estimation/diagnosis/diagnosis_json.h"
#include "estimation/output/step_json.h"
#include "runs/kept_work.h"
#include "runs/run_limits.h"

namespace hookeye {
namespace {

void run_diagnose(const std::string& folder, Session& session) {
  Run run = open_run(folder, true);
  Bench bench = open_capture(run.capture(), session, limits_of(run.timeline()));
  const KeptWork kept(run, bench, &interrupted());
  Step step = newest_step(run, bench);
  diagnose_newest(run, bench, step, diagnosis_options());
  session.document = to_json(step.diagnosis);
  session.say("step {}: normalised residual {:.3f}, noise floor {:.3f}\n", step.name,
              step.fitted.evaluation.chi(false), step.diagnosis.floor.chi);
  session.say("{}", diagnosis_table(step.diagnosis, seen_in_words(bench.scene->capture)));
  session.say("{}", wrapped(conclusion(step.diagnosis)));
  if (const auto& note = step.diagnosis.mesh_note; !note.empty()) session.say("{}", wrapped(note));
  if (leaders(step.diagnosis).empty()) tell_free_form(run, bench, step, session);
  say_pictures(run.steps().back(), session);
}

}  // namespace

void add_diagnose(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand("diagnose", "The ranked missing effects");
  const auto folder = std::make_shared<std::string>();
  command->add_option("RUN", *folder, "Run folder")->required();
  command->callback([&chosen, folder] {
    chosen = [folder](Session& session) { run_diagnose(*folder, session); };
  });
}

}  // namespace hookeye
