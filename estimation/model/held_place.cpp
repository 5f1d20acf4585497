#include "estimation/model/held_place.h"

#include <algorithm>

#include "simulation/quadrature.h"

namespace hookeye {

namespace {

/// A node of an element that lies on one of its faces, and where.
struct FaceNode {
  int local;
  Eigen::Vector4d barycentric;
};

FaceNode corner_node(int c) { return {c, Eigen::Vector4d::Unit(c)}; }

/// Between two corners: TetMesh's order of mid-edge nodes.
FaceNode middle_node(int a, int b) {
  constexpr int kMiddle[4][4] = {{-1, 4, 6, 7}, {4, -1, 5, 9}, {6, 5, -1, 8}, {7, 9, 8, -1}};
  return {kMiddle[a][b], 0.5 * (Eigen::Vector4d::Unit(a) + Eigen::Vector4d::Unit(b))};
}

/// The flat triangle of a face that a point lies on.
std::array<FaceNode, 3> piece_of(int order, int opposite, const Eigen::Vector4d& at) {
  std::array<int, 3> c{};
  for (int i = 0, k = 0; i < 4; ++i)
    if (i != opposite) c[static_cast<size_t>(k++)] = i;
  if (order == 1) return {corner_node(c[0]), corner_node(c[1]), corner_node(c[2])};
  for (size_t i = 0; i < 3; ++i) {
    const int j = c[(i + 1) % 3], k = c[(i + 2) % 3];
    if (at[c[i]] >= 0.5) return {corner_node(c[i]), middle_node(c[i], j), middle_node(c[i], k)};
  }
  return {middle_node(c[0], c[1]), middle_node(c[1], c[2]), middle_node(c[2], c[0])};
}

/// In which direction of the last two weights a foot can move that is held at the piece's rim: none
/// at a corner. `whole`: it lies within.
enum class Freedom { whole, edge, none };
Freedom freedom_of(const Vector3d& weights, const Eigen::Matrix<double, 3, 2>& edges,
                   const Vector3d& gap, Eigen::Vector2d* along) {
  constexpr double kOnRim = 1e-9, kNormal = 1e-6;
  const double size = edges.norm();
  if (gap.norm() < 1e-9 * size || (edges.transpose() * gap).norm() <= kNormal * size * gap.norm())
    return Freedom::whole;
  int out = -1, count = 0;
  for (int i = 0; i < 3; ++i)
    if (weights[i] < kOnRim) out = i, ++count;
  if (count == 0) return Freedom::whole;
  if (count > 1) return Freedom::none;
  *along = out == 0   ? Eigen::Vector2d(-1.0, 1.0)
           : out == 1 ? Eigen::Vector2d(0.0, 1.0)
                      : Eigen::Vector2d(1.0, 0.0);
  return Freedom::edge;
}

}  // namespace

HeldPlace::HeldPlace(const TetMesh& mesh, const BoundaryFaces& faces, const SurfacePoint& at,
                     const Vector3d& place) {
  const auto piece = piece_of(mesh.order, faces.opposite(at), at.barycentric);
  Eigen::Matrix<double, 4, 3> corners;
  for (int k = 0; k < 3; ++k) {
    const FaceNode& one = piece[static_cast<size_t>(k)];
    nodes_[static_cast<size_t>(k)] = mesh.elements(one.local, at.element);
    corners.col(k) = one.barycentric;
  }
  weights_ = corners.colPivHouseholderQr().solve(at.barycentric);
  const auto x = [&](int k) -> Vector3d { return mesh.X.col(nodes_[static_cast<size_t>(k)]); };
  for (int i = 0; i < 2; ++i) {
    edges_.col(i) = x(i + 1) - x(0);
    by_.col(i) = (corners.col(i + 1) - corners.col(0)).tail<3>();
  }
  gap_ = weights_[0] * x(0) + weights_[1] * x(1) + weights_[2] * x(2) - place;
  const Eigen::Matrix2d M = edges_.transpose() * edges_;
  Eigen::Vector2d along;
  switch (freedom_of(weights_, edges_, gap_, &along)) {
    case Freedom::whole:
      answer_ = M.inverse();
      break;
    case Freedom::edge:
      answer_ = along * along.transpose() / along.dot(M * along);
      break;
    case Freedom::none:
      answer_.setZero();
  }
}

Eigen::MatrixXd HeldPlace::moved(const Eigen::MatrixXd& S, const Eigen::MatrixXd* d_place) const {
  const auto of = [&](size_t k) { return S.middleRows(3 * nodes_[k], 3); };
  Eigen::MatrixXd went = weights_[0] * of(0) + weights_[1] * of(1) + weights_[2] * of(2);
  if (d_place) went -= *d_place;
  Eigen::MatrixXd off = edges_.transpose() * went;
  for (int i = 0; i < 2; ++i)
    off.row(i) += gap_.transpose() * (of(static_cast<size_t>(i + 1)) - of(0));
  return -by_ * (answer_ * off);
}

ElementPoint::ElementPoint(const TetMesh& mesh, const SurfacePoint& at)
    : order(mesh.order),
      nodes(mesh.elements.col(at.element)),
      barycentric(at.barycentric),
      N(shape_values(mesh.order, at.barycentric)),
      dN(shape_derivatives(mesh.order, at.barycentric)) {}

Eigen::MatrixXd ElementPoint::of(const Eigen::MatrixXd& S) const {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3, S.cols());
  for (Eigen::Index a = 0; a < N.size(); ++a)
    if (N[a] != 0.0) out += N[a] * S.middleRows(3 * nodes[a], 3);
  return out;
}

Eigen::Matrix3d ElementPoint::gradient(const Eigen::MatrixXd& S, Eigen::Index j) const {
  Eigen::Matrix3d out = Eigen::Matrix3d::Zero();
  for (Eigen::Index a = 0; a < N.size(); ++a) out += S.block<3, 1>(3 * nodes[a], j) * dN.row(a);
  return out;
}

Eigen::Matrix3d ElementPoint::gradient_moved(const Matrix3Xd& at_nodes, const Vector3d& d) const {
  if (order == 1) return Eigen::Matrix3d::Zero();
  Eigen::Vector4d there = barycentric;  // the gradient is linear in it
  there[0] -= d.sum();
  there.tail<3>() += d;
  return at_nodes * (shape_derivatives(order, there) - dN);
}

}  // namespace hookeye
