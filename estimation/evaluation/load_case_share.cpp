#include "estimation/evaluation/load_case_share.h"

#include <algorithm>
#include <numeric>

namespace hookeye {

namespace {

LoadCaseShare*& the_share() {
  static LoadCaseShare* share = nullptr;
  return share;
}

/// What has not been timed counts as the least of those that were: it is not free.
std::vector<double> known(std::vector<double> seconds) {
  double least = 1.0;
  for (const double one : seconds)
    if (one > 0.0) least = std::min(least, one);
  for (double& one : seconds) one = std::max(one, least);
  return seconds;
}

double longest(const std::vector<double>& seconds, int processes, const std::vector<int>& owner) {
  std::vector<double> load(static_cast<size_t>(processes), 0.0);
  for (size_t i = 0; i < seconds.size(); ++i) load[static_cast<size_t>(owner[i])] += seconds[i];
  return *std::max_element(load.begin(), load.end());
}

}  // namespace

void share_load_cases(LoadCaseShare* share) { the_share() = share; }

LoadCaseShare* load_case_share() { return the_share(); }

std::vector<int> dealt(const std::vector<double>& seconds, int processes) {
  const std::vector<double> cost = known(seconds);
  std::vector<size_t> order(cost.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return cost[a] > cost[b]; });
  std::vector<double> load(static_cast<size_t>(processes), 0.0);
  std::vector<int> owner(cost.size(), 0);
  for (const size_t i : order) {
    const auto freest = std::min_element(load.begin(), load.end());
    owner[i] = static_cast<int>(freest - load.begin());
    *freest += cost[i];
  }
  return owner;
}

std::vector<int> dealt_again(const std::vector<double>& seconds, int processes,
                             const std::vector<int>& before) {
  constexpr double kWorthMoving = 0.8;
  std::vector<int> now = dealt(seconds, processes);
  if (before.empty()) return now;
  const std::vector<double> cost = known(seconds);
  return longest(cost, processes, now) < kWorthMoving * longest(cost, processes, before) ? now
                                                                                         : before;
}

}  // namespace hookeye
