// Strain gauges: where their two ends are on the mesh.
#pragma once

#include <Eigen/SparseCore>

#include "estimation/model/model.h"

namespace hookeye {

/// Shape functions at the second end less those at the first, 1 x nodes: N X is what lies between
/// them at rest, N q once deformed.
Eigen::SparseMatrix<double, Eigen::RowMajor> gauge_span(const TetMesh& mesh,
                                                        const MeasuredSpec& measured);

/// Throws InputError where an end lies outside of the body, by more than a hundredth of its extent.
void check_gauges(const Scene& scene, const ExampleSpec& example);

}  // namespace hookeye
