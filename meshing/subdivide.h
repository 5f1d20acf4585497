// Subdivision of a triangle surface until its edges are short: no cracks, texture kept.
#pragma once

#include <utility>
#include <vector>

#include "meshing/surface_mesh.h"

namespace hookeye::detail {

/// A triangle that lies on several of the input.
inline constexpr int kSeveral = -1;

struct Subdivided {
  SurfaceMesh mesh;
  std::vector<int> parent;  ///< triangle of the input each comes from, or kSeveral
};

/// Bisects every edge longer than `longest` once; parents go on to the parts. Returns, for each new
/// vertex, the two that it lies between: none, and nothing is changed, where no edge is so long.
std::vector<std::pair<int, int>> bisect(Subdivided& now, double longest);

/// Bisects edges longer than `longest`, in rounds. Each edge is split or not by its length alone,
/// so both its triangles agree; a triangle with one, two or three split edges becomes two, three or
/// four. uv is interpolated per corner, so seams stay; cut_from and cut_weights are told.
Subdivided subdivide(const SurfaceMesh& surface, double longest);

}  // namespace hookeye::detail
