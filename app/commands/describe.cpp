#include "app/commands/describe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "meshing/flat_tetrahedra.h"
#include "runs/text.h"

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
      "  dihedral angles {:.1f} to {:.1f} degrees, worst radius ratio {:.3f} of element {} (1: "
      "regular, 0: flat)\n",
      q.elements, mesh.order, q.nodes, q.volume, q.mean_edge,
      vector_text(mesh.X.rowwise().minCoeff()), vector_text(mesh.X.rowwise().maxCoeff()),
      q.min_dihedral_deg, q.max_dihedral_deg, q.min_radius_ratio, q.worst_element);
}

std::string flat_tetrahedra_lines(const TetMesh& mesh, MeshedFrom from,
                                  const std::string& surface) {
  constexpr double kFlat = 0.05, kSharp = 5.0;  // docs/meshing.md
  constexpr double kFew = 0.05;                 // 3 % changed nothing (docs/meshing.md)
  const FlatTetrahedra flat = flat_tetrahedra(mesh, kFlat, kSharp);
  if (flat.count == 0) return {};
  const double edge = quality(mesh).mean_edge;
  const std::string how =
      from == MeshedFrom::volume
          ? "The file's own mesher made them: mesh the body anew, or specify its `surface:` and "
            "leave `volume:` out"
      : from == MeshedFrom::remeshed_surface
          ? fmt::format(
                "What is narrower than the edge makes them: a smaller one (`--edge {:.2g}`) "
                "has fewer",
                0.5 * edge)
      : from == MeshedFrom::repaired_surface
          ? fmt::format(
                "The repair keeps narrow triangles, and they make them: with `--edge {:.2g}` "
                "beside `--repair` it remeshes them; look at how far that moves the surface, and "
                "take a smaller edge where a rim matters",
                edge)
          : fmt::format(
                "Narrow triangles of the surface make them: `hookeye mesh {} --repair "
                "--edge {:.2g} -o REMESHED.obj` remeshes it; look at how far it moves the "
                "surface, and take a smaller edge where a rim matters",
                surface.empty() ? "SURFACE" : surface, edge);
  return wrapped(
      fmt::format("{} of {} tetrahedra {} nearly flat (radius ratio below {:g}, or an angle below "
                  "{:g} degrees), the flattest at {}. {}. Strains around them are wrong, and a "
                  "large load may find no equilibrium. {}",
                  flat.count, mesh.size(), flat.count == 1 ? "is" : "are", kFlat, kSharp,
                  vector_text(flat.where, mesh.X.cwiseAbs().maxCoeff()),
                  flat.count > kFew * mesh.size() ? "So many may make it too stiff"
                                                  : "So few hardly change how the body moves",
                  how),
      2);
}

}  // namespace hookeye
