// The only file that touches CGAL: soups turned, holes filled, surfaces remeshed. A program of its
// own.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include "core/helper_main.h"
#include "meshing/parcels.h"

namespace hookeye {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

struct Soup {
  std::vector<Point> points;
  std::vector<std::vector<size_t>> triangles;
};

std::vector<Point> points_of(const Matrix3Xd& X) {
  std::vector<Point> points;
  for (const auto& x : X.colwise()) points.emplace_back(x[0], x[1], x[2]);
  return points;
}

Soup soup_of(const SurfaceMesh& surface) {
  Soup soup{points_of(surface.X), {}};
  for (const auto& t : surface.triangles) soup.triangles.emplace_back(t.begin(), t.end());
  return soup;
}

SurfaceMesh surface_of(const std::vector<Point>& points,
                       const std::vector<std::vector<size_t>>& triangles) {
  SurfaceMesh out;
  out.X.resize(3, static_cast<Eigen::Index>(points.size()));
  for (size_t i = 0; i < points.size(); ++i)
    out.X.col(static_cast<Eigen::Index>(i)) << points[i].x(), points[i].y(), points[i].z();
  for (const auto& t : triangles)
    out.triangles.push_back(
        {static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  return out;
}

/// Triangles turned to agree with their neighbours; parted where more than two meet at an edge.
void orient(Unpacker& request, Packer& out) {
  Soup soup = soup_of(detail::unpack_surface(request));
  const bool whole = PMP::orient_polygon_soup(soup.points, soup.triangles);
  detail::pack(out, surface_of(soup.points, soup.triangles));
  out.put(whole);
}

/// The triangles over a loop, as positions in it; none where there are no good ones. `beside`: the
/// far corner of the triangle at each edge of the loop.
void fill(Unpacker& request, Packer& out) {
  const auto loop = points_of(request.take<Matrix3Xd>()),
             beside = points_of(request.take<Matrix3Xd>());
  std::vector<CGAL::Triple<int, int, int>> patch;
  PMP::triangulate_hole_polyline(loop, beside, std::back_inserter(patch));
  std::vector<std::array<int, 3>> triangles;
  for (const auto& t : patch) triangles.push_back({t.first, t.second, t.third});
  out.put(triangles);
}

/// Edges of more than 40 degrees between their triangles stay where they are.
void remesh(Unpacker& request, Packer& out) {
  const Soup soup = soup_of(detail::unpack_surface(request));
  const auto edge = request.take<double>();
  Mesh mesh;
  PMP::polygon_soup_to_polygon_mesh(soup.points, soup.triangles, mesh);
  auto sharp = mesh.add_property_map<Mesh::Edge_index, bool>("e:sharp", false).first;
  PMP::detect_sharp_edges(mesh, 40.0, sharp);
  PMP::isotropic_remeshing(CGAL::faces(mesh), edge, mesh,
                           CGAL::parameters::number_of_iterations(5)
                               .number_of_relaxation_steps(3)
                               .edge_is_constrained_map(sharp));
  mesh.collect_garbage();
  std::vector<Point> points;
  for (const auto v : mesh.vertices()) points.push_back(mesh.point(v));
  std::vector<std::vector<size_t>> triangles;
  for (const auto f : mesh.faces()) {
    triangles.emplace_back();
    for (const auto v : CGAL::vertices_around_face(mesh.halfedge(f), mesh))
      triangles.back().push_back(v);
  }
  detail::pack(out, surface_of(points, triangles));
}

std::string answer(Unpacker& request) {
  const auto task = request.take<std::string>();
  die_of_interrupts();
  Packer out;
  if (task == "orient") orient(request, out);
  if (task == "fill") fill(request, out);
  if (task == "remesh") remesh(request, out);
  return out.take();
}

}  // namespace
}  // namespace hookeye

int main() { return hookeye::serve(hookeye::answer); }
