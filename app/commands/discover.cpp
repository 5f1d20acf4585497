// hookeye discover: fit, diagnose, add, until what is left is noise.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/commands/limit_options.h"
#include "app/commands/local_workers.h"
#include "app/commands/run_support.h"
#include "app/commands/so_far.h"
#include "app/interrupt.h"
#include "app/validators.h"
#include "capture_io/seen_in_words.h"
#include "estimation/evaluation/load_case_share.h"
#include "runs/add_step.h"
#include "runs/kept_work.h"
#include "runs/search.h"
#include "runs/search_worker.h"

namespace hookeye {
namespace {

struct DiscoverArguments {
  std::string capture, run;
  std::vector<std::string> without, set;
  int workers = 0;
};

/// What ends a search before its end loses nothing, and says what there is.
Discovery search_or_say_so_far(Run& run, Bench& bench, SearchRequest& wanted, bool known,
                               const std::string& folder, const Session& session) {
  SoFar so_far(wanted);
  try {
    return discover_into(run, bench, wanted, known);
  } catch (const Interrupted&) {
    so_far.say(run, folder, session);
    throw;
  } catch (const Failed&) {
    so_far.say(run, folder, session);
    throw;
  }
}

void run_discover(const DiscoverArguments& arguments, Session& session) {
  for (const std::string& name : arguments.without) check_effect(name);
  Bench bench = open_capture(arguments.capture, session,
                             limits_for(arguments.run, told_limits(arguments.set)));
  Run run = create_run(arguments.run, bench.scene->capture.file);
  keep_limits(run, *bench.scene->limits);
  // Processes that share load cases must ask the same: none may hear of an answer alone.
  std::optional<OpenSearch> open;
  if (!load_case_share()) open.emplace(run, threads_here(), arguments.without, &interrupted());
  LocalWorkers workers(run.folder(), arguments.workers, session);
  const KeptWork kept(run, bench, &interrupted(), open ? open->shared() : nullptr);
  SearchRequest wanted;
  if (open) wanted.begun = [&](int from) { open->begun(from); };
  wanted.options = discover_options();
  wanted.options.diagnosis.without = arguments.without;
  wanted.command = invocation();
  wanted.warn = warn_to(session);
  const Discovery found =
      search_or_say_so_far(run, bench, wanted, kept.from_before(), arguments.run, session);
  if (open) open->end();
  workers.end();
  session.document = run.timeline();
  const auto& steps = run.timeline().at("steps");
  say_answer(run, session);
  session.say("\n{}", steps_table(run.timeline()));
  for (size_t i = 1; i < steps.size(); ++i)
    session.say("{}", choice_table(steps[i - 1], steps[i],
                                   run.timeline().at("floor").at("chi").get<double>(),
                                   *bench.scene->limits, seen_in_words(bench.scene->capture)));
  const Fitted& last = found.steps.back().fitted;
  if (const std::string others = parameter_table(last); !others.empty())
    session.say("\n{}", others);
  if (const auto said = not_converged(last.converged, last.iterations); !said.empty())
    session.warn(said);
  if (const auto& note = found.steps.back().diagnosis.mesh_note; !note.empty())
    session.say("{}", wrapped(note));
  session.say("\n{}",
              wrapped(fmt::format("in detail, {}: {}", to_string(found.verdict), found.sentence)));
  if (const std::string hint = run.timeline().at("hint"); !hint.empty())
    session.say("{}", wrapped(hint));
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
  command
      ->add_option("--workers", arguments->workers,
                   "Processes that help, on this machine; the threads are shared out")
      ->check(counting_number());
  add_limit_options(*command, arguments->set);
  command->callback([&chosen, arguments] {
    chosen = [arguments](Session& session) { run_discover(*arguments, session); };
  });
}

}  // namespace hookeye
