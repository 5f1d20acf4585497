// Tasks that many processes share. A task's state is where its ticket lies: one file, which moves
// by rename(2), so that it is never in two places and never in none.
//   tasks/KEY   what is to be done
//   new/        tickets of tasks that are being enrolled
//   todo/KEY.TRIES   leased/KEY.TRIES@WORKER   done/KEY.TRIES@WORKER   failed/KEY.TRIES@WORKER
//   beats/WORKER  who is at work (heartbeat.h)
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sharing/shared_folder.h"

namespace hookeye {

enum class TicketPlace { todo, leased, done, failed };

struct Ticket {
  std::string key;     ///< without a dot or a slash
  int tries = 0;       ///< how often its process was killed
  std::string worker;  ///< who has it, or had; "": nobody yet
  /// "KEY.TRIES@WORKER".
  std::string name() const;
};

/// Whether a worker has gone.
using Gone = std::function<bool(const std::string& worker)>;

class Tickets {
 public:
  /// The folders that it needs, for whoever makes them.
  static const std::vector<std::string>& folders();

  explicit Tickets(std::shared_ptr<SharedFolder> folder) : folder_(std::move(folder)) {}
  SharedFolder& folder() const { return *folder_; }
  const std::shared_ptr<SharedFolder>& shared() const { return folder_; }

  /// False: it was there, and stays as it is. `worker`: who enrols it.
  bool enrol(const std::string& key, nlohmann::json task, const std::string& worker) const;
  /// Tickets whose enrolling was cut short, by workers of whom `gone` says so.
  void finish_enrolling(const Gone& gone) const;
  std::vector<std::string> keys() const { return folder_->names("tasks"); }

  std::vector<Ticket> at(TicketPlace place) const;
  /// False: somebody was faster. Exactly one of those who try gets it.
  bool move(const Ticket& ticket, TicketPlace from, const Ticket& as, TicketPlace to) const;
  bool is_at(const Ticket& ticket, TicketPlace place) const;

 private:
  void finish_one(const std::string& name, bool gone) const;
  std::shared_ptr<SharedFolder> folder_;
};

}  // namespace hookeye
