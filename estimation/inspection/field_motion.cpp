#include "estimation/inspection/field_motion.h"

#include <Eigen/Dense>
#include <cmath>

#include "capture_io/field_start.h"
#include "estimation/model/field_points.h"
#include "estimation/model/strain_measure.h"
#include "meshing/extent.h"

namespace hookeye::inspection {

namespace {

/// Measured components of the points' displacements, point by point, from those in space (3 x n).
VectorXd components_of(const FieldSpec& field, const Matrix3Xd& u) {
  return (field.axes.leftCols(field.components).transpose() * u).reshaped();
}

/// Columns: what each rigid motion to first order, three shifts and three turns, does to them.
Eigen::MatrixXd rigid_motions(const FieldSpec& field) {
  Eigen::MatrixXd out(field.components * field.X.cols(), 6);
  const Vector3d middle = field.X.rowwise().mean();
  const double size = std::max(extent(field.X), 1e-300);
  for (int k = 0; k < 3; ++k) {
    const Vector3d axis = Vector3d::Unit(k);
    Matrix3Xd turned(3, field.X.cols());
    for (Eigen::Index i = 0; i < field.X.cols(); ++i)
      turned.col(i) = axis.cross(field.X.col(i) - middle) / size;
    out.col(k) = components_of(field, axis.replicate(1, field.X.cols()));
    out.col(3 + k) = components_of(field, turned);
  }
  return out;
}

/// Root mean square length of a point's motion.
double length_of(const VectorXd& components, const FieldSpec& field) {
  return std::sqrt(components.squaredNorm() / double(field.X.cols()));
}

double cosine_of(const VectorXd& a, const VectorXd& b) {
  const double size = a.norm() * b.norm();
  return size > 0.0 ? a.dot(b) / size : 0.0;
}

FieldMotion strain_of(const MeasuredSpec& measured, const TetMesh& mesh, const VectorXd& u) {
  const VectorXd expected = strains_to_first_order(measured, mesh, u);
  FieldMotion out;
  out.strain = true;
  out.file = measured.field->told;
  out.place = measured.place;
  out.seen = out.seen_bent = length_of(measured.value, *measured.field);
  if (expected.size() == 0) return out;
  out.expected = out.expected_bent = length_of(expected, *measured.field);
  out.cosine = out.cosine_bent = cosine_of(measured.value, expected);
  return out;
}

/// Components of the nodes' displacements `u` at the field's points.
VectorXd shown_by(const FieldSpec& field, const FieldPoints& points, const VectorXd& u) {
  const Matrix3Xd nodal = u.reshaped(3, u.size() / 3);
  return components_of(field, (points.N * nodal.transpose()).transpose());
}

FieldMotion motion_of(const MeasuredSpec& measured, const TetMesh& mesh, const VectorXd& u) {
  const FieldSpec& field = *measured.field;
  if (field.strain) return strain_of(measured, mesh, u);
  const VectorXd expected = shown_by(field, field_points(mesh, field), u);
  const VectorXd& seen = measured.value;
  FieldMotion out;
  out.file = field.told;
  out.place = measured.place;
  out.seen = length_of(seen, field), out.expected = length_of(expected, field);
  out.cosine = cosine_of(seen, expected);
  // Turns about an axis in the plane that two components do not show leave a column of zeros.
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> rigid(rigid_motions(field));
  const auto bent = [&](const VectorXd& of) -> VectorXd {
    return of - rigid_motions(field) * rigid.solve(of);
  };
  const VectorXd seen_bent = bent(seen), expected_bent = bent(expected);
  out.seen_bent = length_of(seen_bent, field), out.expected_bent = length_of(expected_bent, field);
  out.cosine_bent = cosine_of(seen_bent, expected_bent);
  return out;
}

}  // namespace

GuessedMotion guessed_motion(Sight& sight, int start, int e) {
  const FirstGuess* guess = sight.guess(e);
  const FirstGuess* before = start < 0 ? nullptr : sight.guess(start);
  GuessedMotion out;
  if (!guess || guess->u.size() == 0 || (before && before->u.size() == 0)) return out;
  out.first_order = guess->u;
  if (before) out.first_order -= before->u;
  if (guess->q.size() == 0 || (before && before->q.size() == 0)) return out;
  out.in_equilibrium = guess->q;
  if (before)
    out.in_equilibrium -= before->q;
  else
    out.in_equilibrium -= sight.coarse()->scene().body->mesh.X.reshaped();
  return out;
}

TetMesh mesh_of_field(Sight& sight, const MeasuredSpec& measured) {
  const TetMesh& mesh = sight.coarse()->scene().body->mesh;
  const int start = start_index(sight.scene(), measured);
  const FirstGuess* guess = start < 0 ? nullptr : sight.guess(start);
  if (!guess || guess->u.size() == 0) return mesh;
  TetMesh loaded =
      mesh_at(mesh, guess->q.size() > 0 ? guess->q : VectorXd(mesh.X.reshaped() + guess->u));
  const auto off = [&](const TetMesh& where) {
    const BoundaryLocator locator(where);
    double out = 0.0;
    SurfacePoint point;
    for (Eigen::Index k = 0; k < measured.field->X.cols(); ++k)
      out += std::pow(locator.locate(measured.field->X.col(k), &point), 2);
    return out;
  };
  return off(loaded) <= off(mesh) ? loaded : mesh;
}

VectorXd strains_to_first_order(const MeasuredSpec& measured, const TetMesh& mesh,
                                const VectorXd& u) try {
  const FieldSpec& field = *measured.field;
  const BoundaryLocator locator(mesh);
  const StrainPoints points = strain_points(mesh, field, locator);
  const Matrix3Xd nodal = u.reshaped(3, mesh.nodes());
  const std::array<Matrix3Xd, 2> G{(points.D[0] * nodal.transpose()).transpose(),
                                   (points.D[1] * nodal.transpose()).transpose()};
  Matrix3Xd out(3, field.X.cols());
  for (Eigen::Index k = 0; k < out.cols(); ++k) {
    const Tangents& T = points.tangents[static_cast<size_t>(k)];
    Tangents A = T;
    for (int j = 0; j < 2; ++j) A.col(j) += G[static_cast<size_t>(j)].col(k);
    out.col(k) = strain_by(StrainMeasure::small, A, T).e;
  }
  return out.topRows(field.components).reshaped();
} catch (const InputError&) {
  if (start_of(measured).empty()) throw;
  return {};
}

std::vector<GuessedMotion> field_beside(Sight& sight, const MeasuredSpec& measured,
                                        const std::vector<int>& examples,
                                        const std::vector<int>& starts) {
  const FieldSpec& field = *measured.field;
  const TetMesh mesh = mesh_of_field(sight, measured);
  std::vector<GuessedMotion> out;
  if (field.strain) {
    for (size_t i = 0; i < examples.size(); ++i) {
      out.push_back({strains_to_first_order(
                         measured, mesh, guessed_motion(sight, starts[i], examples[i]).first_order),
                     {}});
      if (out.back().first_order.size() == 0) out.back().first_order.setZero(measured.value.size());
    }
    return out;
  }
  const FieldPoints points = field_points(mesh, field);
  for (size_t i = 0; i < examples.size(); ++i) {
    GuessedMotion nodes = guessed_motion(sight, starts[i], examples[i]);
    out.push_back({shown_by(field, points, nodes.first_order), {}});
    if (nodes.in_equilibrium.size() > 0)
      out.back().in_equilibrium = shown_by(field, points, nodes.in_equilibrium);
  }
  return out;
}

std::vector<FieldMotion> field_motions(Sight& sight, int e) {
  std::vector<FieldMotion> out;
  for (const MeasuredSpec& measured : sight.example(e).measured) {
    if (!measured.field) continue;
    const int start = start_index(sight.scene(), measured);
    const VectorXd u = guessed_motion(sight, start, e).first_order;
    if (u.size() == 0 || (start >= 0 && sight.guess(start)->turned)) continue;
    out.push_back(motion_of(measured, mesh_of_field(sight, measured), u));
    out.back().example = e;
  }
  return out;
}

}  // namespace hookeye::inspection
