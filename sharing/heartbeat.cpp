#include "sharing/heartbeat.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <fstream>
#include <mutex>
#include <random>
#include <sstream>
#include <thread>

#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

constexpr double kEndedFor = 1.0;  // [s] before a process that is there no more counts as gone

std::string first_line_of(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line.empty() ? "-" : line;
}

/// The boot of the machine and the name space of its processes: the same process number means the
/// same process where both are the same. Containers on one machine differ in the second.
const std::string& process_space() {
  static const std::string here = [] {
    std::error_code failed;
    const fs::path names = fs::read_symlink("/proc/self/ns/pid", failed);
    return first_line_of("/proc/sys/kernel/random/boot_id") + " " + (failed ? "-" : names.string());
  }();
  return here;
}

/// When the process began, in ticks since the boot; "": there is none, or it has ended and was not
/// asked for yet.
std::string began(long process) {
  std::string line = first_line_of(fmt::format("/proc/{}/stat", process));
  const size_t behind_name = line.rfind(')');
  if (behind_name == std::string::npos) return {};
  std::istringstream fields(line.substr(behind_name + 1));
  std::string state, field;
  fields >> state;
  constexpr int kStarted = 22, kState = 3;  // proc(5)
  for (int i = kState; i < kStarted && fields; ++i) fields >> field;
  return state == "Z" || state == "X" ? "" : field;
}

std::string host_name() {
  char name[256] = "";
  ::gethostname(name, sizeof name - 1);
  std::string out;
  for (const char* c = name; *c; ++c)
    if (std::isalnum(static_cast<unsigned char>(*c)) || *c == '-') out += *c;
  return out.empty() ? "host" : out.substr(0, 60);
}

std::string new_worker_name() {
  return fmt::format("{}-{}-{:08x}", host_name(), ::getpid(), std::random_device{}());
}

}  // namespace

struct Heartbeat::Impl {
  fs::path file;
  std::string name;
  int handle = -1;
  unsigned long count = 0;
  std::mutex mutex;
  std::condition_variable woken;
  bool ended = false;
  std::thread thread;

  /// In place, in as many bytes as before: it takes no room on a full disk.
  void beat() {
    const std::string text = fmt::format("{:020}\n", ++count);
    // What cannot be written is not seen by others, and the lease is theirs in the end.
    [[maybe_unused]] const auto written = ::pwrite(handle, text.data(), text.size(), 0);
    ::fsync(handle);
  }
  void run(double every) {
    std::unique_lock lock(mutex);
    while (!woken.wait_for(lock, std::chrono::duration<double>(every), [&] { return ended; }))
      beat();
  }
};

Heartbeat::Heartbeat(const fs::path& folder, const BeatTimes& times)
    : impl_(std::make_unique<Impl>()) {
  impl_->name = new_worker_name();
  impl_->file = folder / impl_->name;
  write_text(impl_->file, beat_text(0, process_space(), ::getpid(), began(::getpid())));
  impl_->handle = ::open(impl_->file.c_str(), O_WRONLY | O_CLOEXEC);
  if (impl_->handle < 0) throw cannot_write(impl_->file.string(), std::strerror(errno));
  impl_->thread = std::thread([this, every = times.beat] { impl_->run(every); });
}

Heartbeat::~Heartbeat() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->ended = true;
  }
  impl_->woken.notify_all();
  impl_->thread.join();
  ::close(impl_->handle);
  std::error_code ignored;
  fs::remove(impl_->file, ignored);
}

const std::string& Heartbeat::worker() const { return impl_->name; }

std::string beat_text(unsigned long count, const std::string& machine, long process,
                      const std::string& began) {
  return fmt::format("{:020}\n{} {} {}\n", count, machine, process, began);
}

WorkerWatch::WorkerWatch(std::shared_ptr<SharedFolder> folder, const BeatTimes& times)
    : folder_(std::move(folder)), times_(times) {}

bool WorkerWatch::gone(const std::string& worker) {
  const std::string text = folder_->read("beats/" + worker).value_or("");
  const double now = folder_->seconds();
  const auto [place, first] = seen_.try_emplace(worker, Seen{text, now, false, false});
  Seen& seen = place->second;
  std::istringstream lines(text);
  std::string count, boot, names, process, its_begin;
  lines >> count >> boot >> names >> process >> its_begin;
  const bool here = boot + " " + names == process_space() && boot != "-" && names != "-";
  if (here && !its_begin.empty()) {
    const bool ended = began(std::atol(process.c_str())) != its_begin;
    if (ended != seen.ended) seen = {text, now, ended, false};
    seen.alive = !ended;
    return ended && now - seen.since >= kEndedFor;
  }
  if (text != seen.text) seen = {text, now, false, true};
  return now - seen.since >= times_.silent;
}

bool WorkerWatch::known_alive(const std::string& worker) const {
  const auto found = seen_.find(worker);
  return found != seen_.end() && found->second.alive;
}

void WorkerWatch::forget(const std::string& worker) {
  seen_.erase(worker);
  folder_->remove("beats/" + worker);
}

}  // namespace hookeye
