// Rules that a camera's numbers obey wherever they come from.
#pragma once

#include <Eigen/Core>
#include <string>

namespace hookeye {

inline constexpr const char* rotation_rule =
    "a rotation has orthonormal rows and determinant +1 (within 1e-4)";

/// Replaces R by the nearest rotation when it is within 1e-4 of one (numbers written with few
/// digits); otherwise returns what is wrong with it and leaves it. "" = fine.
std::string make_rotation(Eigen::Matrix3d& R);

}  // namespace hookeye
