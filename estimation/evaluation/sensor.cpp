#include "estimation/evaluation/sensor.h"

namespace hookeye {

SensorPrediction predicted(const MeasuredSpec& measured, const Sensed& seen) {
  using Predict = SensorPrediction (*)(const MeasuredSpec&, const Sensed&);
  static constexpr Predict kSensors[] = {
#define MEASURED(kind, on, key, size, unit, words) &sensors::kind,
#include "capture_io/measured_kinds.def"
#undef MEASURED
  };
  return kSensors[static_cast<size_t>(measured.kind)](measured, seen);
}

}  // namespace hookeye
