// Subdivision of a triangle surface until its edges are short: no cracks, texture kept.
#pragma once

#include <vector>

#include "meshing/surface_mesh.h"

namespace hookeye::detail {

struct Subdivided {
  SurfaceMesh mesh;
  std::vector<int> parent;  ///< triangle of the input each comes from
};

/// Bisects edges longer than `longest`, in rounds. Each edge is split or not by its length alone,
/// so both its triangles agree; a triangle with one, two or three split edges becomes two, three or
/// four. uv is interpolated per corner, so seams stay; cut_from and cut_weights are told.
Subdivided subdivide(const SurfaceMesh& surface, double longest);

}  // namespace hookeye::detail
