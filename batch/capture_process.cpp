#include "batch/capture_process.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>

#include "batch/finding.h"
#include "batch/obstacles.h"
#include "core/input_error.h"

namespace hookeye {
namespace {

using nlohmann::json;
constexpr double kGrace = 20.0;  // [s] from the request to stop until a process is killed

std::vector<std::string> arguments_of(const BatchFolder& folder, const BatchTask& task,
                                      int threads) {
  const BatchOrder& order = folder.order();
  std::vector<std::string> out = {order.verb, task.capture.string(), "-o",
                                  folder.run_of(task).string()};
  out.insert(out.end(), order.options.begin(), order.options.end());
  out.insert(out.end(), task.options.begin(), task.options.end());
  out.insert(out.end(), {"--json", "--threads", std::to_string(threads)});
  return out;
}

}  // namespace

CaptureProcess::CaptureProcess(const BatchFolder& folder, const WorkOptions& options, Ticket ticket,
                               BatchTask task, json result)
    : folder_(&folder),
      options_(&options),
      ticket_(std::move(ticket)),
      task_(std::move(task)),
      result_(std::move(result)),
      child_(options.program, arguments_of(folder, task_, options.threads),
             folder.log_of(task_, ".json"), folder.log_of(task_, ".txt"), options.memory) {}

CaptureState CaptureProcess::settle(bool stopping) {
  const std::optional<ChildEnd> end = child_.ended();
  if (!end) return CaptureState::running;
  result_["seconds"] = result_.value("seconds", 0.0) + end->seconds;
  result_["cpu_seconds"] = result_.value("cpu_seconds", 0.0) + end->cpu;
  result_["memory"] = std::max(result_.value("memory", 0.0), end->memory);
  if (!reporting_) return settle_capture(*end, stopping);
  settle_report(*end, stopping);
  return CaptureState::finished;
}

CaptureState CaptureProcess::settle_capture(const ChildEnd& end, bool stopping) {
  constexpr int kStopped = 130;
  const bool stopped = end.signal != 0 || end.status == kStopped;
  if (stopped && stopping) return CaptureState::stopped;
  result_["exit"] = end.status;
  if (end.status == 0)
    return add_finding(stopping) ? CaptureState::finished : CaptureState::running;
  result_["error"] = error_line(folder_->log_of(task_, ".json"), folder_->log_of(task_, ".txt"));
  if (timed_out_) {
    result_["error"] = fmt::format("it took longer than {:g} s (--timeout)", options_->timeout);
    return CaptureState::finished;
  }
  if (stopped) {
    signal_ = end.signal ? end.signal : SIGTERM;
    return CaptureState::killed;
  }
  return tells_a_full_disk(result_["error"]) ? CaptureState::no_room : CaptureState::finished;
}

/// False: the run's page is being written first.
bool CaptureProcess::add_finding(bool stopping) {
  if (!makes_run(folder_->order().verb)) {
    result_["finding"] = finding_of_log(folder_->log_of(task_, ".txt"));
    return true;
  }
  const std::filesystem::path run = folder_->run_of(task_);
  try {
    result_["finding"] = finding_of_run(run);
  } catch (const InputError& error) {
    result_["exit"] = 1;
    result_["error"] = error.wrong();
    return true;
  }
  if (!folder_->order().reports || stopping) return true;
  const std::vector<std::string> words = {"report",    run.string(),
                                          "-o",        folder_->report_of(task_).string(),
                                          "--threads", std::to_string(options_->threads)};
  child_ = Child(options_->program, words, "/dev/null", folder_->log_of(task_, ".report.txt"),
                 options_->memory);
  reporting_ = true;
  return false;
}

/// A run stands without its page, too.
void CaptureProcess::settle_report(const ChildEnd& end, bool stopping) const {
  if (end.status != 0 && !stopping && options_->warn)
    options_->warn(fmt::format("{}: no page of its run: {}", task_.label,
                               error_line("", folder_->log_of(task_, ".report.txt"))));
}

void CaptureProcess::look_after(bool stopping) {
  const double lived = child_.seconds();
  if (!reporting_ && options_->timeout > 0.0 && lived > options_->timeout) timed_out_ = true;
  if (stopping_since_ < 0.0 && (stopping || timed_out_)) {
    stopping_since_ = lived;
    child_.stop();
  }
  if (stopping_since_ >= 0.0 && lived > stopping_since_ + kGrace) child_.kill();
}

}  // namespace hookeye
