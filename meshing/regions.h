// Regions are patches of the rest surface: the same patch whatever the tetrahedral mesh.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "capture_io/capture.h"
#include "meshing/surface_mesh.h"
#include "meshing/tet_mesh.h"

namespace hookeye {

/// One region on one mesh.
struct Region {
  std::string name;
  std::vector<int> nodes;  ///< boundary nodes in the region (closed: its edge too), ascending
  /// Consistent nodal areas: integral of the shape function over the patch, sum = area. n entries
  /// (all nodes), zero away from the patch. Sub-triangle exact where the patch cuts through faces
  /// (face subdivided 16x16, midpoint rule).
  VectorXd nodal_area;
  double area = 0.0;  ///< rest area of the patch [length^2]
  Vector3d centroid = Vector3d::Zero();
  Vector3d normal = Vector3d::Zero();  ///< mean outward normal, unit (zero for closed patches)
  /// Boundary faces with the fraction of each that belongs to the patch (0..1].
  std::vector<std::pair<int, double>> faces;
};

class RegionSet {
 public:
  RegionSet() = default;
  /// `surface` may be null (no surface file: box, sphere, halfspace and group only). `mended` maps
  /// file triangles. Throws InputError (the region's place) for a region that selects nothing, an
  /// index past the surface's triangles, an unknown group (with the nearest name).
  RegionSet(const Capture& capture, const TetMesh& mesh, const MendedSurface* surface);
  const Region& at(const std::string& name) const;
  const std::map<std::string, Region>& all() const { return regions_; }

 private:
  std::map<std::string, Region> regions_;
};

}  // namespace hookeye
