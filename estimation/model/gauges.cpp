#include "estimation/model/gauges.h"

#include <fmt/format.h>

#include <Eigen/LU>

#include "meshing/extent.h"
#include "meshing/interpolation.h"

namespace hookeye {
namespace {

/// Whether a tetrahedron, its edges taken as straight, holds the point.
bool lies_inside(const TetMesh& mesh, const Vector3d& X) {
  constexpr double kRounding = 1e-9;
  for (int e = 0; e < mesh.size(); ++e) {
    Matrix3d edges;
    const Vector3d corner = mesh.X.col(mesh.elements(0, e));
    for (int c = 0; c < 3; ++c) edges.col(c) = mesh.X.col(mesh.elements(c + 1, e)) - corner;
    const Vector3d b = edges.inverse() * (X - corner);
    if (b.minCoeff() >= -kRounding && b.sum() <= 1.0 + kRounding) return true;
  }
  return false;
}

}  // namespace

Eigen::SparseMatrix<double, Eigen::RowMajor> gauge_span(const TetMesh& mesh,
                                                        const MeasuredSpec& measured) {
  Matrix3Xd ends(3, 2);
  ends << measured.point, measured.direction;
  const Eigen::SparseMatrix<double, Eigen::RowMajor> N = interpolation(mesh, ends);
  return N.row(1) - N.row(0);
}

void check_gauges(const Scene& scene, const ExampleSpec& example) {
  const TetMesh& mesh = scene.body->mesh;
  for (const MeasuredSpec& measured : example.measured) {
    if (measured.kind != MeasuredSpec::Kind::strain_of) continue;
    for (const Vector3d& X : {measured.point, measured.direction}) {
      if (lies_inside(mesh, X)) continue;
      SurfacePoint nearest;
      const double off = locate_on_boundary(mesh, X, &nearest);
      constexpr double kChords =
          0.01;  // of the body, by which a mesh's flat faces may miss its skin
      if (off <= kChords * extent(mesh.X)) continue;
      throw InputError(
          measured.place,
          fmt::format("`strain_of` of example `{}`: the point ({:.4g}, {:.4g}, {:.4g}) lies {:.3g} "
                      "{} outside of the body at rest",
                      example.name, X.x(), X.y(), X.z(), off, scene.capture.units.length),
          "two points of the body as it was given, in the capture's frame and unit");
    }
  }
}

}  // namespace hookeye
