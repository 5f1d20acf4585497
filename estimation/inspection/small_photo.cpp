#include "estimation/inspection/small_photo.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "estimation/model/photo_pyramid.h"

namespace hookeye::inspection {

namespace {

using Mask = std::vector<unsigned char>;

float quantile(std::vector<float> values, double share) {
  const auto at = values.begin() + static_cast<long>(share * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// A level behind the body that the photo's border shows all around; NaN: the border is not even.
struct Border {
  float level = NAN, spread = 0.0f;
};

Border even_border(const Image& I, double sigma) {
  constexpr int kWide = 2;           // px
  constexpr double kOfBorder = 0.9;  // the body may reach out of the picture on a short stretch
  constexpr double kOfRange = 0.04;  // of the picture's range: a lit wall varies by as much
  std::vector<float> border;
  for (int y = 0; y < I.height; ++y)
    for (int x = 0; x < I.width; ++x)
      if (std::min({x, y, I.width - 1 - x, I.height - 1 - y}) < kWide) border.push_back(I.at(x, y));
  const float range = quantile(I.values, 0.99) - quantile(I.values, 0.01);
  const float level = quantile(border, 0.5);
  const auto spread = static_cast<float>(std::max(kOfRange * range, 4.0 * sigma));
  const auto near = std::count_if(border.begin(), border.end(),
                                  [&](float v) { return std::abs(v - level) <= spread; });
  if (double(near) < kOfBorder * double(border.size())) return {};
  return {level, spread};
}

/// Closes gaps of a few pixels (dark speckle before black) and holes smaller than a hundredth of
/// the body; drops specks.
void tidy(Mask& inside, int width, int height) {
  constexpr int kGap = 5;          // px
  constexpr double kHole = 0.01;   // of the body's area
  constexpr double kSpeck = 0.02;  // of the largest piece
  cv::Mat mask(height, width, CV_8U, inside.data());
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN, cv::Mat::ones(2, 2, CV_8U));
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {kGap, kGap}));
  const double area = cv::countNonZero(mask);
  for (const bool hole : {true, false}) {
    cv::Mat labels, stats, centres;
    const cv::Mat of = hole ? cv::Mat(mask == 0) : mask;
    const int pieces = cv::connectedComponentsWithStats(of, labels, stats, centres, 4);
    int largest = 0;
    for (int i = 1; i < pieces; ++i)
      largest = std::max(largest, stats.at<int>(i, cv::CC_STAT_AREA));
    for (int i = 1; i < pieces; ++i)
      if (stats.at<int>(i, cv::CC_STAT_AREA) < (hole ? kHole * area : kSpeck * largest))
        mask.setTo(hole ? 1 : 0, labels == i);
  }
}

/// Pixels that differ from what is behind the body.
Mask differing(const Image& I, const Image* backdrop, float level, float by) {
  Mask inside(I.pixels());
  for (size_t i = 0; i < inside.size(); ++i)
    inside[i] = std::abs(I.values[i] - (backdrop ? backdrop->values[i] : level)) > by;
  tidy(inside, I.width, I.height);
  return inside;
}

Foreground foreground_of(const PhotoSpec& spec, const PhotoPlane& plane, double sigma) {
  constexpr double kOfWhite = 0.02;  // what is behind is dark to 2 % of the picture's white
  Foreground out;
  Mask inside;
  out.told = true;
  const auto by =
      static_cast<float>(std::max(5.0 * sigma, kOfWhite * quantile(plane.I->values, 0.99)));
  if (spec.kind == PhotoSpec::Kind::silhouette) {
    inside.resize(plane.I->pixels());
    for (size_t i = 0; i < inside.size(); ++i) inside[i] = plane.I->values[i] > 0.5f;
  } else if (spec.background.kind == BackgroundSpec::Kind::level) {
    inside = differing(plane.I, nullptr, static_cast<float>(spec.background.level), by);
  } else if (spec.background.kind == BackgroundSpec::Kind::photo && plane.backdrop) {
    inside = differing(plane.I, plane.backdrop.get(), 0.0f, by);
  } else {
    out.told = false;
    const Border border = even_border(plane.I, sigma);
    if (std::isnan(border.level)) {
      out.unknown =
          "nothing is told of what is behind the body, and the photo's border is not even";
      return out;
    }
    inside = differing(plane.I, nullptr, border.level, std::max(by, 1.5f * border.spread));
  }
  const auto count = static_cast<double>(std::count(inside.begin(), inside.end(), 1));
  constexpr double kLeast = 0.003, kMost = 0.97;  // of the picture
  if (count >= kLeast * double(inside.size()) && count <= kMost * double(inside.size())) {
    out.pixels.assign(inside.begin(), inside.end());
    return out;
  }
  out.unknown = count < 10.0 ? "nothing stands out from what is behind the body"
                             : "the body fills the photo, or nearly nothing of it";
  return out;
}

}  // namespace

int looked_at_plane(const Photo& photo) { return photo.planes.size() == 3 ? 1 : 0; }

SmallPhoto small_photo(const Scene& scene, int e, int k, const InspectionOptions& options) {
  const Photo& photo = scene.photos[static_cast<size_t>(e)][static_cast<size_t>(k)];
  const PhotoSpec& spec =
      scene.capture.examples[static_cast<size_t>(e)].photos[static_cast<size_t>(k)];
  SmallPhoto out;
  const int plane = looked_at_plane(photo);
  const Image& full = photo.planes[static_cast<size_t>(plane)];
  while (std::max(full.width, full.height) >> out.level > options.look_px) ++out.level;
  out.halvings = out.level + scene.halvings_of(photo.camera);
  PhotoPlane small = photo_pyramid(photo, plane, out.level + 1).back();
  const double mean = quantile(small.I->values, 0.5);
  out.foreground = foreground_of(spec, small, photo.noise.sigma(mean) / out.px());
  out.I = small.I;
  out.valid = small.valid;
  return out;
}

double overlap(const Mask& one, const Mask& other, const Mask& valid) {
  double both = 0.0, either = 0.0;
  for (size_t i = 0; i < one.size(); ++i) {
    if (!valid.empty() && !valid[i]) continue;
    both += one[i] && other[i], either += one[i] || other[i];
  }
  return either > 0.0 ? both / either : NAN;
}

}  // namespace hookeye::inspection
