// Which row of the machine's table belongs to which photo.
#pragma once

#include <string>
#include <vector>

#include "proposal/inventory.h"
#include "proposal/machine_record.h"
#include "proposal/photo_motion.h"

namespace hookeye {

struct PairedPhoto {
  long number = 0;
  double time = 0;               ///< [s] of the table; the row's index where it has no time
  double force = 0, travel = 0;  ///< [N], [mm]; 0 where the table has none
  double force_rate = 0, travel_rate = 0;  ///< [N/s], [mm/s]
  int line = 0;                            ///< of the nearest row
};

struct Pairing {
  std::vector<PairedPhoto> photos;  ///< in order; those without a row are left out
  std::string how;                  ///< one sentence
  double clock_error = 0;           ///< [s] by which all times may be off
  std::vector<std::string> said;
};

/// By the photo's column of the table, by the photos' own clock, by equal counts, or as told. What
/// cannot be told is asked without a default; then `photos` is empty. Throws InputError.
Pairing pair_photos(const PhotoSeries& series, const MachineRecord& record, Questions& questions);

/// Seconds that the photos' clock is ahead of the table's, from the motion's begin in both.
struct ClockOffset {
  double seconds = 0, error = 0;
};
ClockOffset clock_offset(const std::vector<double>& photo_seconds, const PhotoMotion& motion,
                         const MachineRecord& record);

}  // namespace hookeye
