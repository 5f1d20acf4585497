// How points of the surface went, along the field's axes, or how it is strained there. Fits
// condense it (field_evaluation.h).
#include "estimation/evaluation/field_evaluation.h"
#include "estimation/evaluation/started_field.h"

namespace hookeye {

SensorPrediction sensors::field(const MeasuredSpec& measured, const Sensed& seen) {
  if (start_index(seen.scene, measured) >= 0)
    return StartedField(measured, seen).predicted(0, measured.field->X.cols());
  const FieldPoints points = field_points(seen.scene.body->mesh, *measured.field);
  return predicted_field(measured, points, seen, 0, measured.field->X.cols());
}

}  // namespace hookeye
