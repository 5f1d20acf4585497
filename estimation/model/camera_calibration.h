// Cameras that are known as well as their calibration tells, no better.
#pragma once

#include <memory>

#include "estimation/model/model.h"

namespace hookeye {

/// The camera's own seven numbers (turn, shift, log of the zoom: Camera::Jacobian7) that move its
/// picture of the points X as its intrinsics() do, by least squares: 7 x intrinsics. What the
/// points hardly show apart (a hundredth of what they show best) stays out: from a flat body seen
/// straight, zoom and distance would come out large and of opposite sign.
Eigen::MatrixXd as_motion(const Camera& camera, const Matrix3Xd& X);

/// Lower triangle L of the covariance L L^T of all calibrated cameras' seven numbers, in the order
/// of CameraCovariance::cameras(). A column is zero where the numbers before it tell all: the
/// camera that is the world does not move.
Eigen::MatrixXd calibration_root(const Scene& scene);

/// Seven numbers a camera with a covariance, u, of independent deviations of 1: its motion and zoom
/// are L u. The capture's first fitted example measures them as 0. Null: there is no such camera.
std::shared_ptr<const Ingredient> calibration_ingredient(const Scene& scene);

/// A camera that is not where its calibration has it (camera_pose, focal_length from the start):
/// the photos are met by the numbers above as before, and the calibration sees less of them. That
/// is the same as to move the camera, but no small difference of what photos tell.
struct OffCalibration {
  Eigen::MatrixXd deviations;  ///< Model::calibration by the camera's seven numbers
  /// What of these the calibration takes for exact: by that much the camera moves.
  Eigen::Matrix<double, 7, 7> beyond = Eigen::Matrix<double, 7, 7>::Identity();
  /// Whether the camera moves by any of `count` numbers from `first`.
  bool moves(int first, int count) const { return !beyond.middleCols(first, count).isZero(0.0); }
  /// Takes `numbers` off what the calibration sees; those by which the camera still has to move.
  VectorXd seen(const VectorXd& numbers, Model& model) const;
};
/// Nothing where the camera has no calibration: it moves by all.
OffCalibration off_calibration(const Scene& scene, const std::string& camera);

}  // namespace hookeye
