#include "proposal/machine_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/input_error.h"
#include "proposal/words.h"

namespace hookeye {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// What a column is taken for.
struct Kind {
  std::string name;  ///< "force": of --set force_column and force_unit
  Quantity quantity;
  std::string unit;                 ///< that of the record
  std::vector<std::string> words;   ///< pieces of its names, the likelier first
  std::vector<std::string> others;  ///< pieces of names that are something else
};
const Kind kForce{"force",
                  Quantity::force,
                  "N",
                  {"force", "load", "kraft", "effort", "fuerza"},
                  {"rate", "stress", "time", "strain"}};
const Kind kTravel{"travel",
                   Quantity::length,
                   "mm",
                   {"travel", "stroke", "extension", "displacement", "crosshead", "elongation",
                    "traverse", "weg", "deplacement", "déplacement", "position", "hub"},
                   {"rate", "speed", "strain", "time", "force", "load"}};
const Kind kTime{"time", Quantity::time, "s", {"time", "zeit", "temps", "tiempo"}, {"date"}};
const std::vector<std::string> kPhotoWords{"photo",   "image",  "picture", "frame",
                                           "trigger", "camera", "bild",    "kamera"};

bool is_of(const Kind& kind, const std::string& name) {
  const std::string low = lower(name);
  return has_any(low, kind.words) && !has_any(low, kind.others);
}

/// Columns whose name or, without one, unit says so; the likelier first.
std::vector<size_t> columns_of(const TextTable& table, const Kind& kind) {
  std::vector<size_t> out;
  for (const std::string& word : kind.words)
    for (size_t i = 0; i < table.names.size(); ++i)
      if (is_of(kind, table.names[i]) && lower(table.names[i]).find(word) != std::string::npos &&
          std::find(out.begin(), out.end(), i) == out.end())
        out.push_back(i);
  if (!out.empty()) return out;
  for (size_t i = 0; i < table.names.size(); ++i) {
    const bool short_name = trimmed(table.names[i]).size() <= 5;  // "F [N]"
    if (short_name && !table.units[i].empty() && unit_in(table.units[i], kind.quantity))
      out.push_back(i);
  }
  return out;
}

std::string shown(const TextTable& table, size_t column) {
  const std::string& name = table.names[column];
  return name.empty() ? fmt::format("column {}", column + 1) : "`" + name + "`";
}

/// The column of a kind; none: std::string::npos.
size_t choose_column(const TextTable& table, const Kind& kind, Questions& questions,
                     std::vector<std::string>& said) {
  const std::vector<size_t> found = columns_of(table, kind);
  CaptureQuestion question{.name = kind.name + "_column",
                           .text = fmt::format("which column is the {}", kind.name),
                           .standard = found.empty() ? "none" : table.names[found[0]],
                           .asked = false};
  if (question.standard.empty()) question.standard = std::to_string(found[0] + 1);
  const std::string answer = questions.ask(question);
  if (answer == "none") return std::string::npos;
  if (answer == question.standard) {
    for (size_t i = 1; i < found.size(); ++i)
      said.push_back(fmt::format("{} is the {}, not {}; --set {}_column=NAME takes another",
                                 shown(table, found[0]), kind.name, shown(table, found[i]),
                                 kind.name));
    return found[0];
  }
  for (size_t i = 0; i < table.names.size(); ++i)
    if (lower(table.names[i]) == lower(answer) || std::to_string(i + 1) == answer) return i;
  const std::string near = nearest_name(answer, table.names);
  refuse_answer(question.name, answer,
                near.empty() ? "the name of a column, its number from 1, or none"
                             : fmt::format("did you mean `{}`?", near));
}

struct Read {
  std::vector<double> values;  ///< NaN: no number there
  bool clock = false;
};
Read read_column(const TextTable& table, size_t column) {
  Read out;
  for (const auto& row : table.rows) {
    const auto value = column < row.size() ? number_in(row[column], table.decimal_comma, &out.clock)
                                           : std::nullopt;
    out.values.push_back(value.value_or(kNone));
  }
  return out;
}

/// From the least to the largest of a column's numbers, in the record's unit; 0: there is none.
double range_of(const TextTable& table, size_t column, double factor) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : read_column(table, column).values)
    if (!std::isnan(value)) low = std::min(low, value), high = std::max(high, value);
  return high > low ? factor * (high - low) : 0.0;
}

/// What another column of lengths says of this one's unit: it goes a thousand times as far, or a
/// thousandth, as the same motion does in m and in mm.
struct OddUnit {
  std::string unit;  ///< that would bring both together; "": there is no such column
  std::string why;
};
OddUnit odd_unit(const TextTable& table, size_t column, const Kind& kind, double factor) {
  constexpr double kThousand = 1000.0, kNear = 2.0;
  if (kind.quantity != Quantity::length) return {};
  const double own = range_of(table, column, factor);
  for (size_t i = 0; i < table.names.size() && own > 0.0; ++i) {
    const auto known = unit_in(table.units[i], Quantity::length);
    if (i == column || table.units[i].empty() || !known ||
        has_any(lower(table.names[i]), kind.others))
      continue;
    const double times = range_of(table, i, *known) / own;
    const bool longer = std::abs(std::log(std::max(times, 1e-300) / kThousand)) < std::log(kNear);
    const bool shorter = std::abs(std::log(std::max(times, 1e-300) * kThousand)) < std::log(kNear);
    const double meant = longer ? factor * kThousand : factor / kThousand;
    for (const char* unit : {"m", "mm", "um"})
      if ((longer || shorter) && std::abs(*unit_in(unit, Quantity::length) / meant - 1.0) < 1e-9)
        return {unit, fmt::format("{} goes over {:.3g} mm, {} over {:.3g} mm", shown(table, column),
                                  own, shown(table, i), times * own)};
  }
  return {};
}

/// Units of the record in one of the column's.
double factor_of(const TextTable& table, size_t column, const Kind& kind, Questions& questions) {
  const std::string unit = table.units[column];
  const std::string name = kind.name + "_unit";
  const auto known = unit_in(unit, kind.quantity);
  const OddUnit odd = odd_unit(table, column, kind, known.value_or(1.0));
  CaptureQuestion question{
      .name = name,
      .text = known
                  ? fmt::format("unit of {}, in which the table's lengths do not go together",
                                shown(table, column))
                  : fmt::format("unit of {}, which the table does not tell", shown(table, column)),
      .standard = known              ? unit
                  : odd.unit.empty() ? kind.unit
                                     : odd.unit,
      .why = odd.unit.empty() ? "" : fmt::format("{}: as if it were in {}", odd.why, odd.unit),
      .asked = !known || !odd.unit.empty()};
  const std::string answer = questions.ask(question);
  if (!known && !unit.empty() && !questions.all().back().answered)
    throw InputError(
        {table.file.string(), table.names_line},
        fmt::format("the unit `{}` of {} is not known here", unit, shown(table, column)),
        fmt::format("give one that is, as --set {}={}", name, kind.unit));
  if (const auto factor = unit_in(answer, kind.quantity)) return *factor;
  refuse_answer(name, answer, fmt::format("a unit like {}", kind.unit));
}

/// Rows with a cell that is no number go, and the first is told with its line.
void drop_gaps(const TextTable& table, const std::vector<size_t>& columns, MachineRecord& record) {
  std::vector<char> keep(record.lines.size(), 1);
  for (const size_t column : columns) {
    size_t gone = 0;
    std::string first;
    for (size_t i = 0; i < keep.size(); ++i) {
      const auto& row = table.rows[i];
      const std::string cell = column < row.size() ? row[column] : "";
      if (number_in(cell, table.decimal_comma)) continue;
      keep[i] = 0;
      if (gone++ == 0)
        first = fmt::format("{}:{}: {} is {}", table.file.string(), table.lines[i],
                            shown(table, column), cell.empty() ? "empty" : "`" + cell + "`");
    }
    if (gone > 0)
      record.said.push_back(
          fmt::format("{}{}", first,
                      gone == 1 ? ": the row is left out"
                                : fmt::format(": this row and {} more are left out", gone - 1)));
  }
  const auto drop = [&](std::vector<double>& values) {
    size_t n = 0;
    for (size_t i = 0; i < values.size(); ++i)
      if (keep[i]) values[n++] = values[i];
    values.resize(n);
  };
  for (auto* values : {&record.time, &record.force, &record.travel, &record.photo}) drop(*values);
  size_t n = 0;
  for (size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) record.lines[n++] = record.lines[i];
  record.lines.resize(n);
}

/// Where commas stand between the cells and within the numbers, rows fall into more cells than the
/// head has names, and none of them has a decimal point.
void check_commas(const TextTable& table) {
  size_t named = table.names.size();
  while (named > 0 && table.names[named - 1].empty()) --named;
  if (table.delimiter != ',' || table.names_line == 0 || table.rows.empty()) return;
  const auto& row = table.rows.front();
  if (row.size() <= named || row.back().empty()) return;
  for (const auto& one : table.rows)
    for (const std::string& cell : one)
      if (cell.find('.') != std::string::npos) return;
  throw InputError({table.file.string(), table.lines.front()},
                   fmt::format("the row has {} cells, the head {} names: commas stand between the "
                               "cells and within the numbers",
                               row.size(), named),
                   "export with semicolons between the cells, or with decimal points");
}

/// Time must not go back; a hole in it is told.
void check_time(MachineRecord& record) {
  const auto& t = record.time;
  if (t.size() < 3) return;
  std::vector<double> steps;
  for (size_t i = 1; i < t.size(); ++i) {
    if (t[i] < t[i - 1])
      throw InputError({record.file.string(), record.lines[i]},
                       fmt::format("time goes back from {:.6g} s to {:.6g} s", t[i - 1], t[i]),
                       "one test a table: cut the file there, or name the right column by --set "
                       "time_column=NAME");
    steps.push_back(t[i] - t[i - 1]);
  }
  std::vector<double> sorted = steps;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  const double usual = sorted[sorted.size() / 2];
  for (size_t i = 0; i < steps.size(); ++i)
    if (usual > 0 && steps[i] > 10 * usual) {
      record.said.push_back(
          fmt::format("{}:{}: {:.4g} s without a row; rows come every {:.3g} s elsewhere",
                      record.file.string(), record.lines[i + 1], steps[i], usual));
      return;
    }
}

/// Pulses or numbers of photos, where a column has them.
void read_photos_column(const TextTable& table, Questions& questions, MachineRecord& record) {
  std::string standard = "none";
  for (size_t i = table.names.size(); i-- > 0;)
    if (has_any(lower(table.names[i]), kPhotoWords) && !is_of(kTime, table.names[i]))
      standard = table.names[i];
  const std::string answer =
      questions.ask({.name = "photo_column",
                     .text = "which column has the photo's number or the camera's pulse",
                     .standard = standard,
                     .asked = false});
  if (answer == "none") return;
  for (size_t i = 0; i < table.names.size(); ++i) {
    if (lower(table.names[i]) != lower(answer) && std::to_string(i + 1) != answer) continue;
    record.photo = read_column(table, i).values;
    for (double& value : record.photo)
      if (std::isnan(value)) value = 0;  // a pulse that is told only where it is
    return;
  }
  refuse_answer("photo_column", answer, "the name of a column, its number from 1, or none");
}

}  // namespace

bool is_machine_table(const TextTable& table) {
  if (!columns_of(table, kForce).empty()) return true;
  const bool photos = std::any_of(table.names.begin(), table.names.end(), [](const auto& name) {
    return has_any(lower(name), kPhotoWords);
  });
  return !columns_of(table, kTravel).empty() && (photos || !columns_of(table, kTime).empty());
}

std::string columns_told(const TextTable& table) {
  const std::string at = table.file.filename().string();
  if (table.names_line == 0)
    return fmt::format("{} has no line of names above its numbers (line {})", at,
                       table.lines.front());
  std::string names;
  for (const std::string& name : table.names)
    if (!name.empty()) names += (names.empty() ? "`" : ", `") + name + "`";
  return fmt::format("the columns of {} are {} (line {})", at, names, table.names_line);
}

MachineRecord machine_record(const TextTable& table, Questions& questions) {
  check_commas(table);
  MachineRecord record;
  record.file = table.file;
  record.lines = table.lines;
  std::vector<size_t> used;
  bool clock = false;
  const auto take = [&](const Kind& kind, std::vector<double>& to) {
    const size_t column = choose_column(table, kind, questions, record.said);
    if (column == std::string::npos) return;
    Read read = read_column(table, column);
    const double factor = read.clock ? 1.0 : factor_of(table, column, kind, questions);
    for (double& value : read.values) value *= factor;
    clock |= read.clock;
    to = std::move(read.values);
    used.push_back(column);
  };
  take(kTime, record.time);
  take(kForce, record.force);
  take(kTravel, record.travel);
  if (record.force.empty() && record.travel.empty())
    throw InputError({table.file.string(), table.names_line},
                     "there is neither a force nor a travel in this table",
                     "name a column by --set force_column=NAME or travel_column=NAME");
  read_photos_column(table, questions, record);
  for (size_t i = 0; i < std::min<size_t>(table.strangers.size(), 3); ++i)
    record.said.push_back(table.strangers[i] + " is no row: left out");
  if (table.strangers.size() > 3)
    record.said.push_back(
        fmt::format("{} more lines like that are left out", table.strangers.size() - 3));
  drop_gaps(table, used, record);
  if (record.size() < 3)
    throw InputError({table.file.string()}, "fewer than three rows have all their numbers",
                     "export time, force and travel in full");
  check_time(record);
  std::string words;
  for (const auto& name : table.names) words += lower(name) + " ";
  for (const auto& line : table.head) words += lower(line) + " ";
  record.compression = has_any(words, {"compress", "druckversuch", "stauch"});
  find_still_start(record);
  return record;
}

}  // namespace hookeye
