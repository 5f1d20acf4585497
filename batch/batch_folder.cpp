#include "batch/batch_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <system_error>

#include "core/input_error.h"
#include "core/json_file.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kOrderFile = "batch.json";

/// Of the tickets and of all else.
std::vector<std::string> folders() {
  std::vector<std::string> out = Tickets::folders();
  for (const char* name : {"results", "past", "runs", "logs", "reports"}) out.push_back(name);
  return out;
}

/// What differs, in words.
std::string difference(const BatchOrder& there, const BatchOrder& told) {
  if (there.verb != told.verb)
    return fmt::format("its captures are worked on by `{}`, not by `{}`", there.verb, told.verb);
  if (there.options != told.options)
    return there.options.empty()
               ? std::string("it was begun without options of the verb")
               : fmt::format("it was begun with other options: {}", fmt::join(there.options, " "));
  if (there.program != told.program)
    return fmt::format("it was begun by another program, {} (this is {})", there.version,
                       told.version == there.version ? "another build of it" : told.version);
  return there.reports ? "it was begun with reports" : "it was begun without reports";
}

void demand_room_for_batch(const fs::path& folder) {
  if (fs::exists(folder) && !fs::is_directory(folder))
    throw InputError({folder.string()}, "this is a file, not a folder",
                     "name a new folder for the batch");
  if (!fs::exists(folder)) return;
  const std::vector<std::string> own = folders();
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    // of a start that was cut short, or is under way
    const bool ours = std::find(own.begin(), own.end(), name) != own.end();
    if (!ours && name[0] != '.' && name != kOrderFile)
      throw InputError({folder.string()},
                       fmt::format("the folder holds something else than a batch: {}", name),
                       "name a new or empty folder for the batch");
  }
}

/// The first of those who write it at once wins, and the others read what it wrote.
void write_once(const fs::path& file, const std::string& text) {
  const fs::path own = file.parent_path() / fmt::format(".first-{}-{}", ::getpid(), ::gethostid());
  write_text(own, text);
  std::error_code failed;
  fs::create_hard_link(own, file, failed);
  std::error_code ignored;
  fs::remove(own, ignored);
  if (failed && !fs::exists(file)) throw cannot_write(file.string(), failed.message());
}

}  // namespace

BatchFolder::BatchFolder(fs::path path, BatchOrder order)
    : path_(std::move(path)), order_(std::move(order)), tickets_(folder_on_disk(path_)) {}

BatchFolder BatchFolder::make(const fs::path& folder, const BatchOrder& order) {
  if (!fs::exists(folder / kOrderFile)) {
    demand_room_for_batch(folder);
    std::error_code failed;
    for (const std::string& name : folders()) {
      fs::create_directories(folder / name, failed);
      if (failed)
        throw InputError({folder.string()}, "the folder cannot be made: " + failed.message(),
                         "choose a folder that you may write");
    }
    write_once(folder / kOrderFile, to_json(order).dump(2) + "\n");
  }
  BatchFolder out = open(folder);
  if (out.order_ != order)
    throw InputError({folder.string()},
                     "the folder holds another batch: " + difference(out.order_, order),
                     "name a new folder, or give the command that began this one");
  return out;
}

BatchFolder BatchFolder::open(const fs::path& folder) {
  const fs::path file = folder / kOrderFile;
  std::error_code ignored;
  if (!fs::exists(file, ignored))
    throw InputError({folder.string()}, "there is no batch in this folder",
                     "begin one with `hookeye batch CAPTURES -o FOLDER`");
  return {fs::canonical(folder), batch_order_from(read_json(file), file)};
}

bool BatchFolder::enrol(const BatchTask& task, const std::string& worker) const {
  return tickets_.enrol(task.key, to_json(task), worker);
}

void BatchFolder::set_capture(const std::string& key, const fs::path& capture) const {
  const fs::path file = path_ / "tasks" / key;
  json told = read_json(file);
  told["capture"] = capture.string();
  write_text(file, told.dump() + "\n");
}

BatchTask BatchFolder::task(const std::string& key) const {
  const fs::path file = path_ / "tasks" / key;
  return batch_task_from(read_json(file), file);
}

std::vector<BatchTask> BatchFolder::tasks() const {
  std::vector<BatchTask> out;
  const std::set<std::string> gone_by = past();
  for (const std::string& key : keys())
    if (!gone_by.count(key)) out.push_back(task(key));
  std::sort(out.begin(), out.end(), [](const BatchTask& a, const BatchTask& b) {
    return std::tie(a.label, a.key) < std::tie(b.label, b.key);
  });
  return out;
}

void BatchFolder::set_past(const std::string& key, bool past) const {
  if (past == is_past(key)) return;
  if (past)
    write_text(path_ / "past" / key, "");
  else
    fs::remove(path_ / "past" / key);
}

bool BatchFolder::is_past(const std::string& key) const { return fs::exists(path_ / "past" / key); }

std::set<std::string> BatchFolder::past() const {
  const std::vector<std::string> names = tickets_.folder().names("past");
  return {names.begin(), names.end()};
}

void BatchFolder::store_result(const Ticket& ticket, const json& result) const {
  write_text(path_ / "results" / ticket.name(),
             result.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
}

json BatchFolder::result(const Ticket& ticket) const {
  try {
    return read_json(path_ / "results" / ticket.name());
  } catch (const InputError&) {
    return {};
  }
}

void BatchFolder::drop_result(const Ticket& ticket) const {
  std::error_code ignored;
  fs::remove(path_ / "results" / ticket.name(), ignored);
}

fs::path BatchFolder::run_of(const BatchTask& task) const {
  return path_ / "runs" / task.file_name();
}

fs::path BatchFolder::log_of(const BatchTask& task, const std::string& extension) const {
  return path_ / "logs" / (task.file_name() + extension);
}

fs::path BatchFolder::report_of(const BatchTask& task) const {
  return path_ / "reports" / (task.file_name() + ".html");
}

BatchCounts count(const BatchFolder& folder, const std::vector<std::string>& keys) {
  const std::set<std::string> wanted(keys.begin(), keys.end()), past = folder.past();
  // A ticket that moves on meanwhile is seen where it comes to; one of a moment ago counts once.
  std::map<std::string, TicketPlace> places;
  for (const TicketPlace place :
       {TicketPlace::todo, TicketPlace::leased, TicketPlace::failed, TicketPlace::done})
    for (const Ticket& ticket : folder.tickets().at(place))
      if ((wanted.empty() || wanted.count(ticket.key)) && !past.count(ticket.key))
        places[ticket.key] = place;
  BatchCounts out;
  for (const auto& [key, place] : places)
    ++(place == TicketPlace::todo     ? out.todo
       : place == TicketPlace::leased ? out.running
       : place == TicketPlace::done   ? out.done
                                      : out.failed);
  return out;
}

}  // namespace hookeye
