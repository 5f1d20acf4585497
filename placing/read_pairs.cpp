#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <sstream>

#include "core/text_file.h"
#include "placing/pairs.h"

namespace hookeye {
namespace {

constexpr const char* kRight = "CAMERA:u,v=x,y,z, as front:412.5,233=10,0,80";
constexpr const char* kRightLine = "CAMERA u v x y z, as `front 412.5 233  10 0 80`";

/// Numbers between commas, as many as asked for; empty: others stand there.
std::vector<double> numbers(const std::string& text, size_t count) {
  std::vector<double> out;
  std::istringstream cells(text);
  for (std::string cell; std::getline(cells, cell, ',');) {
    const size_t first = cell.find_first_not_of(" \t");
    const size_t last = cell.find_last_not_of(" \t");
    if (first == std::string::npos) return {};
    const char* const begin = cell.data() + first + (cell[first] == '+' ? 1 : 0);
    const char* const end = cell.data() + last + 1;
    double value = 0.0;
    const auto [at, fault] = std::from_chars(begin, end, value);
    if (fault != std::errc() || at != end || !std::isfinite(value)) return {};
    out.push_back(value);
  }
  return out.size() == count && !text.ends_with(',') ? out : std::vector<double>{};
}

PickedPair pair_of(const std::string& camera, const std::vector<double>& pixel,
                   const std::vector<double>& point, const Place& place) {
  return {camera, {pixel[0], pixel[1]}, {point[0], point[1], point[2]}, place};
}

}  // namespace

PickedPair read_pair(const std::string& text, const Place& place) {
  const size_t middle = text.rfind('=');
  const size_t colon = middle == std::string::npos ? middle : text.rfind(':', middle);
  if (colon == std::string::npos || colon == 0)
    throw InputError(place, fmt::format("`{}` is no pair of a pixel and a point", text), kRight);
  const auto pixel = numbers(text.substr(colon + 1, middle - colon - 1), 2);
  const auto point = numbers(text.substr(middle + 1), 3);
  if (pixel.empty() || point.empty())
    throw InputError(
        place,
        fmt::format("`{}` has no {} {} `=`", text, pixel.empty() ? "two numbers" : "three numbers",
                    pixel.empty() ? "before" : "behind"),
        kRight);
  return pair_of(text.substr(0, colon), pixel, point, place);
}

std::vector<PickedPair> read_pairs(const std::filesystem::path& file) {
  std::istringstream lines(read_text(file));
  std::vector<PickedPair> out;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // a byte order mark
    line.resize(std::min(line.size(), line.find('#')));
    for (char& c : line)
      if (c == ',' || c == ';' || c == '\t' || c == '\r') c = ' ';
    std::istringstream fields(line);
    std::string camera, field, rest;
    if (!(fields >> camera)) continue;
    while (fields >> field) rest += (rest.empty() ? "" : ",") + field;
    const std::vector<double> all = numbers(rest, 5);
    const Place place{file.string(), number};
    if (all.empty())
      throw InputError(place, "this line is no pair of a pixel and a point", kRightLine);
    out.push_back(pair_of(camera, {all[0], all[1]}, {all[2], all[3], all[4]}, place));
  }
  if (out.empty()) throw InputError({file.string()}, "there is no pair in this file", kRightLine);
  return out;
}

}  // namespace hookeye
