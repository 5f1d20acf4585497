// Tetrahedral meshes of order 1 or 2 and their boundary.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "capture_io/capture.h"
#include "meshing/surface_mesh.h"

namespace hookeye {

/// Node order of an element: corners 0..3 (positive volume: det[x1-x0, x2-x0, x3-x0] > 0), then for
/// order 2 the mid-edge nodes of the edges 01 12 02 03 23 13 (gmsh's order).
struct TetMesh {
  int order = 2;
  Matrix3Xd X;               ///< 3 x n rest positions [length]
  Eigen::MatrixXi elements;  ///< (4 or 10) x m, 0-based nodes
  /// Triangles of the boundary, outward: corners 0 1 2, order 2 then mids of 01 12 20. With the
  /// element they belong to.
  Eigen::MatrixXi boundary;  ///< (3 or 6) x nb
  std::vector<int> boundary_element;
  std::map<std::string, std::vector<int>>
      volume_groups;  ///< name -> elements (msh physical groups)
  std::map<std::string, std::vector<int>> boundary_groups;  ///< name -> columns of boundary
  /// Of fill(): the surface's triangle each boundary triangle lies on, -1: several; else empty.
  std::vector<int> boundary_parent;

  int nodes() const { return static_cast<int>(X.cols()); }
  int size() const { return static_cast<int>(elements.cols()); }
  int nodes_per_element() const { return order == 1 ? 4 : 10; }
};

/// Fills boundary and boundary_element from elements (needed after reading or building by hand).
void find_boundary(TetMesh& mesh);

struct MeshQuality {
  int nodes = 0, elements = 0;
  double volume = 0, min_dihedral_deg = 0, max_dihedral_deg = 0;
  double min_radius_ratio = 0;  ///< 3 inradius / circumradius, 1 = regular
  double mean_edge = 0;
  int worst_element = -1;
};
MeshQuality quality(const TetMesh& mesh);

struct FillOptions {
  double edge = 0.0;  ///< target edge [length]; 0: a twelfth of the bounding box's diagonal
  int order = 2;
  double radius_edge_ratio = 1.4;  ///< TetGen's quality bound -q
  double min_dihedral_deg = 12.0;
};
/// Fills a closed surface (TetGen). The boundary of the result lies on the surface, within a few
/// thousandths of the edge where triangles of a bad shape had to go, and boundary_parent says on
/// which triangle. A surface much finer than the edge is made coarser first, within a tenth of the
/// edge, and `said` tells so. Throws InputError (place) with the place of the fault.
TetMesh fill(const SurfaceMesh& surface, const FillOptions& options, const Place& place,
             std::vector<std::string>* said = nullptr);

/// msh 2.2 / 4.1, vtu, inp (C3D4, C3D10), mesh (medit, and "nnodes ntets nodes_per_tet" text).
/// Inverted elements are refused with their number. Nodes in no element are dropped and `said`
/// tells so; without `said` they are refused. Throws InputError.
TetMesh read_volume(const std::filesystem::path& file, const Place& place,
                    std::vector<std::string>* said = nullptr);

/// Raises order 1 to 2 (straight edges) or lowers 2 to 1.
TetMesh with_order(const TetMesh& mesh, int order);

struct VtuArray {
  std::string name;
  Eigen::MatrixXd values;
  bool on_points = true;
};  ///< c x n
/// Points in the rest state; double precision; appended/binary. Written whole or not at all.
void write_vtu(const std::filesystem::path& file, const TetMesh& mesh,
               const std::vector<VtuArray>& arrays);
/// Named point or cell array of a vtu (c x n); throws InputError when absent.
Eigen::MatrixXd read_vtu_array(const std::filesystem::path& file, const std::string& name,
                               bool on_points = true);
/// `normals`: of the vertices, 3 x n; none: left to the reader.
void write_surface_obj(const std::filesystem::path& file, const SurfaceMesh& surface,
                       const Eigen::Matrix3Xd& normals = {});

/// Shape functions at barycentric coordinates (4): values (4 or 10).
VectorXd shape_functions(int order, const Eigen::Vector4d& barycentric);

/// A material point of the body: element + barycentric coordinates.
struct SurfacePoint {
  int element = -1;
  Eigen::Vector4d barycentric = Eigen::Vector4d::Zero();
};

}  // namespace hookeye
