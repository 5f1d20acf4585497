// How points of the surface went, along the field's axes, or how it is strained there. Fits
// condense it (field_evaluation.h).
#include "estimation/evaluation/field_evaluation.h"

namespace hookeye {

SensorPrediction sensors::field(const MeasuredSpec& measured, const Sensed& seen) {
  const FieldPoints points = field_points(seen.scene.body->mesh, *measured.field);
  return predicted_field(measured, points, seen, 0, measured.field->X.cols());
}

}  // namespace hookeye
