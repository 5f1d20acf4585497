// Corners of squares to a fraction of a pixel.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hookeye {

inline constexpr int kFarthest = 8;  ///< reach of a disc [px]: farther, the lens bends edges

/// From the grey values in a disc (row by row of its square) to the coefficients of
/// x^2, xy, y^2, x, y, 1, by least squares; places near its rim count little.
inline Eigen::Matrix<double, 6, Eigen::Dynamic> fit_of_disc(int reach) {
  const int side = 2 * reach + 1;
  Eigen::Matrix<double, Eigen::Dynamic, 6> terms(side * side, 6);
  Eigen::VectorXd weights(side * side);
  for (int i = 0; i < side * side; ++i) {
    const double x = i % side - reach, y = i / side - reach;
    terms.row(i) << x * x, x * y, y * y, x, y, 1.0;
    weights[i] = std::max(0.0, 1.0 - (x * x + y * y) / ((reach + 1.0) * (reach + 1.0)));
  }
  const Eigen::Matrix<double, 6, Eigen::Dynamic> weighted =
      terms.transpose() * weights.asDiagonal();
  return (weighted * terms).eval().ldlt().solve(weighted);
}

/// Moves a corner to the saddle of the grey around it. (cv::cornerSubPix() wants windows much wider
/// than the blur: within the blurred saddle its steps lead away from it.) `reach` of the disc [px].
/// False where the corner ran away, is none, or is too near to the rim.
inline bool refine(const cv::Mat& grey, int reach, cv::Point2f& corner) {
  const float rim = static_cast<float>(reach) + 2.0F;
  const cv::Rect2f inside(rim, rim, static_cast<float>(grey.cols) - 2 * rim,
                          static_cast<float>(grey.rows) - 2 * rim);
  const Eigen::Matrix<double, 6, Eigen::Dynamic> fit = fit_of_disc(reach);
  const cv::Point2f rough = corner;
  constexpr int kMostSteps = 30;
  for (int step = 0; step < kMostSteps; ++step) {
    if (!inside.contains(corner) || cv::norm(corner - rough) > reach) return false;
    cv::Mat around;
    cv::getRectSubPix(grey, {2 * reach + 1, 2 * reach + 1}, corner, around, CV_32F);
    const Eigen::Map<const Eigen::VectorXf> values(around.ptr<float>(),
                                                   static_cast<Eigen::Index>(around.total()));
    const Eigen::Matrix<double, 6, 1> c = fit * values.cast<double>();
    Eigen::Matrix2d bend;
    bend << 2 * c[0], c[1], c[1], 2 * c[2];
    if (bend.determinant() >= 0.0) return false;
    const Eigen::Vector2d move = -bend.inverse() * c.segment<2>(3);
    const double length = move.norm();
    const Eigen::Vector2d part = move * std::min(1.0, 1.0 / std::max(length, 1e-12));
    corner += cv::Point2f(static_cast<float>(part.x()), static_cast<float>(part.y()));
    if (length < 1e-3) return true;
  }
  return false;
}

}  // namespace hookeye
