#include "batch/enrolment.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <thread>

#include "batch/batch_index.h"
#include "core/interrupted.h"
#include "core/memory_left.h"
#include "sharing/heartbeat.h"

namespace hookeye {
namespace {

/// What the folder holds already of each capture and its options.
using Known = std::map<std::pair<std::string, std::vector<std::string>>, std::vector<std::string>>;

Known known_in(const BatchFolder& folder) {
  Known out;
  for (const std::string& key : folder.keys()) {
    const BatchTask task = folder.task(key);
    out[{task.capture.string(), task.options}].push_back(key);
  }
  return out;
}

}  // namespace

std::vector<std::string> enrol(const BatchFolder& folder, const std::vector<ListedCapture>& list,
                               const EnrolOptions& options) {
  const Heartbeat beating(folder.beats(), {});
  const Known known = known_in(folder);
  std::map<std::string, std::string> seen;  // capture, by key
  std::vector<std::string> keys;
  for (const ListedCapture& one : list) {
    if (options.cancel && options.cancel->load()) throw Interrupted{};
    BatchTask task{"", one.label, one.capture, one.options, ""};
    set_key(task, folder.order());
    const auto [same, first] = seen.try_emplace(task.key, one.capture.string());
    if (!first) {
      if (same->second != one.capture.string() && options.warn)
        options.warn(fmt::format("{} has the same content as {}: it is worked on once",
                                 one.capture.string(), same->second));
      continue;
    }
    if (!folder.enrol(task, beating.worker()) &&
        !std::filesystem::exists(folder.task(task.key).capture))
      folder.set_capture(task.key, task.capture);
    if (const auto found = known.find({task.capture.string(), task.options}); found != known.end())
      for (const std::string& other : found->second) folder.set_past(other, other != task.key);
    keys.push_back(task.key);
    if (options.progress) options.progress(one.label);
  }
  return keys;
}

void try_failed_again(const BatchFolder& folder, const std::vector<std::string>& keys) {
  for (const Ticket& ticket : folder.tickets().at(TicketPlace::failed)) {
    if (!keys.empty() && std::find(keys.begin(), keys.end(), ticket.key) == keys.end()) continue;
    if (folder.tickets().move(ticket, TicketPlace::failed, {ticket.key, 0, ""}, TicketPlace::todo))
      folder.drop_result(ticket);
  }
}

void share_machine(const MachineShare& wanted, int open, WorkOptions& work) {
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  int jobs = wanted.jobs;
  if (jobs == 0) {
    jobs = std::max(1, std::min(open, cores / std::max(1, wanted.threads)));
    if (wanted.memory > 0.0)
      jobs = std::clamp(static_cast<int>(memory_left().bytes / wanted.memory), 1, jobs);
  }
  work.jobs = jobs;
  work.threads = wanted.threads > 0 ? wanted.threads : std::max(1, cores / jobs);
  work.memory = wanted.memory;
}

void work_and_index(const BatchFolder& folder, const WorkOptions& work) {
  try {
    work_on(folder, work);
  } catch (const Interrupted&) {
    write_index(folder, batch_rows(folder, work.keys));
    throw;
  }
  write_index(folder, batch_rows(folder, work.keys));
}

}  // namespace hookeye
