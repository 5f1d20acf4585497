#include "proposal/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "core/input_error.h"
#include "core/text_file.h"
#include "proposal/words.h"

namespace hookeye {

namespace fs = std::filesystem;

namespace {

constexpr uintmax_t kMostBytes = uintmax_t{64} << 20;
constexpr size_t kSampled = 2000;  ///< lines that decide upon the delimiter

struct Line {
  int number;
  std::string text;
};

/// UTF-16 (testing programs on Windows write it) as UTF-8, characters beyond Latin-1 as `?`.
std::string from_utf16(const std::string& bytes, bool big_endian) {
  std::string out;
  for (size_t i = 2; i + 1 < bytes.size(); i += 2) {
    const auto first = static_cast<unsigned char>(bytes[i + (big_endian ? 0 : 1)]);
    const auto second = static_cast<unsigned char>(bytes[i + (big_endian ? 1 : 0)]);
    if (first != 0)
      out += '?';
    else if (second < 0x80)
      out += static_cast<char>(second);
    else
      out += {static_cast<char>(0xC0 | (second >> 6)), static_cast<char>(0x80 | (second & 0x3F))};
  }
  return out;
}

/// Whether bytes beyond ASCII come as UTF-8 has them: a leading one, then its followers.
bool is_utf8(const std::string& text) {
  int due = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (due > 0) {
      if ((byte & 0xC0) != 0x80) return false;
      --due;
    } else if (byte >= 0x80) {
      due = (byte & 0xE0) == 0xC0 ? 1 : (byte & 0xF0) == 0xE0 ? 2 : (byte & 0xF8) == 0xF0 ? 3 : -1;
      if (due < 0) return false;
    }
  }
  return due == 0;
}

std::string from_latin1(const std::string& bytes) {
  std::string out;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80)
      out += c;
    else
      out += {static_cast<char>(0xC0 | (byte >> 6)), static_cast<char>(0x80 | (byte & 0x3F))};
  }
  return out;
}

std::vector<Line> lines_of(const fs::path& file) {
  std::string text = read_text(file);
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    text = from_utf16(text, text[0] == '\xFE');
  else if (text.starts_with("\xEF\xBB\xBF"))
    text.erase(0, 3);
  else if (!is_utf8(text))
    text = from_latin1(text);
  std::vector<Line> lines;
  int number = 0;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size());
    ++number;
    std::string line = text.substr(at, end - at);
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (!line.empty()) lines.push_back({number, std::move(line)});
    at = end + 1;
  }
  return lines;
}

/// The cells of a line; a delimiter within quotes is part of the cell.
std::vector<std::string> split(const std::string& line, char delimiter) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"')
        cells.back() += line[++i];
      else
        quoted = !quoted;
    } else if (c == delimiter && !quoted) {
      if (delimiter != ' ' || !cells.back().empty()) cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  for (std::string& cell : cells) cell = trimmed(cell);
  if (delimiter == ' ' && cells.back().empty()) cells.pop_back();
  return cells;
}

size_t numbers_among(const std::vector<std::string>& cells, bool comma) {
  return static_cast<size_t>(std::count_if(cells.begin(), cells.end(), [&](const auto& cell) {
    return number_in(cell, comma).has_value();
  }));
}

bool is_row(const std::vector<std::string>& cells, bool comma) {
  const size_t numbers = numbers_among(cells, comma);
  return numbers >= 2 && 2 * numbers >= cells.size();
}

/// By which the lines fall into the most numbers: text around a number counts against it.
void find_delimiter(const std::vector<Line>& lines, TextTable& table) {
  double best = 0;
  for (const char delimiter : {'\t', ';', ',', ' '})
    for (const bool comma : {false, true}) {
      double score = 0;
      for (size_t i = 0; i < std::min(lines.size(), kSampled); ++i) {
        const auto cells = split(lines[i].text, delimiter);
        if (is_row(cells, comma))
          score +=
              static_cast<double>(numbers_among(cells, comma)) / static_cast<double>(cells.size());
      }
      if (score <= best + 1e-9) continue;
      best = score;
      table.delimiter = delimiter, table.decimal_comma = comma;
    }
}

/// The number of cells that most rows have.
size_t usual_width(const std::vector<Line>& lines, const TextTable& table) {
  std::map<size_t, int> count;
  for (size_t i = 0; i < std::min(lines.size(), kSampled); ++i) {
    const auto cells = split(lines[i].text, table.delimiter);
    if (is_row(cells, table.decimal_comma)) ++count[cells.size()];
  }
  size_t usual = 0;
  int most = 0;
  for (const auto& [width, rows] : count)
    if (rows > most) most = rows, usual = width;
  return usual;
}

/// "(s)" or "[mm]" or "N" -> "s", "mm", "N".
std::string bare_unit(std::string cell) {
  cell = trimmed(cell);
  if (cell.size() > 2 && (cell.front() == '(' || cell.front() == '['))
    cell = trimmed(cell.substr(1, cell.size() - 2));
  return cell;
}

bool is_unit(const std::string& cell) {
  static const std::vector<std::string> others = {"%",     "mpa", "kpa",   "pa",    "n/mm2",
                                                  "n/mm²", "1",   "-",     "mm/mm", "mm/s",
                                                  "°c",    "v",   "digit", "cycles"};
  const std::string unit = bare_unit(cell);
  for (const Quantity kind : {Quantity::time, Quantity::force, Quantity::length})
    if (unit_in(unit, kind)) return true;
  return std::find(others.begin(), others.end(), lower(unit)) != others.end();
}

bool are_units(const std::vector<std::string>& cells) {
  size_t told = 0;
  for (const std::string& cell : cells) {
    if (cell.empty()) continue;
    // A bracket round a short word is a unit that is not known here, and will be refused by name.
    const bool bracketed = (cell.front() == '[' || cell.front() == '(') && cell.size() <= 8;
    if (!is_unit(cell) && !bracketed) return false;
    ++told;
  }
  return told > 0;
}

/// The unit within a name: "Force [N]", "Load (kN)", "Kraft in N", "Extension/mm", "force_N".
std::string unit_within(const std::string& name) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const size_t from = name.rfind(open), to = name.rfind(close);
    if (from == std::string::npos || to == std::string::npos || to < from) continue;
    const std::string inside = trimmed(name.substr(from + 1, to - from - 1));
    if (open == '[' || is_unit(inside)) return inside;
  }
  for (const std::string before : {" in ", "/", "_", " "}) {
    const size_t at = name.rfind(before);
    if (at == std::string::npos) continue;
    const std::string behind = trimmed(name.substr(at + before.size()));
    if (is_unit(behind) && behind != "1" && behind != "-") return behind;
  }
  return "";
}

void name_columns(const std::vector<Line>& lines, size_t first, size_t width, TextTable& table) {
  table.names.assign(width, "");
  table.units.assign(width, "");
  size_t names = first;
  std::vector<std::string> units;
  if (names > 0 && are_units(split(lines[names - 1].text, table.delimiter)))
    units = split(lines[--names].text, table.delimiter);
  if (names > 0) {
    const auto cells = split(lines[names - 1].text, table.delimiter);
    if (cells.size() >= 2 && numbers_among(cells, table.decimal_comma) == 0) {
      --names;
      table.names_line = lines[names].number;
      for (size_t i = 0; i < std::min(width, cells.size()); ++i) table.names[i] = cells[i];
    }
  }
  for (size_t i = 0; i < width; ++i)
    table.units[i] =
        i < units.size() && !units[i].empty() ? bare_unit(units[i]) : unit_within(table.names[i]);
  for (size_t i = 0; i < names; ++i) table.head.push_back(lines[i].text);
}

}  // namespace

std::optional<TextTable> read_text_table(const fs::path& file) {
  std::error_code error;
  if (const uintmax_t size = fs::file_size(file, error); error || size > kMostBytes)
    throw InputError({file.string()}, "the table has more than 64 MiB",
                     "export the columns of time, force and travel alone, or fewer rows a second");
  const std::vector<Line> lines = lines_of(file);
  TextTable table;
  table.file = file;
  find_delimiter(lines, table);
  const size_t width = usual_width(lines, table);
  std::vector<std::vector<std::string>> cells;
  for (const Line& line : lines) cells.push_back(split(line.text, table.delimiter));
  const auto row_at = [&](size_t i) {
    return i < lines.size() && cells[i].size() == width && is_row(cells[i], table.decimal_comma);
  };
  size_t first = 0;
  while (first < lines.size() && !(row_at(first) && row_at(first + 1) && row_at(first + 2)))
    ++first;
  if (width < 2 || first == lines.size()) return {};
  name_columns(lines, first, width, table);
  for (size_t i = first; i < lines.size(); ++i) {
    if (numbers_among(cells[i], table.decimal_comma) == 0) {
      table.strangers.push_back(
          fmt::format("{}:{}: `{}`", file.string(), lines[i].number, lines[i].text.substr(0, 60)));
      continue;
    }
    table.rows.push_back(std::move(cells[i]));
    table.lines.push_back(lines[i].number);
  }
  return table;
}

}  // namespace hookeye
