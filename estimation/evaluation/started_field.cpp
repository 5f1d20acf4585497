#include "estimation/evaluation/started_field.h"

#include <algorithm>

#include "estimation/model/held_place.h"

namespace hookeye {

VectorXd state_of(const Model& model, const Evaluation& evaluation, int example) {
  if (const ExampleEvaluation* known = evaluation.find(example); known && known->equilibrium)
    return known->equilibrium->q;
  auto solved =
      EquilibriumSolver(model.scene->mesh())
          .solve(model.energy_of(example), model.examples[static_cast<size_t>(example)].loading);
  return solved ? std::move(solved->q) : VectorXd();
}

TetMesh mesh_below(const Model& model, const Evaluation& evaluation, const MeasuredSpec& measured) {
  const TetMesh& mesh = model.scene->body->mesh;
  const int start = start_index(*model.scene, measured);
  if (start < 0) return mesh;
  const VectorXd q = state_of(model, evaluation, start);
  return q.size() > 0 ? mesh_at(mesh, q) : mesh;
}

std::vector<int> field_starts(const Scene& scene, const std::vector<int>& examples) {
  std::vector<int> out;
  for (const int e : examples)
    for (const MeasuredSpec& measured : scene.capture.examples[static_cast<size_t>(e)].measured)
      if (const int start = start_index(scene, measured);
          start >= 0 && std::find(out.begin(), out.end(), start) == out.end())
        out.push_back(start);
  return out;
}

namespace {

Turning turning_of(const Sensed& seen) {
  Turning out;
  for (Eigen::Index j = 0; seen.columns && j < seen.S.cols(); ++j)
    if (const auto turn = seen.columns->d_placement.col(j); !turn.head<9>().isZero(0.0))
      out.emplace_back(j, Eigen::Map<const Eigen::Matrix3d>(turn.data()));
  return out;
}

/// Derivatives of the tangents that tangents_along() lays into the surface, 6 x columns, by those
/// of its normal n, 3 x columns: T1 = P x / |P x| with P = 1 - n n^T, T2 = n x T1 or its opposite.
Eigen::MatrixXd tangents_turned(const Tangents& T, const Vector3d& n, const Eigen::MatrixXd& d_n,
                                const Vector3d& x) {
  const Vector3d t1 = T.col(0);
  const double into = x.dot(n), length = (x - into * n).norm();
  const double side = n.cross(t1).dot(T.col(1)) < 0.0 ? -1.0 : 1.0;
  Eigen::MatrixXd out(6, d_n.cols());
  for (Eigen::Index j = 0; j < d_n.cols(); ++j) {
    const Vector3d dn = d_n.col(j);
    Vector3d d1 = -(x.dot(dn) * n + into * dn) / length;
    d1 -= t1.dot(d1) * t1;
    out.col(j) << d1, side * (dn.cross(t1) + n.cross(d1));
  }
  return out;
}

}  // namespace

StartedField::StartedField(const MeasuredSpec& measured, const Sensed& seen)
    : field_(*measured.field),
      seen_(seen),
      start_(seen.states->at(static_cast<size_t>(start_index(seen.scene, measured)))),
      mesh_(mesh_at(seen.scene.body->mesh, start_.equilibrium->q)),
      faces_(mesh_),
      points_(field_points(mesh_, field_, seen.columns != nullptr)) {}

StartedField::PointMoved StartedField::point_moved(const SurfacePoint& at, const Vector3d& place,
                                                   const Eigen::MatrixXd* d_place) const {
  const ElementPoint point(mesh_, at);
  const Matrix3Xd from = nodes_of(mesh_, at.element),
                  to = nodes_of(mesh_, at.element, &seen_.equilibrium.q);
  const Eigen::MatrixXd d = HeldPlace(mesh_, faces_, at, place).moved(start_.S, d_place);
  return {from * point.N, point.of(start_.S) + from * point.dN * d,
          point.of(seen_.S) + to * point.dN * d};
}

StartedField::TangentsMoved StartedField::tangents_moved(Eigen::Index k) const {
  const SurfacePoint& at = points_.at[static_cast<size_t>(k)];
  const ElementPoint point(mesh_, at);
  const Matrix3Xd from = nodes_of(mesh_, at.element),
                  to = nodes_of(mesh_, at.element, &seen_.equilibrium.q);
  const Eigen::Matrix3d G = from * point.dN, back = G.inverse(), F = to * point.dN * back;
  const Eigen::MatrixXd d = HeldPlace(mesh_, faces_, at, field_.X.col(k)).moved(start_.S, nullptr);
  const Vector3d n = faces_.normal(at);
  const Tangents& T = points_.strain->tangents[static_cast<size_t>(k)];
  const Eigen::Index columns = seen_.S.cols();
  // n is along a row m of the inverse of G, whose derivative is -m dG G^-1.
  std::vector<Eigen::Matrix3d> d_G;
  Eigen::MatrixXd d_n(3, columns);
  for (Eigen::Index j = 0; j < columns; ++j) {
    d_G.push_back(point.gradient(start_.S, j) + point.gradient_moved(from, d.col(j)));
    const Vector3d turned = -(n.transpose() * d_G.back() * back).transpose();
    d_n.col(j) = turned - n.dot(turned) * n;
  }
  TangentsMoved out;
  out.d_T = tangents_turned(T, n, d_n, field_.strain->axes.col(0));
  const StrainWindow& window = points_.strain->windows[static_cast<size_t>(k)];
  if (window.at.empty()) {
    out.d_A.resize(6, columns);
    for (Eigen::Index j = 0; j < columns; ++j) {
      const Eigen::Matrix3d d_to = point.gradient(seen_.S, j) + point.gradient_moved(to, d.col(j));
      const Tangents d_T = out.d_T.col(j).reshaped(3, 2);
      const Tangents d_A = (d_to - F * d_G[static_cast<size_t>(j)]) * back * T + F * d_T;
      out.d_A.col(j) = d_A.reshaped();
    }
    return out;
  }
  out.d_A = out.d_T + by_window(k, point.of(start_.S) + G * d, out.d_T);
  return out;
}

/// What the points of its window add, as the plane through them goes: sum of W (du - G dy), with
/// the gradient G of the plane and its weights W by the points' places y in it. What the points
/// leave of the plane changes the weights to second order only.
Eigen::MatrixXd StartedField::by_window(Eigen::Index k, const Eigen::MatrixXd& d_centre,
                                        const Eigen::MatrixXd& d_T) const {
  const StrainWindow& window = points_.strain->windows[static_cast<size_t>(k)];
  const Tangents& T = points_.strain->tangents[static_cast<size_t>(k)];
  const Vector3d centre = points_.rest.col(k);
  const Tangents G = gradient_of(k);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(6, d_T.cols());
  for (size_t i = 0; i < window.at.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const Eigen::Vector2d offset = window.offset.col(column), weight = window.weights.col(column);
    const Eigen::MatrixXd d_place =
        d_centre + offset[0] * d_T.topRows(3) + offset[1] * d_T.bottomRows(3);
    const PointMoved moved = point_moved(window.at[i], centre + T * offset, &d_place);
    Eigen::MatrixXd d_y = T.transpose() * (moved.d_from - d_centre);
    const Vector3d from_centre = moved.from - centre;
    for (int j = 0; j < 2; ++j) d_y.row(j) += from_centre.transpose() * d_T.middleRows(3 * j, 3);
    const Eigen::MatrixXd d_u = moved.d_to - moved.d_from - G * d_y;
    for (int j = 0; j < 2; ++j) out.middleRows(3 * j, 3) += weight[j] * d_u;
  }
  return out;
}

/// Of the displacements along the tangents.
Tangents StartedField::gradient_of(Eigen::Index k) const {
  Tangents out = Tangents::Zero();
  for (size_t j = 0; j < 2; ++j)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(points_.strain->D[j], k);
         it; ++it)
      out.col(static_cast<Eigen::Index>(j)) +=
          it.value() * (seen_.equilibrium.q.segment<3>(3 * it.col()) - mesh_.X.col(it.col()));
  return out;
}

SensorPrediction StartedField::displacements(Eigen::Index first, Eigen::Index count) const {
  const int components = field_.components;
  const Eigen::MatrixXd along = field_.axes.leftCols(components).transpose();
  const Eigen::MatrixXd turned = along * seen_.model.placement.linear();
  const Turning turning = turning_of(seen_);
  SensorPrediction out;
  out.value.resize(components * count);
  if (seen_.columns) out.J.resize(components * count, seen_.S.cols());
  for (Eigen::Index k = 0; k < count; ++k) {
    Vector3d u = -points_.rest.col(first + k);
    for (decltype(points_.N)::InnerIterator it(points_.N, first + k); it; ++it)
      u += it.value() * seen_.equilibrium.q.segment<3>(3 * it.col());
    out.value.segment(components * k, components) = turned * u;
    if (!seen_.columns) continue;
    auto J = out.J.middleRows(components * k, components);
    const PointMoved moved =
        point_moved(points_.at[static_cast<size_t>(first + k)], field_.X.col(first + k), nullptr);
    J = turned * (moved.d_to - moved.d_from);
    for (const auto& [column, d_placement] : turning) J.col(column) += along * (d_placement * u);
  }
  return out;
}

SensorPrediction StartedField::strains(Eigen::Index first, Eigen::Index count) const {
  const int components = field_.components;
  const Turning turning = turning_of(seen_);
  const PointStrainer strainer(mesh_, field_, *points_.strain, seen_.model.placement.linear());
  SensorPrediction out;
  out.value.resize(components * count);
  if (seen_.columns) out.J.resize(components * count, seen_.S.cols());
  for (Eigen::Index k = 0; k < count; ++k) {
    TangentsMoved moved;
    if (seen_.columns) moved = tangents_moved(first + k);
    const PointStrain at =
        strainer.at(first + k, seen_.equilibrium.q, moved.d_A, moved.d_T, turning);
    out.value.segment(components * k, components) = at.e.head(components);
    if (seen_.columns) out.J.middleRows(components * k, components) = at.J.topRows(components);
  }
  return out;
}

SensorPrediction StartedField::predicted(Eigen::Index first, Eigen::Index count) const {
  return field_.strain ? strains(first, count) : displacements(first, count);
}

}  // namespace hookeye
