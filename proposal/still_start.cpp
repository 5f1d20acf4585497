// The rows before a test machine moves: they tell the load cell's zero, its noise and when it
// began.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "proposal/machine_record.h"

namespace hookeye {
namespace {

struct Moments {
  double mean = 0, deviation = 0;
};
Moments moments(const std::vector<double>& values, size_t n) {
  Moments out;
  for (size_t i = 0; i < n; ++i) out.mean += values[i] / static_cast<double>(n);
  for (size_t i = 0; i < n; ++i) out.deviation += std::pow(values[i] - out.mean, 2);
  if (n > 1) out.deviation = std::sqrt(out.deviation / static_cast<double>(n - 1));
  return out;
}

double median_of_first(const std::vector<double>& values, size_t n) {
  std::vector<double> first(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n));
  std::nth_element(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(n / 2), first.end());
  return first[n / 2];
}

/// Where y = mean + slope (x - x0) leaves `level`, by least squares over the rows [from, to).
double crossing(const std::vector<double>& x, const std::vector<double>& y, size_t from, size_t to,
                double level) {
  const auto n = static_cast<double>(to - from);
  double mx = 0, my = 0, xx = 0, xy = 0;
  for (size_t i = from; i < to; ++i) mx += x[i] / n, my += y[i] / n;
  for (size_t i = from; i < to; ++i) xx += std::pow(x[i] - mx, 2), xy += (x[i] - mx) * (y[i] - my);
  return xy == 0 ? x[from] : mx + (level - my) * xx / xy;
}

/// The still rows by one signal, and when they end; {0, 0}: none are seen.
struct Start {
  size_t rows = 0;
  double onset = 0;
};

/// A table of a row a photo has few rows at rest, and the next is a step away. In a motion that
/// began at once the first rows lie as far apart as those that follow.
Start start_of_few(const std::vector<double>& x, const std::vector<double>& y, double range) {
  size_t moving = 1;
  while (moving < y.size() && std::abs(y[moving] - y[0]) <= 0.02 * range) ++moving;
  if (moving < 2 || moving >= y.size()) return {};
  const auto [low, high] =
      std::minmax_element(y.begin(), y.begin() + static_cast<std::ptrdiff_t>(moving));
  const double step = std::abs(y[moving] - moments(y, moving).mean);
  if (*high - *low > 0.1 * step) return {};
  return {moving, x[moving - 1]};
}

Start start_of(const std::vector<double>& x, const std::vector<double>& y) {
  const auto [low, high] = std::minmax_element(y.begin(), y.end());
  const double range = *high - *low;
  if (range == 0) return {};
  if (const Start few = start_of_few(x, y, range); y.size() < 8 || (few.rows > 0 && few.rows < 4))
    return few;
  const double base = median_of_first(y, std::clamp<size_t>(y.size() / 50, 3, 50));
  const auto leaves = [&](size_t from, double share) {
    size_t i = from;
    while (i < y.size() && std::abs(y[i] - base) <= share * range) ++i;
    return i;
  };
  // From a fiftieth of the range the motion is followed back to where it began.
  const size_t moving = leaves(0, 0.02);
  const size_t later = std::min(std::max(leaves(moving, 0.08) + 1, moving + 2), y.size());
  if (moving < 4 || later - moving < 2) return {};
  const auto rows_before = [&](double onset) {
    const auto end = x.begin() + static_cast<std::ptrdiff_t>(moving);
    return static_cast<size_t>(std::lower_bound(x.begin(), end, onset) - x.begin());
  };
  const double level = median_of_first(y, std::max<size_t>(3, moving / 10));
  size_t rows = rows_before(crossing(x, y, moving, later, level));
  // One that moves at once comes out as beginning within the first tenth.
  if (rows < 3 || 3 * rows < moving) return {};
  const double onset = crossing(x, y, moving, later, moments(y, rows - rows / 5).mean);
  rows = rows_before(onset);
  if (rows < 3) return {};
  return {rows, onset};
}

}  // namespace

void find_still_start(MachineRecord& record) {
  std::vector<double> x = record.time;
  if (x.empty())
    for (size_t i = 0; i < record.size(); ++i) x.push_back(static_cast<double>(i));
  // The crosshead's travel shows best when it starts; a slack specimen has no force yet.
  const Start start = start_of(x, record.travel.empty() ? record.force : record.travel);
  record.still_rows = start.rows;
  record.onset = start.onset;
  if (!record.travel.empty()) {
    const size_t n = std::max<size_t>(start.rows, 1);
    const Moments still = moments(record.travel, n);
    record.travel_zero = still.mean, record.travel_noise = still.deviation;
    for (double& value : record.travel) value -= record.travel_zero;
  }
  if (start.rows == 0) {
    record.said.push_back(fmt::format(
        "{}:{}: no rows at rest stand out before the machine moves: the load cell's zero cannot be "
        "seen, and forces are taken as they stand",
        record.file.string(), record.lines.front()));
    return;
  }
  if (record.force.empty()) return;
  const Moments still = moments(record.force, start.rows);
  record.force_zero = still.mean, record.force_noise = still.deviation;
  for (double& value : record.force) value -= record.force_zero;
  record.said.push_back(fmt::format(
      "load cell: {:.4g} N, the mean of {} rows before the machine moves, is taken off; "
      "their deviation is {:.3g} N",
      record.force_zero, start.rows, record.force_noise));
}

}  // namespace hookeye
