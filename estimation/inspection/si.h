// A capture's numbers in SI units.
#pragma once

#include <string>

#include "capture_io/capture.h"

namespace hookeye::inspection {

/// Newtons in one unit of force.
double newtons(const Units& units);
/// "104 mm", "3.5 m".
std::string length_in_words(double metres);
/// "35 kPa", "0.035 Pa".
std::string stress_in_words(double pascals);

}  // namespace hookeye::inspection
