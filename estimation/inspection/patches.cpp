#include "estimation/inspection/patches.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace hookeye::inspection {

namespace {

using Eigen::Vector2d;

cv::Mat wrap(const Image& image) {
  return {image.height, image.width, CV_32F, const_cast<float*>(image.values.data())};
}

/// Centres of a grid, all with a patch that is covered nearly whole.
std::vector<cv::Point> centres(const cv::Mat& body, const InspectionOptions& options) {
  constexpr double kCovered = 0.9;
  const int half = options.patch_px / 2;
  cv::Mat sums;
  cv::integral(body, sums, CV_32S);
  const double area = cv::countNonZero(body);
  const double step = std::max(8.0, std::sqrt(area / options.most_patches));
  std::vector<cv::Point> out;
  for (double y = half + step / 4; y < body.rows - half; y += step)
    for (double x = half + step / 4; x < body.cols - half; x += step) {
      const int x0 = int(x) - half, y0 = int(y) - half, side = 2 * half + 1;
      const int covered = sums.at<int>(y0 + side, x0 + side) - sums.at<int>(y0, x0 + side) -
                          sums.at<int>(y0 + side, x0) + sums.at<int>(y0, x0);
      if (covered >= kCovered * side * side) out.emplace_back(int(x), int(y));
    }
  return out;
}

/// A picture as it is, its light (the mean of a window around each pixel), and levelled: (I - m) /
/// s with that mean m and the window's deviation s. The step between a bright and a dark face is as
/// high everywhere along their edge, and outweighs the texture of both; levelled it does not.
struct Picture {
  cv::Mat I, light, levelled;
};

/// Means over `body` alone, where it is not empty. What is below the least contrast of a texture
/// (shading), or below a code of eight bits, is not levelled up to be one.
Picture picture_of(const cv::Mat& I, const cv::Mat& body, const InspectionOptions& options) {
  const cv::Size window(options.light_px, options.light_px);
  const auto average = [&](const cv::Mat& of) {
    cv::Mat out;
    cv::boxFilter(of, out, CV_64F, window, {-1, -1}, true, cv::BORDER_REFLECT);
    return out;
  };
  cv::Mat weight = cv::Mat::ones(I.size(), CV_64F), values = I.clone();
  if (!body.empty()) cv::Mat(body != 0).convertTo(weight, CV_64F, 1.0 / 255.0);
  cv::patchNaNs(values, 0.0);
  values.convertTo(values, CV_64F);
  values = values.mul(weight);
  const cv::Mat count = cv::max(average(weight), 1e-9);
  const cv::Mat mean = average(values) / count, squares = average(values.mul(values)) / count;
  double white = 0.0;
  cv::minMaxLoc(mean, nullptr, &white);
  const double code = std::max(white, 1e-6) / 255.0;
  cv::Mat spread = cv::max(squares - mean.mul(mean), 0.0) +
                   options.least_contrast * options.least_contrast * mean.mul(mean) + code * code;
  cv::sqrt(spread, spread);
  Picture out{I, {}, {}};
  mean.convertTo(out.light, CV_32F);
  cv::Mat((values - mean).mul(weight) / spread).convertTo(out.levelled, CV_32F);
  return out;
}

double variance(const cv::Mat& of) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(of, mean, deviation);
  return deviation[0] * deviation[0];
}

/// Most of what is seen in the patch is light and no texture.
bool needs_levelling(const Picture& picture, const cv::Rect& where,
                     const InspectionOptions& options) {
  return variance(picture.light(where)) > options.most_light * variance(picture.I(where));
}

/// How alike the patch is to another place of its own picture. Along an edge it is (the aperture
/// problem: it tells motion across it alone), and in a pattern that repeats.
double likeness_elsewhere(const cv::Mat& picture, const cv::Rect& where,
                          const InspectionOptions& options) {
  const int half = options.patch_px / 2;
  const cv::Rect window = cv::Rect(where.x - 2 * half, where.y - 2 * half, where.width + 4 * half,
                                   where.height + 4 * half) &
                          cv::Rect(0, 0, picture.cols, picture.rows);
  cv::Mat likeness;
  cv::matchTemplate(picture(window), picture(where), likeness, cv::TM_CCOEFF_NORMED);
  cv::patchNaNs(likeness, -1.0);
  // Within half a patch it is the same place.
  cv::circle(likeness, {where.x - window.x, where.y - window.y}, half, cv::Scalar(-1.0), -1);
  double best = 0.0;
  cv::minMaxLoc(likeness, nullptr, &best);
  return best;
}

/// Top of the parabola through three neighbours, within half a step.
double top(double left, double middle, double right) {
  const double bend = left - 2.0 * middle + right;
  return bend < 0.0 ? std::clamp(0.5 * (left - right) / bend, -0.5, 0.5) : 0.0;
}

/// A patch of a picture that has one place there.
struct Sought {
  cv::Point at;
  cv::Rect where;
  bool level = false;      ///< sought in levelled pictures
  double elsewhere = 0.0;  ///< Patch::elsewhere
};

/// False: nothing to see in the patch that has one place.
bool has_one_place(const Picture& from, const InspectionOptions& options, Sought* patch) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(from.I(patch->where), mean, deviation);
  if (deviation[0] < options.least_contrast * std::abs(mean[0]) || deviation[0] < 1e-4)
    return false;
  patch->level = needs_levelling(from, patch->where, options);
  patch->elsewhere =
      likeness_elsewhere(patch->level ? from.levelled : from.I, patch->where, options);
  return patch->elsewhere <= options.alike_elsewhere;
}

/// False: no room to seek it.
bool seek(const Picture& from, const Picture& to, const Sought& sought, int reach, Patch* patch) {
  const cv::Mat &source = sought.level ? from.levelled : from.I,
                &in = sought.level ? to.levelled : to.I;
  const cv::Rect& its = sought.where;
  const int half = its.width / 2;
  const cv::Mat piece = source(its);
  const cv::Rect window =
      cv::Rect(its.x - reach, its.y - reach, its.width + 2 * reach, its.height + 2 * reach) &
      cv::Rect(0, 0, in.cols, in.rows);
  if (window.width < piece.cols || window.height < piece.rows) return false;
  cv::Mat likeness;
  cv::matchTemplate(in(window), piece, likeness, cv::TM_CCOEFF_NORMED);
  cv::patchNaNs(likeness, -1.0);
  double best = 0.0;
  cv::Point where;
  cv::minMaxLoc(likeness, nullptr, &best, nullptr, &where);
  patch->at = {double(sought.at.x), double(sought.at.y)};
  patch->elsewhere = sought.elsewhere;
  patch->likeness = std::min(best, 1.0);
  Vector2d place(where.x, where.y);
  if (where.x > 0 && where.x + 1 < likeness.cols)
    place.x() += top(likeness.at<float>(where.y, where.x - 1), best,
                     likeness.at<float>(where.y, where.x + 1));
  if (where.y > 0 && where.y + 1 < likeness.rows)
    place.y() += top(likeness.at<float>(where.y - 1, where.x), best,
                     likeness.at<float>(where.y + 1, where.x));
  patch->shift = place + Vector2d(window.x + half, window.y + half) - patch->at;
  return true;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool alike(const Patch& patch, const InspectionOptions& options) {
  return patch.likeness >= std::max(options.alike, patch.elsewhere);
}

/// Whether patch `i` moves as its alike neighbours do.
bool moves_along(const std::vector<Patch>& patches, size_t i, const InspectionOptions& options) {
  constexpr size_t kNeighbours = 6, kLeast = 3;
  constexpr double kRoom = 2.0, kStrain = 0.25;  // px, and px a px of distance
  std::vector<std::pair<double, size_t>> near;
  for (size_t j = 0; j < patches.size(); ++j)
    if (j != i && alike(patches[j], options))
      near.emplace_back((patches[j].at - patches[i].at).norm(), j);
  if (near.size() < kLeast) return false;
  const size_t count = std::min(near.size(), kNeighbours);
  std::partial_sort(near.begin(), near.begin() + long(count), near.end());
  std::vector<double> x, y;
  double distance = 0.0;
  for (size_t k = 0; k < count; ++k) {
    x.push_back(patches[near[k].second].shift.x()), y.push_back(patches[near[k].second].shift.y());
    distance += near[k].first / double(count);
  }
  const Vector2d off = patches[i].shift - Vector2d(median(x), median(y));
  return off.norm() <= kRoom + kStrain * distance;
}

}  // namespace

int PatchField::found() const {
  return static_cast<int>(
      std::count_if(patches.begin(), patches.end(), [](const Patch& p) { return p.found; }));
}

double PatchField::share() const {
  return patches.empty() ? 0.0 : double(found()) / double(patches.size());
}

double PatchField::shift_px() const {
  double sum = 0.0;
  for (const Patch& patch : patches)
    if (patch.found) sum += patch.shift.squaredNorm();
  return found() > 0 ? std::sqrt(sum / found()) : 0.0;
}

struct SoughtPatches::Impl {
  InspectionOptions options;
  int reach = 0;
  Picture picture;
  std::vector<Sought> patches;
};

SoughtPatches::SoughtPatches(const Image& from, const std::vector<unsigned char>& body,
                             double reach, const InspectionOptions& options)
    : impl_(std::make_unique<Impl>()) {
  const cv::Mat mask(from.height, from.width, CV_8U, const_cast<unsigned char*>(body.data()));
  impl_->options = options;
  impl_->reach = static_cast<int>(std::ceil(reach));
  impl_->picture = picture_of(wrap(from), mask, options);
  const int half = options.patch_px / 2, side = 2 * half + 1;
  const std::vector<cv::Point> places = centres(mask, options);
  std::vector<std::optional<Sought>> kept(places.size());
  tbb::parallel_for(size_t{0}, places.size(), [&](size_t i) {
    Sought patch{places[i], {places[i].x - half, places[i].y - half, side, side}};
    if (has_one_place(impl_->picture, options, &patch)) kept[i] = patch;
  });
  for (const auto& patch : kept)
    if (patch) impl_->patches.push_back(*patch);
}

SoughtPatches::SoughtPatches(SoughtPatches&&) noexcept = default;
SoughtPatches::~SoughtPatches() = default;

PatchField SoughtPatches::in(const Image& to) const {
  PatchField field;
  const InspectionOptions& options = impl_->options;
  const Picture other = picture_of(wrap(to), cv::Mat(), options);
  std::vector<std::optional<Patch>> sought(impl_->patches.size());
  tbb::parallel_for(size_t{0}, sought.size(), [&](size_t i) {
    Patch patch;
    if (seek(impl_->picture, other, impl_->patches[i], impl_->reach, &patch)) sought[i] = patch;
  });
  for (const auto& patch : sought)
    if (patch) field.patches.push_back(*patch);
  for (size_t i = 0; i < field.patches.size(); ++i)
    field.patches[i].found =
        alike(field.patches[i], options) && moves_along(field.patches, i, options);
  return field;
}

PatchField find_patches(const Image& from, const std::vector<unsigned char>& body, const Image& to,
                        double reach, const InspectionOptions& options) {
  return SoughtPatches(from, body, reach, options).in(to);
}

double correlation(const Image& one, const Image& other,
                   const std::vector<unsigned char>& counted) {
  constexpr double kLeast = 200.0;  // pixels
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (size_t i = 0; i < counted.size(); ++i) {
    if (!counted[i]) continue;
    const double p = one.values[i], q = other.values[i];
    n += 1, a += p, b += q, aa += p * p, bb += q * q, ab += p * q;
  }
  if (n < kLeast) return NAN;
  const double of_a = aa - a * a / n, of_b = bb - b * b / n;
  return of_a > 0 && of_b > 0 ? (ab - a * b / n) / std::sqrt(of_a * of_b) : NAN;
}

}  // namespace hookeye::inspection
