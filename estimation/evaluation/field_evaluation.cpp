#include "estimation/evaluation/field_evaluation.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "estimation/evaluation/gram.h"
#include "estimation/evaluation/started_field.h"

namespace hookeye {

namespace {

/// The same of strains.
SensorPrediction predicted_strains(const FieldSpec& field, const FieldPoints& points,
                                   const Sensed& seen, Eigen::Index first, Eigen::Index count) {
  const int components = field.components;
  SensorPrediction out;
  out.value.resize(components * count);
  if (seen.columns) out.J.resize(components * count, seen.S.cols());
  std::vector<std::pair<Eigen::Index, Eigen::Matrix3d>> turning;
  for (Eigen::Index j = 0; seen.columns && j < seen.S.cols(); ++j)
    if (const auto turn = seen.columns->d_placement.col(j); !turn.isZero(0.0))
      turning.emplace_back(j, Eigen::Map<const Eigen::Matrix3d>(turn.data()));
  const PointStrainer strainer(seen.scene.body->mesh, field, *points.strain,
                               seen.model.placement.linear());
  for (Eigen::Index k = 0; k < count; ++k) {
    const PointStrain at =
        strainer.at(first + k, seen.equilibrium.q, seen.columns ? &seen.S : nullptr, turning);
    out.value.segment(components * k, components) = at.e.head(components);
    if (seen.columns) out.J.middleRows(components * k, components) = at.J.topRows(components);
  }
  return out;
}

}  // namespace

SensorPrediction predicted_field(const MeasuredSpec& measured, const FieldPoints& points,
                                 const Sensed& seen, Eigen::Index first, Eigen::Index count) {
  if (points.strain) return predicted_strains(*measured.field, points, seen, first, count);
  const int components = measured.field->components;
  const auto along = measured.field->axes.leftCols(components).transpose();
  const Eigen::Matrix3d& turn = seen.model.placement.linear();
  const Eigen::MatrixXd turned = along * turn;
  SensorPrediction out;
  out.value.resize(components * count);
  if (seen.columns) out.J.setZero(components * count, seen.S.cols());
  std::vector<Eigen::Index> placing;  // columns that move the whole set-up
  if (seen.columns)
    for (Eigen::Index j = 0; j < seen.S.cols(); ++j)
      if (!seen.columns->d_placement.col(j).isZero(0.0)) placing.push_back(j);
  Eigen::MatrixXd moved;  // 3 x columns: derivative of the point's place in the body
  for (Eigen::Index k = 0; k < count; ++k) {
    Vector3d u = -points.rest.col(first + k);
    if (seen.columns) moved.setZero(3, seen.S.cols());
    for (decltype(points.N)::InnerIterator it(points.N, first + k); it; ++it) {
      u += it.value() * seen.equilibrium.q.segment<3>(3 * it.col());
      if (seen.columns) moved += it.value() * seen.S.middleRows(3 * it.col(), 3);
    }
    out.value.segment(components * k, components) = turned * u;
    if (!seen.columns) continue;
    auto J = out.J.middleRows(components * k, components);
    J = turned * moved;
    for (const Eigen::Index j : placing)
      J.col(j) +=
          along * (Eigen::Map<const Eigen::Matrix3d>(seen.columns->d_placement.col(j).data()) * u);
  }
  return out;
}

namespace {

/// B with B^T B = G.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& G) {
  VectorXd length = lengths(G);
  for (double& one : length)
    if (one <= 0.0) one = 1.0;
  const VectorXd inverse = length.cwiseInverse();
  const Eigen::MatrixXd scaled = inverse.asDiagonal() * G * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose() * length.asDiagonal();
}

}  // namespace

MeasuredEvaluation compare_field(const MeasuredSpec& measured, const Sensed& seen,
                                 const PredictPoints& predict) {
  constexpr Eigen::Index kAtOnce = 256;
  const int components = measured.field->components;
  const Eigen::Index n = measured.field->X.cols(), m = seen.columns ? seen.S.cols() : 0;
  MeasuredEvaluation out;
  out.numbers = measured.field->numbers();
  out.predicted.resize(components * n);
  VectorXd r(components * n);
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(m + 1, m + 1), rows;
  for (Eigen::Index first = 0; first < n; first += kAtOnce) {
    const Eigen::Index count = std::min(kAtOnce, n - first);
    const Eigen::Index at = components * first, size = components * count;
    const SensorPrediction there = predict(first, count);
    const VectorXd weight = measured.sigma.segment(at, size).cwiseInverse();
    out.predicted.segment(at, size) = there.value;
    r.segment(at, size) = weight.cwiseProduct(there.value - measured.value.segment(at, size));
    if (!seen.columns) continue;
    rows.resize(size, m + 1);
    rows.leftCols(m) = weight.asDiagonal() * there.J;
    rows.col(m) = r.segment(at, size);
    G.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  }
  out.inflation = measured.field->inflation(r);
  out.effective = measured.field->effective(r);
  if (!seen.columns) {
    out.r = std::move(r);
    return out;
  }
  const Eigen::MatrixXd root = root_of(G.selfadjointView<Eigen::Lower>());
  out.J = root.leftCols(m);
  out.r = root.col(m);
  return out;
}

MeasuredEvaluation FieldComparer::compare(int index, const Sensed& seen) {
  const MeasuredSpec& spec = seen.scene.capture.examples[static_cast<size_t>(seen.example)]
                                 .measured[static_cast<size_t>(index)];
  MeasuredEvaluation out;
  if (start_index(seen.scene, spec) >= 0) {
    const StartedField field(spec, seen);
    out = compare_field(spec, seen, [&](Eigen::Index first, Eigen::Index count) {
      return field.predicted(first, count);
    });
  } else {
    auto found = points_.find(index);
    if (found == points_.end())
      found = points_.emplace(index, field_points(seen.scene.body->mesh, *spec.field)).first;
    out = compare_field(spec, seen, [&](Eigen::Index first, Eigen::Index count) {
      return predicted_field(spec, found->second, seen, first, count);
    });
  }
  out.example = seen.example;
  out.index = index;
  return out;
}

}  // namespace hookeye
