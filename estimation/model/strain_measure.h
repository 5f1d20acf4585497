// Strains of a surface out of its tangents.
#pragma once

#include "capture_io/strain_field.h"
#include "estimation/model/boundary_faces.h"

namespace hookeye {

struct StrainOfTangents {
  Vector3d e = Vector3d::Zero();  ///< exx, eyy, exy; exy is the tensor's, half of the shear's angle
  /// By A column after column.
  Eigen::Matrix<double, 3, 6> d_A = Eigen::Matrix<double, 3, 6>::Zero();
};
/// `T`: orthonormal tangents at rest; A = F T where they went. Does not depend on T but for small
/// strains.
StrainOfTangents strain_by(StrainMeasure measure, const Tangents& A, const Tangents& T);

}  // namespace hookeye
