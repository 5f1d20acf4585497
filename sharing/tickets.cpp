#include "sharing/tickets.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace hookeye {
namespace {

using nlohmann::json;

std::string folder_of(TicketPlace place) {
  switch (place) {
    case TicketPlace::todo:
      return "todo/";
    case TicketPlace::leased:
      return "leased/";
    case TicketPlace::done:
      return "done/";
    case TicketPlace::failed:
      return "failed/";
  }
  return "";
}

std::string file_of(const Ticket& ticket, TicketPlace place) {
  return folder_of(place) + ticket.name();
}

/// Of "KEY.TRIES" or "KEY.TRIES@WORKER"; empty: another file.
std::optional<Ticket> ticket_from(const std::string& name) {
  const size_t dot = name.find('.'), at = name.find('@');
  if (dot == std::string::npos || dot == 0) return {};
  Ticket out;
  out.key = name.substr(0, dot);
  const char* end = name.data() + std::min(at, name.size());
  const auto [stop, error] = std::from_chars(name.data() + dot + 1, end, out.tries);
  if (error != std::errc() || stop != end) return {};
  if (at != std::string::npos) out.worker = name.substr(at + 1);
  return out;
}

}  // namespace

std::string Ticket::name() const {
  return worker.empty() ? fmt::format("{}.{}", key, tries)
                        : fmt::format("{}.{}@{}", key, tries, worker);
}

const std::vector<std::string>& Tickets::folders() {
  static const std::vector<std::string> names = {"tasks", "new",    "todo", "leased",
                                                 "done",  "failed", "beats"};
  return names;
}

// The ticket becomes a second name of the task's file, which is made once; whoever finds it in new/
// may move it on, and one of them does.
bool Tickets::enrol(const std::string& key, json task, const std::string& worker) const {
  const std::string file = "tasks/" + key;
  if (folder_->exists(file)) return false;
  const std::string name = Ticket{key, 0, worker}.name();
  task["enrolled_by"] = worker;
  folder_->write_openly("new/" + name, task.dump() + "\n");
  const bool first = folder_->link("new/" + name, file);
  finish_one(name, true);
  return first;
}

void Tickets::finish_one(const std::string& name, bool gone) const {
  const std::optional<Ticket> ticket = ticket_from(name);
  if (!ticket) return;
  std::string by;
  if (const auto text = folder_->read("tasks/" + ticket->key)) {
    const json task = json::parse(*text, nullptr, false);
    if (task.is_object()) by = task.value("enrolled_by", "");
  }
  if (by == ticket->worker)
    folder_->rename("new/" + name, file_of({ticket->key, 0, ""}, TicketPlace::todo));
  else if (gone || !by.empty())  // another was first: its own worker would remove it, too
    folder_->remove("new/" + name);
}

void Tickets::finish_enrolling(const Gone& gone) const {
  for (const std::string& name : folder_->names("new")) {
    const std::optional<Ticket> ticket = ticket_from(name);
    finish_one(name, gone(ticket ? ticket->worker : ""));
  }
}

std::vector<Ticket> Tickets::at(TicketPlace place) const {
  std::string folder = folder_of(place);
  folder.pop_back();
  std::vector<Ticket> out;
  for (const std::string& name : folder_->names(folder))
    if (std::optional<Ticket> ticket = ticket_from(name)) out.push_back(std::move(*ticket));
  return out;
}

bool Tickets::move(const Ticket& ticket, TicketPlace from, const Ticket& as, TicketPlace to) const {
  if (folder_->rename(file_of(ticket, from), file_of(as, to))) return true;
  // A network file system may send a rename twice, and then says of the second that there is
  // nothing to rename. Nobody else makes a name with this worker in it.
  return !as.worker.empty() && is_at(as, to);
}

bool Tickets::is_at(const Ticket& ticket, TicketPlace place) const {
  return folder_->exists(file_of(ticket, place));
}

}  // namespace hookeye
