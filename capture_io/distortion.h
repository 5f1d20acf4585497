// OpenCV's lens distortion (calib3d module page, "Detailed Description"): rational radial terms,
// tangential terms, thin prism, tilted sensor. Normalised coordinates throughout.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace hookeye {

/// Distorted coordinates of ideal ones and, where asked, their derivative. `coefficients` holds
/// k1 k2 p1 p2 (k3 (k4 k5 k6 (s1 s2 s3 s4 (tx ty)))).
Eigen::Vector2d distort(const std::vector<double>& coefficients, const Eigen::Vector2d& ideal,
                        Eigen::Matrix2d* d_dideal = nullptr);

/// Derivative of distort() by the coefficients: 2 x coefficients.size().
Eigen::Matrix2Xd distortion_derivative(const std::vector<double>& coefficients,
                                       const Eigen::Vector2d& ideal);

/// The inverse: fixed-point steps, then Newton to rounding. NaN where the model has no inverse
/// there (a strong polynomial folds back far outside the picture).
Eigen::Vector2d undistort(const std::vector<double>& coefficients,
                          const Eigen::Vector2d& distorted);

}  // namespace hookeye
