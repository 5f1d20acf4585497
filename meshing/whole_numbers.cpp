#include "meshing/whole_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

namespace hookeye::detail {

void check_whole_numbers(std::string_view line, const Place& place) {
  constexpr std::string_view kBetween = " \t\r\n/";
  for (size_t at = 0; (at = line.find_first_not_of(kBetween, at)) != std::string_view::npos;) {
    const size_t end = std::min(line.find_first_of(kBetween, at), line.size());
    const std::string_view field = line.substr(at, end - at);
    int value = 0;
    const auto [stop, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error == std::errc::result_out_of_range && stop == field.data() + field.size())
      throw InputError(place,
                       fmt::format("the number {} counts nothing that a mesh can have", field),
                       fmt::format("whole numbers up to {}", std::numeric_limits<int>::max()));
    at = end;
  }
}

}  // namespace hookeye::detail
