// hookeye edit: a capture in the browser, its body over its photos, its faults where they are.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/server/edit_server.h"

namespace hookeye {
namespace {

struct EditArguments {
  std::string capture;
  ServerOptions options;
};

void run_edit(const EditArguments& arguments, Session& session) {
  serve_editor(arguments.capture, arguments.options, [&](const std::string& address) {
    session.document = {{"hookeye", 1}, {"address", address}};
    // Told at once, also with --json: the one document comes only when the editor ends.
    fmt::print(session.json ? stderr : stdout, "{}\n", address);
    session.say(
        "Open this address in a browser. Every change is written into the capture; Ctrl-C ends "
        "it.\n");
    std::fflush(nullptr);
  });
}

}  // namespace

void add_edit(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("edit", "The capture in the browser: body over photos, regions, loads");
  const auto arguments = std::make_shared<EditArguments>();
  command->add_option("CAPTURE", arguments->capture, "capture.yaml or its folder")->required();
  command->add_option("--port", arguments->options.port, "Port (default: any free one)")
      ->check(CLI::Range(1, 65535));
  command->add_option("--host", arguments->options.host,
                      "An address of this machine; all but 127.0.0.1 open it to the network");
  command->callback([&chosen, arguments] {
    chosen = [arguments](Session& session) { run_edit(*arguments, session); };
  });
}

}  // namespace hookeye
