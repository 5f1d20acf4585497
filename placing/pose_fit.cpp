// The only file of this layer that touches Ceres.
#include "placing/pose_fit.h"

#include <ceres/ceres.h>

#include <cmath>
#include <vector>

namespace hookeye {
namespace {

using Eigen::Matrix3d;

Matrix3d cross(const Vector3d& w) {
  Matrix3d out;
  out << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return out;
}

Matrix3d turn(const Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-12) return Matrix3d::Identity() + cross(w);
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

/// exp(w + dw) = exp(left_jacobian(w) dw) exp(w) to first order.
Matrix3d left_jacobian(const Vector3d& w) {
  const double angle = w.norm();
  const Matrix3d W = cross(w);
  if (angle < 1e-6) return Matrix3d::Identity() + 0.5 * W;
  return Matrix3d::Identity() + (1.0 - std::cos(angle)) / (angle * angle) * W +
         (angle - std::sin(angle)) / (angle * angle * angle) * W * W;
}

/// `start`, then turned by w about the moved middle of the body and shifted by v.
Isometry3d moved(const Isometry3d& start, const Vector3d& middle, const double* wv) {
  const Eigen::Map<const Vector3d> w(wv), v(wv + 3);
  const Vector3d about = start * middle;
  Isometry3d out = start;
  out.linear() = turn(w) * start.linear();
  out.translation() = about + v + turn(w) * (start.translation() - about);
  return out;
}

class TermCost final : public ceres::CostFunction {
 public:
  TermCost(const PoseTerms& terms, int i, const Isometry3d& start)
      : terms_(terms), i_(i), start_(start) {
    set_num_residuals(terms.size);
    *mutable_parameter_block_sizes() = {6};
  }
  bool Evaluate(double const* const* block, double* r, double** jacobians) const override {
    double* const J = jacobians ? jacobians[0] : nullptr;
    const Isometry3d pose = moved(start_, terms_.middle, block[0]);
    if (!terms_.term(i_, pose, r, J)) return false;
    if (!J) return true;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>> by(J, terms_.size, 6);
    by.leftCols<3>() =
        (by.leftCols<3>() * left_jacobian(Eigen::Map<const Vector3d>(block[0]))).eval();
    return true;
  }

 private:
  const PoseTerms& terms_;
  int i_;
  const Isometry3d& start_;
};

}  // namespace

PointJacobian point_jacobian(const Isometry3d& pose, const Vector3d& middle, const Vector3d& X) {
  PointJacobian J;
  J << -cross(pose.linear() * (X - middle)), Matrix3d::Identity();
  return J;
}

PoseFit fit_pose(const Isometry3d& start, const PoseTerms& terms, double loss, int iterations) {
  Vector6d wv = Vector6d::Zero();
  ceres::Problem problem;
  // One loss for all; the problem deletes it once.
  ceres::LossFunction* const cauchy = loss > 0.0 ? new ceres::CauchyLoss(loss) : nullptr;
  if (terms.count == 0) delete cauchy;
  for (int i = 0; i < terms.count; ++i)
    problem.AddResidualBlock(new TermCost(terms, i, start), cauchy, wv.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = iterations;
  options.function_tolerance = 1e-12;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  if (terms.count > 0) ceres::Solve(options, &problem, &summary);
  PoseFit out;
  out.pose = moved(start, terms.middle, wv.data());
  out.good = terms.count > 0 && summary.IsSolutionUsable() && wv.allFinite();
  out.cost = summary.final_cost;
  return out;
}

Matrix6d information_of(const Isometry3d& pose, const PoseTerms& terms, double loss) {
  Matrix6d out = Matrix6d::Zero();
  std::vector<double> r(static_cast<size_t>(terms.size)), J(6 * r.size());
  for (int i = 0; i < terms.count; ++i) {
    if (!terms.term(i, pose, r.data(), J.data())) continue;
    const Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>> by(J.data(),
                                                                                   terms.size, 6);
    const double squares = Eigen::Map<const Eigen::VectorXd>(r.data(), terms.size).squaredNorm();
    const double weight = loss > 0.0 ? 1.0 / (1.0 + squares / (loss * loss)) : 1.0;
    out += weight * by.transpose() * by;
  }
  return out;
}

}  // namespace hookeye
