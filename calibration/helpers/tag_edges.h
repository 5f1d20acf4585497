// Corners of a black square on white to a fraction of a pixel: where its sides meet.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

namespace hookeye {

/// Grey between pixels; their centres are at integers.
inline double grey_at(const cv::Mat& grey, const Eigen::Vector2d& at) {
  const double x = std::clamp(at.x(), 0.0, grey.cols - 1.001);
  const double y = std::clamp(at.y(), 0.0, grey.rows - 1.001);
  const int u = static_cast<int>(x), v = static_cast<int>(y);
  const auto value = [&](int i, int j) { return double(grey.at<unsigned char>(v + j, u + i)); };
  const double s = x - u, t = y - v;
  return (1 - t) * ((1 - s) * value(0, 0) + s * value(1, 0)) +
         t * ((1 - s) * value(0, 1) + s * value(1, 1));
}

/// Where grey passes the middle between both ends of a line from `inside`, dark, to 2 `reach`
/// farther along `out`; none: it rises too little.
inline std::optional<double> edge_along(const cv::Mat& grey, const Eigen::Vector2d& inside,
                                        const Eigen::Vector2d& out, double reach) {
  constexpr int kSteps = 32;
  constexpr double kLeastStep = 20.0;  // of 255: noise alone is no edge
  double values[kSteps + 1];
  for (int i = 0; i <= kSteps; ++i)
    values[i] = grey_at(grey, inside + (2.0 * reach * i / kSteps) * out);
  const double middle = 0.5 * (values[0] + values[kSteps]);
  if (values[kSteps] - values[0] < kLeastStep) return std::nullopt;
  for (int i = 0; i < kSteps; ++i)
    if (values[i] <= middle && values[i + 1] > middle)
      return 2.0 * reach * (i + (middle - values[i]) / (values[i + 1] - values[i])) / kSteps;
  return std::nullopt;
}

/// A line as a point and a direction, by total least squares; half of the points, those nearest to
/// it, decide.
struct EdgeLine {
  Eigen::Vector2d point, direction;
};
inline EdgeLine line_through(std::vector<Eigen::Vector2d> points) {
  EdgeLine line;
  for (int round = 0; round < 3; ++round) {
    line.point.setZero();
    for (const auto& p : points) line.point += p / static_cast<double>(points.size());
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (const auto& p : points) spread += (p - line.point) * (p - line.point).transpose();
    line.direction = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvectors().col(1);
    const Eigen::Vector2d normal(-line.direction.y(), line.direction.x());
    if (round == 0)
      std::sort(points.begin(), points.end(),
                [&](const auto& a, const auto& b) {
                  return std::abs(normal.dot(a - line.point)) <
                         std::abs(normal.dot(b - line.point));
                }),
          points.resize((points.size() + 1) / 2);
  }
  return line;
}

/// Moves the four corners, clockwise as seen, to where the sides meet. (cv::cornerSubPix() draws
/// corners of a lone square inwards.) `cells` across a side, of which the outermost are black.
/// False where a side has no clear edge; the corners stay then.
inline bool refine_square(const cv::Mat& grey, int cells, std::vector<cv::Point2f>& corners) {
  Eigen::Vector2d p[4];
  for (size_t k = 0; k < 4; ++k) p[k] = Eigen::Vector2d(corners[k].x, corners[k].y);
  EdgeLine sides[4];
  for (size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d along = p[(k + 1) % 4] - p[k];
    const double length = along.norm();
    const Eigen::Vector2d out = Eigen::Vector2d(along.y(), -along.x()) / length;
    const double reach = std::clamp(0.6 * length / cells, 1.5, 6.0);
    const int count = std::max(10, static_cast<int>(length));
    std::vector<Eigen::Vector2d> edge;
    for (int i = 0; i < count; ++i) {
      const double s = 0.15 + 0.7 * i / (count - 1.0);
      const Eigen::Vector2d inside = p[k] + s * along - reach * out;
      if (const auto at = edge_along(grey, inside, out, reach)) edge.push_back(inside + *at * out);
    }
    if (2 * edge.size() < static_cast<size_t>(count)) return false;
    sides[k] = line_through(std::move(edge));
  }
  for (size_t k = 0; k < 4; ++k) {
    const EdgeLine &a = sides[(k + 3) % 4], &b = sides[k];
    Eigen::Matrix2d both;
    both << a.direction, -b.direction;
    if (std::abs(both.determinant()) < 0.1) return false;
    const Eigen::Vector2d steps = both.inverse() * (b.point - a.point);
    p[k] = a.point + steps[0] * a.direction;
  }
  for (size_t k = 0; k < 4; ++k)
    corners[k] = cv::Point2f(static_cast<float>(p[k].x()), static_cast<float>(p[k].y()));
  return true;
}

}  // namespace hookeye
