#include "estimation/inspection/exchanges.h"

#include <algorithm>
#include <numeric>

namespace hookeye::inspection {

namespace {

/// Squares that are left of what stands in `places` if it is what `fits` expects, and all squares.
struct Left {
  double left = 0.0, all = 0.0;
  double share() const { return all > 0.0 ? left / all : 0.0; }
};

Left left_of(const ComparedPlaces& compared, const std::vector<char>& scaled,
             const std::vector<int>& places, const std::vector<int>& fits) {
  Left out;
  MotionSums shared;  // of the places with the common factor
  for (size_t i = 0; i < places.size(); ++i) {
    const auto j = static_cast<size_t>(fits[i]);
    const MotionSums& sums = compared[static_cast<size_t>(places[i])][j];
    out.all += sums.seen2;
    if (!scaled[j]) {
      out.left += sums.seen2 - 2.0 * sums.both + sums.expected2;
      continue;
    }
    shared.seen2 += sums.seen2, shared.expected2 += sums.expected2, shared.both += sums.both;
  }
  const double times = std::max(shared.times(), 0.0);
  out.left += shared.seen2 - times * shared.both;
  return out;
}

}  // namespace

double share_left(const ComparedWays& compared, const std::vector<int>& places,
                  const std::vector<int>& fits) {
  double least = 1e300;
  for (const ComparedPlaces& way : compared.ways)
    least = std::min(least, left_of(way, compared.scaled, places, fits).share());
  return least;
}

namespace {

/// Exchanges the pair that gains most, as long as one does.
std::vector<int> exchanged_pairwise(const ComparedWays& compared, double better) {
  const auto n = static_cast<int>(compared.scaled.size());
  std::vector<int> fits(compared.scaled.size());
  std::iota(fits.begin(), fits.end(), 0);
  // Every exchange lowers what is left, and a permutation takes n - 1 of them.
  for (int tries = 0; tries < n * n; ++tries) {
    double gained = better;
    std::pair<int, int> best{-1, -1};
    for (int i = 0; i < n; ++i)
      for (int j = i + 1; j < n; ++j) {
        const int a = fits[static_cast<size_t>(i)], b = fits[static_cast<size_t>(j)];
        const double told = share_left(compared, {i, j}, {a, b});
        const double now = share_left(compared, {i, j}, {b, a});
        if (told > 0.0 && now / told < gained) gained = now / told, best = {i, j};
      }
    if (best.first < 0) break;
    std::swap(fits[static_cast<size_t>(best.first)], fits[static_cast<size_t>(best.second)]);
  }
  return fits;
}

}  // namespace

std::vector<Exchange> exchanges(const std::vector<ComparedWays>& aspects,
                                const InspectionOptions& options) {
  std::vector<Exchange> out;
  if (aspects.empty() || aspects.front().ways.empty()) return out;
  const std::vector<int> fits = exchanged_pairwise(aspects.front(), options.better_by_pair);
  std::vector<char> taken(fits.size(), 0);
  for (size_t first = 0; first < fits.size(); ++first) {
    Exchange one;
    for (int at = static_cast<int>(first); !taken[static_cast<size_t>(at)];
         at = fits[static_cast<size_t>(at)]) {
      taken[static_cast<size_t>(at)] = 1;
      one.places.push_back(at);
    }
    if (one.places.size() < 2) continue;
    std::sort(one.places.begin(), one.places.end());
    for (const int place : one.places) one.fits.push_back(fits[static_cast<size_t>(place)]);
    one.told = 1.0;
    const bool clear =
        std::all_of(aspects.begin(), aspects.end(), [&](const ComparedWays& compared) {
          const double told = share_left(compared, one.places, one.places);
          const double now = share_left(compared, one.places, one.fits);
          if (&compared == &aspects.front()) one.told = told, one.exchanged = now;
          return told >= options.left_of_exchanged && now <= options.left_by_exchange * told;
        });
    if (clear) out.push_back(std::move(one));
  }
  return out;
}

}  // namespace hookeye::inspection
