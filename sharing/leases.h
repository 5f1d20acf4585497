// What one worker takes of the tickets of a folder, and takes up of those who have gone.
#pragma once

#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sharing/heartbeat.h"
#include "sharing/tickets.h"

namespace hookeye {

/// The order in which a worker asks for what waits. Few keys with an order of their own, or many
/// that all are as good: then everybody begins elsewhere, so that not all ask for the same one.
struct WantedTickets {
  std::vector<std::string> keys;               ///< in this order; empty: all that wait
  std::function<std::set<std::string>()> but;  ///< not these, asked at each look; may be empty
};

class Leases {
 public:
  /// `worker`: whose heartbeat it is.
  Leases(const Tickets& tickets, std::string worker, const BeatTimes& times, WantedTickets wanted);

  /// Looks through the folder, at most once a second: what waits; where nothing does, and now and
  /// then, whose worker has gone and whose enrolling was cut short.
  void look();
  /// The next look() looks, however short the time since the last.
  void look_soon() { looked_ = kNever; }
  /// The next that waits, now leased. Empty: look() has found none that is left.
  std::optional<Ticket> claim();

  bool has(const Ticket& ticket) const { return tickets_.is_at(ticket, TicketPlace::leased); }
  /// For whoever comes next. `tries`: how many more of its processes were killed.
  void give_back(const Ticket& ticket, int tries);
  /// False: somebody else has taken it over meanwhile, and what came of it is not wanted.
  bool finish(const Ticket& ticket, TicketPlace place);

  bool none_waits() const { return waiting_.empty(); }
  /// Leases of workers of whom it is not known whether they are gone.
  int in_doubt() const { return in_doubt_; }
  const std::string& worker() const { return worker_; }

 private:
  static constexpr double kLookEvery = 1.0, kWatchEvery = 10.0;  // [s]
  static constexpr double kNever = -std::numeric_limits<double>::infinity();
  void find_waiting();
  /// `all`: of all leases; else of a few, others each time.
  void take_up_abandoned(bool all);
  void put_in_order();

  const Tickets& tickets_;
  std::string worker_;
  WorkerWatch watch_;
  WantedTickets wanted_;
  std::deque<Ticket> waiting_;
  int in_doubt_ = 0, missed_ = 0;
  double looked_ = kNever, watched_ = kNever;
  unsigned long turns_ = 0;
};

}  // namespace hookeye
