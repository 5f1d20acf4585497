#include "app/commands/batch_report.h"

#include <algorithm>
#include <map>

#include "runs/text.h"

namespace hookeye {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr size_t kMostFailures = 10;

std::map<std::string, int> states_of(const std::vector<json>& rows) {
  std::map<std::string, int> out;
  for (const json& row : rows) ++out[row.at("state")];
  return out;
}

void say_effects(const std::vector<json>& rows, const Session& session) {
  std::map<std::string, int> named;
  int judged = 0;
  for (const json& row : rows) {
    if (row.at("state") != "done" || !row.at("verdict").is_string()) continue;
    ++judged;
    for (const json& effect : row.at("found")) ++named[effect];
  }
  if (named.empty()) return;
  std::vector<std::pair<std::string, int>> sorted(named.begin(), named.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<std::vector<std::string>> lines = {{"effect", "named in", ""}};
  for (const auto& [effect, count] : sorted)
    lines.push_back({effect, std::to_string(count), bar(static_cast<double>(count) / judged)});
  session.say("{}\n", table(lines));
}

void say_failures(const std::vector<json>& rows, const Session& session) {
  size_t said = 0, all = 0;
  for (const json& row : rows) {
    if (row.at("state") != "failed") continue;
    if (++all > kMostFailures) continue;
    ++said;
    session.say("{}", wrapped(fmt::format(
                          "failed: {}: exit status {}: {}", row.at("label").get<std::string>(),
                          row.at("exit").dump(),
                          row.at("error").is_string() ? row.at("error").get<std::string>() : "")));
  }
  if (all > said) session.say("  and {} more, in index.csv\n", all - said);
}

/// Of verbs that make no run: `check` warns and goes on.
void say_warnings(const std::vector<json>& rows, const Session& session) {
  size_t all = 0;
  for (const json& row : rows) {
    if (row.at("state") != "done" || !row.at("verdict").is_string() ||
        !row.at("sentence").is_string() ||
        row.at("verdict").get<std::string>().find("warning") == std::string::npos)
      continue;
    if (++all > kMostFailures) continue;
    session.say("{}",
                wrapped(fmt::format("{}: {}, the first: {}", row.at("label").get<std::string>(),
                                    row.at("verdict").get<std::string>(),
                                    row.at("sentence").get<std::string>())));
  }
  if (all > kMostFailures) session.say("  and {} more, in index.csv\n", all - kMostFailures);
}

}  // namespace

void report_batch(const BatchFolder& folder, const std::vector<json>& rows, Session& session) {
  const BatchOrder& order = folder.order();
  std::map<std::string, int> states = states_of(rows);
  ordered_json& document = session.document;
  document["hookeye"] = 1;
  document["command"] = "batch";
  document["folder"] = folder.path().string();
  document["verb"] = order.verb;
  document["options"] = order.options;
  document["counts"] = {{"captures", rows.size()},
                        {"done", states["done"]},
                        {"failed", states["failed"]},
                        {"running", states["leased"]},
                        {"todo", states["todo"]}};
  document["captures"] = rows;
  std::string line = fmt::format("{} capture{}: {} done", rows.size(), rows.size() == 1 ? "" : "s",
                                 states["done"]);
  for (const auto& [state, words] : {std::pair<const char*, const char*>{"failed", "failed"},
                                     {"leased", "at work"},
                                     {"todo", "to do"}})
    if (states[state]) line += fmt::format(", {} {}", states[state], words);
  session.say("{}\n", line);
  say_effects(rows, session);
  say_failures(rows, session);
  say_warnings(rows, session);
  const std::filesystem::path page = folder.path() / "index.html";
  session.say("page: {}\ntable: {} (and index.sqlite)\n", page.string(),
              (folder.path() / "index.csv").string());
  constexpr int kSomeFailed = 3;
  if (states["failed"]) session.status = kSomeFailed;
}

}  // namespace hookeye
