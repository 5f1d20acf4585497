#include "estimation/output/own_weight.h"

#include <cmath>

#include "capture_io/newtons.h"

namespace hookeye {

nlohmann::json own_weight(const Scene& scene, const Fitted& fitted) {
  bool measured = false;
  for (const ExampleSpec& example : scene.capture.examples)
    for (const MeasuredSpec& one : example.measured)
      measured = measured || one.kind == MeasuredSpec::Kind::force_on;
  if (!measured || !fitted.form.realise(fitted.p).gravity.isZero()) return {};
  constexpr double kEarth = 9.81, kWater = 1000.0;  // m/s^2, kg/m^3
  const Units& units = scene.capture.units;
  const double volume = quality(scene.body->mesh).volume, metre = units.metre();
  const double told = scene.capture.body.density * volume * kEarth * metre;
  return {{"told", told > 0.0 ? nlohmann::json(told) : nlohmann::json()},
          {"of_water", kWater * volume / std::pow(metre, 3) * kEarth / newtons(units)},
          {"unit", units.force}};
}

}  // namespace hookeye
