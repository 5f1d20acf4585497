#include "estimation/inspection/apart.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hookeye::inspection {

namespace {

using Pixels = std::vector<unsigned char>;

cv::Mat as_mat(const Pixels& pixels, const Image& size) {
  return cv::Mat(size.height, size.width, CV_8U, const_cast<unsigned char*>(pixels.data())) != 0;
}

/// Photos of the same camera in other examples than `photo`, which the body's motion is seen in.
std::vector<PhotoIndex> moved_photos(const Sight& sight, PhotoIndex photo) {
  std::vector<PhotoIndex> out;
  for (const PhotoIndex& other : sight.photos())
    if (other.first != photo.first && sight.spec(other).camera == sight.spec(photo).camera &&
        !is_rest(sight.example(other.first)))
      out.push_back(other);
  return out;
}

/// Pixels that have the same brightness, but for noise, in all of these photos. Silhouettes have no
/// noise.
cv::Mat still(Sight& sight, PhotoIndex photo, const std::vector<PhotoIndex>& others) {
  constexpr double kOfWhite = 0.02;  // as small_photo has it
  constexpr double kSigmas = 5.0;    // of one of two photos
  const SmallPhoto& here = sight.small(photo);
  const NoiseModel& noise = sight.scene().photos[size_t(photo.first)][size_t(photo.second)].noise;
  std::vector<float> sorted = here.I->values;
  const auto bright = sorted.begin() + static_cast<long>(0.99 * double(sorted.size() - 1));
  std::nth_element(sorted.begin(), bright, sorted.end());
  const double least = kOfWhite * double(*bright);
  Pixels out(here.I->pixels(), 255);
  for (const PhotoIndex& other : others) {
    const SmallPhoto& there = sight.small(other);
    if (there.I->pixels() != out.size()) continue;
    for (size_t i = 0; i < out.size(); ++i) {
      const double sigma = noise.sigma(double(here.I->values[i])) / here.px();
      if (std::abs(there.I->values[i] - here.I->values[i]) > std::max(kSigmas * sigma, least))
        out[i] = 0;
    }
  }
  return as_mat(out, here.I).clone();
}

struct Piece {
  cv::Mat mask;
  cv::Rect box;
  int area = 0;
  double still = 0.0;  ///< share
};

/// Pieces of `alone` that are no rim of a misplaced outline, the largest first.
std::vector<Piece> pieces(const cv::Mat& alone, const cv::Mat& still) {
  constexpr int kRim = 3;  // px
  cv::Mat core, labels, stats, centres;
  cv::morphologyEx(alone, core, cv::MORPH_OPEN, cv::Mat::ones(kRim, kRim, CV_8U));
  const int count = cv::connectedComponentsWithStats(core, labels, stats, centres, 8);
  std::vector<Piece> out;
  for (int i = 1; i < count; ++i) {
    Piece piece;
    piece.mask = labels == i;
    piece.area = stats.at<int>(i, cv::CC_STAT_AREA);
    piece.box = {stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                 stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT)};
    piece.still = double(cv::countNonZero(piece.mask & still)) / piece.area;
    out.push_back(std::move(piece));
  }
  std::sort(out.begin(), out.end(), [](const Piece& a, const Piece& b) { return a.area > b.area; });
  return out;
}

constexpr double kStillShare = 0.9;  // of a piece's pixels: noise and shadows of the body take some
constexpr double kLeastPiece = 0.01;  // of what either covers

}  // namespace

std::optional<Apart> apart(Sight& sight, PhotoIndex photo) {
  const SmallPhoto& seen = sight.small(photo);
  if (!seen.foreground.known()) return {};
  const Pixels outline = sight.outline(photo, sight.shown(photo.first));
  const Pixels inside = seen.foreground.inside();
  cv::Mat in_photo = as_mat(inside, seen.I), in_model = as_mat(outline, seen.I);
  if (!seen.valid->empty()) {
    const cv::Mat valid = as_mat(seen.valid, seen.I);
    in_photo &= valid, in_model &= valid;
  }
  const double either = cv::countNonZero(in_photo | in_model);
  if (either == 0.0) return {};
  const auto others = moved_photos(sight, photo);
  const cv::Mat stands =
      others.empty() ? cv::Mat::zeros(in_photo.size(), CV_8U) : still(sight, photo, others);
  const cv::Mat alone = in_photo & ~in_model;
  Apart out;
  out.photos = static_cast<int>(others.size());
  out.photo_alone = cv::countNonZero(alone) / either;
  out.model_alone = cv::countNonZero(in_model & ~in_photo) / either;
  double still_area = 0.0;
  for (const Piece& piece : pieces(alone, stands)) {
    if (piece.area < kLeastPiece * either) break;
    const bool stays = !others.empty() && piece.still >= kStillShare;
    if (stays) still_area += piece.area;
    if (out.largest > 0.0) continue;
    out.largest = piece.area / either;
    out.largest_still = stays;
    const double px = seen.px();
    out.x = px * (piece.box.x + 0.5 * piece.box.width);
    out.y = px * (piece.box.y + 0.5 * piece.box.height);
    out.width = px * piece.box.width, out.height = px * piece.box.height;
  }
  const double both = cv::countNonZero(in_photo & in_model);
  out.without_still = both / (either - still_area);
  return out;
}

Pixels still_beside(Sight& sight, PhotoIndex photo) {
  const auto others = moved_photos(sight, photo);
  const SmallPhoto& seen = sight.small(photo);
  if (others.empty() || !seen.foreground.known()) return {};
  const Pixels outline = sight.outline(photo, sight.shown(photo.first));
  const Pixels inside = seen.foreground.inside();
  const cv::Mat alone = as_mat(inside, seen.I) & ~as_mat(outline, seen.I);
  const double most = cv::countNonZero(as_mat(inside, seen.I) | as_mat(outline, seen.I));
  cv::Mat all = cv::Mat::zeros(alone.size(), CV_8U);
  for (const Piece& piece : pieces(alone, still(sight, photo, others)))
    if (piece.area >= kLeastPiece * most && piece.still >= kStillShare) all |= piece.mask;
  return {all.begin<uchar>(), all.end<uchar>()};
}

}  // namespace hookeye::inspection
