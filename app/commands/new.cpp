// hookeye new: a capture proposed from what lies in a folder, asking what no file tells.
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "app/commands/check.h"
#include "app/commands/commands.h"
#include "core/scope.h"
#include "proposal/proposal.h"

namespace hookeye {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

struct NewCommand {
  std::string folder, out;
  std::vector<std::string> told;  ///< NAME=VALUE
  bool yes = false, force = false, no_check = false;
};

Questions::Answers answers_of(const std::vector<std::string>& told) {
  Questions::Answers out;
  for (const std::string& one : told) {
    const size_t equals = one.find('=');
    if (equals == std::string::npos || equals == 0)
      throw InputError({"--set " + one}, "this has no name and value", "--set NAME=VALUE");
    out[one.substr(0, equals)] = one.substr(equals + 1);
  }
  return out;
}

/// Where the capture goes: a folder, or a yaml file of any name.
fs::path capture_file(const NewCommand& options) {
  std::error_code error;
  fs::path file = options.out.empty() ? fs::path(options.folder) : fs::path(options.out);
  const std::string ending = file.extension().string();
  const bool named = !options.out.empty() && (ending == ".yaml" || ending == ".yml");
  if (!named) file /= "capture.yaml";
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error))
    throw InputError({folder.string()}, "there is no such folder",
                     "leave -o out, or name the folder of the photos or one above it");
  return fs::canonical(folder, error) / file.filename();
}

std::string question_line(const CaptureQuestion& question) {
  std::string line = question.text;
  if (!question.choices.empty()) line += fmt::format(": {}", fmt::join(question.choices, ", "));
  if (!question.why.empty()) line += fmt::format(" ({})", question.why);
  return line;
}

/// The open questions, each with the option that answers it.
std::string listed(const std::vector<CaptureQuestion>& questions) {
  std::string out;
  for (const CaptureQuestion& one : questions) {
    if (!out.empty()) out += "\n  ";
    out += fmt::format("--set {}={}\n      {}", one.name,
                       one.standard.empty() ? "..." : one.standard, question_line(one));
  }
  return out;
}

[[noreturn]] void refuse_unanswered(const NewCommand& options,
                                    const std::vector<CaptureQuestion>& questions, bool defaults) {
  throw InputError(
      {options.folder},
      fmt::format("no file tells {}",
                  questions.size() == 1 ? "one thing" : fmt::format("{} things", questions.size())),
      (defaults ? "--yes takes what stands here, --set another:\n  "
                : "these have no default:\n  ") +
          listed(questions));
}

/// Asks each open question on the terminal; false: the input ended.
bool prompt(const std::vector<CaptureQuestion>& questions, Questions::Answers& answers) {
  for (const CaptureQuestion& one : questions) {
    std::string line;
    do {
      fmt::print("{}{}: ", wrapped(one.name + ": " + question_line(one)),
                 one.standard.empty() ? "  " : fmt::format("  [{}]", one.standard));
      std::fflush(stdout);
      if (!std::getline(std::cin, line)) return false;
      if (line.empty()) line = one.standard;
    } while (line.empty());
    answers[one.name] = line;
  }
  return true;
}

/// Proposes until nothing is open: answers may raise further questions. An answer that cannot be
/// is asked for again.
Proposal settled(const Inventory& inventory, const NewCommand& options, const fs::path& file,
                 bool terminal) {
  Questions::Answers answers = answers_of(options.told);
  Proposal proposal = propose(inventory, answers, file);
  while (terminal && !options.yes && !proposal.open.empty()) {
    Questions::Answers more = answers;
    if (!prompt(proposal.open, more)) break;
    try {
      proposal = propose(inventory, more, file);
      answers = std::move(more);
    } catch (const InputError& error) {
      if (!error.place().file.starts_with("--set ")) throw;
      fmt::print("{}\n", error.what());
    }
  }
  if (!options.yes && !proposal.open.empty()) refuse_unanswered(options, proposal.open, true);
  if (!proposal.needed.empty()) refuse_unanswered(options, proposal.needed, false);
  return proposal;
}

Json describe(const Inventory& inventory, const Proposal& proposal, const fs::path& file) {
  Json d = {{"hookeye", 1}, {"command", "new"}, {"file", file.string()}};
  d["photos"] = Json::array();
  for (const PhotoSeries& one : inventory.series)
    d["photos"].push_back(
        {{"camera", one.camera}, {"scheme", one.scheme}, {"count", one.photos.size()}});
  d["cameras"] = proposal.cameras;
  d["pairing"] = proposal.pairing;
  const auto photo = [&](const std::string& name, const PairedPhoto& at, const char* use) {
    Json one{{"name", name},      {"photo", at.number},  {"line", at.line},
             {"force", at.force}, {"travel", at.travel}, {"use", use}};
    if (proposal.timed) one["time"] = at.time;
    return one;
  };
  d["cases"] = {photo("rest", proposal.cases.rest, "fit")};
  for (const LoadCase& one : proposal.cases.loads)
    d["cases"].push_back(photo(one.name, one.photo, one.held_out ? "validate" : "fit"));
  d["questions"] = Json::array();
  for (const CaptureQuestion& one : proposal.questions)
    d["questions"].push_back({{"name", one.name},
                              {"asked", one.asked},
                              {"default", one.standard},
                              {"answer", one.answer},
                              {"from", one.answered ? "told" : one.why}});
  d["said"] = proposal.said;
  return d;
}

void say(const Inventory& inventory, const Proposal& proposal, const Session& session) {
  std::vector<std::vector<std::string>> rows{{"camera", "photos", "called"}};
  for (const PhotoSeries& one : inventory.series)
    rows.push_back({one.camera, std::to_string(one.photos.size()), one.scheme});
  session.say("{}", table(rows));
  session.say("{}", wrapped("cameras by " + proposal.cameras));
  session.say("{}", wrapped("photos and rows are paired " + proposal.pairing));
  rows = {{"load case", "photo", "line", "time s", "force N", "travel mm", "use"}};
  const auto row = [&](const std::string& name, const PairedPhoto& photo, const char* use) {
    rows.push_back({name, std::to_string(photo.number), std::to_string(photo.line),
                    proposal.timed ? fmt::format("{:.2f}", photo.time) : "-",
                    fmt::format("{:.4g}", photo.force), fmt::format("{:.4g}", photo.travel), use});
  };
  row("rest", proposal.cases.rest, "fit");
  for (const LoadCase& one : proposal.cases.loads)
    row(one.name, one.photo, one.held_out ? "validate" : "fit");
  session.say("\n{}\n", table(rows));
  for (const std::string& said : proposal.said) session.say("{}", wrapped(said));
  rows = {{"--set", "taken", "from"}};
  for (const CaptureQuestion& one : proposal.questions)
    if (one.asked || one.answered)
      rows.push_back({one.name, one.answer, one.answered ? "told" : one.why});
  session.say("\n{}", table(rows));
}

void run_new(const NewCommand& options, Session& session) {
  const Scope scope("folder " + options.folder);
  const Inventory inventory = look_at(options.folder);
  const fs::path file = capture_file(options);
  if (std::error_code error; fs::exists(file, error) && !options.force)
    throw InputError({file.string()}, "there is a capture already",
                     "--force writes over it; -o FOLDER/other.yaml writes another beside it");
  const bool terminal = !session.json && ::isatty(STDIN_FILENO) && ::isatty(STDOUT_FILENO);
  const Proposal proposal = settled(inventory, options, file, terminal);
  store(proposal, file, options.force);
  Json document = describe(inventory, proposal, file);
  say(inventory, proposal, session);
  session.say("\nwritten to {}\n", file.string());
  if (!options.no_check) {
    session.say("\nhookeye check {}\n", file.string());
    session.document = Json::object();
    check_capture(file.string(), "", session);
    document["check"] = std::move(session.document);
  }
  session.document = std::move(document);
}

}  // namespace

void add_new(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("new", "A capture from a folder of photos, calibration, mesh and CSV");
  const auto options = std::make_shared<NewCommand>();
  command->add_option("FOLDER", options->folder, "Where all of it lies")->required();
  command->add_option("-o,--out", options->out,
                      "Folder or yaml file of the capture, in FOLDER or above");
  command->add_flag("-y,--yes", options->yes, "Ask nothing, take the defaults");
  command->add_option("--set", options->told, "Answers a question; may be given again")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  command->add_flag("--force", options->force, "Write over a capture that is there");
  command->add_flag("--no-check", options->no_check, "Without looking at the photos at the end");
  command->callback(
      [&chosen, options] { chosen = [options](Session& session) { run_new(*options, session); }; });
}

}  // namespace hookeye
