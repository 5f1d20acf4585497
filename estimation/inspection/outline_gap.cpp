#include "estimation/inspection/outline_gap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "estimation/inspection/apart.h"

namespace hookeye::inspection {

namespace {

using PhotoMask = std::vector<unsigned char>;

constexpr double kHalfPixel =
    0.5;  // px of the small photo: no outline of whole pixels is known better

double value_at_share(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<long>(share * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

cv::Mat mask_of(const PhotoMask& pixels, int width, int height) {
  return cv::Mat(height, width, CV_8U, const_cast<unsigned char*>(pixels.data())) != 0;
}

/// To the outline of a mask: positive without, half a pixel in the pixels beside it.
cv::Mat signed_distance(const cv::Mat& inside) {
  cv::Mat in, out, both;
  cv::distanceTransform(inside, in, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
  cv::distanceTransform(~inside, out, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
  cv::subtract(out, in, both);
  for (int i = 0; i < both.rows; ++i)
    for (int j = 0; j < both.cols; ++j)
      both.at<float>(i, j) += inside.at<uchar>(i, j) ? 0.5f : -0.5f;
  return both;
}

/// Pixels of a mask beside one that is none of it; none at the border of the picture, where the
/// body is cut off, and none near pixels that do not count.
cv::Mat rim_of_mask(const cv::Mat& inside, const cv::Mat& counts) {
  constexpr int kBorder = 4;  // px: what is smeared beside a border or a mask
  const cv::Mat cross = cv::getStructuringElement(cv::MORPH_CROSS, {3, 3});
  const cv::Mat wide = cv::Mat::ones(2 * kBorder + 1, 2 * kBorder + 1, CV_8U);
  cv::Mat core, usable;
  cv::erode(inside, core, cross);
  cv::erode(counts, usable, wide, {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  return inside & ~core & usable;
}

/// Distances at the pixels of a rim less their mean along a stretch of it.
std::vector<double> rough_of(const cv::Mat& rim, const cv::Mat& distance) {
  constexpr int kStretch = 13;  // px: a few speckles
  cv::Mat one, held, count, sum;
  rim.convertTo(one, CV_32F, 1.0 / 255.0);
  held = distance.mul(one);
  const cv::Size box(kStretch, kStretch);
  cv::boxFilter(one, count, -1, box, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::boxFilter(held, sum, -1, box, {-1, -1}, false, cv::BORDER_CONSTANT);
  std::vector<double> out;
  for (int y = 0; y < rim.rows; ++y)
    for (int x = 0; x < rim.cols; ++x)
      if (rim.at<uchar>(y, x))
        out.push_back(
            std::abs(distance.at<float>(y, x) - sum.at<float>(y, x) / count.at<float>(y, x)));
  return out;
}

std::string gap_words(const OutlineGap& gap) {
  if (std::isinf(gap.far_px)) return "the model is not in its picture at all";
  return fmt::format(
      "a quarter of the model's outline lies {:.0f} px and more off the photo's, {:.1f} % of the "
      "body's size there; that outline is ragged by {:.1f} px",
      gap.far_px, 100.0 * gap.far_px / gap.extent_px, gap.rough_px);
}

}  // namespace

double OutlineGap::most_px(const InspectionOptions& options) const {
  return std::max(options.outline_of_body * extent_px, options.outline_of_noise * rough_px);
}

std::optional<OutlineGap> outline_gap(Sight& sight, PhotoIndex photo) {
  constexpr double kRobust = 1.4826;  // of a median, for the deviation of normal numbers
  constexpr double kQuarter = 0.75;
  const SmallPhoto& seen = sight.small(photo);
  if (!seen.foreground.known()) return {};
  const int width = seen.I->width, height = seen.I->height;
  const PhotoMask outline = sight.outline(photo, sight.shown(photo.first));
  const cv::Mat model = mask_of(outline, width, height);
  OutlineGap out;
  if (cv::countNonZero(model) == 0) {
    out.far_px = INFINITY;
    return out;
  }
  const cv::Mat counts = seen.valid->empty() ? cv::Mat(height, width, CV_8U, cv::Scalar(255))
                                             : mask_of(seen.valid, width, height);
  const PhotoMask inside = seen.foreground.inside(), still = still_beside(sight, photo);
  cv::Mat body = mask_of(inside, width, height);
  if (!still.empty()) body &= ~mask_of(still, width, height);
  const cv::Mat rim = rim_of_mask(model, counts);
  const int covered = cv::countNonZero(body);
  if (cv::countNonZero(rim) == 0 || covered == 0 || covered == width * height) return {};
  // A pixel of the model's rim lies half a pixel within the model's own outline.
  cv::Mat distance = signed_distance(body);
  distance += 0.5f;
  std::vector<double> off;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (rim.at<uchar>(y, x)) off.push_back(std::abs(distance.at<float>(y, x)));
  const cv::Rect box = cv::boundingRect(model);
  out.far_px = seen.px() * value_at_share(std::move(off), kQuarter);
  out.rough_px =
      seen.px() * std::max(kRobust * value_at_share(rough_of(rim, distance), 0.5), kHalfPixel);
  out.extent_px = seen.px() * std::hypot(box.width, box.height);
  return out;
}

std::optional<CaptureWarning> outline_doubt(Sight& sight) {
  const InspectionOptions& options = sight.options();
  std::optional<CaptureWarning> out;
  for (const PhotoIndex& photo : sight.references()) {
    const std::string& camera = sight.spec(photo).camera;
    if (!is_rest(sight.example(photo.first)) || sight.doubted(camera)) continue;
    const auto gap = outline_gap(sight, photo);
    if (!gap || !(gap->far_px > gap->most_px(options))) continue;
    // A texture that was told knows the place better than an outline: what is off is beside the
    // body. One out of the photos themselves is painted wherever the body is said to lie.
    const BodySpec& body = sight.scene().capture.body;
    if (body.texture == BodySpec::Texture::image &&
        sight.agreement(photo).share >= options.found_share)
      continue;
    if (!out) {
      out.emplace();
      out->question = "placement";
      out->place = body.place;
      out->seen = "the photos contradict the place of the body";
      out->right =
          "place it by four --pair of pixels and points first, then by the outline "
          "(docs/place.md). Else look at what is drawn (-o DIR): the cameras' poses and lenses, "
          "the body's shape and unit, what hides it or stands beside it (`mask:`), and its weight, "
          "if it sags at rest";
    }
    out->seen += fmt::format("; camera `{}`, example `{}`: {}", camera,
                             sight.example(photo.first).name, gap_words(*gap));
    sight.doubt(camera);
  }
  return out;
}

}  // namespace hookeye::inspection
