// The surface as the mesher gets it: edges of the wanted size, and triangles of a good shape.
#pragma once

#include "meshing/subdivide.h"

namespace hookeye::detail {

/// Cuts edges longer than `longest`, as subdivide() does, and turns or contracts edges of triangles
/// that would be far from round: drawn parts have plane faces of long thin triangles. Good
/// triangles stay as they are. No vertex is moved; those that go lie within `tolerance` of the
/// skin, and so far from each other do an edge and the one that it is turned to pass. Without
/// texture.
Subdivided skin_of(const SurfaceMesh& surface, double longest, double tolerance);
/// The same of a surface that was changed before.
Subdivided skin_of(Subdivided skin, double longest, double tolerance);

}  // namespace hookeye::detail
