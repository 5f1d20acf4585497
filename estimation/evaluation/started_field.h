// A field that starts from another load case: its places are on the body as that deforms it, and
// what it holds leads on from there.
#pragma once

#include "estimation/evaluation/sensor.h"
#include "estimation/model/field_points.h"

namespace hookeye {

/// The field's points on the body in the state that it starts from. Both states move with the
/// parameters, and so do the material points that lie at the field's places.
class StartedField {
 public:
  /// Of one that starts from a load case. Both outlive it.
  StartedField(const MeasuredSpec& measured, const Sensed& seen);
  /// As predicted_field().
  SensorPrediction predicted(Eigen::Index first, Eigen::Index count) const;

 private:
  /// Of A = F T and of T, 6 x columns.
  struct TangentsMoved {
    Eigen::MatrixXd d_A, d_T;
  };
  /// The point that lies at a place, and where it is at the start and goes: derivatives, 3 x
  /// columns.
  struct PointMoved {
    Vector3d from;
    Eigen::MatrixXd d_from, d_to;
  };
  /// `d_place`: null: the place stands still.
  PointMoved point_moved(const SurfacePoint& at, const Vector3d& place,
                         const Eigen::MatrixXd* d_place) const;
  TangentsMoved tangents_moved(Eigen::Index k) const;
  Eigen::MatrixXd by_window(Eigen::Index k, const Eigen::MatrixXd& d_centre,
                            const Eigen::MatrixXd& d_T) const;
  Tangents gradient_of(Eigen::Index k) const;
  SensorPrediction displacements(Eigen::Index first, Eigen::Index count) const;
  SensorPrediction strains(Eigen::Index first, Eigen::Index count) const;

  const FieldSpec& field_;
  const Sensed& seen_;
  const ExampleEvaluation& start_;  ///< the example that it starts from
  TetMesh mesh_;                    ///< with its nodes there
  BoundaryFaces faces_;
  FieldPoints points_;
};

/// The state of an example that fields start from: of the evaluation, where it is in it; where
/// nothing is measured of it, solved anew. No numbers: it has no equilibrium.
VectorXd state_of(const Model& model, const Evaluation& evaluation, int example);
/// The mesh that a field's points lie on, in a model and its evaluation.
TetMesh mesh_below(const Model& model, const Evaluation& evaluation, const MeasuredSpec& measured);

/// Examples at which the fields of `examples` look, each once.
std::vector<int> field_starts(const Scene& scene, const std::vector<int>& examples);

}  // namespace hookeye
