#include <Eigen/Dense>

#include "python/effect_term.h"
#include "simulation/quadrature.h"

namespace hookeye {

namespace py = pybind11;

namespace {

/// Body force or traction that depends on where its points are. Whether it has a potential is not
/// known, so that it is sought by its residual.
class FollowingForce final : public ForceTerm {
 public:
  FollowingForce(std::shared_ptr<const Bridge> bridge, std::shared_ptr<const LoadPoints> points,
                 double share, Eigen::VectorXd values)
      : bridge_(std::move(bridge)),
        points_(std::move(points)),
        share_(share),
        values_(std::move(values)) {}

  double potential(const TetMesh&, const VectorXd&, double) const override { return 0.0; }
  bool has_potential() const override { return false; }

  void add_residual(const TetMesh&, const VectorXd& q, double s, VectorXd& R) const override;
  void add_tangent(const TetMesh&, const VectorXd& q, double s, Triplets& K) const override {
    add_part(q, s, 1.0, K);
  }
  void add_skew_tangent(const TetMesh&, const VectorXd& q, double s, Triplets& W) const override {
    add_part(q, s, -1.0, W);
  }

 private:
  /// The half of d(-force)/dq and its transpose, times `sign`.
  void add_part(const VectorXd& q, double s, double sign, Triplets& out) const;

  std::shared_ptr<const Bridge> bridge_;
  std::shared_ptr<const LoadPoints> points_;
  double share_;
  Eigen::VectorXd values_;
};

/// n x 3, or None of what a body has not.
py::object rows_or_none(const Matrix3Xd& points) {
  if (points.cols() == 0) return py::none();
  return points_array(points);
}

/// Force per rest volume or area at the points. `q`: null, at rest.
Matrix3Xd density_at(const Bridge& bridge, const LoadPoints& points, const VectorXd* q,
                     const VectorXd& values) {
  return bridge.ask([&](py::handle effect) -> Matrix3Xd {
    const py::object x = q ? py::object(points_array(points.at(*q))) : py::none();
    const py::object told = effect.attr("force")(points_array(points.X), x,
                                                 rows_or_none(points.normal), array_of(values));
    return Bridge::rows_of(told, points.X.cols(), 3).transpose();
  });
}

void spread_over(const LoadPoints& points, const Matrix3Xd& density, double factor, VectorXd& R) {
  for (Eigen::Index k = 0; k < density.cols(); ++k) {
    const Eigen::Index cell = k / points.per_cell, p = k % points.per_cell;
    const Vector3d f = (factor * points.weight[k]) * density.col(k);
    for (Eigen::Index a = 0; a < points.nodes.rows(); ++a)
      R.segment<3>(3 * points.nodes(a, cell)) += points.shape(a, p) * f;
  }
}

void FollowingForce::add_residual(const TetMesh&, const VectorXd& q, double s, VectorXd& R) const {
  spread_over(*points_, density_at(*bridge_, *points_, &q, values_), -s * share_, R);
}

void FollowingForce::add_part(const VectorXd& q, double s, double sign, Triplets& out) const {
  const Eigen::Index n = points_->X.cols();
  const Bridge::Rows D = bridge_->ask([&](py::handle effect) {
    const py::object told =
        effect.attr("force_dx")(points_array(points_->X), points_array(points_->at(q)),
                                rows_or_none(points_->normal), array_of(values_));
    return Bridge::rows_of(told, n, 9);
  });
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Index cell = k / points_->per_cell, p = k % points_->per_cell;
    const Eigen::Matrix3d own =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(D.data() + 9 * k);
    const Eigen::Matrix3d half =
        (-0.5 * s * share_ * points_->weight[k]) * (own + sign * own.transpose());
    if (half.isZero(0.0)) continue;
    for (Eigen::Index a = 0; a < points_->nodes.rows(); ++a)
      for (Eigen::Index b = 0; b < points_->nodes.rows(); ++b)
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            out.emplace_back(3 * points_->nodes(a, cell) + i, 3 * points_->nodes(b, cell) + j,
                             points_->shape(a, p) * points_->shape(b, p) * half(i, j));
  }
}

}  // namespace

Matrix3Xd LoadPoints::at(const VectorXd& q) const {
  Matrix3Xd x = Matrix3Xd::Zero(3, X.cols());
  for (Eigen::Index k = 0; k < x.cols(); ++k)
    for (Eigen::Index a = 0; a < nodes.rows(); ++a)
      x.col(k) += shape(a, k % per_cell) * q.segment<3>(3 * nodes(a, k / per_cell));
  return x;
}

LoadPoints volume_points(const TetMesh& mesh) {
  const TetRule& rule = stiffness_rule(mesh.order);
  LoadPoints out;
  out.mesh_nodes = mesh.nodes();
  out.per_cell = static_cast<int>(rule.points.size());
  out.nodes = mesh.elements;
  out.shape.resize(mesh.nodes_per_element(), out.per_cell);
  for (int p = 0; p < out.per_cell; ++p)
    out.shape.col(p) = shape_values(mesh.order, rule.points[p]);
  out.X.resize(3, mesh.size() * out.per_cell);
  out.weight.resize(out.X.cols());
  for (int e = 0; e < mesh.size(); ++e) {
    const Matrix3Xd corners = mesh.X(Eigen::all, mesh.elements.col(e));
    for (int p = 0; p < out.per_cell; ++p) {
      const int k = e * out.per_cell + p;
      const Eigen::Matrix3d jacobian = corners * shape_derivatives(mesh.order, rule.points[p]);
      out.X.col(k) = corners * out.shape.col(p);
      out.weight[k] = rule.weights[p] * jacobian.determinant() / 6.0;
    }
  }
  return out;
}

LoadPoints surface_points(const TetMesh& mesh, const Region& region) {
  const auto& rule = face_rule(mesh.order);
  LoadPoints out;
  out.mesh_nodes = mesh.nodes();
  out.per_cell = static_cast<int>(rule.size());
  const auto cells = static_cast<Eigen::Index>(region.faces.size());
  out.nodes.resize(mesh.boundary.rows(), cells);
  out.shape.resize(mesh.boundary.rows(), out.per_cell);
  for (int p = 0; p < out.per_cell; ++p) out.shape.col(p) = rule[p].N;
  out.X.resize(3, cells * out.per_cell);
  out.normal.resize(3, out.X.cols());
  out.weight.resize(out.X.cols());
  for (Eigen::Index f = 0; f < cells; ++f) {
    const auto& [face, fraction] = region.faces[static_cast<size_t>(f)];
    out.nodes.col(f) = mesh.boundary.col(face);
    const Matrix3Xd corners = mesh.X(Eigen::all, mesh.boundary.col(face));
    for (int p = 0; p < out.per_cell; ++p) {
      const Eigen::Index k = f * out.per_cell + p;
      const Eigen::Matrix<double, 3, 2> t = corners * rule[p].dN;
      const Vector3d normal = t.col(0).cross(t.col(1));
      out.X.col(k) = corners * rule[p].N;
      out.normal.col(k) = normal.normalized();
      out.weight[k] = fraction * rule[p].weight * normal.norm();
    }
  }
  return out;
}

std::shared_ptr<const ForceTerm> python_force(std::shared_ptr<const Bridge> bridge,
                                              std::shared_ptr<const LoadPoints> points,
                                              bool follows, double share, VectorXd values) {
  if (follows)
    return std::make_shared<FollowingForce>(std::move(bridge), std::move(points), share,
                                            std::move(values));
  VectorXd force = VectorXd::Zero(3 * points->mesh_nodes);
  spread_over(*points, density_at(*bridge, *points, nullptr, values), share, force);
  return nodal_force(std::move(force));
}

}  // namespace hookeye
