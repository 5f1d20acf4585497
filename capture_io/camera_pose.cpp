#include "capture_io/camera_pose.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace hookeye {

std::string make_rotation(Eigen::Matrix3d& R) {
  const double miss = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(miss <= 1e-4)) return "is not orthonormal";
  if (R.determinant() < 0) return "is a reflection";
  if (miss > 1e-12) {
    // The nearest rotation in the Frobenius norm (orthogonal Procrustes).
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
    R = svd.matrixU() * svd.matrixV().transpose();
  }
  return "";
}

}  // namespace hookeye
