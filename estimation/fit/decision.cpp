#include "estimation/fit/decision.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace hookeye {

namespace {

constexpr std::array<const char*, 12> kAsked = {"named",  "screened", "refitted", "ranked",
                                                "stands", "widened",  "dropped",  "swapped",
                                                "tied",   "paired",   "ended",    "scored"};

double number_or_nan(const nlohmann::json& line, const char* key) {
  const nlohmann::json& value = line.at(key);
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

nlohmann::json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

/// From the folder of the sources on.
std::string short_path(const std::string& path) {
  const size_t at = path.rfind("estimation/");
  return at == std::string::npos ? path : path.substr(at);
}

}  // namespace

const char* to_string(Asked asked) { return kAsked.at(static_cast<size_t>(asked)); }

bool tell(const Decided& decided, Decision decision, SourceLine where) {
  if (decision.where.empty())
    decision.where = fmt::format("{}:{}", short_path(where.file), where.line);
  if (decided) decided(decision);
  return decision.accepted;
}

nlohmann::json to_json(const Decision& decision) {
  nlohmann::json out = {{"asked", to_string(decision.asked)},
                        {"candidate", decision.candidate},
                        {"accepted", decision.accepted},
                        {"value", number_or_null(decision.by.value)},
                        {"limit", number_or_null(decision.by.limit)},
                        {"option", decision.by.option},
                        {"why", decision.why},
                        {"where", decision.where},
                        {"cpu_s", decision.cpu_s}};
  for (const auto& [name, value] : decision.parts) out["parts"][name] = number_or_null(value);
  return out;
}

Decision decision_from_json(const nlohmann::json& line) {
  Decision out;
  const std::string asked = line.at("asked");
  const auto found = std::find(kAsked.begin(), kAsked.end(), asked);
  if (found == kAsked.end()) throw std::out_of_range("no such question: " + asked);
  out.asked = static_cast<Asked>(found - kAsked.begin());
  out.candidate = line.at("candidate");
  out.accepted = line.at("accepted");
  out.by = {number_or_nan(line, "value"), number_or_nan(line, "limit"), line.at("option")};
  out.why = line.at("why");
  out.where = line.at("where");
  if (line.contains("parts"))
    for (const auto& part : line.at("parts").items())
      out.parts[part.key()] = number_or_nan(line.at("parts"), part.key().c_str());
  out.cpu_s = line.value("cpu_s", 0.0);
  return out;
}

}  // namespace hookeye
