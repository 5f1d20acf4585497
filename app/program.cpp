#include "app/program.h"

#include <spdlog/sinks/ansicolor_sink.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>

#include "app/commands/commands.h"
#include "app/interrupt.h"
#include "app/invocation.h"
#include "app/progress.h"
#include "app/validators.h"
#include "core/input_error.h"
#include "core/memory_left.h"
#include "core/scope.h"
#include "runs/failed.h"
#include "runs/printable.h"
#include "runs/versions.h"

namespace hookeye {
namespace {

/// Log lines on standard error that do not run into the progress bar.
class LogSink : public spdlog::sinks::base_sink<std::mutex> {
  void sink_it_(const spdlog::details::log_msg& message) override {
    Progress::clear_line();
    const std::string text = printable({message.payload.data(), message.payload.size()});
    spdlog::details::log_msg shown = message;
    shown.payload = text;
    out_.log(shown);
  }
  void flush_() override { out_.flush(); }
  void set_pattern_(const std::string& pattern) override { out_.set_pattern(pattern); }
  void set_formatter_(std::unique_ptr<spdlog::formatter> formatter) override {
    out_.set_formatter(std::move(formatter));
  }
  spdlog::sinks::ansicolor_stderr_sink_st out_;
};

void set_up_log(bool verbose) {
  auto logger = std::make_shared<spdlog::logger>("hookeye", std::make_shared<LogSink>());
  logger->set_pattern("%^%l%$: %v");
  logger->set_level(verbose ? spdlog::level::debug : spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

/// The one document of --json.
void print(const nlohmann::ordered_json& document) {
  using nlohmann::ordered_json;
  const std::string text =
      printable(document.dump(2, ' ', false, ordered_json::error_handler_t::replace)) + "\n";
  std::fwrite(text.data(), 1, text.size(), stdout);
}

int report(const Session& session, Exit status, const std::string& kind, const std::string& wrong,
           nlohmann::ordered_json more = nlohmann::ordered_json::object()) {
  Progress::clear_line();
  fmt::print(stderr, "{}\n", printable(wrong));
  if (session.json) {
    more["kind"] = kind;
    more["message"] = wrong;
    print({{"hookeye", 1}, {"exit", static_cast<int>(status)}, {"error", std::move(more)}});
  }
  return status;
}

int report_failure(const Session& session, const NumericalFailure& failure) {
  const std::string where =
      failure.example.empty() ? "" : fmt::format("example {}: ", failure.example);
  const bool no_memory = out_of_memory(failure);
  return report(session, kNumericalFailure, no_memory ? "out of memory" : "numbers failed",
                failure.load_fraction < 1.0 && !no_memory
                    ? fmt::format("{}{}\n  reached {:.4g} of the load", where, failure.reason,
                                  failure.load_fraction)
                    : where + failure.reason,
                {{"example", failure.example},
                 {"load_fraction", failure.load_fraction},
                 {"reason", failure.reason}});
}

int report_input(const Session& session, const InputError& error) {
  return report(session, kBadInput, "bad input", error.what(),
                {{"file", error.place().file},
                 {"line", error.place().line},
                 {"column", error.place().column},
                 {"wrong", error.wrong()},
                 {"right", error.right()}});
}

int run(const CommandBody& body, Session& session) {
  try {
    body(session);
    for (const auto& warning : session.warnings) session.document["warnings"].push_back(warning);
    if (session.json) print(session.document);
    // A buffer that could not be written on the way leaves the error, and nothing to flush.
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
      throw InputError({"standard output"}, "this cannot be written to",
                       "a file on a disk with room, or a pipe that is read to its end");
    return session.status;
  } catch (const InputError& error) {
    return report_input(session, error);
  } catch (const Failed& failed) {
    if (interrupted()) return report(session, kInterrupted, "interrupted", "stopped");
    return report_failure(session, failed.failure);
  } catch (const Interrupted&) {
    return report(session, kInterrupted, "interrupted", "stopped");
  } catch (const std::filesystem::filesystem_error& error) {
    // Of reading or of writing: the library does not say.
    const InputError told({error.path1().string()}, error.code().message(),
                          "a place that is there and open to you, on a disk with room");
    return report_input(session, told);
  } catch (const std::bad_alloc& error) {
    const std::string context = Scope::take_context();
    const auto* told = dynamic_cast<const OutOfMemory*>(&error);
    return report(session, kNumericalFailure, "out of memory",
                  fmt::format("out of memory{}{}{}{}\n  a coarser mesh (`edge`), fewer or smaller "
                              "photos, or a machine with more memory",
                              told ? ": " : "", told ? told->what() : "",
                              context.empty() ? "" : " while working on: ", context));
  } catch (const std::exception& error) {
    const std::string context = Scope::take_context();
    return report(session, kInternal, "internal error",
                  fmt::format("internal error: {}{}{}", error.what(),
                              context.empty() ? "" : "\n  while working on: ", context));
  }
}

/// "did you mean": the nearest name to a word that CLI11 did not take.
std::string hint(const CLI::App& app, const std::vector<std::string>& words) {
  const auto chosen = app.get_subcommands();
  std::vector<std::string> known;
  for (const auto* command : app.get_subcommands({}))
    if (chosen.empty()) known.push_back(command->get_name());
  for (const auto* option : (chosen.empty() ? &app : chosen.front())->get_options())
    for (const auto& name : option->get_lnames()) known.push_back("--" + name);
  for (const auto& word : words) {
    const std::string near = nearest_name(word.substr(0, word.find('=')), known);
    if (!near.empty()) return fmt::format("did you mean {}? ", near);
  }
  return {};
}

/// CLI11 asks for a command where there is a word that is none.
std::string wrong_with(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> words = app.remaining(true);
  const bool a_word = !words.empty() && !words.front().starts_with('-');
  if (app.get_subcommands().empty() && a_word)
    return fmt::format("there is no command `{}`", words.front());
  return error.what();
}

int report_usage(const CLI::App& app, Session& session, const CLI::ParseError& error) {
  const auto chosen = app.get_subcommands();
  const std::string name =
      chosen.empty() ? app.get_name() : app.get_name() + " " + chosen.front()->get_name();
  return report(session, kBadInput, "bad input",
                fmt::format("{}: {}\n  {}{} --help tells what is right", name,
                            wrong_with(app, error), hint(app, app.remaining(true)), name),
                {{"file", ""}, {"line", 0}, {"column", 0}});
}

void add_common_options(CLI::App& command, Session& session) {
  command.add_flag("--json", session.json, "One JSON document on standard output");
  command.add_option("--threads", session.threads, "Cores to use (default: all)")
      ->check(counting_number());
  if (!command.get_option_no_throw("--memory"))  // of a batch it is each capture's
    command
        .add_option("--memory", session.memory,
                    "Memory to use at most, as 4G (default: what is free; for photos half)")
        ->transform(memory_size());
  command.add_flag("-v,--verbose", session.verbose, "More about what is going on");
}

/// Of a process in company: the commands that share their work, each with a folder of its own.
void keep_to(const Company& company, CLI::App& app, std::string& solver) {
  if (company.commands.empty()) return;
  if (!company.solvers.empty()) solver = company.solvers.front();
  for (CLI::App* command : app.get_subcommands({})) {
    if (std::ranges::find(company.commands, command->get_name()) == company.commands.end()) {
      app.remove_subcommand(command);
      continue;
    }
    if (CLI::Option* others = command->get_option_no_throw("--workers"))
      command->remove_option(others);
    if (!company.solvers.empty())
      command->add_option("--solver", solver, "auto, direct or multigrid (default: by memory)")
          ->check(CLI::IsMember(company.solvers));
    if (!company.own_folder) continue;
    for (const char* folder : {"--out", "RUN"})
      if (CLI::Option* option = command->get_option_no_throw(folder))
        option->transform(company.own_folder);
  }
}

int run_program(int argc, char** argv, const Company& company) {
  Session session;
  session.handed_on = take_handed_on(argc, argv);
  CommandBody chosen;
  std::string solver;
  CLI::App app{
      "Finds the elastic model whose pictures match the photos of a soft object,\n"
      "and names the physical effect that the model lacks."};
  app.name(company.name);
  app.set_version_flag("--version", company.name + " " + version_text());
  app.require_subcommand(1);
  app.footer(
      "\nExit status: 0 done, 1 internal error, 2 bad input, 3 the numbers failed,\n"
      "130 stopped by Ctrl-C (all that is finished is kept).");
  for (const AddCommand add : kCommands) add(app, chosen);
  keep_to(company, app, solver);
  add_common_options(app, session);  // people write them before the command, too
  for (CLI::App* command : app.get_subcommands({})) add_common_options(*command, session);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wanted) {
    return app.exit(wanted);
  } catch (const CLI::ParseError& error) {
    // Options are only stored when all of them were understood.
    session.json = std::any_of(argv, argv + argc, [](std::string_view a) { return a == "--json"; });
    return report_usage(app, session, error);
  }
  set_up_log(session.verbose);
  set_memory_limit(session.memory);
  auto threads = static_cast<size_t>(session.threads > 0 ? session.threads : company.threads);
  if (threads == 0)
    threads = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  if (company.begins) company.begins(static_cast<int>(threads));
  return run(
      [&](Session& told) {
        if (company.solve_by) company.solve_by(solver);
        chosen(told);
      },
      session);
}

}  // namespace

int program(int argc, char** argv, const Company& company) {
  remember_invocation(argc, argv);
  try {
    return run_program(argc, argv, company);
  } catch (const std::exception& error) {
    fmt::print(stderr, "internal error: {}\n", printable(error.what()));
    return kInternal;
  }
}

void leave_at_once(int status) {
  std::fflush(nullptr);
  std::_Exit(status);
}

}  // namespace hookeye
