// A surface made as coarse as the mesh that is to fill it: scans are far finer than that.
#pragma once

#include "meshing/subdivide.h"

namespace hookeye::detail {

/// Contracts edges shorter than 0.6 of `edge`, the shortest first, while old and new surface stay
/// within `tolerance` of each other [length, both]; plane faces stay plane. Then its vertices move
/// until it lies as far outside the old one as inside: chords alone would make a round body
/// thinner, and so too soft. Its triangles lie on several of the input. Without texture.
Subdivided coarsened(const SurfaceMesh& surface, double edge, double tolerance);

}  // namespace hookeye::detail
