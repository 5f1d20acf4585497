#include "app/commands/describe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hookeye {

nlohmann::ordered_json describe_vector(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::string vector_text(const Vector3d& v, double scale) {
  // what rounding left reads as zero (and -0 as 0)
  const double least = 1e-9 * std::max(scale, v.cwiseAbs().maxCoeff());
  const auto shown = [&](double x) { return std::abs(x) <= least ? 0.0 : x; };
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", shown(v.x()), shown(v.y()), shown(v.z()));
}

nlohmann::ordered_json describe_mesh(const TetMesh& mesh) {
  const MeshQuality q = quality(mesh);
  return {{"order", mesh.order},
          {"nodes", q.nodes},
          {"elements", q.elements},
          {"unknowns", 3 * q.nodes},
          {"volume", q.volume},
          {"low", describe_vector(mesh.X.rowwise().minCoeff())},
          {"high", describe_vector(mesh.X.rowwise().maxCoeff())},
          {"mean_edge", q.mean_edge},
          {"min_dihedral_deg", q.min_dihedral_deg},
          {"max_dihedral_deg", q.max_dihedral_deg},
          {"min_radius_ratio", q.min_radius_ratio},
          {"worst_element", q.worst_element}};
}

std::string mesh_lines(const TetMesh& mesh) {
  const MeshQuality q = quality(mesh);
  return fmt::format(
      "  {} tetrahedra of order {}, {} nodes, volume {:.6g}, mean edge {:.4g}\n"
      "  from {} to {}\n"
      "  dihedral angles {:.1f} to {:.1f} degrees, worst radius ratio {:.3f} (element {})\n",
      q.elements, mesh.order, q.nodes, q.volume, q.mean_edge,
      vector_text(mesh.X.rowwise().minCoeff()), vector_text(mesh.X.rowwise().maxCoeff()),
      q.min_dihedral_deg, q.max_dihedral_deg, q.min_radius_ratio, q.worst_element);
}

std::string narrow_triangles_line(const TetMesh& mesh) {
  constexpr double kFlat = 0.05;  // docs/meshing.md
  const MeshQuality q = quality(mesh);
  if (q.min_radius_ratio >= kFlat) return {};
  return fmt::format(
      "  narrow triangles of the surface make flat tetrahedra: "
      "`hookeye mesh --repair --edge {:.2g}` remeshes it first\n",
      q.mean_edge);
}

}  // namespace hookeye
