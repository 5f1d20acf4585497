// `frame` of an anisotropic law: axes 1, 2, 3 of the material, or a tube's axis.
#pragma once

#include "simulation/energy_term.h"

namespace hookeye::laws {

/// Columns a1 a2 a3 from nine numbers, one axis a row. As for a camera's rotation, rounding to 1e-4
/// is allowed and the nearest exact frame is used. Throws InputError if it is not orthonormal.
Matrix3d read_frame(const MaterialSpec::Value& rows);
/// Throws InputError for a wrong count or an axis without length.
CylinderFrame read_cylinder(const MaterialSpec::Value& axis, const MaterialSpec::Value& center);

}  // namespace hookeye::laws
