#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "estimation/images/registration.h"

namespace hookeye {

namespace {

using Eigen::Vector2d;
constexpr double kInside = 0.5;  ///< coverage on the contour

/// A coverage picture, bilinear between the centres of its pixels.
class Coverage {
 public:
  Coverage(const Image& image, const std::vector<unsigned char>& valid)
      : image_(image), valid_(valid) {}
  /// Empty beyond the picture and where a pixel does not count.
  std::optional<double> at(const Vector2d& px) const {
    const int x = static_cast<int>(std::floor(px.x())), y = static_cast<int>(std::floor(px.y()));
    if (x < 0 || y < 0 || x + 1 >= image_.width || y + 1 >= image_.height) return {};
    double sum = 0.0;
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        const size_t pixel = static_cast<size_t>(y + j) * image_.width + x + i;
        if (!valid_.empty() && !valid_[pixel]) return {};
        sum += image_.values[pixel] * (i ? px.x() - x : 1.0 - px.x() + x) *
               (j ? px.y() - y : 1.0 - px.y() + y);
      }
    return sum;
  }
  /// Central difference over two pixels on either side: a binary picture has no finer direction.
  std::optional<Vector2d> slope(const Vector2d& px) const {
    Vector2d out;
    for (int axis = 0; axis < 2; ++axis) {
      const Vector2d step = 2.0 * Vector2d::Unit(axis);
      const auto ahead = at(px + step), behind = at(px - step);
      if (!ahead || !behind) return {};
      out[axis] = (*ahead - *behind) / 4.0;
    }
    return out;
  }

 private:
  const Image& image_;
  const std::vector<unsigned char>& valid_;
};

/// Way along the unit vector `outward` from `px` to where the coverage falls through the contour's;
/// negative: against it. Empty: no contour within `reach`, or one that faces elsewhere (by more
/// than 60 degrees: another edge of the body).
std::optional<double> way_to_contour(const Coverage& coverage, const Vector2d& px,
                                     const Vector2d& outward, double reach) {
  constexpr double kStep = 0.5;  // px
  const auto here = coverage.at(px);
  if (!here) return {};
  const double sign = *here > kInside ? 1.0 : -1.0;
  double before = *here;
  for (double way = kStep; way <= reach; way += kStep) {
    const auto next = coverage.at(px + sign * way * outward);
    if (!next) return {};
    if ((*next > kInside) != (*here > kInside)) {
      const double at = way - kStep + kStep * (kInside - before) / (*next - before);
      const auto slope = coverage.slope(px + sign * at * outward);
      if (!slope || -slope->dot(outward) < 0.5 * slope->norm()) return {};
      return sign * at;
    }
    before = *next;
  }
  return {};
}

struct RimPixel {
  int x, y;
  Vector2d outward;
  double slope;  ///< fall of the model's coverage along `outward` [1/px]
  double way;    ///< from the model's contour to the photo's
};

/// A rim is where the coverage changes by more than rounding does.
constexpr double kRimSlope = 0.02;  // 1/px

/// Pixels of the model's rim whose contour is found in the photo.
std::vector<RimPixel> rim_pixels(const Image& model, const Image& photo,
                                 const std::vector<unsigned char>& valid, const Image& residual) {
  // A body that moves by more than this is led there by the coarse pictures first.
  const double reach = 0.25 * std::min(model.width, model.height);
  const Coverage rendered(model, valid), seen(photo, valid);
  std::vector<RimPixel> all;
  for (int y = 0; y < model.height; ++y)
    for (int x = 0; x < model.width; ++x) {
      if (std::isnan(residual.at(x, y))) continue;
      const Vector2d px(x, y);
      const auto slope = rendered.slope(px);
      if (!slope || slope->norm() < kRimSlope) continue;
      const Vector2d outward = -slope->normalized();
      const auto own = way_to_contour(rendered, px, outward, 4.0);
      const auto other = own ? way_to_contour(seen, px, outward, reach) : std::nullopt;
      if (other) all.push_back({x, y, outward, picture_slope(model, x, y).norm(), *other - *own});
    }
  return all;
}

}  // namespace

std::vector<unsigned char> telling_pixels(const Image& model, const Image& photo) {
  // Motion is read off pixels with two neighbours on either side, three deep into either side.
  constexpr int kNear = 5;  // px
  constexpr float kDiffer = 0.02f;
  const cv::Mat window = cv::Mat::ones(2 * kNear + 1, 2 * kNear + 1, CV_8U);
  std::vector<unsigned char> telling(model.pixels(), 0);
  for (const Image* picture : {&model, &photo}) {
    const cv::Mat values(picture->height, picture->width, CV_32F,
                         const_cast<float*>(picture->values.data()));
    cv::Mat least, most;
    cv::erode(values, least, window);
    cv::dilate(values, most, window);
    for (int y = 0; y < values.rows; ++y)
      for (int x = 0; x < values.cols; ++x)
        if (most.at<float>(y, x) - least.at<float>(y, x) > kDiffer ||
            std::abs(model.at(x, y) - photo.at(x, y)) > kDiffer)
          telling[static_cast<size_t>(y) * values.cols + x] = 1;
  }
  return telling;
}

Registration register_silhouettes(const Image& model, const Image& photo,
                                  const std::vector<unsigned char>& valid, const Image& residual,
                                  const Image& sigma) {
  Registration out;
  out.residual = out.linear = residual;
  constexpr int kCell = 16;
  struct Cell {
    Vector2d motion = Vector2d::Zero();
    double way = 0.0, count = 0.0;
  };
  const int columns = (model.width + kCell - 1) / kCell;
  std::vector<Cell> cells(static_cast<size_t>(columns) * ((model.height + kCell - 1) / kCell));
  const auto rim = rim_pixels(model, photo, valid, residual);
  auto cell_of = [&](const RimPixel& pixel) -> Cell& {
    return cells[static_cast<size_t>(pixel.y / kCell) * columns + pixel.x / kCell];
  };
  for (const RimPixel& pixel : rim) {
    Cell& cell = cell_of(pixel);
    cell.motion += pixel.way * pixel.outward;
    cell.way += pixel.way;
    cell.count += 1.0;
  }
  double motion = 0.0;
  for (const RimPixel& pixel : rim) {
    // One pixel of a binary picture does not tell its contour's place, those of a cell do.
    const Cell& cell = cell_of(pixel);
    const double mean = std::max(cell.motion.norm(), std::abs(cell.way)) / cell.count;
    if (mean <= kStillPx) continue;
    motion += mean * mean;
    out.residual.at(pixel.x, pixel.y) = 0.0f;
    out.linear.at(pixel.x, pixel.y) =
        static_cast<float>(-pixel.slope * pixel.way / sigma.at(pixel.x, pixel.y));
  }
  if (!rim.empty()) out.rms_px = std::sqrt(motion / static_cast<double>(rim.size()));
  return out;
}

}  // namespace hookeye
