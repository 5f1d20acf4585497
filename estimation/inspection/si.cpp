#include "estimation/inspection/si.h"

#include <fmt/format.h>

#include <cmath>

namespace hookeye::inspection {

std::string length_in_words(double metres) {
  if (metres >= 1e3) return fmt::format("{:.4g} km", 1e-3 * metres);
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

std::string mass_in_words(double kilograms) {
  if (kilograms >= 1e6) return fmt::format("{:.0f} t", 1e-3 * kilograms);
  if (kilograms >= 1e3) return fmt::format("{:.3g} t", 1e-3 * kilograms);
  if (kilograms >= 1.0) return fmt::format("{:.3g} kg", kilograms);
  return kilograms >= 1e-3 ? fmt::format("{:.3g} g", 1e3 * kilograms)
                           : fmt::format("{:.3g} mg", 1e6 * kilograms);
}

std::string size_in_words(const TetMesh& mesh, const Units& units) {
  constexpr double kWater = 1000.0;  // kg/m^3
  const double metre = units.metre();
  const Vector3d box = (mesh.X.rowwise().maxCoeff() - mesh.X.rowwise().minCoeff()) / metre;
  return fmt::format("the body is {} x {} x {}; of water it would have {}",
                     length_in_words(box.x()), length_in_words(box.y()), length_in_words(box.z()),
                     mass_in_words(kWater * quality(mesh).volume / std::pow(metre, 3)));
}

}  // namespace hookeye::inspection
