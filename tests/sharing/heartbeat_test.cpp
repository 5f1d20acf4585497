// Who is at work, and who has gone: by the process where it can be asked, by its count elsewhere.
#include "sharing/heartbeat.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

/// A folder that workers share.
class SharedPlace {
 public:
  SharedPlace() { std::filesystem::create_directory(beats()); }
  std::filesystem::path beats() const { return folder_ / "beats"; }
  WorkerWatch watch(const BeatTimes& times) const {
    return WorkerWatch(folder_on_disk(folder_.path()), times);
  }

 private:
  TemporaryFolder folder_;
};

using std::chrono::milliseconds;

std::string only_file(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().filename().string()[0] != '.') return entry.path().filename();
  return {};
}

/// Whether it counts as gone within `seconds`, asked again and again.
bool gone_within(WorkerWatch& watch, const std::string& worker, double seconds) {
  for (int i = 0; i < 20 * seconds; ++i) {
    if (watch.gone(worker)) return true;
    std::this_thread::sleep_for(milliseconds(50));
  }
  return watch.gone(worker);
}

class OtherWorker {
 public:
  explicit OtherWorker(const std::filesystem::path& folder) : process_(::fork()) {
    if (process_ == 0) {
      const Heartbeat beating(folder, {0.05, 0.5});
      while (true) ::pause();
    }
    for (int i = 0; i < 100 && worker().empty(); ++i)
      std::this_thread::sleep_for(milliseconds(20)), name_ = only_file(folder);
  }
  ~OtherWorker() {
    if (process_ > 0) ::kill(process_, SIGKILL), ::waitpid(process_, nullptr, 0);
  }
  const std::string& worker() const { return name_; }
  void send(int signal) const { ::kill(process_, signal); }
  /// It stays as a zombie, as no one has asked how it ended.
  void kill_and_wait() const {
    send(SIGKILL);
    siginfo_t how{};
    ::waitid(P_PID, static_cast<id_t>(process_), &how, WEXITED | WNOWAIT);
  }

 private:
  pid_t process_;
  std::string name_;
};

TEST(WorkersHere, AreGoneWithTheirProcessAlone) {
  const SharedPlace place;
  const OtherWorker other(place.beats());
  ASSERT_FALSE(other.worker().empty());
  WorkerWatch watch = place.watch({0.05, 0.3});
  other.send(SIGSTOP);  // it is silent, but there
  EXPECT_FALSE(gone_within(watch, other.worker(), 1.5));
  EXPECT_TRUE(watch.known_alive(other.worker()));
  other.send(SIGCONT);
  other.kill_and_wait();
  EXPECT_FALSE(watch.gone(other.worker())) << "what it had started may still end";
  EXPECT_FALSE(watch.known_alive(other.worker()));
  EXPECT_TRUE(gone_within(watch, other.worker(), 3.0));
  watch.forget(other.worker());
  EXPECT_EQ(only_file(place.beats()), "");
}

/// As of another machine: its boot is another.
class CountingElsewhere {
 public:
  CountingElsewhere(const std::filesystem::path& folder, const std::string& name)
      : file_(folder / name) {
    beat();
  }
  void beat() {
    std::ofstream(file_) << ++count_ << "\nanother-boot pid:[1] " << ::getpid() << " 1\n";
  }

 private:
  std::filesystem::path file_;
  int count_ = 0;
};

TEST(WorkersElsewhere, AreGoneWhenTheyCountNoMore) {
  const SharedPlace place;
  CountingElsewhere other(place.beats(), "other");
  WorkerWatch watch = place.watch({0.05, 0.4});
  for (int i = 0; i < 12; ++i) {
    EXPECT_FALSE(watch.gone("other"));
    EXPECT_EQ(watch.known_alive("other"), i > 0);
    std::this_thread::sleep_for(milliseconds(80));
    other.beat();
  }
  EXPECT_FALSE(watch.gone("other"));
  EXPECT_TRUE(gone_within(watch, "other", 2.0));
  other.beat();  // it was out of sight, and is back
  EXPECT_FALSE(watch.gone("other"));
  WorkerWatch later = place.watch({0.05, 0.4});  // whoever comes anew waits by his own clock
  EXPECT_FALSE(later.gone("other"));
  EXPECT_FALSE(later.gone("nobody"));
  EXPECT_TRUE(gone_within(later, "nobody", 2.0));
}

TEST(Heartbeat, CountsAndLeavesNothing) {
  const SharedPlace place;
  const auto text = [&](const std::string& name) {
    std::ifstream stream(place.beats() / name);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  {
    const Heartbeat one(place.beats(), {0.05, 0.5}), two(place.beats(), {0.05, 0.5});
    EXPECT_NE(one.worker(), two.worker());
    const std::string before = text(one.worker());
    std::this_thread::sleep_for(milliseconds(300));
    const std::string after = text(one.worker());
    EXPECT_NE(before, after);
    EXPECT_EQ(before.size(), after.size());
  }
  EXPECT_EQ(only_file(place.beats()), "");
}

}  // namespace
}  // namespace hookeye::test
