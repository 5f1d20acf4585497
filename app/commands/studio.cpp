// hookeye studio: the page of a run live in the browser, with Add buttons and progress.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/server/studio_server.h"

namespace hookeye {
namespace {

struct StudioArguments {
  std::string run;
  ServerOptions options;
};

void run_studio(const StudioArguments& arguments, Session& session) {
  serve_studio(arguments.run, arguments.options, [&](const std::string& address) {
    session.document = {{"hookeye", 1}, {"address", address}};
    // Told at once, also with --json: the one document comes only when the studio ends.
    fmt::print(session.json ? stderr : stdout, "{}\n", address);
    session.say(
        "Open this address in a browser. It is good for this studio alone; Ctrl-C ends it.\n");
    std::fflush(nullptr);
  });
}

}  // namespace

void add_studio(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand(
      "studio", "The page of a run live in the browser, with Add buttons and progress");
  const auto arguments = std::make_shared<StudioArguments>();
  command->add_option("RUN", arguments->run, "Run folder")->required();
  command->add_option("--port", arguments->options.port, "Port (default: any free one)")
      ->check(CLI::Range(1, 65535));
  command->add_option("--host", arguments->options.host,
                      "An address of this machine; all but 127.0.0.1 open it to the network");
  command->callback([&chosen, arguments] {
    chosen = [arguments](Session& session) { run_studio(*arguments, session); };
  });
}

}  // namespace hookeye
