#include "proposal/load_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/input_error.h"

namespace hookeye {
namespace {

double load_of(const PairedPhoto& photo, const MachineRecord& record) {
  return std::abs(record.force.empty() ? photo.travel : photo.force);
}

size_t rest_of(const Pairing& pairing, const MachineRecord& record, LoadCases& out) {
  const auto& photos = pairing.photos;
  size_t rest = 0;
  if (record.still_rows > 0) {
    const double span = record.time.empty() ? 0 : record.time.back() - record.time.front();
    const double until = record.time.empty() ? static_cast<double>(record.still_rows) - 1
                                             : record.onset + 1e-6 * span;
    for (size_t k = 0; k < photos.size() && photos[k].time <= until - pairing.clock_error; ++k)
      rest = k;
    if (photos[rest].time <= until) return rest;
  }
  double most = 0;
  for (size_t k = 0; k < photos.size(); ++k) {
    most = std::max(most, load_of(photos[k], record));
    if (load_of(photos[k], record) < load_of(photos[rest], record)) rest = k;
  }
  out.said.push_back(fmt::format(
      "photo {} is taken as the rest: none is known to be from before the machine moved, and this "
      "has "
      "the least load ({:.2g} of the largest); the body is taken to be undeformed there",
      photos[rest].number, most > 0 ? load_of(photos[rest], record) / most : 0.0));
  return rest;
}

}  // namespace

LoadCases choose_cases(const Pairing& pairing, const MachineRecord& record, size_t count) {
  LoadCases out;
  const auto& photos = pairing.photos;
  const Place place{record.file.string()};
  if (photos.size() < 2)
    throw InputError(place, fmt::format("{} of the photos fall into its time", photos.size()),
                     "the first photo's time in the table may be wrong: --set clock=SECONDS");
  const size_t rest = rest_of(pairing, record, out);
  out.rest = photos[rest];
  size_t peak = rest;
  for (size_t k = rest; k < photos.size(); ++k)
    if (load_of(photos[k], record) > load_of(photos[peak], record)) peak = k;
  if (peak == rest)
    throw InputError(
        place,
        fmt::format("no photo after the rest, photo {}, has more load than it", out.rest.number),
        "is the right column read? --set force_column=NAME tells it");
  std::set<size_t> chosen;
  const double most = load_of(photos[peak], record);
  for (size_t j = 1; j <= count; ++j) {
    const double level = most * static_cast<double>(j) / static_cast<double>(count);
    size_t best = peak;
    for (size_t k = rest + 1; k <= peak; ++k)
      if (std::abs(load_of(photos[k], record) - level) <
          std::abs(load_of(photos[best], record) - level))
        best = k;
    chosen.insert(best);
  }
  for (const size_t k : chosen) {
    const size_t n = out.loads.size() + 1;
    out.loads.push_back({fmt::format("load{}", n), photos[k], n % 3 == 2});
  }
  if (chosen.size() < count)
    out.said.push_back(
        fmt::format("{} load cases instead of {}: more photos on the way to the "
                    "largest load would give more",
                    chosen.size(), count));
  if (peak + 1 < photos.size())
    out.said.push_back(
        fmt::format("photos after the largest load (photo {}) are not used", photos[peak].number));
  return out;
}

}  // namespace hookeye
