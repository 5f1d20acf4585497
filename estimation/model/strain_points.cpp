#include "estimation/model/strain_points.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "estimation/model/strain_measure.h"
#include "simulation/quadrature.h"

namespace hookeye {

namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

/// A point of the body's skin with what its element's nodes have there.
struct Sample {
  Vector3d X;
  const TetMesh* mesh;
  SurfacePoint at;
  Eigen::Vector2d offset;  ///< where it was sought
};

/// Points of a disc about `centre` on the skin, a square grid of it; those that lie past a rim, or
/// round an edge, are no part of the surface there.
std::vector<Sample> disc_on(const TetMesh& mesh, const BoundaryLocator& locator,
                            const BoundaryFaces& faces, const Vector3d& centre,
                            const Vector3d& normal, const Tangents& T, double diameter) {
  constexpr int kHalf = 2;           // five points across
  constexpr double kSameSide = 0.7;  // cosine of normals
  constexpr double kShift = 0.25;    // of a step, by which a foot may lie beside its point
  constexpr double kInward = 0.02;   // of the way to the centre: a foot on a rim is on two faces
  const double step = diameter / (2 * kHalf + 1);
  std::vector<Sample> out;
  for (int i = -kHalf; i <= kHalf; ++i)
    for (int j = -kHalf; j <= kHalf; ++j) {
      if (i * i + j * j > (kHalf + 0.5) * (kHalf + 0.5)) continue;
      const Vector3d sought = centre + step * T * Eigen::Vector2d(i, j);
      Sample one{{}, &mesh, {}, step * Eigen::Vector2d(i, j)};
      locator.locate(sought, &one.at);
      one.X = nodes_of(mesh, one.at.element) * shape_values(mesh.order, one.at.barycentric);
      if ((T.transpose() * (one.X - sought)).norm() > kShift * step) continue;
      SurfacePoint inside;
      locator.locate(one.X + kInward * (centre - one.X), &inside);
      if (faces.normal(inside).dot(normal) < kSameSide) continue;
      out.push_back(one);
    }
  return out;
}

/// Weights of the samples in the gradient of the plane through them, by tangent; empty: they are
/// too few, or on a line.
Eigen::Matrix2Xd plane_weights(const std::vector<Sample>& samples, const Vector3d& centre,
                               const Tangents& T) {
  constexpr size_t kLeast = 4;
  if (samples.size() < kLeast) return {};
  const auto n = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixX3d plane(n, 3);
  for (Eigen::Index i = 0; i < n; ++i)
    plane.row(i) << 1.0, (T.transpose() * (samples[static_cast<size_t>(i)].X - centre)).transpose();
  Eigen::ColPivHouseholderQR<Eigen::MatrixX3d> qr(plane);
  qr.setThreshold(1e-3);
  if (qr.rank() < 3) return {};
  return qr.solve(Eigen::MatrixXd::Identity(n, n)).bottomRows<2>();
}

/// The gradient itself.
void by_plane(const std::vector<Sample>& samples, const Eigen::Matrix2Xd& weights, int row,
              std::array<Triplets, 2>& out) {
  for (size_t i = 0; i < samples.size(); ++i) {
    const Sample& one = samples[i];
    const VectorXd N = shape_values(one.mesh->order, one.at.barycentric);
    for (Eigen::Index a = 0; a < N.size(); ++a)
      for (int j = 0; j < 2; ++j)
        if (std::abs(N[a]) > 1e-14)
          out[static_cast<size_t>(j)].emplace_back(row, one.mesh->elements(a, one.at.element),
                                                   N[a] * weights(j, static_cast<Eigen::Index>(i)));
  }
}

StrainWindow window_of(const std::vector<Sample>& samples, const Eigen::Matrix2Xd& weights) {
  StrainWindow out;
  out.weights = weights;
  out.offset.resize(2, weights.cols());
  for (const Sample& one : samples) {
    out.offset.col(static_cast<Eigen::Index>(out.at.size())) = one.offset;
    out.at.push_back(one.at);
  }
  return out;
}

/// Gradient of the shape functions at the point itself.
void by_shape(const TetMesh& mesh, const SurfacePoint& at, const Tangents& T, int row,
              std::array<Triplets, 2>& out) {
  const Eigen::MatrixXd along = shape_derivatives(mesh.order, at.barycentric) *
                                rest_gradient(mesh, at).inverse() * T;  // nodes x 2
  for (Eigen::Index a = 0; a < along.rows(); ++a)
    for (int j = 0; j < 2; ++j)
      if (along(a, j) != 0.0)
        out[static_cast<size_t>(j)].emplace_back(row, mesh.elements(a, at.element), along(a, j));
}

}  // namespace

std::optional<Tangents> tangents_along(const Vector3d& normal,
                                       const Eigen::Matrix<double, 3, 2>& axes) {
  constexpr double kLeast = 0.2;  // sine of the least angle between an axis and the normal
  const Vector3d x = axes.col(0) - axes.col(0).dot(normal) * normal;
  if (x.norm() < kLeast) return {};
  Tangents out;
  out.col(0) = x.normalized();
  out.col(1) = normal.cross(Vector3d(out.col(0)));
  const double side = out.col(1).dot(axes.col(1));
  if (std::abs(side) < kLeast) return {};
  if (side < 0.0) out.col(1) *= -1.0;
  return out;
}

std::vector<Tangents> strain_tangents(const TetMesh& mesh, const FieldSpec& field,
                                      const BoundaryLocator& locator) {
  const BoundaryFaces faces(mesh);
  std::vector<Tangents> out;
  for (Eigen::Index k = 0; k < field.X.cols(); ++k) {
    SurfacePoint at;
    locator.locate(field.X.col(k), &at);
    const Vector3d normal = faces.normal(at);
    const auto tangents = tangents_along(normal, field.strain->axes);
    if (!tangents)
      throw InputError(  // + 0.0: of a plane face none is -0
          {field.told, field.lines[static_cast<size_t>(k)]},
          fmt::format("the axes of the strains do not lie in the body's surface, whose normal at "
                      "this point is ({:.2g}, {:.2g}, {:.2g})",
                      normal.x() + 0.0, normal.y() + 0.0, normal.z() + 0.0),
          "tell along what exx and eyy are, in the capture's frame: `axes: [[1, 0, 0], [0, 0, "
          "1]]`, or the `frame` of the file");
    out.push_back(*tangents);
  }
  return out;
}

StrainPoints strain_points(const TetMesh& mesh, const FieldSpec& field,
                           const BoundaryLocator& locator, bool windows) {
  const BoundaryFaces faces(mesh);
  StrainPoints out;
  out.tangents = strain_tangents(mesh, field, locator);
  std::array<Triplets, 2> entries;
  for (Eigen::Index k = 0; k < field.X.cols(); ++k) {
    SurfacePoint at;
    locator.locate(field.X.col(k), &at);
    const Tangents& T = out.tangents[static_cast<size_t>(k)];
    const int row = static_cast<int>(k);
    const Vector3d X = nodes_of(mesh, at.element) * shape_values(mesh.order, at.barycentric);
    std::vector<Sample> disc;
    Eigen::Matrix2Xd weights;
    if (field.strain->gauge > 0.0) {
      disc = disc_on(mesh, locator, faces, X, faces.normal(at), T, field.strain->gauge);
      weights = plane_weights(disc, X, T);
    }
    if (weights.cols() > 0)
      by_plane(disc, weights, row, entries);
    else
      by_shape(mesh, at, T, row, entries);
    if (windows)
      out.windows.push_back(weights.cols() > 0 ? window_of(disc, weights) : StrainWindow{});
  }
  for (size_t j = 0; j < 2; ++j) {
    out.D[j].resize(field.X.cols(), mesh.nodes());
    out.D[j].setFromTriplets(entries[j].begin(), entries[j].end());
  }
  return out;
}

PointStrainer::PointStrainer(const TetMesh& mesh, const FieldSpec& field,
                             const StrainPoints& points, const Eigen::Matrix3d& placement)
    : mesh_(mesh), strain_(*field.strain), points_(points), placement_(placement) {}

Tangents PointStrainer::went(Eigen::Index point, const VectorXd& q) const {
  Tangents A = points_.tangents[static_cast<size_t>(point)];
  for (size_t j = 0; j < 2; ++j)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(points_.D[j], point); it;
         ++it)
      A.col(static_cast<Eigen::Index>(j)) +=
          it.value() * (q.segment<3>(3 * it.col()) - mesh_.X.col(it.col()));
  return A;
}

PointStrain PointStrainer::at(Eigen::Index point, const VectorXd& q, const Eigen::MatrixXd* S,
                              const Turning& turning) const {
  if (!S) return at(point, q, Eigen::MatrixXd(), Eigen::MatrixXd(), turning);
  Eigen::MatrixXd d_A = Eigen::MatrixXd::Zero(6, S->cols());
  for (size_t j = 0; j < 2; ++j)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(points_.D[j], point); it;
         ++it)
      d_A.middleRows(static_cast<Eigen::Index>(3 * j), 3) +=
          it.value() * S->middleRows(3 * it.col(), 3);
  return at(point, q, d_A, Eigen::MatrixXd(), turning);
}

PointStrain PointStrainer::at(Eigen::Index point, const VectorXd& q, const Eigen::MatrixXd& d_A,
                              const Eigen::MatrixXd& d_T, const Turning& turning) const {
  const Tangents& T = points_.tangents[static_cast<size_t>(point)];
  // A body that is placed otherwise has turned below the axes, in its surface.
  const Vector3d x = strain_.axes.col(0), x_in_body = placement_.transpose() * x;
  const Eigen::Vector2d along = T.transpose() * x_in_body;
  Eigen::Matrix2d turn;
  turn << along.x(), -along.y(), along.y(), along.x();
  turn /= along.norm();
  const Tangents turned = T * turn, A = went(point, q) * turn;
  const StrainOfTangents of = strain_by(strain_.measure, A, turned);
  PointStrain out{of.e, {}};
  if (d_A.size() == 0) return out;
  Eigen::MatrixXd d(6, d_A.cols());
  for (int j = 0; j < 2; ++j)
    d.middleRows(3 * j, 3) = turn(0, j) * d_A.topRows(3) + turn(1, j) * d_A.bottomRows(3);
  out.J = of.d_A * d;
  // What turns the axes against the surface: `d_along` of their place in it, `d_tangents` of its
  // own.
  const auto swing_by = [&](Eigen::Index column, const Eigen::Vector2d& d_along,
                            const Tangents& d_tangents) {
    const double angle = (along.x() * d_along.y() - along.y() * d_along.x()) / along.squaredNorm();
    Eigen::Matrix2d swing;
    swing << 0.0, -angle, angle, 0.0;
    const Tangents dA = A * swing;
    out.J.col(column) += of.d_A * dA.reshaped();
    if (strain_.measure != StrainMeasure::small) return;
    const Tangents d_turned = turned * swing + d_tangents * turn;
    const Eigen::Matrix2d G = d_turned.transpose() * (A - turned);
    out.J.col(column) += Vector3d(G(0, 0), G(1, 1), 0.5 * (G(0, 1) + G(1, 0)));
  };
  for (const auto& [column, d_placement] : turning)
    swing_by(column, T.transpose() * (d_placement.transpose() * x), Tangents::Zero());
  for (Eigen::Index column = 0; column < d_T.cols(); ++column) {
    const Tangents d_tangents = d_T.col(column).reshaped(3, 2);
    swing_by(column, d_tangents.transpose() * x_in_body, d_tangents);
  }
  return out;
}

}  // namespace hookeye
