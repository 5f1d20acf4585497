// Where an effect is seen, in words; and by how much. Internal to diagnosis.
#pragma once

#include <string>

#include "estimation/evaluation/evaluation.h"

namespace hookeye {

/// Change of the sum of squares s, H by a joint step.
double change(const Eigen::MatrixXd& H, const VectorXd& s, const VectorXd& step);

/// "; seen in both cameras, most in 'side'": where the step removes misfit of fitted photos; "":
/// nowhere.
std::string where_seen(const Scene& scene, const Evaluation& evaluation, const VectorXd& step);

/// "; what was measured would be off by 1.1 instead of 3.9 times their told noise", of sums of
/// squares over `count` values.
std::string seen_by_sensors(double before, double after, double count);

}  // namespace hookeye
