#include "python/log.h"

#include <pybind11/pybind11.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "runs/printable.h"

namespace hookeye {
namespace {

namespace py = pybind11;

struct Line {
  int level;  ///< of `logging`
  std::string text;
};

/// A thread that logs never waits for the interpreter.
class KeptLines : public spdlog::sinks::base_sink<std::mutex> {
 public:
  std::vector<Line> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(lines_, {});
  }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const int level = message.level >= spdlog::level::critical ? 50
                      : message.level == spdlog::level::err    ? 40
                      : message.level == spdlog::level::warn   ? 30
                      : message.level == spdlog::level::info   ? 20
                                                               : 10;
    lines_.push_back({level, printable({message.payload.data(), message.payload.size()})});
  }
  void flush_() override {}

  std::vector<Line> lines_;
};

const std::shared_ptr<KeptLines>& kept_lines() {
  static const auto lines = std::make_shared<KeptLines>();
  return lines;
}

py::object logger() { return py::module_::import("logging").attr("getLogger")("hookeye"); }

}  // namespace

void keep_log() {
  auto all = std::make_shared<spdlog::logger>("hookeye", kept_lines());
  all->set_level(spdlog::level::info);
  spdlog::set_default_logger(std::move(all));
}

void follow_level() {
  constexpr int kDebug = 10;
  const bool wanted = logger().attr("isEnabledFor")(kDebug).cast<bool>();
  spdlog::default_logger()->set_level(wanted ? spdlog::level::debug : spdlog::level::info);
}

void drain_log() {
  const std::vector<Line> lines = kept_lines()->take();
  if (lines.empty()) return;
  const py::object log = logger().attr("log");
  for (const Line& line : lines) log(line.level, "%s", line.text);
}

}  // namespace hookeye
