#include "estimation/fit/field_floor.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "estimation/model/field_points.h"

namespace hookeye {

namespace {

/// Monomials of the place up to `degree`, over the field's extent: points x monomials.
Eigen::MatrixXd monomials(const Matrix3Xd& X, int degree) {
  const Vector3d low = X.rowwise().minCoeff(), high = X.rowwise().maxCoeff();
  const double half = std::max(0.5 * (high - low).maxCoeff(), 1e-300);
  const Matrix3Xd x = (X.colwise() - 0.5 * (low + high)) / half;
  Eigen::MatrixXd out(X.cols(), (degree + 1) * (degree + 2) * (degree + 3) / 6);
  Eigen::Index column = 0;
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j)
      for (int k = 0; i + j + k <= degree; ++k)
        out.col(column++) = x.row(0).array().pow(i).transpose() *
                            x.row(1).array().pow(j).transpose() *
                            x.row(2).array().pow(k).transpose();
  return out;
}

/// -1: too few numbers even for a constant.
int degree_of(const FieldSpec& field, const FloorLimits& limits) {
  int degree = -1;
  while (degree < limits.most_degree &&
         (degree + 2) * (degree + 3) * (degree + 4) / 6 * limits.cells_a_term <=
             field.numbers() / field.components)
    ++degree;
  return degree;
}

}  // namespace

VectorXd whole_residual(const MeasuredSpec& spec, const MeasuredEvaluation& field) {
  return (field.predicted - spec.value).cwiseQuotient(spec.sigma);
}

SmoothField smooth_field(const FieldSpec& field, const VectorXd& r, const FloorLimits& limits) {
  SmoothField out;
  out.rest = r;
  const int degree = degree_of(field, limits);
  if (degree < 0) return out;
  const Eigen::MatrixXd basis =
      field.alike.cwiseSqrt().cwiseInverse().asDiagonal() * monomials(field.X, degree);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(basis);
  const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(basis.rows(), qr.rank());
  const Eigen::Map<const Eigen::MatrixXd> components(r.data(), field.components, field.X.cols());
  const Eigen::MatrixXd found = components * Q;
  out.explained = found.squaredNorm();
  out.numbers = static_cast<double>(found.size());
  out.rest = (components - found * Q.transpose()).reshaped();
  return out;
}

RoughField rough_field(const FieldSpec& field, const VectorXd& r) {
  // Of fewer independent numbers a plane leaves next to nothing.
  constexpr double kLeast = 6.0;
  std::vector<std::vector<Eigen::Index>> points(static_cast<size_t>(field.pieces));
  for (size_t k = 0; k < field.piece.size(); ++k)
    points[static_cast<size_t>(field.piece[k])].push_back(static_cast<Eigen::Index>(k));
  const Eigen::Map<const Eigen::MatrixXd> components(r.data(), field.components, field.X.cols());
  RoughField out;
  for (const auto& piece : points) {
    const double numbers = field.alike(piece).cwiseInverse().sum();
    if (numbers < kLeast) continue;
    const Eigen::MatrixXd basis = field.alike(piece).cwiseSqrt().cwiseInverse().asDiagonal() *
                                  monomials(field.X(Eigen::all, piece), 1);
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(basis);
    const Eigen::MatrixXd there = components(Eigen::all, piece).transpose();
    const auto rank = qr.rank();
    const Eigen::MatrixXd turned = qr.householderQ().adjoint() * there;
    out.r2 += there.squaredNorm() - turned.topRows(rank).squaredNorm();
    out.count += field.components * (numbers - static_cast<double>(rank));
  }
  return out;
}

namespace {

/// Of fields at rest, or of the loaded ones.
struct FieldLeft {
  RoughField all;
  double least = std::numeric_limits<double>::infinity();  ///< of one field
  double inflation = 0.0, fields = 0.0;
};

/// Neither load case of which the field tells strains the body.
bool shows_rest(const Scene& scene, const ExampleSpec& example, const MeasuredSpec& field) {
  const int start = start_index(scene, field);
  return is_rest(example) &&
         (start < 0 || is_rest(scene.capture.examples[static_cast<size_t>(start)]));
}

FieldLeft left_of(const Scene& scene, const Evaluation& evaluation, bool rest) {
  FieldLeft out;
  for (const auto& example : evaluation.examples) {
    const ExampleSpec& spec = scene.capture.examples[example.example];
    if (!rest && example.held_out) continue;
    for (const auto& field : example.measured) {
      if (!field.is_field()) continue;
      const MeasuredSpec& told = spec.measured[field.index];
      if (shows_rest(scene, spec, told) != rest) continue;
      const VectorXd r = whole_residual(told, field);
      const RoughField rough = rough_field(*told.field, r);
      if (rough.count <= 0.0) continue;
      out.all.r2 += rough.r2, out.all.count += rough.count;
      out.least = std::min(out.least, rough.chi());
      const SmoothField smooth = smooth_field(*told.field, r, scene.limits->floor);
      const double variance =
          smooth.rest.squaredNorm() / std::max(1.0, field.numbers - smooth.numbers);
      if (variance > 0.0) out.inflation += told.field->inflation(smooth.rest / std::sqrt(variance));
      out.fields += 1.0;
    }
  }
  return out;
}

}  // namespace

Floor field_floor(const Scene& scene, const Evaluation& evaluation) {
  Floor floor;
  floor.limits = scene.limits;
  floor.source = "told noise";
  const FieldLeft rest = left_of(scene, evaluation, true);
  if (rest.all.count >= scene.limits->floor.least_numbers) {
    floor.chi = rest.all.chi();
    floor.cell_inflation = std::max(1.0, rest.inflation / rest.fields);
    floor.source = "rest fields";
  } else if (const FieldLeft loaded = left_of(scene, evaluation, false);
             loaded.all.count >= scene.limits->floor.least_numbers && loaded.least > 1.0) {
    floor.chi = loaded.least;
    floor.source = "loaded fields";
  }
  floor.cell_variance = floor.chi * floor.chi;
  return floor;
}

}  // namespace hookeye
