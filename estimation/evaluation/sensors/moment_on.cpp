// The moment of what a support exerts on the body.
#include "estimation/evaluation/sensor.h"

namespace hookeye {

SensorPrediction sensors::moment_on(const MeasuredSpec& measured, const Sensed& seen) {
  const Region& region = seen.scene.body->regions.at(measured.region);
  SensorPrediction out;
  out.value = support_moment(seen.equilibrium, region, measured.direction);
  if (seen.columns)
    out.J =
        d_support_moment(seen.equilibrium, region, measured.direction, seen.columns->dR, seen.S);
  return out;
}

}  // namespace hookeye
