#include "estimation/inspection/si.h"

#include <fmt/format.h>

namespace hookeye::inspection {

double newtons(const Units& units) {
  if (units.force == "mN") return 1e-3;
  if (units.force == "kN") return 1e3;
  if (units.force == "uN") return 1e-6;
  return 1.0;
}

std::string length_in_words(double metres) {
  if (metres >= 1.0) return fmt::format("{:.3g} m", metres);
  return metres >= 1e-3 ? fmt::format("{:.3g} mm", 1e3 * metres)
                        : fmt::format("{:.3g} um", 1e6 * metres);
}

std::string stress_in_words(double pascals) {
  if (pascals >= 1e9) return fmt::format("{:.3g} GPa", 1e-9 * pascals);
  if (pascals >= 1e6) return fmt::format("{:.3g} MPa", 1e-6 * pascals);
  return pascals >= 1e3 ? fmt::format("{:.3g} kPa", 1e-3 * pascals)
                        : fmt::format("{:.3g} Pa", pascals);
}

}  // namespace hookeye::inspection
