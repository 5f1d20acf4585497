#include "app/session.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "app/interrupt.h"

namespace hookeye {

void Session::warn(const std::string& sentence) {
  spdlog::warn("{}", sentence);
  document["warnings"].push_back(sentence);
}

void fail(NumericalFailure failure) {
  if (interrupted()) throw Interrupted{};
  throw Failed{std::move(failure)};
}

std::string table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line = " ";
    for (size_t i = 0; i < row.size(); ++i) line += fmt::format(" {:{}} ", row[i], widths[i]);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

}  // namespace hookeye
