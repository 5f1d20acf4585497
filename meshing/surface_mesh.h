// The triangle surface as the user gave it, with texture coordinates. Read by a library.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <filesystem>
#include <vector>

#include "core/input_error.h"

namespace hookeye {

using Eigen::Matrix3Xd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

struct SurfaceMesh {
  Matrix3Xd X;                                ///< 3 x nv, rest positions [length]
  std::vector<std::array<int, 3>> triangles;  ///< outward (counter-clockwise seen from outside)
  /// Texture coordinates of each triangle corner (v up, bottom row 0); empty: none.
  std::vector<std::array<Vector2d, 3>> uv;
  /// Of a subdivided surface: the triangles that it was cut from (their n vertices are its first)
  /// and each vertex's weights in one of them, nv x n. Smooth normals are interpolated from there:
  /// cutting a triangle changes no picture. Empty: its own triangles.
  std::vector<std::array<int, 3>> cut_from;
  Eigen::SparseMatrix<double, Eigen::RowMajor> cut_weights;
};

/// obj, ply, stl. Triangles keep the file's order (regions count on it); polygons are refused.
/// Corners at the same position are one vertex. Throws InputError.
SurfaceMesh read_surface(const std::filesystem::path& file);

/// What is wrong with a surface that should bound a body; empty lists: nothing.
struct SurfaceFaults {
  std::vector<std::array<int, 2>> open_edges;          ///< vertex pairs with one triangle
  std::vector<std::array<int, 2>> crowded_edges;       ///< with three or more
  std::vector<std::array<int, 2>> self_intersections;  ///< triangle pairs
  std::vector<int> degenerate, duplicated;             ///< triangles
  std::vector<int> inverted;  ///< triangles turned against their neighbours
  bool inside_out = false;    ///< closed parts: negative volume
  bool clean() const;
  /// One sentence with the place (vertex position, triangle index) of the first fault.
  std::string describe(const SurfaceMesh& surface) const;
};
SurfaceFaults inspect(const SurfaceMesh& surface);

/// Mends what can be mended without guessing and `said` tells each mend (docs/meshing.md); what
/// intersects by rounding alone stays, for fill() passes it by. Throws InputError for the rest.
/// Triangle indices of the file remain valid through `file_triangle` (one per triangle left).
struct MendedSurface {
  SurfaceMesh surface;
  std::vector<int> file_triangle;
  std::vector<std::string> said;
};
MendedSurface mend(const SurfaceMesh& surface, const Place& place);

}  // namespace hookeye
