// Pictures of loads and views that nobody has taken, predicted at the fitted model, with their
// normal equations by the effects to be separated.
#pragma once

#include "estimation/fit/evidence.h"
#include "estimation/plan/plan.h"

namespace hookeye {

/// One effect in the columns of the prediction.
struct PlanHypothesis {
  std::string name;
  std::shared_ptr<const Ingredient> ingredient;
  int first = 0;
  VectorXd step;     ///< from its null to what the diagnosis estimates
  VectorXd typical;  ///< changes that matter
  bool one_sided = false;
};

/// The model of a scene with a candidate in it, and its states.
struct PlannedModel {
  Model model;
  ModelForm form;           ///< with the hypotheses appended
  VectorXd p;               ///< of form, hypotheses at their nulls
  std::vector<int> global;  ///< column of Prediction::H for each column here
  std::map<int, std::pair<VectorXd, Eigen::MatrixXd>> states;  ///< example -> q, S = dq/dp
};

struct PredictedPhotos {
  PlanCandidate candidate;
  std::string why_not;  ///< no equilibrium, out of sight
  Eigen::MatrixXd H;    ///< sum of J^T J with the effective share, as EffectiveSums::H
  double count = 0.0;   ///< effective number of residuals
  struct View {
    int example = 0, photo = 0;
    double count = 0.0;
    Eigen::MatrixXd JtJ;  ///< plain, per pixel
  };
  std::vector<View> views;
  std::shared_ptr<const PlannedModel> planned;
};

/// All columns: the fitted parameters (`base` of them), the confused effects, the untestable ones.
struct Prediction {
  int base = 0;
  double noise = 1.0;  ///< variance of a cell's standardised estimate
  std::vector<PlanHypothesis> confused, untestable;
  Eigen::MatrixXd H;   ///< of the photos there are
  double count = 0.0;  ///< their effective number of residuals
  std::vector<PredictedPhotos> photos;
};

/// Throws std::runtime_error for a confused effect that has no estimate in the diagnosis.
Result<Prediction> predict(const Fitted& fitted, const Diagnosis& diagnosis,
                           const std::vector<std::string>& confused,
                           const std::vector<std::string>& untestable, const PlanOptions& options);

struct Difference {
  double px = 0.0;   ///< rms over the surface in the pictures
  double chi = 0.0;  ///< rms over the pixels, in units of noise
  std::string most;  ///< camera of the photo with the largest px, example for a view
};
/// What a step over all columns does to the pictures of one candidate.
Difference difference_of(const PredictedPhotos& photos, const VectorXd& step);

}  // namespace hookeye
