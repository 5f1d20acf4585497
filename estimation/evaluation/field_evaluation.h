// A measured field against a model: as many numbers as points, condensed at once.
#pragma once

#include <functional>
#include <map>

#include "estimation/evaluation/sensor.h"
#include "estimation/model/field_points.h"

namespace hookeye {

/// Predictions of points [first, first + count) of a field, displacements along its axes or strains
/// along theirs, and their derivatives. It starts from the body as it was given
/// (started_field.h: from a load case).
SensorPrediction predicted_field(const MeasuredSpec& measured, const FieldPoints& points,
                                 const Sensed& seen, Eigen::Index first, Eigen::Index count);

/// A field's evaluation as MeasuredEvaluation tells. With derivatives r and J are a root of the
/// products of the whole ones: a dense field takes no more memory than the columns ask for.
using PredictPoints = std::function<SensorPrediction(Eigen::Index first, Eigen::Index count)>;
MeasuredEvaluation compare_field(const MeasuredSpec& measured, const Sensed& seen,
                                 const PredictPoints& predict);

/// Of one example: finds its fields' points on the body as it was given once. One at a time.
class FieldComparer {
 public:
  MeasuredEvaluation compare(int index, const Sensed& seen);

 private:
  std::map<int, FieldPoints> points_;  ///< by index among what is measured
};

}  // namespace hookeye
