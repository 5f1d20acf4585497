// Cells of a table and names of units.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <map>
#include <regex>

#include "proposal/text_table.h"
#include "proposal/words.h"

namespace hookeye {
namespace {

std::optional<double> plain_number(const std::string& text) {
  double value = 0;
  const char* from = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(from, text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

/// 1,234.5 with `mark` ',': groups of three digits after one to three, of which the first is no 0.
bool has_thousands(const std::string& text, char mark, char point) {
  size_t at = text.find_first_of("0123456789");
  if (at > 1 || at == std::string::npos || text[at] == '0') return false;
  const size_t end = std::min(text.find(point, at), text.size());
  const size_t first = text.find(mark, at);
  if (first == std::string::npos || first > end || first - at > 3) return false;
  for (at = first; at < end; at += 4) {
    if (text[at] != mark || at + 4 > end) return false;
    for (size_t i = at + 1; i < at + 4; ++i)
      if (!std::isdigit(static_cast<unsigned char>(text[i]))) return false;
  }
  return true;
}

double days_to(int year, int month, int day) {
  using namespace std::chrono;
  const sys_days date(std::chrono::year(year) / month / day);
  return static_cast<double>(date.time_since_epoch().count());
}

int whole(const std::ssub_match& match) { return match.matched ? std::stoi(match.str()) : 0; }

/// [date ](h)h:mm(:ss(.fff)): 2024-05-01, 01.05.2024, 2024:05:01 before it where there is a date.
std::optional<double> clock_number(std::string text) {
  if (text.size() < 4 || text.size() > 40 || text.find(':') == std::string::npos) return {};
  std::replace(text.begin(), text.end(), ',', '.');
  static const std::regex form(
      R"((?:(\d{4})[-/:.](\d{1,2})[-/:.](\d{1,2})[ T]|(\d{1,2})\.(\d{1,2})\.(\d{4}) )?)"
      R"((\d{1,3}):(\d{2})(?::(\d{2}(?:\.\d{1,9})?))?Z?)");
  std::smatch m;
  if (!std::regex_match(text, m, form)) return {};
  double seconds = 3600.0 * whole(m[7]) + 60.0 * whole(m[8]);
  if (m[9].matched)
    seconds += std::stod(m[9].str());
  else
    seconds /= m[1].matched || m[4].matched ? 1.0 : 60.0;  // 01:30 alone is a minute and a half
  if (m[1].matched) seconds += 86400.0 * days_to(whole(m[1]), whole(m[2]), whole(m[3]));
  if (m[4].matched) seconds += 86400.0 * days_to(whole(m[6]), whole(m[5]), whole(m[4]));
  return seconds;
}

}  // namespace

std::optional<double> number_in(const std::string& cell, bool decimal_comma, bool* clock) {
  if (cell.empty() || cell.size() > 60) return {};
  const char first = cell.front();
  if (!std::isdigit(static_cast<unsigned char>(first)) && first != '-' && first != '+' &&
      first != '.' && first != ',')
    return {};
  std::string text = cell;
  const char point = decimal_comma ? ',' : '.', mark = decimal_comma ? '.' : ',';
  if (has_thousands(text, mark, point)) std::erase(text, mark);
  if (decimal_comma && text.find('.') == std::string::npos)
    std::replace(text.begin(), text.end(), ',', '.');
  if (!decimal_comma || cell.find('.') == std::string::npos || text != cell)
    if (const auto value = plain_number(text)) return value;
  const auto value = clock_number(cell);
  if (value && clock != nullptr) *clock = true;
  return value;
}

std::optional<double> unit_in(const std::string& unit, Quantity kind) {
  static const std::map<std::string, double> times = {
      {"s", 1},        {"sec", 1},   {"secs", 1},     {"second", 1}, {"seconds", 1},
      {"sek", 1},      {"ms", 1e-3}, {"msec", 1e-3},  {"us", 1e-6},  {"min", 60},
      {"minutes", 60}, {"h", 3600},  {"hours", 3600}, {"µs", 1e-6}};
  static const std::map<std::string, double> forces = {{"n", 1},
                                                       {"kn", 1e3},
                                                       {"cn", 1e-2},
                                                       {"µn", 1e-6},
                                                       {"un", 1e-6},
                                                       {"newton", 1},
                                                       {"newtons", 1},
                                                       {"lbf", 4.4482216152605},
                                                       {"lbs", 4.4482216152605},
                                                       {"lb", 4.4482216152605},
                                                       {"kgf", 9.80665},
                                                       {"gf", 9.80665e-3},
                                                       {"ozf", 0.27801385}};
  static const std::map<std::string, double> lengths = {
      {"mm", 1},    {"cm", 10},   {"m", 1000},    {"um", 1e-3},     {"µm", 1e-3},
      {"μm", 1e-3}, {"in", 25.4}, {"inch", 25.4}, {"inches", 25.4}, {"millimeter", 1}};
  // Capitals tell milli from mega.
  if (kind == Quantity::force && unit == "mN") return 1e-3;
  if (kind == Quantity::force && unit == "MN") return 1e6;
  const auto& known = kind == Quantity::time ? times : kind == Quantity::force ? forces : lengths;
  const auto at = known.find(lower(unit));
  if (at == known.end()) return {};
  return at->second;
}

}  // namespace hookeye
