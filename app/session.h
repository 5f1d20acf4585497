// What one command is told by the shell and hands back to it.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "runs/printable.h"
#include "runs/text.h"

namespace CLI {
class App;
}

namespace hookeye {

/// Commands fill `document`, which is printed with --json, and say() lines for people, which are
/// printed without (printable: they quote files). Warnings go through warn(): standard error and,
/// at the end, the document's "warnings".
struct Session {
  bool json = false;
  bool verbose = false;
  int threads = 0;      ///< 0: all cores
  double memory = 0.0;  ///< [bytes] at most; 0: as memory_budget() says
  /// What stands behind `--` on the command line, for a command that hands it on.
  std::vector<std::string> handed_on;
  int status = 0;  ///< exit status of work that was done and in which something failed
  nlohmann::ordered_json document;
  std::vector<std::string> warnings;

  template <class... Args>
  void say(fmt::format_string<Args...> format, Args&&... args) const {
    if (!json) fmt::print("{}", printable(fmt::format(format, std::forward<Args>(args)...)));
  }
  void warn(const std::string& sentence);
};

using CommandBody = std::function<void(Session&)>;
/// Adds a subcommand whose callback sets `chosen`.
using AddCommand = void (*)(CLI::App& app, CommandBody& chosen);

}  // namespace hookeye
