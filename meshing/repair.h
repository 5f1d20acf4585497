// A broken surface mended as far as that can be done: `hookeye mesh --repair`.
#pragma once

#include <string>
#include <vector>

#include "meshing/surface_mesh.h"

namespace hookeye {

struct RepairOptions {
  /// Gaps as wide as this are closed [length]; 0: a ten-thousandth of the bounding box's diagonal,
  /// and at most a tenth of an open edge in the median.
  double tolerance = 0.0;
  double edge = 0.0;  ///< remesh to this edge [length]; 0: keep the triangles
};

struct RepairedSurface {
  SurfaceMesh surface;            ///< bounds a body; without texture coordinates
  std::vector<std::string> said;  ///< what was done, in order
  /// [length^3]; NaN before where it had holes or triangles that disagree, and enclosed nothing.
  double volume_before = 0.0, volume = 0.0;
  double area_before = 0.0, area = 0.0;  ///< [length^2]
  double moved = 0.0;  ///< how far the old and the new surface leave each other [length]
};

/// Drops what is there twice, closes gaps, turns triangles to agree, fills holes, mends slivers,
/// cuts out what intersects itself, and remeshes where asked (helpers/repair.cpp: CGAL). Throws
/// InputError (place) where what comes out still bounds no body, or where this build has no CGAL.
RepairedSurface repair(const SurfaceMesh& surface, const RepairOptions& options,
                       const Place& place);

}  // namespace hookeye
