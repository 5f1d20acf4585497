#include <fmt/format.h>

#include <sstream>

#include "placing/field_lines.h"
#include "placing/pairs.h"

namespace hookeye {
namespace {

constexpr const char* kRight = "CAMERA:u,v=x,y,z, as front:412.5,233=10,0,80";
constexpr const char* kRightLine = "CAMERA u v x y z, as `front 412.5 233  10 0 80`";

/// Numbers between commas, as many as asked for; empty: others stand there.
std::vector<double> numbers(const std::string& text, size_t count) {
  std::vector<std::string> cells;
  std::istringstream all(text);
  for (std::string cell; std::getline(all, cell, ',');) cells.push_back(cell);
  return text.ends_with(',') ? std::vector<double>{} : numbers_in(cells, 0, count);
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
  std::vector<PickedPair> out;
  for (const FieldLine& line : field_lines(file)) {
    const std::vector<double> all = numbers_in(line.fields, 1, 5);
    if (all.empty())
      throw InputError(line.place, "this line is no pair of a pixel and a point", kRightLine);
    out.push_back(
        pair_of(line.fields.front(), {all[0], all[1]}, {all[2], all[3], all[4]}, line.place));
  }
  if (out.empty()) throw InputError({file.string()}, "there is no pair in this file", kRightLine);
  return out;
}

}  // namespace hookeye
