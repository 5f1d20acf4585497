#include "app/commands/local_workers.h"

#include <algorithm>
#include <fstream>
#include <thread>

#include "core/own_file.h"

namespace hookeye {

namespace {

std::filesystem::path log_of(const ScratchFolder& logs, size_t worker) {
  return logs.path() / fmt::format("{}.txt", worker);
}

}  // namespace

LocalWorkers::LocalWorkers(int count, const std::filesystem::path& run, const Session& session) {
  if (count == 0) return;
  logs_.emplace("workers");
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const int threads = session.threads > 0 ? session.threads : std::max(1, cores / (count + 1));
  for (int i = 0; i < count; ++i)
    workers_.emplace_back(
        own_file(),
        std::vector<std::string>{"worker", run.string(), "--threads", std::to_string(threads)},
        "/dev/null", log_of(*logs_, workers_.size()), 0.0);
}

void LocalWorkers::tell_failures(Session& session) {
  for (size_t i = 0; i < workers_.size(); ++i) {
    const auto end = workers_[i].ended();
    if (!end || end->status == 0) continue;
    std::ifstream log(log_of(*logs_, i));
    std::string line;
    std::getline(log, line);
    session.warn(fmt::format("worker {} ended with exit status {}: {}", i + 1, end->status, line));
  }
}

}  // namespace hookeye
