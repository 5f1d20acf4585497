// What shading asks of a triangle, in one place and in single precision. Internal to render.
#pragma once

#include <array>
#include <vector>

#include "render/optics.h"
#include "render/ray_scene.h"
#include "render/view.h"

namespace hookeye {

/// Numbers of one triangle by their first index; corner k of a vector at 3k. Everything that would
/// lose digits as a float is relative to the triangle: rays to the direction h0 of its centroid,
/// texels to its first, corners to the scene's centre.
enum TriangleFloat {
  kRayToBary = 0,       ///< 3 x 2, column-major: A of b = (1/3 + A (h-h0)) / (1 + 1^T A (h-h0))
  kInverseDepth = 6,    ///< of the centroid; 1 where rays are parallel
  kNormals = 7,         ///< unit, at the corners
  kVisibility = 16,     ///< of the sky, at the corners
  kFacet = 19,          ///< the triangle's own unit normal
  kTexels = 22,         ///< corners in the texture, x and y in turn [texel]
  kCorners = 28,        ///< deformed positions
  kTriangleFloats = 40  ///< padded to fours
};

struct TriangleTable {
  struct alignas(64) Row {
    std::array<float, kTriangleFloats> value;
    std::array<int, 2> texel = {0, 0};  ///< texel that kTexels are counted from
    Vector2d h0;
  };
  std::vector<Row> rows;
};

/// One state of the surface, seen by one camera.
struct SurfaceState {
  const SurfaceMesh& surface;
  const Matrix3Xd& x;
  const Matrix3Xd& normals;               ///< unit vertex normals
  const std::vector<Vector3d>& facets;    ///< unit normals of the triangles
  const std::vector<double>& visibility;  ///< of the sky, per vertex
};

TriangleTable triangle_table(const SurfaceState& state, const View& view,
                             const Vector3d& scene_centre, const Texture& texture);

}  // namespace hookeye
