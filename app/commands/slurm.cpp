#include "app/commands/slurm.h"

#include <sys/wait.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

#include "app/invocation.h"
#include "batch/batch_worker.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

constexpr int kMostWorkers = 16;  // where --jobs does not tell

/// The program takes the script's place, so that Slurm's signals reach it.
std::string script_of(const BatchFolder& folder, const SlurmRequest& request) {
  std::string command =
      fmt::format("exec {} batch --resume {} --worker --jobs 1",
                  shell_word(request.program.string()), shell_word(folder.path().string()));
  if (request.threads > 0) command += fmt::format(" --threads {}", request.threads);
  if (request.memory > 0.0) command += fmt::format(" --memory {:.0f}", request.memory);
  if (request.timeout > 0.0) command += fmt::format(" --timeout {:g}", request.timeout);
  return "#!/bin/sh\n# A worker of this batch, begun by a job array (hookeye batch --slurm).\n" +
         command + "\n";
}

struct ShellAnswer {
  int status = 0;
  std::string text;
};

ShellAnswer ask_shell(const std::string& command) {
  ShellAnswer out;
  std::FILE* const pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (!pipe) return {127, "no shell"};
  char some[512];
  while (std::fgets(some, sizeof some, pipe)) out.text += some;
  const int status = ::pclose(pipe);
  out.status = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
  while (!out.text.empty() && out.text.back() == '\n') out.text.pop_back();
  return out;
}

}  // namespace

void send_to_slurm(const BatchFolder& folder, const SlurmRequest& request, Session& session) {
  const int open = count(folder, {}).todo + count(folder, {}).running;
  session.document = {{"hookeye", 1}, {"command", "batch"}, {"folder", folder.path().string()}};
  if (open == 0) {
    session.say("nothing is left to do\n");
    return;
  }
  const int workers = std::min(open, request.jobs > 0 ? request.jobs : kMostWorkers);
  const std::filesystem::path script = folder.path() / "slurm.sh";
  write_text(script, script_of(folder, request));
  // A minute before the time limit a worker is asked to stop, and hands back what it has in hand.
  std::string command = fmt::format(
      "sbatch --parsable --array=1-{} --job-name=hookeye-batch --requeue --open-mode=append "
      "--signal=B:TERM@60 --output={}",
      workers, shell_word((folder.path() / "logs" / "slurm-%A_%a.txt").string()));
  if (request.threads > 0) command += fmt::format(" --cpus-per-task={}", request.threads);
  for (const std::string& word : CLI::detail::split_up(request.options))
    command += " " + shell_word(word);
  const ShellAnswer answer = ask_shell(command + " " + shell_word(script.string()));
  constexpr int kNoSuchProgram = 127;
  if (answer.status == kNoSuchProgram)
    throw InputError({"--slurm"}, "there is no program sbatch here",
                     "a machine of the cluster that sends jobs, or the command without --slurm");
  if (answer.status != 0)
    throw InputError({"--slurm"}, "sbatch refuses: " + answer.text,
                     "options that `sbatch --help` names, as in --slurm '--partition=long'");
  session.document["slurm"] = {{"job", answer.text}, {"workers", workers}};
  session.say("sent: job {} with {} workers for {} captures\n", answer.text, workers, open);
  session.say("{}", wrapped(fmt::format("`hookeye batch --resume {} --status` tells how far it is",
                                        folder.path().string())));
}

}  // namespace hookeye
