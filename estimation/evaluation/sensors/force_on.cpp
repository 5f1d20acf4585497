// What a support exerts on the body.
#include "estimation/evaluation/sensor.h"

namespace hookeye {

SensorPrediction sensors::force_on(const MeasuredSpec& measured, const Sensed& seen) {
  const Region& region = seen.scene.body->regions.at(measured.region);
  SensorPrediction out;
  out.value =
      support_force(seen.equilibrium, region) + seen.model.examples[seen.example].force_offset;
  if (seen.columns)
    out.J = d_support_force(seen.equilibrium, region, seen.columns->dR, seen.S) +
            seen.columns->d_offset;
  return out;
}

}  // namespace hookeye
