// Whether a fitted material resists shear bands and wrinkles over the strains that occur.
#pragma once

#include <nlohmann/json.hpp>

#include "estimation/fit/fit.h"

namespace hookeye {

/// `metrics.ellipticity`, at the most strained and the most compressed point of every element of
/// every example: {smallest, example, element, elements_lost}: the smallest eigenvalue of the
/// acoustic tensor [stress], where it is, and how many elements have one that is not positive
/// (ellipticity.h), over all examples. Of any law: StVK loses ellipticity at a uniaxial stretch of
/// 0.577 or before.
nlohmann::json lost_ellipticity(const Scene& scene, const Fitted& fitted);

/// The same of one equilibrium q.
struct LostEllipticity {
  double smallest;   ///< eigenvalue of the acoustic tensor [stress], a sweep's
  int element;       ///< where it is
  Matrix9d dP_dF;    ///< there
  int elements = 0;  ///< that have one that is not positive
};
LostEllipticity lost_ellipticity(const TetMesh& mesh, const EnergyModel& energy, const VectorXd& q);

}  // namespace hookeye
