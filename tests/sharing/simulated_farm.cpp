#include "sharing/simulated_farm.h"

#include <fmt/format.h>
#include <ucontext.h>

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <queue>
#include <random>
#include <set>
#include <vector>

#include "sharing/leases.h"

namespace hookeye::test {
namespace {

/// Thrown in a worker at its next touch of the disk: its process is no more.
struct Killed {};

/// Programs that take turns by a clock of their own: each runs until it sleeps.
class Turns {
 public:
  double now() const { return now_; }

  void start(double at, std::function<void()> program) {
    auto fiber = std::make_unique<Fiber>();
    fiber->program = std::move(program);
    fiber->turns = this;
    queue_.push({at, count_++, fiber.get()});
    fibers_.push_back(std::move(fiber));
  }
  void sleep(double seconds) {
    queue_.push({now_ + seconds, count_++, running_});
    swapcontext(&running_->context, &scheduler_);
  }
  void run() {
    while (!queue_.empty()) {
      const Turn turn = queue_.top();
      queue_.pop();
      now_ = turn.at;
      running_ = turn.fiber;
      if (running_->stack.empty()) begin(*running_);
      swapcontext(&scheduler_, &running_->context);
      if (running_->ended) running_->stack = {}, running_->stack.shrink_to_fit();
    }
  }

 private:
  struct Fiber {
    ucontext_t context;
    std::vector<char> stack;
    std::function<void()> program;
    Turns* turns = nullptr;
    bool ended = false;
  };
  struct Turn {
    double at;
    long number;
    Fiber* fiber;
    bool operator<(const Turn& other) const {
      return at != other.at ? at > other.at : number > other.number;
    }
  };
  void begin(Fiber& fiber) {
    constexpr size_t kStack = 256 * 1024;
    fiber.stack.resize(kStack);
    getcontext(&fiber.context);
    fiber.context.uc_stack.ss_sp = fiber.stack.data();
    fiber.context.uc_stack.ss_size = fiber.stack.size();
    fiber.context.uc_link = &scheduler_;
    const auto address = reinterpret_cast<std::uintptr_t>(&fiber);
    makecontext(&fiber.context, reinterpret_cast<void (*)()>(&Turns::enter), 2,
                static_cast<unsigned>(address >> 32), static_cast<unsigned>(address));
  }
  static void enter(unsigned high, unsigned low) {
    auto* fiber = reinterpret_cast<Fiber*>((static_cast<std::uintptr_t>(high) << 32) | low);
    fiber->program();
    fiber->ended = true;
  }

  double now_ = 0.0;
  long count_ = 0;
  Fiber* running_ = nullptr;
  ucontext_t scheduler_{};
  std::vector<std::unique_ptr<Fiber>> fibers_;
  std::priority_queue<Turn> queue_;
};

/// What lies on the disk, by folder and name.
using Disk = std::map<std::string, std::map<std::string, std::string>>;

std::pair<std::string, std::string> parted(const std::string& file) {
  const size_t slash = file.find('/');
  return {file.substr(0, slash), file.substr(slash + 1)};
}

/// The disk as one worker sees it. Each operation takes its time, others run in between, and it
/// happens at its end.
class SimulatedFolder final : public SharedFolder {
 public:
  SimulatedFolder(const Farm& farm, Turns& turns, Disk& disk, double clock)
      : farm_(farm), turns_(turns), disk_(disk), clock_(clock) {}

  std::vector<std::string> names(const std::string& folder) override {
    touch(farm_.latency + farm_.per_name * static_cast<double>(disk_[folder].size()));
    std::vector<std::string> out;
    for (const auto& [name, text] : disk_[folder]) out.push_back(name);
    return out;
  }
  bool exists(const std::string& file) override {
    touch(farm_.latency);
    const auto [folder, name] = parted(file);
    return disk_[folder].contains(name);
  }
  std::optional<std::string> read(const std::string& file) override {
    touch(farm_.latency);
    const auto [folder, name] = parted(file);
    const auto found = disk_[folder].find(name);
    return found == disk_[folder].end() ? std::nullopt : std::optional(found->second);
  }
  void write(const std::string& file, const std::string& text) override {
    touch(3.0 * farm_.latency);  // made, written out, renamed
    const auto [folder, name] = parted(file);
    disk_[folder][name] = text;
  }
  void write_openly(const std::string& file, const std::string& text) override {
    touch(2.0 * farm_.latency);
    const auto [folder, name] = parted(file);
    disk_[folder][name] = text;
  }
  bool rename(const std::string& from, const std::string& to) override {
    touch(farm_.latency);
    const auto [folder, name] = parted(from);
    auto node = disk_[folder].extract(name);
    if (node.empty()) return false;
    const auto [into, as] = parted(to);
    disk_[into][as] = std::move(node.mapped());
    return true;
  }
  bool link(const std::string& from, const std::string& to) override {
    touch(farm_.latency);
    const auto [folder, name] = parted(from);
    const auto [into, as] = parted(to);
    return disk_[folder].contains(name) && disk_[into].emplace(as, disk_[folder][name]).second;
  }
  void remove(const std::string& file) override {
    touch(farm_.latency);
    const auto [folder, name] = parted(file);
    disk_[folder].erase(name);
  }
  /// No two clocks agree, nor go at the same rate.
  double seconds() const override { return 1e3 * clock_ + (1.0 + 1e-3 * clock_) * turns_.now(); }

  void kill_at(double time) { dies_ = time; }
  void hide(double from, double until) { hidden_from_ = from, hidden_until_ = until; }
  bool dead() const { return turns_.now() >= dies_; }
  bool hidden() const { return turns_.now() >= hidden_from_ && turns_.now() < hidden_until_; }
  double spent() const { return spent_; }
  long operations() const { return operations_; }

 private:
  void touch(double takes) {
    if (dead()) throw Killed{};
    if (hidden()) turns_.sleep(hidden_until_ - turns_.now());  // it hangs until the network is back
    turns_.sleep(takes);
    if (dead()) throw Killed{};
    spent_ += takes;
    ++operations_;
  }

  const Farm& farm_;
  Turns& turns_;
  Disk& disk_;
  double clock_, dies_ = 1e300, hidden_from_ = 1e300, hidden_until_ = 1e300, spent_ = 0.0;
  long operations_ = 0;
};

class Simulation {
 public:
  explicit Simulation(const Farm& farm) : farm_(farm), random_(farm.seed) {
    std::uniform_real_distribution<> share(0.0, 1.0);
    for (int i = 0; i < farm.tasks; ++i) {
      const double length = -std::log(1.0 - share(random_)) * 0.5 + 0.5;  // mean 1, 0.5 at least
      constexpr double kStraggling = 30.0;
      const std::string key = fmt::format("{:08x}", i * 2654435761U);
      length_[key] = farm.seconds * length * (share(random_) < farm.straggling ? kStraggling : 1.0);
      if (share(random_) < farm.failing) fails_.insert(key);
      disk_["tasks"][key] = "{}";
      disk_["todo"][Ticket{key, 0, ""}.name()] = "{}";
    }
  }

  FarmResult run() {
    const double expected = farm_.seconds * farm_.tasks / farm_.workers;
    std::uniform_real_distribution<> moment(0.1 * expected, expected);
    for (int i = 0; i < farm_.workers; ++i) {
      SimulatedFolder& own = add_worker(0.01 * i);
      if (i < farm_.deaths) die(own, moment(random_));
      if (i >= farm_.workers - farm_.out_of_sight) {
        constexpr double kHidden = 120.0;
        const double from = moment(random_);
        own.hide(from, from + kHidden);
      }
    }
    turns_.run();
    count_up();
    return out_;
  }

 private:
  void die(SimulatedFolder& own, double when) {
    constexpr double kReplaced = 30.0;
    own.kill_at(when);
    add_worker(when + kReplaced);
  }

  SimulatedFolder& add_worker(double at) {
    const std::string name = fmt::format("node{}-1-{:08x}", folders_.size(), random_());
    std::uniform_real_distribution<> clock(-1.0, 1.0);
    folders_.push_back(std::make_shared<SimulatedFolder>(farm_, turns_, disk_, clock(random_)));
    const auto own = folders_.back();
    const auto at_work = std::make_shared<bool>(true);
    turns_.start(at, [this, own, name, at_work] {
      beat(name, 0);
      try {
        work(name, own);
      } catch (const Killed&) {
      }
      *at_work = false;
    });
    turns_.start(at, [this, own, name, at_work] {
      for (unsigned long count = 1; *at_work && !own->dead(); ++count) {
        turns_.sleep(times_.beat);
        if (*at_work && !own->dead() && !own->hidden()) beat(name, count);
      }
    });
    return *own;
  }

  void beat(const std::string& name, unsigned long count) {
    disk_["beats"][name] = beat_text(count, "of-" + name + " pid:[1]", 1, "1");
  }

  bool all_ended(const Tickets& tickets) const {
    return static_cast<int>(tickets.at(TicketPlace::done).size() +
                            tickets.at(TicketPlace::failed).size()) == farm_.tasks;
  }

  /// As a batch's worker does with one job (batch_worker.cpp).
  void work(const std::string& name, const std::shared_ptr<SimulatedFolder>& own) {
    const Tickets tickets(own);
    Leases leases(tickets, name, times_, {});
    double before = 0.0;
    const auto arranged = [&](double FarmResult::*what) {
      out_.*what += own->spent() - before;
      before = own->spent();
    };
    while (true) {
      if (leases.none_waits()) leases.look();
      const std::optional<Ticket> ticket = leases.claim();
      if (!ticket) {
        const bool ended = leases.none_waits() && all_ended(tickets);
        arranged(&FarmResult::idle);
        if (ended) return;
        constexpr double kWait = 1.0;
        turns_.sleep(kWait);
        out_.idle += kWait;
        continue;
      }
      own->read("tasks/" + ticket->key);
      arranged(&FarmResult::arranging);
      const double length = length_[ticket->key];
      turns_.sleep(length);
      out_.working += length;
      if (own->dead()) out_.wasted += length;
      finish(leases, *ticket, *own, length);
      arranged(&FarmResult::arranging);
    }
  }

  void finish(Leases& leases, const Ticket& ticket, SimulatedFolder& own, double length) {
    const double began = turns_.now();
    if (!leases.has(ticket)) {
      out_.wasted += length;
      return;
    }
    own.write("results/" + ticket.name(), "{}");
    const auto place = fails_.count(ticket.key) ? TicketPlace::failed : TicketPlace::done;
    if (!leases.finish(ticket, place)) {
      out_.wasted += length;
      return;
    }
    out_.makespan = std::max(out_.makespan, began);
  }

  void count_up() {
    std::map<std::string, int> ended;
    std::set<std::string> workers;
    for (const char* place : {"done", "failed"})
      for (const auto& [name, text] : disk_[place]) ++ended[name.substr(0, name.find('.'))];
    out_.done = static_cast<int>(disk_["done"].size());
    out_.failed = static_cast<int>(disk_["failed"].size());
    for (const auto& [key, length] : length_) {
      out_.lost += !ended.count(key);
      out_.twice += ended[key] > 1;
    }
    for (const char* place : {"todo", "leased", "new"})
      out_.left_over += static_cast<int>(disk_[place].size());
    for (const auto& folder : folders_) out_.operations += folder->operations();
  }

  const Farm farm_;
  const BeatTimes times_;
  std::mt19937 random_;
  Turns turns_;
  Disk disk_;
  std::map<std::string, double> length_;
  std::set<std::string> fails_;
  std::vector<std::shared_ptr<SimulatedFolder>> folders_;
  FarmResult out_;
};

}  // namespace

std::string FarmResult::words() const {
  return fmt::format(
      "{:.0f} s; {} done, {} failed, {} lost, {} twice, {} left over\n"
      "of the workers' time: tasks {:.0f} s ({:.0f} s of them again), arranging {:.1f} s, idle "
      "{:.0f} s\n"
      "{} operations on the disk; overhead {:.2f} %",
      makespan, done, failed, lost, twice, left_over, working, wasted, arranging, idle, operations,
      100.0 * overhead());
}

FarmResult simulate(const Farm& farm) { return Simulation(farm).run(); }

}  // namespace hookeye::test
