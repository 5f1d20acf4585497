#include "capture_io/field_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {

namespace {

constexpr std::array<const char*, 6> kRoles{"X", "Y", "Z", "U", "V", "W"};

/// What a program calls them; "": it has none. Of two that fit a file the first is taken.
struct Dialect {
  std::array<const char*, 6> names;
  const char* unit;
};
constexpr Dialect kDialects[] = {
    {{"X", "Y", "Z", "U", "V", "W"}, ""},  // VIC-3D, MatchID
    {{"MODEL_COORDINATES_X", "MODEL_COORDINATES_Y", "MODEL_COORDINATES_Z", "MODEL_DISPLACEMENT_X",
      "MODEL_DISPLACEMENT_Y", "MODEL_DISPLACEMENT_Z"},
     ""},  // DICe, stereo
    {{"COORDINATE_X", "COORDINATE_Y", "", "DISPLACEMENT_X", "DISPLACEMENT_Y", ""}, "px"},  // DICe
    {{"subset_x", "subset_y", "", "displacement_u", "displacement_v", ""}, "px"},          // pyvale
    {{"X", "Y", "Z", "Ux", "Uy", "Uz"}, ""},
    {{"x", "y", "z", "u", "v", "w"}, ""},
    {{"x", "y", "z", "ux", "uy", "uz"}, ""},
};

std::string_view trimmed(std::string_view text) {
  const auto quiet = [](char c) { return std::isspace(static_cast<unsigned char>(c)) || c == '"'; };
  while (!text.empty() && quiet(text.front())) text.remove_prefix(1);
  while (!text.empty() && quiet(text.back())) text.remove_suffix(1);
  return text;
}

/// One line after the other, without ends of line.
class Lines {
 public:
  explicit Lines(const std::string& text) : rest_(text) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  }
  bool next() {
    if (rest_.empty()) return false;
    const size_t end = std::min(rest_.find('\n'), rest_.size());
    line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++number;
    return true;
  }
  std::string_view line;
  int number = 0;

 private:
  std::string_view rest_;
};

/// ' ': any number of blanks.
char separator_of(std::string_view head) {
  for (const char one : {';', '\t', ','})
    if (head.find(one) != std::string_view::npos) return one;
  return ' ';
}

void split(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  if (separator == ' ') {
    for (size_t at = 0; (at = line.find_first_not_of(' ', at)) != std::string_view::npos;) {
      const size_t end = std::min(line.find(' ', at), line.size());
      cells.push_back(trimmed(line.substr(at, end - at)));
      at = end;
    }
    return;
  }
  for (size_t at = 0; at <= line.size();) {
    const size_t end = std::min(line.find(separator, at), line.size());
    cells.push_back(trimmed(line.substr(at, end - at)));
    at = end + 1;
  }
}

/// "Displacement.U [mm]" is the column U in mm.
struct Head {
  std::string name, unit;
};

Head head_of(std::string_view cell) {
  Head out;
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    const size_t at = cell.find(open), end = cell.rfind(close);
    if (at == std::string_view::npos || end == std::string_view::npos || end < at) continue;
    out.unit = trimmed(cell.substr(at + 1, end - at - 1));
    cell = trimmed(cell.substr(0, at));
    break;
  }
  for (const char* group : {"Coordinates.", "Displacement."})
    if (cell.starts_with(group)) cell.remove_prefix(std::string_view(group).size());
  out.name = cell;
  if (out.unit == "pixel" || out.unit == "pixels" || out.unit == "Pixel") out.unit = "px";
  return out;
}

/// A number; not finite where the cell tells that there is none; empty: it is text.
std::optional<double> number_in(std::string_view cell, bool decimal_comma) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  std::string text(cell);
  if (decimal_comma) std::replace(text.begin(), text.end(), ',', '.');
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (!lower.empty() && (lower[0] == '+' || lower[0] == '-')) lower.erase(0, 1);
  // "nan(ind)" and "1.#QNAN" are what C libraries write.
  if (lower.empty() || lower.starts_with("nan") || lower.starts_with("inf") ||
      lower.starts_with("1.#") || lower == "na" || lower == "null" || lower == "none")
    return none;
  double value = 0.0;
  const char* begin = text.data() + (text[0] == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range) return none;
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Where the columns stand; -1: the file has none.
struct Columns {
  std::array<int, 6> of_role{-1, -1, -1, -1, -1, -1};
  int sigma = -1;      ///< below zero: not correlated (VIC-3D, DICe)
  int flag = -1;       ///< the same (DICe)
  int converged = -1;  ///< zero: not correlated (pyvale)
  std::string unit;
  size_t count = 0;
};

int find(const std::vector<Head>& heads, std::string_view name) {
  for (size_t i = 0; i < heads.size(); ++i)
    if (heads[i].name == name) return static_cast<int>(i);
  return -1;
}

std::string listed(const std::vector<std::string_view>& cells) {
  std::vector<std::string> shown;
  for (size_t i = 0; i < std::min<size_t>(cells.size(), 20); ++i)
    shown.emplace_back(cells[i].substr(0, 40));
  return fmt::format("{}{}", fmt::join(shown, ", "), cells.size() > 20 ? ", ..." : "");
}

/// By the names that the user gave; the others must be the roles' own.
void by_told_names(const std::map<std::string, std::string>& told, const Place& place,
                   const std::vector<std::string_view>& cells, const std::vector<Head>& heads,
                   Columns& out) {
  for (size_t role = 0; role < kRoles.size(); ++role) {
    const auto named = told.find(kRoles[role]);
    out.of_role[role] = find(heads, named == told.end() ? kRoles[role] : named->second);
    if (named == told.end()) continue;
    for (size_t i = 0; i < cells.size() && out.of_role[role] < 0; ++i)
      if (cells[i] == named->second) out.of_role[role] = static_cast<int>(i);
    if (out.of_role[role] < 0)
      throw InputError(place, fmt::format("there is no column `{}`", named->second),
                       "the file has " + listed(cells));
  }
}

/// Pixels are not taken where the file has lengths but for one or two columns.
void refuse_partial(const std::vector<std::string_view>& cells, const std::vector<Head>& heads,
                    const Place& place) {
  for (const Dialect& dialect : kDialects) {
    if (*dialect.unit) continue;
    std::vector<std::string> there, missing;
    for (const char* name : dialect.names)
      (find(heads, name) >= 0 ? there : missing).push_back(name);
    if (there.size() < 4) continue;
    throw InputError(
        place,
        fmt::format("of {} the file lacks {}; it has {}", fmt::join(dialect.names, ", "),
                    fmt::join(missing, ", "), listed(cells)),
        "export all of them; or tell the file's own names: `columns: {X: NAME, Y: "
        "NAME, U: NAME, V: NAME}`");
  }
}

Columns columns_in(const std::vector<std::string_view>& cells, const Place& place,
                   const std::map<std::string, std::string>& told) {
  std::vector<Head> heads;
  for (const auto cell : cells) heads.push_back(head_of(cell));
  Columns out;
  out.count = cells.size();
  const auto complete = [&] {
    return out.of_role[0] >= 0 && out.of_role[1] >= 0 && out.of_role[3] >= 0 && out.of_role[4] >= 0;
  };
  if (!told.empty()) {
    by_told_names(told, place, cells, heads, out);
  } else {
    for (const Dialect& dialect : kDialects) {
      for (size_t role = 0; role < kRoles.size(); ++role)
        out.of_role[role] = *dialect.names[role] ? find(heads, dialect.names[role]) : -1;
      out.unit = dialect.unit;
      if (complete()) break;
    }
    if (!complete() || out.unit == "px") refuse_partial(cells, heads, place);
  }
  if (!complete())
    throw InputError(place,
                     "the columns of points and displacements are not found in " + listed(cells),
                     "X, Y, U, V and, where they are known, Z and W; or tell the file's own names: "
                     "`columns: {X: NAME, Y: NAME, U: NAME, V: NAME}`");
  for (size_t role = 0; role < kRoles.size(); ++role) {
    if (out.of_role[role] < 0) continue;
    const Head& head = heads[static_cast<size_t>(out.of_role[role])];
    if (head.unit.empty()) continue;
    if (!out.unit.empty() && out.unit != head.unit)
      throw InputError(
          place, fmt::format("column `{}` is in {}, others in {}", head.name, head.unit, out.unit),
          "one unit for all of them");
    out.unit = head.unit;
  }
  for (const char* name : {"sigma", "SIGMA"})
    if (out.sigma < 0) out.sigma = find(heads, name);
  out.flag = find(heads, "STATUS_FLAG");
  out.converged = find(heads, "converged");
  return out;
}

/// Whether the file itself says that the row tells nothing.
bool is_marked(const Columns& columns, const std::vector<std::string_view>& cells, bool comma) {
  for (const int column : {columns.sigma, columns.flag})
    if (column >= 0 && number_in(cells[static_cast<size_t>(column)], comma).value_or(0.0) < 0.0)
      return true;
  if (columns.converged < 0) return false;
  const auto cell = cells[static_cast<size_t>(columns.converged)];
  return cell == "False" || cell == "false" || number_in(cell, comma).value_or(1.0) == 0.0;
}

/// By role, 0 where the file has none; not finite where a cell tells no number.
std::array<double, 6> row_of(const std::vector<std::string_view>& cells, const Columns& columns,
                             bool comma, const Place& place) {
  std::array<double, 6> out{};
  for (size_t role = 0; role < out.size(); ++role) {
    if (columns.of_role[role] < 0) continue;
    const auto cell = cells[static_cast<size_t>(columns.of_role[role])];
    const auto value = number_in(cell, comma);
    if (!value)
      throw InputError(place,
                       fmt::format("`{}` in column {} is no number", cell.substr(0, 40),
                                   columns.of_role[role] + 1),
                       "a number, or nan where the point has none");
    out[role] = *value;
  }
  return out;
}

/// Skips what stands before the head; faults where there is none.
void to_head(Lines& lines, const std::string& told, std::vector<std::string_view>& cells,
             char& separator) {
  while (lines.next()) {
    const auto text = trimmed(lines.line);
    if (text.empty() || text.starts_with('#') || text.starts_with("***")) continue;
    separator = separator_of(lines.line);
    split(lines.line, separator, cells);
    const bool numbers = std::all_of(cells.begin(), cells.end(), [&](auto cell) {
      return number_in(cell, separator == ';').has_value();
    });
    if (numbers)
      throw InputError({told, lines.number}, "the table begins without the names of its columns",
                       "a first line such as `X,Y,Z,U,V,W`");
    return;
  }
  throw InputError({told}, "the file is empty", "a table of points with their displacements");
}

}  // namespace

FieldTable read_field_table(const std::filesystem::path& file, const std::string& told,
                            const std::map<std::string, std::string>& names) {
  const std::string text = read_text(file);
  if (const size_t zero = text.find('\0'); zero != std::string::npos)
    throw InputError(
        {told, 1 + static_cast<int>(std::count(text.begin(), text.begin() + zero, '\n'))},
        "there is a zero byte: this is no text", "a table as text, in UTF-8");
  Lines lines(text);
  std::vector<std::string_view> cells;
  char separator = ',';
  to_head(lines, told, cells, separator);
  const Columns columns = columns_in(cells, {told, lines.number}, names);
  FieldTable out;
  out.unit = columns.unit;
  out.has_z = columns.of_role[2] >= 0;
  out.has_w = columns.of_role[5] >= 0;
  const bool comma = separator == ';' || separator == '\t';
  std::vector<std::array<double, 6>> rows;
  while (lines.next()) {
    if (trimmed(lines.line).empty()) continue;
    split(lines.line, separator, cells);
    if (cells.size() == columns.count + 1 && cells.back().empty()) cells.pop_back();
    if (cells.size() != columns.count)
      throw InputError(
          {told, lines.number},
          fmt::format("the row has {} cells, the head {}", cells.size(), columns.count),
          "one cell for every column");
    const std::array<double, 6> row = row_of(cells, columns, comma, {told, lines.number});
    const bool whole =
        std::all_of(row.begin(), row.end(), [](double x) { return std::isfinite(x); });
    if (!whole || is_marked(columns, cells, comma)) {
      ++out.dropped;
      continue;
    }
    rows.push_back(row);
    out.lines.push_back(lines.number);
  }
  if (rows.empty())
    throw InputError({told}, fmt::format("no point is left ({} rows dropped)", out.dropped),
                     "rows with numbers for the place and the displacement of a point");
  out.X.resize(3, static_cast<Eigen::Index>(rows.size()));
  out.u.resize(3, out.X.cols());
  for (Eigen::Index k = 0; k < out.X.cols(); ++k)
    for (int i = 0; i < 3; ++i) {
      out.X(i, k) = rows[static_cast<size_t>(k)][static_cast<size_t>(i)];
      out.u(i, k) = rows[static_cast<size_t>(k)][static_cast<size_t>(i) + 3];
    }
  return out;
}

}  // namespace hookeye
