// The values of photos as their files store them.
#pragma once

#include <vector>

#include "estimation/inspection/sight.h"

namespace hookeye::inspection {

/// Codes of all integer photos of one camera together.
struct Codes {
  int bits = 0;  ///< of a stored value: 8 or 16; 0: floating-point or none
  int photos = 0;
  PhotoIndex first;                           ///< one of them
  int largest = 0, divisor = 0;               ///< divisor: greatest common one of all codes
  std::vector<unsigned char> used;            ///< by code: whether it occurs; 2^bits entries
  int used_between(int low, int high) const;  ///< codes of [low, high) that occur
};

/// One a camera that has integer photos (silhouettes aside). Photos are read again: throws
/// InputError where one has gone or changed meanwhile.
std::vector<Codes> stored_codes(const Sight& sight);

}  // namespace hookeye::inspection
