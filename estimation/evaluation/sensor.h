// What a model predicts of a measurement, and its derivative. A new kind: sensors/KIND.cpp, and a
// line in capture_io/measured_kinds.def.
#pragma once

#include "estimation/evaluation/columns.h"
#include "estimation/evaluation/evaluation.h"

namespace hookeye {

/// One example under the present parameters.
struct Sensed {
  const Scene& scene;
  const Model& model;
  int example = 0;
  const Equilibrium& equilibrium;
  const Eigen::MatrixXd& S;                 ///< dq/dp, 3n x columns
  const ExampleColumns* columns = nullptr;  ///< null: no derivative is asked for
  /// By example, those that a field may start from; null: none of these does.
  const std::vector<ExampleEvaluation>* states = nullptr;
};

struct SensorPrediction {
  VectorXd value;     ///< as many as MeasuredSpec::value, in the capture's units; angles in degrees
  Eigen::MatrixXd J;  ///< its derivative by the columns; empty: none was asked for
};

/// By MeasuredSpec::Kind.
SensorPrediction predicted(const MeasuredSpec& measured, const Sensed& seen);

namespace sensors {
#define MEASURED(kind, on, key, size, unit, words) \
  SensorPrediction kind(const MeasuredSpec& measured, const Sensed& seen);
#include "capture_io/measured_kinds.def"
#undef MEASURED
}  // namespace sensors

}  // namespace hookeye
