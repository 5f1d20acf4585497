#include "batch/batch_index.h"

#include <fmt/format.h>

#include <map>

#include "batch/fleet_page.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Of a file or folder below that of the batch; "": it is not there.
std::string below(const BatchFolder& folder, const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) ? fs::relative(path, folder.path()).string() : "";
}

/// The page of a capture: a run's report, or the pictures of `check`.
std::string page_of(const BatchFolder& folder, const BatchTask& task) {
  const std::string report = below(folder, folder.report_of(task));
  return report.empty() ? below(folder, folder.run_of(task) / "index.html") : report;
}

json row_of(const BatchFolder& folder, const BatchTask& task, const std::string& state,
            const json& result) {
  json row = {{"label", task.label},
              {"capture", task.capture.string()},
              {"key", task.key},
              {"options", task.options},
              {"state", state},
              {"found", json::array()},
              {"tie", json::array()},
              {"parameters", json::array()},
              {"run", below(folder, folder.run_of(task))},
              {"report", page_of(folder, task)},
              {"log", below(folder, folder.log_of(task, ".txt"))}};
  for (const char* key : {"seconds", "cpu_seconds", "memory", "exit", "error", "worker"})
    row[key] = result.is_object() && result.contains(key) ? result[key] : json();
  for (const char* key : {"verdict", "sentence", "chi_fit", "chi_validate", "floor", "rms_px"})
    row[key] = json();
  if (result.is_object() && result.contains("finding"))
    for (const auto& [key, value] : result["finding"].items()) row[key] = value;
  return row;
}

std::string joined(const json& texts, const char* between) {
  std::string out;
  for (const json& one : texts) out += (out.empty() ? "" : between) + one.get<std::string>();
  return out;
}

std::string csv_cell(const json& value) {
  if (value.is_null()) return {};
  const std::string text = value.is_string()  ? value.get<std::string>()
                           : value.is_array() ? joined(value, ";")
                                              : value.dump();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

}  // namespace

std::vector<json> batch_rows(const BatchFolder& folder, const std::vector<std::string>& keys) {
  struct Where {
    std::string state;
    Ticket ticket;
  };
  std::map<std::string, Where> places;
  for (const auto& [place, state] : {std::pair<TicketPlace, const char*>{TicketPlace::todo, "todo"},
                                     {TicketPlace::leased, "leased"},
                                     {TicketPlace::failed, "failed"},
                                     {TicketPlace::done, "done"}})
    for (const Ticket& ticket : folder.tickets().at(place)) places[ticket.key] = {state, ticket};
  std::vector<BatchTask> tasks;
  if (keys.empty()) tasks = folder.tasks();
  for (const std::string& key : keys) tasks.push_back(folder.task(key));
  std::vector<json> rows;
  for (const BatchTask& task : tasks) {
    const auto found = places.find(task.key);
    const Where where = found == places.end() ? Where{"todo", {}} : found->second;
    const bool ended = where.state == "done" || where.state == "failed";
    rows.push_back(row_of(folder, task, where.state, ended ? folder.result(where.ticket) : json()));
  }
  return rows;
}

std::string index_csv(const std::vector<json>& rows) {
  std::map<std::string, std::string> units;  // of all parameters, by name
  for (const json& row : rows)
    for (const json& one : row["parameters"])
      units.try_emplace(one["name"], one["unit"].is_string() ? one["unit"] : "");
  std::vector<std::string> columns = {"label",  "capture", "options",     "state",        "verdict",
                                      "found",  "tie",     "chi_fit",     "chi_validate", "floor",
                                      "rms_px", "seconds", "cpu_seconds", "memory",       "exit",
                                      "error",  "run",     "report"};
  std::string out;
  for (const std::string& column : columns) out += (out.empty() ? "" : ",") + column;
  for (const auto& [name, unit] : units)
    for (const char* end : {"", "_low", "_high", "_unit"}) out += "," + csv_cell(name + end);
  out += "\n";
  for (const json& row : rows) {
    std::string line;
    for (const std::string& column : columns)
      line += (column == columns.front() ? "" : ",") + csv_cell(row[column]);
    for (const auto& [name, unit] : units) {
      json found;
      for (const json& one : row["parameters"])
        if (one["name"] == name) found = one;
      for (const char* key : {"value", "low", "high", "unit"})
        line += "," + (found.is_null() ? "" : csv_cell(found[key]));
    }
    out += line + "\n";
  }
  return out;
}

void write_index(const BatchFolder& folder, const std::vector<json>& rows) {
  write_text(folder.path() / "index.csv", index_csv(rows));
  write_text(folder.path() / "index.sqlite", index_sqlite(rows, folder.order()));
  write_text(folder.path() / "index.html", fleet_page(rows, folder.order()));
}

}  // namespace hookeye
