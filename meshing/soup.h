// Triangles that do not yet bound a body, and what can be done to them without a library. In
// meshing alone.
#pragma once

#include <vector>

#include "meshing/surface_mesh.h"

namespace hookeye::detail {

/// An edge with one triangle, in that triangle's direction.
struct OpenEdge {
  int from, to, triangle;
};
std::vector<OpenEdge> open_edges(const SurfaceMesh& soup);

/// Each returns how many it changed. Triangles with a corner twice, or that are there once more.
int drop_repeated(SurfaceMesh& soup);
/// Pairs of triangles with the same corners, turned against each other: walls within a body.
int drop_inner_walls(SurfaceMesh& soup);
/// Triangles with an open edge that hang on one where two others already meet.
int drop_hanging(SurfaceMesh& soup);
/// Parts that enclose nothing: of a volume below their area times `thickness`.
int drop_flat_parts(SurfaceMesh& soup, double thickness);

/// Corners of open edges that lie within `tolerance` of each other become one; `widest` is the
/// largest distance.
int weld(SurfaceMesh& soup, double tolerance, double& widest);
/// Triangles whose open edge passes a corner of another within `tolerance` are cut there.
int cut_at_corners(SurfaceMesh& soup, double tolerance);

/// Loops of open edges, each in the direction in which a patch must use them.
std::vector<std::vector<int>> holes(const SurfaceMesh& soup);

/// Takes out the triangles that intersect, and those that share a corner with them, `rings` deep.
int cut_out(SurfaceMesh& soup, const std::vector<std::array<int, 2>>& pairs, int rings);

/// Vertices of no triangle go.
void drop_unused(SurfaceMesh& soup);

}  // namespace hookeye::detail
