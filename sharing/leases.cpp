#include "sharing/leases.h"

#include <algorithm>
#include <map>
#include <set>

namespace hookeye {

namespace {

/// So many in a row that others had taken already, and the list is out of date.
constexpr int kMissed = 4;

/// So many workers are watched at a time while there is something else to do.
constexpr size_t kSome = 8;

}  // namespace

Leases::Leases(const Tickets& tickets, std::string worker, const BeatTimes& times,
               WantedTickets wanted)
    : tickets_(tickets),
      worker_(std::move(worker)),
      watch_(tickets.shared(), times),
      wanted_(std::move(wanted)) {}

void Leases::look() {
  const double now = tickets_.folder().seconds();
  ++turns_;
  if (now - looked_ < kLookEvery) return;
  looked_ = now;
  missed_ = 0;
  find_waiting();
  if (!waiting_.empty() && now - watched_ < kWatchEvery) return;
  watched_ = now;
  tickets_.finish_enrolling([&](const std::string& worker) { return watch_.gone(worker); });
  take_up_abandoned(waiting_.empty());
  if (waiting_.empty()) find_waiting();
}

void Leases::find_waiting() {
  waiting_.clear();
  const std::set<std::string> wanted(wanted_.keys.begin(), wanted_.keys.end());
  const std::set<std::string> but = wanted_.but ? wanted_.but() : std::set<std::string>();
  for (Ticket& ticket : tickets_.at(TicketPlace::todo))
    if ((wanted.empty() || wanted.count(ticket.key)) && !but.count(ticket.key))
      waiting_.push_back(std::move(ticket));
  put_in_order();
}

void Leases::put_in_order() {
  if (waiting_.empty()) return;
  if (wanted_.keys.empty()) {
    const std::string begins = worker_ + std::to_string(++turns_);
    const size_t first = std::hash<std::string>()(begins) % waiting_.size();
    std::rotate(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(first),
                waiting_.end());
    return;
  }
  std::map<std::string, size_t> place;
  for (const std::string& key : wanted_.keys) place.emplace(key, place.size());
  std::sort(waiting_.begin(), waiting_.end(),
            [&](const Ticket& a, const Ticket& b) { return place.at(a.key) < place.at(b.key); });
}

/// A lease is taken over by one rename: of those who see that its worker is gone one gets it.
void Leases::take_up_abandoned(bool all) {
  std::set<std::string> gone;
  in_doubt_ = 0;
  std::vector<Ticket> leased = tickets_.at(TicketPlace::leased);
  if (!all && leased.size() > kSome) {
    std::sort(leased.begin(), leased.end(),
              [](const Ticket& a, const Ticket& b) { return a.worker < b.worker; });
    const size_t first = kSome * turns_ % leased.size();
    std::rotate(leased.begin(), leased.begin() + static_cast<std::ptrdiff_t>(first), leased.end());
    leased.resize(kSome);
  }
  for (const Ticket& ticket : leased) {
    if (ticket.worker == worker_) continue;
    if (!gone.count(ticket.worker) && !watch_.gone(ticket.worker)) {
      in_doubt_ += !watch_.known_alive(ticket.worker);
      continue;
    }
    gone.insert(ticket.worker);
    tickets_.move(ticket, TicketPlace::leased, {ticket.key, ticket.tries, ""}, TicketPlace::todo);
  }
  for (const std::string& worker : gone) watch_.forget(worker);
}

std::optional<Ticket> Leases::claim() {
  while (!waiting_.empty()) {
    const Ticket ticket = waiting_.front();
    waiting_.pop_front();
    const Ticket own{ticket.key, ticket.tries, worker_};
    if (tickets_.move(ticket, TicketPlace::todo, own, TicketPlace::leased)) {
      missed_ = 0;
      return own;
    }
    if (!wanted_.keys.empty()) continue;
    // From there on others have taken them: elsewhere there may be more.
    if (++missed_ % kMissed == 0)
      look();
    else
      put_in_order();
  }
  return {};
}

void Leases::give_back(const Ticket& ticket, int tries) {
  tickets_.move(ticket, TicketPlace::leased, {ticket.key, ticket.tries + tries, ""},
                TicketPlace::todo);
  look_soon();
}

bool Leases::finish(const Ticket& ticket, TicketPlace place) {
  look_soon();
  return tickets_.move(ticket, TicketPlace::leased, ticket, place);
}

}  // namespace hookeye
