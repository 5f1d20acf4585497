// A table of text as test machines write it: any head, any delimiter, decimal point or comma.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hookeye {

/// Rows of cells below a line of names and, where there is one, a line of units.
struct TextTable {
  std::filesystem::path file;
  char delimiter = ',';  ///< of , ; tab and blank
  bool decimal_comma = false;
  std::vector<std::string> head;          ///< the lines above the names
  int names_line = 0;                     ///< 0: there are none
  std::vector<std::string> names, units;  ///< of each column; "": not told
  std::vector<std::vector<std::string>> rows;
  std::vector<int> lines;  ///< of each row in the file
  /// Lines among the rows that are none of the table, as "FILE:57: `text`".
  std::vector<std::string> strangers;
};

/// The table of a file; empty where there is none (fewer than three rows of two numbers). UTF-8,
/// UTF-16 and Latin-1. Throws InputError where the file cannot be read or has more than 64 MiB.
std::optional<TextTable> read_text_table(const std::filesystem::path& file);

/// A cell as a number: 1.5, 1,5, 1,234.5, 00:01:30.2 (a time of the day in s), and a date with a
/// time of the day (s since 1970); empty: it is none. `clock` is set where it tells time so.
std::optional<double> number_in(const std::string& cell, bool decimal_comma, bool* clock = nullptr);

/// How many of the unit of `kind` (s, N, mm) one of `unit` is; empty: not known.
enum class Quantity { time, force, length };
std::optional<double> unit_in(const std::string& unit, Quantity kind);

}  // namespace hookeye
