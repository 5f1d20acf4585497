#include "real/plate.h"

#include <gmsh.h>

#include <cmath>

namespace hookeye::real {

namespace {

namespace geo = gmsh::model::geo;

int add_outline(const std::vector<Plate::Corner>& corners) {
  std::vector<int> points, lines;
  for (const auto& c : corners) points.push_back(geo::addPoint(c.at.x(), c.at.y(), 0.0, c.edge));
  for (size_t i = 0; i < points.size(); ++i)
    lines.push_back(geo::addLine(points[i], points[(i + 1) % points.size()]));
  return geo::addCurveLoop(lines);
}

/// Four arcs: gmsh draws none above half a turn.
int add_hole(const Plate::Hole& hole) {
  const int centre = geo::addPoint(hole.centre.x(), hole.centre.y(), 0.0, hole.edge);
  std::vector<int> points, arcs;
  for (int i = 0; i < 4; ++i) {
    const double angle = i * EIGEN_PI / 2.0;
    points.push_back(geo::addPoint(hole.centre.x() + hole.radius * std::cos(angle),
                                   hole.centre.y() + hole.radius * std::sin(angle), 0.0,
                                   hole.edge));
  }
  for (int i = 0; i < 4; ++i)
    arcs.push_back(geo::addCircleArc(points[i], centre, points[(i + 1) % 4]));
  return geo::addCurveLoop(arcs);
}

}  // namespace

void write_plate(const std::filesystem::path& msh, const Plate& plate) {
  gmsh::initialize(0, nullptr, false);
  gmsh::option::setNumber("General.Terminal", 0);
  std::vector<int> loops{add_outline(plate.outline)};
  for (const auto& hole : plate.holes) loops.push_back(add_hole(hole));
  const int face = geo::addPlaneSurface(loops);
  // Extruded layers become tetrahedra without gmsh's three-dimensional mesher.
  gmsh::vectorpair extruded;
  geo::extrude({{2, face}}, 0.0, 0.0, -plate.thickness, extruded, {plate.layers});
  geo::synchronize();
  gmsh::option::setNumber("Mesh.SecondOrderLinear", 1);
  gmsh::model::mesh::generate(3);
  gmsh::model::mesh::setOrder(2);
  gmsh::write(msh.string());
  gmsh::finalize();
}

}  // namespace hookeye::real
