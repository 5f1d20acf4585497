// The offset of two clocks that saw the same motion begin.
#include <algorithm>
#include <cmath>

#include "proposal/pairing.h"

namespace hookeye {
namespace {

/// How far the machine has come at a time of the table; 0 before it moves.
double progress(const MachineRecord& record, double time) {
  if (time <= record.onset) return 0;
  const auto& t = record.time;
  const auto& y = record.travel.empty() ? record.force : record.travel;
  const auto at = std::lower_bound(t.begin(), t.end(), time) - t.begin();
  const size_t i = std::clamp<size_t>(static_cast<size_t>(at), 1, t.size() - 1);
  const double step = t[i] - t[i - 1];
  const double share = step > 0 ? std::clamp((time - t[i - 1]) / step, 0.0, 1.0) : 1.0;
  return std::abs(y[i - 1] + share * (y[i] - y[i - 1]));
}

struct Seen {
  double time, motion;
};

/// Misfit of motion = c progress(time - offset), relative; c is the best.
double misfit(const std::vector<Seen>& seen, const MachineRecord& record, double offset) {
  double mm = 0, mp = 0, pp = 0;
  for (const Seen& one : seen) {
    const double p = progress(record, one.time - offset);
    mm += one.motion * one.motion, mp += one.motion * p, pp += p * p;
  }
  if (pp == 0 || mm == 0) return 1;
  return std::sqrt(std::max(0.0, 1 - mp * mp / (pp * mm)));
}

}  // namespace

ClockOffset clock_offset(const std::vector<double>& photo_seconds, const PhotoMotion& motion,
                         const MachineRecord& record) {
  const double early = photo_seconds[motion.moved - 1] - record.onset,
               late = photo_seconds[motion.moved] - record.onset;
  const ClockOffset between{(early + late) / 2, (late - early) / 2};
  // Texture goes in proportion to the machine's travel.
  std::vector<Seen> seen;
  for (size_t i = 0; i < motion.gone.size(); ++i)
    seen.push_back({photo_seconds[motion.moved - 1 + i], motion.gone[i]});
  if (seen.size() < 3) return between;
  // The last photo that seemed still may have moved by less than its noise shows.
  const double from = early - (late - early), step = (late - from) / 400;
  double best = 2, at = between.seconds;
  for (int i = 0; i <= 400; ++i)
    if (const double off = misfit(seen, record, from + i * step); off < best)
      best = off, at = from + i * step;
  if (best > 0.25) return between;
  double low = at, high = at;
  for (int i = 0; i <= 400; ++i) {
    const double offset = from + i * step;
    if (misfit(seen, record, offset) <= std::max(1.5 * best, 0.02))
      low = std::min(low, offset), high = std::max(high, offset);
  }
  return {at, std::max((high - low) / 2, step)};
}

}  // namespace hookeye
