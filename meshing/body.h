// The body: tetrahedra to compute with, a triangle surface to look at, and the map between them.
#pragma once

#include <Eigen/SparseCore>
#include <memory>

#include "meshing/regions.h"
#include "meshing/surface_mesh.h"
#include "meshing/tet_mesh.h"

namespace hookeye {

/// The surface that is photographed. Its vertices ride on the tetrahedra: x = X_surface + W (q - X)
/// per coordinate. Triangles of the surface file are subdivided (uv interpolated, flat) until no
/// edge is longer than the tetrahedra's edge (half of it for order 2), unless the file's triangles
/// already are the faces of the volume (corner nodes), in which case they are kept.
struct RenderSurface {
  SurfaceMesh mesh;                                ///< rest
  std::vector<int> file_triangle;                  ///< triangle of the surface file each comes from
  std::vector<SurfacePoint> points;                ///< of each vertex
  Eigen::SparseMatrix<double, Eigen::RowMajor> W;  ///< nv x n, rows sum to 1
  /// Vertex positions (3 x nv) of the deformed state q (3n, node-major x0 y0 z0 x1 ...).
  Matrix3Xd deformed(const TetMesh& mesh, const VectorXd& q) const;
};

struct Body {
  TetMesh mesh;
  RenderSurface surface;
  RegionSet regions;
  std::vector<std::string> said;  ///< mends and choices the user should know of
};

/// Builds the body of a capture: reads the surface and the volume, or fills the surface.
Body make_body(const Capture& capture);

/// Another mesh of the same body: `edge_factor` scales the target edge, `order` 0: as told. What is
/// photographed stays the surface of `told`, riding on the new tetrahedra: smooth normals would
/// change with its vertices, and a mesh would be blamed for its shading. (Without a surface file
/// that is the boundary of the mesh of `told`.)
Body remesh(const Capture& capture, const Body& told, double edge_factor, int order = 0);

/// Nearest material points of the mesh's boundary, for many queries. Quadratic faces are taken as
/// their four flat parts between the mid nodes. The mesh must outlive the locator.
class BoundaryLocator {
 public:
  explicit BoundaryLocator(const TetMesh& mesh);
  ~BoundaryLocator();
  double locate(const Vector3d& X, SurfacePoint* point) const;  ///< returns the distance

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One query: nearest material point of the mesh's boundary to a rest position; distance returned.
double locate_on_boundary(const TetMesh& mesh, const Vector3d& X, SurfacePoint* point);

}  // namespace hookeye
