// What the cameras' calibration tells of their numbers: that they are off by none of its standard
// deviations, each give or take one. What knocks a camera afterwards is none of it.
#include "estimation/evaluation/sensor.h"

namespace hookeye {

SensorPrediction sensors::calibration(const MeasuredSpec& measured, const Sensed& seen) {
  const Eigen::Index size = measured.value.size();
  SensorPrediction out{VectorXd::Zero(size), {}};
  if (seen.columns) out.J.setZero(size, seen.S.cols());
  if (seen.model.calibration.size() != size) return out;  // a model that holds them as told
  out.value = seen.model.calibration;
  if (seen.columns) out.J = seen.columns->d_calibration;
  return out;
}

}  // namespace hookeye
