#include "app/commands/local_workers.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "core/own_file.h"
#include "runs/shared_search.h"

namespace hookeye {
namespace {

constexpr double kPatience = 20.0;  // [s] from the search's end until a worker is killed

std::string last_line_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string last;
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) last = line;
  return last;
}

}  // namespace

int threads_here() {
  return static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

LocalWorkers::LocalWorkers(const std::filesystem::path& run, int count, Session& session)
    : folder_(workers_folder(run)), session_(session) {
  if (count <= 0) return;
  const int threads = threads_here();
  std::vector<std::string> words = {"worker", run.string(), "--threads", std::to_string(threads)};
  if (session.memory > 0.0)
    words.insert(words.end(), {"--memory", fmt::format("{:.0f}", session.memory)});
  for (int i = 0; i < count; ++i)
    children_.emplace_back(own_file(), words, "/dev/null", log_of(children_.size()), 0.0);
  spdlog::info("workers: {} beside this process; {} threads are shared out among those at work",
               count, threads);
}

std::filesystem::path LocalWorkers::log_of(size_t worker) const {
  return folder_ / fmt::format("worker-{}.txt", worker + 1);
}

void LocalWorkers::end() {
  const auto began = std::chrono::steady_clock::now();
  for (size_t i = 0; i < children_.size();) {
    const auto ended = children_[i].ended();
    if (ended && ended->status != 0)
      session_.warn(fmt::format("a worker ended with exit status {}: {}", ended->status,
                                last_line_of(log_of(i))));
    const double waited =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    if (ended || waited > kPatience)
      ++i;
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  children_.clear();  // and kills those that are left
}

}  // namespace hookeye
