#include <fmt/format.h>
#include <sqlite3.h>

#include <memory>
#include <stdexcept>

#include "batch/batch_index.h"

namespace hookeye {
namespace {

using nlohmann::json;

constexpr const char* kTables = R"(
CREATE TABLE batch (verb TEXT, options TEXT, version TEXT, program TEXT);
CREATE TABLE captures (key TEXT PRIMARY KEY, label TEXT, capture TEXT, options TEXT, state TEXT,
  verdict TEXT, sentence TEXT, chi_fit REAL, chi_validate REAL, floor REAL, rms_px REAL,
  seconds REAL, cpu_seconds REAL, memory REAL, exit INTEGER, error TEXT, run TEXT, report TEXT,
  log TEXT);
CREATE TABLE parameters (key TEXT REFERENCES captures(key), name TEXT, unit TEXT, long_name TEXT,
  value REAL, low REAL, high REAL);
CREATE TABLE found (key TEXT REFERENCES captures(key), effect TEXT);
CREATE TABLE ties (key TEXT REFERENCES captures(key), effect TEXT);
)";

/// In memory: a file of a network file system would have to be locked.
class Database {
 public:
  Database() {
    sqlite3* opened = nullptr;
    const int status = sqlite3_open(":memory:", &opened);
    handle_.reset(opened);
    demand(status == SQLITE_OK);
  }
  void run(const char* statement) {
    demand(sqlite3_exec(handle_.get(), statement, nullptr, nullptr, nullptr) == SQLITE_OK);
  }
  /// One more row; values are text, numbers, flags or null.
  void insert(const std::string& table, const std::vector<json>& values) {
    std::string places;
    for (size_t i = 0; i < values.size(); ++i) places += i ? ",?" : "?";
    sqlite3_stmt* made = nullptr;
    const std::string text = fmt::format("INSERT INTO {} VALUES ({})", table, places);
    demand(sqlite3_prepare_v2(handle_.get(), text.c_str(), -1, &made, nullptr) == SQLITE_OK);
    const std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)> statement(made,
                                                                               &sqlite3_finalize);
    for (size_t i = 0; i < values.size(); ++i) bind(made, static_cast<int>(i) + 1, values[i]);
    demand(sqlite3_step(made) == SQLITE_DONE);
  }
  std::string bytes() {
    sqlite3_int64 size = 0;
    const std::unique_ptr<unsigned char, decltype(&sqlite3_free)> taken(
        sqlite3_serialize(handle_.get(), "main", &size, 0), &sqlite3_free);
    demand(taken != nullptr);
    return {reinterpret_cast<const char*>(taken.get()), static_cast<size_t>(size)};
  }

 private:
  void demand(bool good) const {
    if (!good)
      throw std::runtime_error(
          fmt::format("the index as SQLite: {}", sqlite3_errmsg(handle_.get())));
  }
  void bind(sqlite3_stmt* statement, int place, const json& value) const {
    if (value.is_number_integer()) {
      demand(sqlite3_bind_int64(statement, place, value.get<sqlite3_int64>()) == SQLITE_OK);
    } else if (value.is_number()) {
      demand(sqlite3_bind_double(statement, place, value.get<double>()) == SQLITE_OK);
    } else if (value.is_null()) {
      demand(sqlite3_bind_null(statement, place) == SQLITE_OK);
    } else {
      const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
      demand(sqlite3_bind_text(statement, place, text.data(), static_cast<int>(text.size()),
                               SQLITE_TRANSIENT) == SQLITE_OK);
    }
  }
  std::unique_ptr<sqlite3, decltype(&sqlite3_close)> handle_{nullptr, &sqlite3_close};
};

}  // namespace

std::string index_sqlite(const std::vector<json>& rows, const BatchOrder& order) {
  Database out;
  out.run(kTables);
  out.run("BEGIN");
  out.insert("batch", {order.verb, json(order.options), order.version, order.program});
  for (const json& row : rows) {
    std::vector<json> values;
    for (const char* column : {"key", "label", "capture", "options", "state", "verdict", "sentence",
                               "chi_fit", "chi_validate", "floor", "rms_px", "seconds",
                               "cpu_seconds", "memory", "exit", "error", "run", "report", "log"})
      values.push_back(row.at(column));
    out.insert("captures", values);
    for (const json& one : row.at("parameters"))
      out.insert("parameters", {row.at("key"), one.at("name"), one.at("unit"), one.at("long_name"),
                                one.at("value"), one.at("low"), one.at("high")});
    for (const json& effect : row.at("found")) out.insert("found", {row.at("key"), effect});
    for (const json& effect : row.at("tie")) out.insert("ties", {row.at("key"), effect});
  }
  out.run("COMMIT");
  return out.bytes();
}

}  // namespace hookeye
