// hookeye worker: help for a search that runs in another process, here or on another machine.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/commands/run_support.h"
#include "app/interrupt.h"
#include "app/validators.h"
#include "runs/search_worker.h"

namespace hookeye {
namespace {

struct WorkerArguments {
  std::string run;
  double wait = 60.0;
};

void run_worker(const WorkerArguments& arguments, Session& session) {
  const Helped helped = help_search(arguments.run, {arguments.wait, &interrupted()});
  session.document = {{"hookeye", 1},
                      {"command", "worker"},
                      {"run", arguments.run},
                      {"tasks", helped.tally.tasks},
                      {"seconds", helped.tally.seconds},
                      {"ended", helped.ended}};
  session.say("{}: {} tasks worked out here, in {:.0f} s\n",
              helped.ended ? "the search has ended" : "the search has gone, and did not come back",
              helped.tally.tasks, helped.tally.seconds);
}

}  // namespace

void add_worker(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand(
      "worker", "Help the search of a run, from any machine that sees its folder");
  const auto arguments = std::make_shared<WorkerArguments>();
  command->add_option("RUN", arguments->run, "Run folder of `hookeye discover`")->required();
  command
      ->add_option("--wait", arguments->wait,
                   "Seconds to wait for the search to begin, or to be taken up again")
      ->check(above_zero())
      ->capture_default_str();
  command->callback([&chosen, arguments] {
    chosen = [arguments](Session& session) { run_worker(*arguments, session); };
  });
}

}  // namespace hookeye
