// What a step leaves of measured fields: figures, and their residuals on the body.
#pragma once

#include <nlohmann/json.hpp>

#include "estimation/fit/fit.h"

namespace hookeye {

/// metrics.json, `fields`: by example what is left of each, over noise and as a length.
nlohmann::json fields_json(const Scene& scene, const Fitted& fitted);

/// Residual of an example's fields on the nodes: the mean of what the points near a node have,
/// weighted with its share in them. A component that is not measured is zero.
struct NodalField {
  Eigen::MatrixXd residual;  ///< 3 x n, predicted less measured [length]
  Eigen::MatrixXd strain;    ///< 3 x n, the same of strains: exx, eyy, exy along the told axes
  Eigen::MatrixXd rms;       ///< 1 x n, of a component, over told noise
  Eigen::MatrixXd share;     ///< 1 x n, the points' weights; 0: no point is near
  bool has_motions = false, has_strains = false;
};
NodalField nodal_field(const Model& model, const Evaluation& evaluation,
                       const ExampleEvaluation& example);

}  // namespace hookeye
