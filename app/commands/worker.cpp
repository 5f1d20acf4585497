// hookeye worker: helps a running search.
#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands/commands.h"
#include "app/commands/local_workers.h"
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
  WorkerRequest wanted;
  wanted.run = arguments.run;
  wanted.threads = threads_here();
  wanted.wait = arguments.wait;
  wanted.cancel = &interrupted();
  wanted.warn = warn_to(session);
  const WorkerEnd end = work_for_search(wanted);
  session.document = {{"hookeye", 1},           {"command", "worker"},    {"run", arguments.run},
                      {"answers", end.answers}, {"seconds", end.seconds}, {"ended", end.why}};
  if (end.began)
    session.say("worked out {} answers for the search in {} in {:.0f} s: {}\n", end.answers,
                arguments.run, end.seconds, end.why);
  else
    session.say("nothing to do in {}: {}\n", arguments.run, end.why);
}

}  // namespace

void add_worker(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("worker", "Work on a running search, here or where its folder is shared");
  const auto arguments = std::make_shared<WorkerArguments>();
  command->add_option("RUN", arguments->run, "Run folder of the search")->required();
  command
      ->add_option("--wait", arguments->wait, "Seconds to wait for a search to begin, or to go on")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->callback([&chosen, arguments] {
    chosen = [arguments](Session& session) { run_worker(*arguments, session); };
  });
}

}  // namespace hookeye
