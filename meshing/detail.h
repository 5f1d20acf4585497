// Shared inside meshing only.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "meshing/surface_mesh.h"
#include "meshing/tet_mesh.h"

namespace hookeye::detail {

/// Corners of the four faces of an element, outward, and (order 2) the mids of 01 12 20.
inline constexpr int kFaces[4][6] = {
    {0, 2, 1, 6, 5, 4}, {0, 1, 3, 4, 9, 7}, {1, 2, 3, 5, 8, 9}, {0, 3, 2, 7, 8, 6}};
/// Corners of the edges in the order of the mid nodes 4..9.
inline constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}};

/// Triangle corners before welding, as a file gives them.
struct TriangleSoup {
  Matrix3Xd corners;                        ///< 3 x (3 triangles)
  std::vector<std::array<Vector2d, 3>> uv;  ///< empty: none
};
/// Raw tetrahedra of a file: node order ours, no checks done yet.
struct RawVolume {
  Matrix3Xd X;
  Eigen::MatrixXi elements;
  int lost = 0;                            ///< loose nodes that the reader itself left out
  std::vector<std::string> element_names;  ///< number of each element in the file; empty: 1-based
  std::map<std::string, std::vector<int>> volume_groups;
  std::map<std::string, std::vector<std::array<int, 3>>> face_groups;  ///< corner nodes
  std::map<std::string, std::vector<int>> node_groups;
};

// ply.cpp, stl.cpp, vtu.cpp
TriangleSoup read_ply(const std::filesystem::path& file);
TriangleSoup read_stl(const std::filesystem::path& file);
RawVolume read_vtu(const std::filesystem::path& file);
// ask_gmsh.cpp
RawVolume read_gmsh(const std::filesystem::path& file, const Place& place);
// text_mesh.cpp
RawVolume read_inp(const std::filesystem::path& file);
RawVolume read_text_mesh(const std::filesystem::path& file);

/// Sign of det[b-a, c-a, d-a], exact (Shewchuk's predicates, which TetGen carries): predicates.cpp.
int orientation(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d);

struct TetGenTask {
  std::vector<Vector3d> holes;  ///< a point in each
  double volume = 0.0;          ///< largest of a tetrahedron [length^3]
  double radius_edge_ratio = 0.0, min_dihedral_deg = 0.0;
  bool keep_surface = true;  ///< no points on the boundary but the skin's own
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< while it is meshed: other rounding
  double most_points = 0.0, seconds = 0.0;  ///< where quality cannot be had it may go on for ever
};
struct TetGenAnswer {
  std::optional<TetMesh> mesh;  ///< none where TetGen gives up
  double seconds = 0.0;         ///< of computing that it took
  bool in_time = true;          ///< false: it was ended, for its time or its memory
};
/// Tetrahedra of order 1 within a closed surface, boundary_parent being its triangles
/// (ask_tetgen.cpp). Throws Interrupted where Ctrl-C ended TetGen.
TetGenAnswer tetrahedra(const SurfaceMesh& skin, const TetGenTask& task);

/// fill(), whose attempts take `seconds` of computing together.
TetMesh fill_within(const SurfaceMesh& surface, const FillOptions& options, const Place& place,
                    double seconds, std::vector<std::string>* said = nullptr);

/// How far the surfaces leave each other: corners of both, and the middles of the old edges. A hole
/// that is remeshed with fewer corners keeps those on the old surface, and cuts across between
/// them. What closes a gap was nowhere before: the middles of the new edges are not asked for.
double apart(const SurfaceMesh& before, const SurfaceMesh& now);

/// Where a surface is hardest to fill, in words: where two of its parts that share no corner come
/// nearest to each other, where it folds onto itself, or its thinnest triangle, whichever is
/// smallest (tightest.cpp).
std::string tightest(const SurfaceMesh& surface);

// shells.cpp
/// Six times the enclosed volume, negative inside out; as exact far from the origin.
double six_volume(const SurfaceMesh& surface);
double area(const SurfaceMesh& surface);
/// Triangles that hang together.
struct Shell {
  std::vector<int> triangles;
  double six_volume = 0.0;
  int depth = 0;  ///< number of shells around it
};
std::vector<Shell> shells(const SurfaceMesh& surface);
/// Triangles of shells that enclose a negative volume and are no cavities.
std::vector<int> inside_out(const SurfaceMesh& surface);
/// Refuses shells within another that are turned outwards, as if there were material in material.
void refuse_shells_within(const SurfaceMesh& surface, const Place& place);
/// A point in every cavity: shells within another, whose triangles are turned inwards, away from
/// the material around them.
std::vector<Vector3d> cavities(const SurfaceMesh& surface);

/// How far rounding of a file, to six digits or single precision, may have moved a vertex:
/// mend.cpp.
double rounding(const SurfaceMesh& surface);
/// Of a surface that bounds no body: inspect.cpp.
InputError no_body(const SurfaceMesh& surface, const SurfaceFaults& faults, const Place& place);

/// Jacobian determinant of an element at barycentric coordinates (6 x volume when straight).
double jacobian(const TetMesh& mesh, int element, const Eigen::Vector4d& barycentric);

/// Diagonal of the bounding box.
double diagonal(const Matrix3Xd& X);

/// "(1, 2, 3)" for messages.
std::string where(const Vector3d& x);

}  // namespace hookeye::detail
