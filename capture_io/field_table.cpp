#include "capture_io/field_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string_view>
#include <tuple>

#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {

namespace {

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
      cells.push_back(bare_cell(line.substr(at, end - at)));
      at = end;
    }
    return;
  }
  for (size_t at = 0; at <= line.size();) {
    const size_t end = std::min(line.find(separator, at), line.size());
    cells.push_back(bare_cell(line.substr(at, end - at)));
    at = end + 1;
  }
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

/// Whether the file itself says that the row tells nothing.
bool is_marked(const FieldColumns& columns, const std::vector<std::string_view>& cells,
               bool comma) {
  for (const int column : {columns.sigma, columns.flag})
    if (column >= 0 && number_in(cells[static_cast<size_t>(column)], comma).value_or(0.0) < 0.0)
      return true;
  if (columns.converged < 0) return false;
  const auto cell = cells[static_cast<size_t>(columns.converged)];
  return cell == "False" || cell == "false" || number_in(cell, comma).value_or(1.0) == 0.0;
}

/// By role, 0 where the file has none; not finite where a cell tells no number.
using Row = std::array<double, kFieldRoles.size()>;

Row row_of(const std::vector<std::string_view>& cells, const FieldColumns& columns, bool comma,
           const Place& place) {
  Row out{};
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
  for (size_t role = 6; role < out.size(); ++role) out[role] *= columns.fraction;
  if (columns.gamma) out[8] *= 0.5;
  return out;
}

/// Whether all is there that the field is read for.
bool is_whole(const Row& row, FieldHolds holds) {
  const auto finite = [&](size_t first) {
    return std::all_of(row.begin() + first, row.begin() + first + 3,
                       [](double x) { return std::isfinite(x); });
  };
  return finite(0) && finite(holds == FieldHolds::strains ? 6 : 3);
}

/// Skips what stands before the head; faults where there is none.
void to_head(Lines& lines, const std::string& told, std::vector<std::string_view>& cells,
             char& separator) {
  int commented = 0;  // the last line that might have been meant as the head
  while (lines.next()) {
    const auto text = bare_cell(lines.line);
    if (text.starts_with('#')) commented = lines.number;
    if (text.empty() || text.starts_with('#') || text.starts_with("***")) continue;
    separator = separator_of(lines.line);
    split(lines.line, separator, cells);
    const bool numbers = std::all_of(cells.begin(), cells.end(), [&](auto cell) {
      return number_in(cell, separator == ';').has_value();
    });
    if (numbers)
      throw InputError(
          {told, lines.number}, "the table begins without the names of its columns",
          commented > 0 ? fmt::format("a first line such as `X,Y,Z,U,V,W` without `#`: line {} is "
                                      "a comment (np.savetxt: comments=\"\")",
                                      commented)
                        : "a first line such as `X,Y,Z,U,V,W`");
    return;
  }
  throw InputError({told}, "the file is empty", "a table of points with their displacements");
}

/// Two load cases, or two cameras, in one table.
void refuse_twice(const FieldTable& table, const std::string& told) {
  std::vector<Eigen::Index> order(static_cast<size_t>(table.X.cols()));
  std::iota(order.begin(), order.end(), 0);
  const auto at = [&](Eigen::Index k) {
    return std::make_tuple(table.X(0, k), table.X(1, k), table.X(2, k));
  };
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::make_tuple(at(a), a) < std::make_tuple(at(b), b);
  });
  for (size_t i = 1; i < order.size(); ++i)
    if (at(order[i - 1]) == at(order[i])) {
      const auto line = [&](size_t of) { return table.lines[static_cast<size_t>(order[of])]; };
      const Eigen::Vector3d X = table.X.col(order[i]);
      throw InputError({told, line(i)},
                       fmt::format("the point ({:g}, {:g}, {:g}) stands in line {} already", X.x(),
                                   X.y(), X.z(), line(i - 1)),
                       "one row a point; a file for each load case and each camera pair");
    }
}

FieldTable table_of(const std::vector<Row>& rows, const FieldColumns& columns) {
  FieldTable out;
  out.unit = columns.unit, out.measure = columns.measure, out.strain_unit = columns.strain_unit;
  out.strain_columns = columns.strains;
  out.has_z = columns.has(2), out.has_u = columns.has(3) && columns.has(4);
  out.has_w = columns.has(5), out.has_exy = columns.has(8);
  out.X.resize(3, static_cast<Eigen::Index>(rows.size()));
  out.u.resize(3, out.X.cols());
  out.strain.resize(3, out.X.cols());
  for (Eigen::Index k = 0; k < out.X.cols(); ++k)
    for (int i = 0; i < 3; ++i) {
      const Row& row = rows[static_cast<size_t>(k)];
      out.X(i, k) = row[static_cast<size_t>(i)];
      out.u(i, k) = row[static_cast<size_t>(i) + 3];
      out.strain(i, k) = row[static_cast<size_t>(i) + 6];
    }
  return out;
}

}  // namespace

FieldTable read_field_table(const std::filesystem::path& file, const std::string& told,
                            const std::map<std::string, std::string>& names, FieldHolds holds) {
  const std::string text = read_text(file);
  if (const size_t zero = text.find('\0'); zero != std::string::npos)
    throw InputError(
        {told, 1 + static_cast<int>(std::count(text.begin(), text.begin() + zero, '\n'))},
        "there is a zero byte: this is no text", "a table as text, in UTF-8");
  Lines lines(text);
  std::vector<std::string_view> cells;
  char separator = ',';
  to_head(lines, told, cells, separator);
  const FieldColumns columns = field_columns(cells, {told, lines.number}, names, holds);
  const bool comma = separator == ';' || separator == '\t';
  std::vector<Row> rows;
  std::vector<int> at;
  std::vector<int> dropped;
  while (lines.next()) {
    if (bare_cell(lines.line).empty()) continue;
    split(lines.line, separator, cells);
    if (cells.size() == columns.count + 1 && cells.back().empty()) cells.pop_back();
    if (cells.size() != columns.count)
      throw InputError(
          {told, lines.number},
          fmt::format("the row has {} cells, the head {}", cells.size(), columns.count),
          "one cell for every column");
    const Row row = row_of(cells, columns, comma, {told, lines.number});
    if (!is_whole(row, holds) || is_marked(columns, cells, comma)) {
      dropped.push_back(lines.number);
      continue;
    }
    rows.push_back(row);
    at.push_back(lines.number);
  }
  if (rows.empty())
    throw InputError({told}, fmt::format("no point is left ({} rows dropped)", dropped.size()),
                     fmt::format("rows with numbers for the place and the {} of a point",
                                 holds == FieldHolds::strains ? "strains" : "displacement"));
  FieldTable out = table_of(rows, columns);
  out.lines = std::move(at), out.dropped_lines = std::move(dropped);
  refuse_twice(out, told);
  return out;
}

}  // namespace hookeye
