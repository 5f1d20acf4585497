#include "proposal/pairing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/input_error.h"
#include "proposal/words.h"

namespace hookeye {
namespace {

double at_row(const std::vector<double>& values, double row) {
  if (values.empty()) return 0;
  const double whole = std::floor(row);
  const size_t i = std::min(static_cast<size_t>(whole), values.size() - 1);
  const size_t next = std::min(i + 1, values.size() - 1);
  return values[i] + (row - whole) * (values[next] - values[i]);
}

/// The row of a time, between two; below zero where the table does not cover it.
double row_of(const MachineRecord& record, double time) {
  const auto& t = record.time;
  const double slack = (t.back() - t.front()) / static_cast<double>(t.size());
  if (time < t.front() - slack || time > t.back() + slack) return -1;
  const auto at = std::lower_bound(t.begin(), t.end(), time) - t.begin();
  const size_t i = std::clamp<size_t>(static_cast<size_t>(at), 1, t.size() - 1);
  const double step = t[i] - t[i - 1];
  return static_cast<double>(i - 1) +
         (step > 0 ? std::clamp((time - t[i - 1]) / step, 0.0, 1.0) : 1.0);
}

PairedPhoto photo_at(const MachineRecord& record, long number, double row) {
  PairedPhoto photo;
  photo.number = number;
  photo.time = record.time.empty() ? row : at_row(record.time, row);
  photo.force = at_row(record.force, row);
  photo.travel = at_row(record.travel, row);
  photo.line = record.lines[std::min(static_cast<size_t>(std::lround(row)), record.size() - 1)];
  const double low = std::max(0.0, row - 2),
               high = std::min(static_cast<double>(record.size() - 1), row + 2);
  if (record.time.empty()) return photo;
  const double span = at_row(record.time, high) - at_row(record.time, low);
  const auto rate = [&](const std::vector<double>& column) {
    return column.empty() || span <= 0 ? 0.0 : (at_row(column, high) - at_row(column, low)) / span;
  };
  photo.force_rate = rate(record.force), photo.travel_rate = rate(record.travel);
  return photo;
}

std::vector<long> numbers_of(const PhotoSeries& series) {
  std::vector<long> out;
  for (const auto& [number, file] : series.photos) out.push_back(number);
  return out;
}

/// Photos by their times in the table; those beyond its ends go.
void pair_by_times(const std::vector<long>& numbers, const std::vector<double>& times,
                   const MachineRecord& record, Pairing& out) {
  std::vector<long> outside;
  for (size_t k = 0; k < numbers.size(); ++k) {
    const double row = row_of(record, times[k]);
    if (row < 0)
      outside.push_back(numbers[k]);
    else
      out.photos.push_back(photo_at(record, numbers[k], row));
  }
  if (!outside.empty())
    out.said.push_back(fmt::format(
        "{} outside of the table's time are left out: {}{}", counted(outside.size(), "photo"),
        outside.front(), outside.size() > 1 ? fmt::format(" to {}", outside.back()) : ""));
}

/// The column has the photo's number from its row on, or a pulse for each photo.
bool pair_by_column(const std::vector<long>& numbers, const MachineRecord& record, Pairing& out) {
  if (record.photo.empty()) return false;
  const auto& column = record.photo;
  std::map<long, size_t> first;
  std::vector<size_t> pulses;
  const double high = *std::max_element(column.begin(), column.end());
  for (size_t i = 0; i < column.size(); ++i) {
    if (column[i] == std::floor(column[i])) first.emplace(static_cast<long>(column[i]), i);
    const bool up = column[i] > 0.5 * high;
    if (up && (i == 0 || !(column[i - 1] > 0.5 * high))) pulses.push_back(i);
  }
  const bool all = std::all_of(numbers.begin(), numbers.end(),
                               [&](long number) { return first.contains(number); });
  if (all && first.size() > 2) {
    for (const long number : numbers)
      out.photos.push_back(photo_at(record, number, static_cast<double>(first.at(number))));
    out.how = "by the photo's number in the table";
    return true;
  }
  if (pulses.size() == numbers.size()) {
    for (size_t k = 0; k < numbers.size(); ++k)
      out.photos.push_back(photo_at(record, numbers[k], static_cast<double>(pulses[k])));
    out.how = fmt::format("by the camera's {} pulses in the table", pulses.size());
    return true;
  }
  throw InputError(
      {record.file.string()},
      fmt::format("its photo column has {} and {}, and there are {} (numbers {} to {})",
                  counted(pulses.size(), "pulse"), counted(first.size(), "value"),
                  counted(numbers.size(), "photo"), numbers.front(), numbers.back()),
      "complete the photos or the table, or pair by time: --set photo_column=none");
}

/// A told clock by which photos and machine do not begin to move together. `seconds` of the photos
/// count from any time.
void doubt_told_clock(const std::vector<double>& seconds, double told_first,
                      const PhotoMotion& motion, const MachineRecord& record, Pairing& out) {
  if (motion.moved == 0) return;
  const ClockOffset offset = clock_offset(seconds, motion, record);
  const double found = seconds.front() - offset.seconds;
  if (std::abs(told_first - found) <= 3.0 * offset.error) return;
  out.said.push_back(
      fmt::format("the first photo is told to be at {:.6g} s of the table, but photos and machine "
                  "begin to move together where it is at {:.6g} s (within {:.2g} s): every load "
                  "may be that of another time",
                  told_first, found, offset.error));
}

/// Where neither is still at first, nothing begins.
PhotoMotion first_motion(const PhotoSeries& series, const MachineRecord& record) {
  return record.still_rows > 0 ? photo_motion(series) : PhotoMotion{};
}

/// By the photos' clock; the offset is that which lets photos and machine begin to move together.
bool pair_by_clock(const PhotoSeries& series, const MachineRecord& record, Questions& questions,
                   Pairing& out) {
  if (record.time.empty()) return false;
  const PhotoClock clock = photo_clock(series);
  if (clock.seconds.empty()) return false;
  CaptureQuestion question{.name = "clock",
                           .text = "time of the first photo in the table, in s",
                           .standard = "",
                           .why = "no still start in photos and table to find it from"};
  const PhotoMotion motion = first_motion(series, record);
  ClockOffset offset;
  if (motion.moved > 0) {
    offset = clock_offset(clock.seconds, motion, record);
    question.standard = fmt::format("{:.6g}", clock.seconds.front() - offset.seconds);
    question.why =
        fmt::format("photos and machine begin to move together, within {:.2g} s", offset.error);
    question.asked = false;
  } else if (row_of(record, clock.seconds.front()) >= 0) {
    question.standard = fmt::format("{:.3f}", clock.seconds.front());
    question.why = "both clocks show the time of the day; they are taken to agree";
  }
  const bool found = !question.standard.empty();
  const double first = questions.ask_number(question);
  const CaptureQuestion& asked = questions.all().back();
  if (!found && !asked.answered) return true;
  out.clock_error = asked.answered ? 0.0 : offset.error;
  if (asked.answered) doubt_told_clock(clock.seconds, first, motion, record, out);
  out.how = asked.answered ? fmt::format("by the photos' clock, the first at {:.6g} s", first)
                           : fmt::format("by the photos' clock, the first at {:.6g} s: {}", first,
                                         question.why);
  std::vector<double> times;
  for (const double second : clock.seconds) times.push_back(first + second - clock.seconds.front());
  pair_by_times(numbers_of(series), times, record, out);
  return true;
}

/// Two numbers told: when the first photo was taken, and how many seconds lie between two.
void pair_as_told(const PhotoSeries& series, const MachineRecord& record, Questions& questions,
                  Pairing& out) {
  const std::vector<long> numbers = numbers_of(series);
  const std::string answer = questions.ask(
      {.name = "photo_times",
       .text = "time of the first photo in the table and seconds between photos, as 12.5,2",
       .standard = "",
       .why = fmt::format("{} a camera and {} in the table; the photos have no times",
                          counted(numbers.size(), "photo"), counted(record.size(), "row"))});
  if (answer.empty()) return;
  const auto parts = between_commas(answer);
  const auto first = number_in(parts[0], false);
  const auto pace = parts.size() == 2 ? number_in(parts[1], false) : std::nullopt;
  if (!first || !pace || *pace <= 0 || record.time.empty())
    refuse_answer("photo_times", answer,
                  record.time.empty() ? "the table has no column of time: give it one"
                                      : "two numbers as 12.5,2: the first photo at 12.5 s, then "
                                        "one each 2 s");
  std::vector<double> times;
  for (const long number : numbers)
    times.push_back(*first + *pace * static_cast<double>(number - numbers.front()));
  doubt_told_clock(times, *first, first_motion(series, record), record, out);
  out.how = fmt::format("as told: the first at {:.6g} s, then one each {:.6g} s", *first, *pace);
  pair_by_times(numbers, times, record, out);
}

}  // namespace

Pairing pair_photos(const PhotoSeries& series, const MachineRecord& record, Questions& questions) {
  Pairing out;
  const std::vector<long> numbers = numbers_of(series);
  if (pair_by_column(numbers, record, out)) return out;
  if (numbers.size() == record.size()) {
    for (size_t k = 0; k < numbers.size(); ++k)
      out.photos.push_back(photo_at(record, numbers[k], static_cast<double>(k)));
    out.how = fmt::format("a row a photo: {} of each", numbers.size());
    return out;
  }
  if (pair_by_clock(series, record, questions, out)) return out;
  pair_as_told(series, record, questions, out);
  return out;
}

}  // namespace hookeye
