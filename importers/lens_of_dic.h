// What importers of DIC systems share; for this folder alone.
#pragma once

#include <Eigen/Core>
#include <array>

#include "importers/importer.h"

namespace hookeye::detail {

/// R = Rz(c) Ry(b) Rx(a), angles in degrees: the Cardan angles of VIC-3D, DICe and MatchID.
Eigen::Matrix3d cardan(double a_deg, double b_deg, double c_deg);

/// k1 k2 k3 (radial) and p1 p2 of a system whose model is not published. All zero: a lens without
/// distortion; else refused unless the user says that they are OpenCV's. Throws InputError.
std::vector<double> unpublished_lens(const std::array<double, 5>& k1_k2_k3_p1_p2,
                                     const std::string& system, const ImportOptions& options,
                                     const Place& place);

}  // namespace hookeye::detail
