// hookeye batch: one verb over many captures, a process each; several batches share a folder.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "app/commands/batch_report.h"
#include "app/commands/commands.h"
#include "app/commands/slurm.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/validators.h"
#include "batch/batch_index.h"
#include "batch/batch_program.h"
#include "batch/enrolment.h"
#include "core/fingerprint.h"
#include "core/own_file.h"
#include "runs/versions.h"

namespace hookeye {
namespace {

struct BatchArguments {
  std::vector<std::string> list;
  std::string out, resume, verb = "discover", slurm;
  int jobs = 0;
  double memory = 0.0, timeout = 0.0;
  bool retry = false, no_reports = false, worker = false, status = false, verbs = false;
};

/// Options that a batch gives to the verb itself.
bool is_ours(const std::string& name) {
  for (const char* own : {"out", "json", "threads", "help", "options"})
    if (name == own) return true;
  return false;
}

KindOfOption kind_in(const CLI::App& verb) {
  return [&verb](const std::string& name) {
    const CLI::Option* option = is_ours(name) ? nullptr : verb.get_option_no_throw("--" + name);
    if (!option) return OptionKind::unknown;
    return option->get_items_expected_max() == 0 ? OptionKind::flag : OptionKind::valued;
  };
}

/// What stands behind `--` is the verb's: told now, not by every capture.
void check_handed_on(const CLI::App& verb, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    const bool is_long = word.starts_with("--");
    if (!word.starts_with('-') || (!is_long && word.size() > 1 && !std::isalpha(word[1]))) continue;
    const std::string name = word.substr(0, is_long ? word.find('=') : 2);
    if (!is_ours(name.substr(is_long ? 2 : 1)) && name != "-o" && name != "-h" &&
        verb.get_option_no_throw(name))
      continue;
    throw InputError({"hookeye batch"},
                     fmt::format("`{}` is no option of `hookeye {}` that a batch can hand on", name,
                                 verb.get_name()),
                     fmt::format("`hookeye {} --help` names them; --threads stands before the `--`",
                                 verb.get_name()));
  }
}

BatchFolder folder_for(const BatchArguments& arguments, const Session& session,
                       const std::filesystem::path& program) {
  const std::string mark = fingerprint_of_file(program);
  if (!arguments.resume.empty()) {
    BatchFolder folder = BatchFolder::open(arguments.resume);
    if (folder.order().program != mark && !arguments.status)
      throw InputError({arguments.resume},
                       fmt::format("this batch was begun by another program, {} (this is {})",
                                   folder.order().version, version_text()),
                       "that program, or all captures anew in a new folder");
    return folder;
  }
  return BatchFolder::make(arguments.out, {arguments.verb, session.handed_on, mark, version_text(),
                                           makes_run(arguments.verb) && !arguments.no_reports});
}

void work_here(const BatchFolder& folder, const BatchArguments& arguments,
               const std::vector<std::string>& keys, const std::filesystem::path& program,
               Session& session) {
  const BatchCounts before = count(folder, keys);
  WorkOptions work;
  work.program = program;
  work.keys = keys;
  work.wait_for_others = !arguments.worker;
  work.cancel = &interrupted();
  work.timeout = arguments.timeout;
  share_machine({arguments.jobs, session.threads, arguments.memory}, before.todo + before.running,
                work);
  Progress progress("batch", before.all());
  work.progress = [&](const BatchCounts& now) {
    std::string note = fmt::format("{} at work", now.running);
    if (now.failed) note += fmt::format(", {} failed", now.failed);
    progress.set(now.done + now.failed, now.all(), note);
  };
  work.warn = [&](const std::string& sentence) { session.warn(sentence); };
  arguments.worker ? work_on(folder, work) : work_and_index(folder, work);
}

std::vector<std::string> enrol_all(const BatchFolder& folder,
                                   const std::vector<ListedCapture>& list, Session& session) {
  Progress progress("reading", static_cast<int>(list.size()));
  EnrolOptions options;
  options.cancel = &interrupted();
  options.progress = [&](const std::string& label) { progress.advance(label); };
  options.warn = [&](const std::string& sentence) { session.warn(sentence); };
  return enrol(folder, list, options);
}

/// What each verb may be told here, for who starts this program: Python.
BatchProgram own_program(const CLI::App& app) {
  BatchProgram out{own_file(), version_text(), {}};
  for (const std::string& name : batch_verbs()) {
    const CLI::App& verb = *app.get_subcommand(name);
    const KindOfOption kind_of = kind_in(verb);
    for (const CLI::Option* option : verb.get_options())
      for (const std::string& word : option->get_lnames())
        if (const OptionKind kind = kind_of(word); kind != OptionKind::unknown)
          out.verbs[name][word] = kind;
  }
  return out;
}

void run_batch(const BatchArguments& arguments, const CLI::App& app, Session& session) {
  const std::filesystem::path program = own_file();
  if (arguments.verbs) {
    session.document = to_json(own_program(app));
    return;
  }
  std::vector<ListedCapture> list;
  if (arguments.resume.empty()) {
    const CLI::App& verb = *app.get_subcommand(arguments.verb);
    check_handed_on(verb, session.handed_on);
    list = read_capture_list(arguments.list, kind_in(verb));
  }
  const BatchFolder folder = folder_for(arguments, session, program);
  const std::vector<std::string> keys =
      list.empty() ? std::vector<std::string>() : enrol_all(folder, list, session);
  if (arguments.retry) try_failed_again(folder, keys);
  if (!arguments.slurm.empty()) {
    send_to_slurm(folder,
                  {arguments.slurm, program, arguments.jobs, session.threads, arguments.memory,
                   arguments.timeout},
                  session);
    return;
  }
  if (!arguments.status) work_here(folder, arguments, keys, program, session);
  const BatchCounts now = count(folder, keys);
  if (arguments.worker && now.todo + now.running > 0) {
    session.document = {{"hookeye", 1}, {"command", "batch"}, {"folder", folder.path().string()}};
    session.say("nothing is left to take up; at work elsewhere: {}\n", now.running);
    return;
  }
  const std::vector<nlohmann::json> rows = batch_rows(folder, keys);
  if (arguments.status || arguments.worker) write_index(folder, rows);
  report_batch(folder, rows, session);
}

}  // namespace

void add_batch(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("batch", "A verb over many captures, a process each; resumes a batch");
  command->footer("\nOptions of the verb stand at the end: -- --without creep" +
                  command->get_footer());
  const auto arguments = std::make_shared<BatchArguments>();
  CLI::Option* list =
      command->add_option("CAPTURES", arguments->list,
                          "Captures, folders above them, patterns in quotes, lists, tables (csv)");
  CLI::Option* out = command->add_option("-o,--out", arguments->out, "Folder of the batch");
  CLI::Option* resume =
      command->add_option("--resume", arguments->resume, "Go on with all that this folder holds");
  list->needs(out);
  out->needs(list);
  resume->excludes(list)->excludes(out);
  command->add_option("--verb", arguments->verb, "What each capture is given to")
      ->check(CLI::IsMember(batch_verbs()))
      ->capture_default_str()
      ->excludes(resume);
  command->add_option("--jobs", arguments->jobs, "Captures at once (default: as cores allow)")
      ->check(counting_number());
  command->add_option("--memory", arguments->memory, "Most that one capture may take: 4GB")
      ->transform(CLI::AsSizeValue(true));
  command->add_option("--timeout", arguments->timeout, "Seconds that one capture may take")
      ->check(above_zero());
  command->add_flag("--retry", arguments->retry, "Try again what has failed");
  command->add_flag("--no-reports", arguments->no_reports, "No page of every run");
  command->add_flag("--status", arguments->status, "Only tell how far it is, and write the index");
  command->add_flag("--worker", arguments->worker, "Leave where nothing waits any more")
      ->needs(resume);
  command->add_flag("--verbs", arguments->verbs, "Which options each verb has")->group("");
  command->add_option("--slurm", arguments->slurm,
                      "Send a job array of --jobs workers, with these options of sbatch");
  command->callback([&chosen, &app, arguments, list, resume] {
    if (!list->count() && !resume->count() && !arguments->verbs)
      throw CLI::RequiredError("CAPTURES with -o, or --resume");
    chosen = [&app, arguments](Session& session) { run_batch(*arguments, app, session); };
  });
}

}  // namespace hookeye
