#include "placing/outline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "estimation/evaluation/evaluation.h"
#include "estimation/inspection/small_photo.h"

namespace hookeye {
namespace {

using Eigen::Vector2d;
using Mask = std::vector<unsigned char>;

/// From each pixel that is not zero in `mask` to the nearest that is.
cv::Mat distance_to_zero(const cv::Mat& mask) {
  cv::Mat out;
  cv::distanceTransform(mask, out, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
  return out;
}

/// Wide enough for what the photo's halving and the outline's tidying smear over a masked edge.
constexpr int kBesideMasked = 3;  // px

/// `counts` less the pixels near one that does not.
Mask well_inside(const Mask& counts, int width, int height) {
  if (counts.empty()) return {};
  Mask out = counts;
  cv::Mat mask(height, width, CV_8U, out.data());
  cv::erode(mask, mask, cv::Mat::ones(2 * kBesideMasked + 1, 2 * kBesideMasked + 1, CV_8U),
            {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(1));
  return out;
}

/// What stands out from the background reaches out to where a pixel is covered by a little. Here
/// pixels near the outline are inside from half of the step between what lies within and without.
void set_at_half(const Image& I, Mask* inside) {
  constexpr double kBand = 1.6;  // px about the outline whose pixels are asked
  constexpr int kReach = 4;      // px in which within and without are looked at
  const SignedDistance distance(*inside, I.width, I.height);
  Mask out = *inside;
  for (int y = kReach; y + kReach < I.height; ++y)
    for (int x = kReach; x + kReach < I.width; ++x) {
      if (std::abs(distance.at(Vector2d(x, y))) > kBand) continue;
      double sums[2] = {0, 0}, counts[2] = {0, 0};
      for (int v = y - kReach; v <= y + kReach; ++v)
        for (int u = x - kReach; u <= x + kReach; ++u) {
          const double s = distance.at(Vector2d(u, v));
          if (std::abs(s) < kBand) continue;
          sums[s > 0] += I.at(u, v), counts[s > 0] += 1;
        }
      if (counts[0] == 0 || counts[1] == 0) continue;
      const double within = sums[0] / counts[0], without = sums[1] / counts[1];
      out[static_cast<size_t>(y) * static_cast<size_t>(I.width) + static_cast<size_t>(x)] =
          std::abs(I.at(x, y) - without) > 0.5 * std::abs(within - without);
    }
  if (std::find(out.begin(), out.end(), 1) != out.end()) *inside = std::move(out);
}

void measure(Outline* outline) {
  double count = 0.0;
  Vector2d sum = Vector2d::Zero();
  double squares = 0.0;
  const int width = outline->view.width;
  for (size_t i = 0; i < outline->inside.size(); ++i) {
    if (!outline->inside[i]) continue;
    const Vector2d at(static_cast<double>(static_cast<int>(i) % width),
                      static_cast<double>(static_cast<int>(i) / width));
    count += 1.0, sum += at, squares += at.squaredNorm();
  }
  outline->centre = sum / count;
  outline->spread = std::sqrt(squares / count - outline->centre.squaredNorm());
}

}  // namespace

SignedDistance::SignedDistance(const Mask& inside, int width, int height)
    : width_(width), height_(height), values_(inside.size()) {
  cv::Mat mask(height, width, CV_8U);
  std::copy(inside.begin(), inside.end(), mask.begin<uchar>());
  const cv::Mat in = distance_to_zero(mask), out = distance_to_zero(mask == 0);
  for (size_t i = 0; i < values_.size(); ++i)
    values_[i] = inside[i] ? 0.5f - in.ptr<float>()[i] : out.ptr<float>()[i] - 0.5f;
}

double SignedDistance::value(int x, int y) const {
  x = std::clamp(x, 0, width_ - 1), y = std::clamp(y, 0, height_ - 1);
  return values_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)];
}

double SignedDistance::at(const Vector2d& pixel) const {
  const Vector2d in(std::clamp(pixel.x(), 0.0, width_ - 1.0),
                    std::clamp(pixel.y(), 0.0, height_ - 1.0));
  const int x = static_cast<int>(in.x()), y = static_cast<int>(in.y());
  const double u = in.x() - x, v = in.y() - y;
  return (1 - v) * ((1 - u) * value(x, y) + u * value(x + 1, y)) +
         v * ((1 - u) * value(x, y + 1) + u * value(x + 1, y + 1)) + (pixel - in).norm();
}

Vector2d SignedDistance::slope(const Vector2d& pixel) const {
  return 0.5 * Vector2d(at(pixel + Vector2d::UnitX()) - at(pixel - Vector2d::UnitX()),
                        at(pixel + Vector2d::UnitY()) - at(pixel - Vector2d::UnitY()));
}

std::vector<int> rim_of(const Mask& inside, int width, int height, const Mask& counts) {
  std::vector<int> out;
  for (int y = 1; y + 1 < height; ++y)
    for (int x = 1; x + 1 < width; ++x) {
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      const auto w = static_cast<size_t>(width);
      if (!inside[i] || (!counts.empty() && !counts[i])) continue;
      if (inside[i - 1] && inside[i + 1] && inside[i - w] && inside[i + w]) continue;
      out.push_back(static_cast<int>(i));
    }
  return out;
}

std::vector<int> nearest_of(const std::vector<int>& pixels, int width, int height) {
  cv::Mat mask(height, width, CV_8U, cv::Scalar(1)), distance, labels;
  for (const int i : pixels) mask.at<uchar>(i / width, i % width) = 0;
  cv::distanceTransform(mask, distance, labels, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<int> index_of_label(pixels.size() + 2, -1);
  for (size_t k = 0; k < pixels.size(); ++k)
    index_of_label[static_cast<size_t>(labels.ptr<int>()[pixels[k]])] = static_cast<int>(k);
  std::vector<int> out(static_cast<size_t>(width) * static_cast<size_t>(height));
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = index_of_label[static_cast<size_t>(labels.ptr<int>()[i])];
  return out;
}

std::vector<Outline> outlines_of(const Scene& scene, int look_px,
                                 std::vector<std::string>* why_not) {
  InspectionOptions options;
  options.look_px = look_px;
  std::vector<Outline> out;
  for (size_t e = 0; e < scene.photos.size(); ++e) {
    const ExampleSpec& example = scene.capture.examples[e];
    if (!is_rest(example)) continue;
    for (size_t k = 0; k < scene.photos[e].size(); ++k) {
      const std::string& camera = example.photos[k].camera;
      if (std::any_of(out.begin(), out.end(), [&](const Outline& o) { return o.camera == camera; }))
        continue;
      const inspection::SmallPhoto small =
          inspection::small_photo(scene, static_cast<int>(e), static_cast<int>(k), options);
      if (!small.foreground.known()) {
        if (why_not)
          why_not->push_back(fmt::format("{}: camera `{}`, example `{}`: {}",
                                         example.photos[k].place.str(), camera, example.name,
                                         small.foreground.unknown));
        continue;
      }
      Outline one;
      one.camera = camera, one.example = example.name;
      one.view = camera_at_level(scene.capture.camera(camera), small.level);
      one.px = small.px();
      one.inside = small.foreground.inside();
      one.image = example.photos[k].kind == PhotoSpec::Kind::image;
      if (one.image) set_at_half(small.I, &one.inside);
      one.counts = well_inside(small.valid, one.view.width, one.view.height);
      one.distance = SignedDistance(one.inside, one.view.width, one.view.height);
      one.rim = rim_of(one.inside, one.view.width, one.view.height, one.counts);
      measure(&one);
      out.push_back(std::move(one));
    }
  }
  return out;
}

}  // namespace hookeye
