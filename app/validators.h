// Checks of the numbers of options. CLI11's own PositiveNumber states its range, the end of which
// is the largest double, in 309 digits.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>
#include <string>

#include "core/memory_left.h"

namespace hookeye {

/// A whole number from 1 that an int holds.
inline CLI::Validator counting_number() {
  return CLI::Validator(
      [](std::string& text) {
        double value = 0.0;
        const bool good = CLI::detail::lexical_cast(text, value) && value >= 1.0 &&
                          value <= std::numeric_limits<int>::max() && std::floor(value) == value;
        return good ? std::string()
                    : fmt::format("a whole number from 1 is expected, not {}", text);
      },
      "FROM 1");
}

/// A finite number above zero.
inline CLI::Validator above_zero() {
  return CLI::Validator(
      [](std::string& text) {
        double value = 0.0;
        const bool good =
            CLI::detail::lexical_cast(text, value) && value > 0.0 && std::isfinite(value);
        return good ? std::string() : fmt::format("a number above zero is expected, not {}", text);
      },
      "POSITIVE");
}

/// At least 200 MB, as "4G"; stored in bytes.
inline CLI::Validator memory_size() {
  return CLI::Validator(
      [](std::string& text) {
        constexpr double kLeast = 2e8;  // below it not even a small capture is fitted
        const auto bytes = bytes_in(text);
        if (!bytes || *bytes < kLeast)
          return fmt::format("a size from 200M is expected, as 4G or 1.5GB, not {}", text);
        text = fmt::format("{:.0f}", *bytes);
        return std::string();
      },
      "SIZE");
}

}  // namespace hookeye
