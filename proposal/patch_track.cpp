#include "proposal/patch_track.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hookeye {
namespace {

constexpr int kHalf = 8;         ///< of a patch [px]
constexpr int kReach = 14;       ///< search about the place where its last motion leads [px]
constexpr size_t kPatches = 48;  ///< of the most texture
constexpr double kAlike = 0.75;  ///< correlation below which a patch is lost
constexpr size_t kFewest = 5;

struct Patch {
  double x, y;               ///< where it is
  double dx = 0, dy = 0;     ///< of its last step
  std::vector<double> gone;  ///< distance from its start, by photo
  double start_x, start_y;
};

bool inside(const Image& image, int x, int y) {
  return x >= kHalf && y >= kHalf && x + kHalf < image.width && y + kHalf < image.height;
}

/// The patch about (x, y) without its mean, and its sum of squares.
struct Cut {
  std::vector<float> values;
  double squares = 0;
};
Cut cut_out(const Image& image, int x, int y) {
  Cut cut;
  double mean = 0;
  for (int v = -kHalf; v <= kHalf; ++v)
    for (int u = -kHalf; u <= kHalf; ++u) {
      cut.values.push_back(image.at(x + u, y + v));
      mean += cut.values.back();
    }
  mean /= static_cast<double>(cut.values.size());
  for (float& value : cut.values) {
    value -= static_cast<float>(mean);
    cut.squares += value * value;
  }
  return cut;
}

double correlation(const Cut& a, const Image& image, int x, int y) {
  if (!inside(image, x, y)) return -1;
  const Cut b = cut_out(image, x, y);
  double sum = 0;
  for (size_t i = 0; i < a.values.size(); ++i) sum += a.values[i] * b.values[i];
  const double norm = std::sqrt(a.squares * b.squares);
  return norm > 0 ? sum / norm : -1;
}

/// Where a parabola through three values has its top, from the middle one.
double top_of(double before, double at, double behind) {
  const double bend = before - 2 * at + behind;
  return bend < 0 ? std::clamp(0.5 * (before - behind) / bend, -0.5, 0.5) : 0.0;
}

/// Follows a patch into the next photo; false: it is lost.
bool follow(Patch& patch, const Image& from, const Image& to) {
  const int x = static_cast<int>(std::lround(patch.x)), y = static_cast<int>(std::lround(patch.y));
  if (!inside(from, x, y)) return false;
  const Cut here = cut_out(from, x, y);
  const int x0 = x + static_cast<int>(std::lround(patch.dx)),
            y0 = y + static_cast<int>(std::lround(patch.dy));
  double best = -1;
  int bx = 0, by = 0;
  for (int v = y0 - kReach; v <= y0 + kReach; ++v)
    for (int u = x0 - kReach; u <= x0 + kReach; ++u)
      if (const double like = correlation(here, to, u, v); like > best) best = like, bx = u, by = v;
  if (best < kAlike) return false;
  patch.dx =
      bx - x + top_of(correlation(here, to, bx - 1, by), best, correlation(here, to, bx + 1, by));
  patch.dy =
      by - y + top_of(correlation(here, to, bx, by - 1), best, correlation(here, to, bx, by + 1));
  patch.x += patch.dx, patch.y += patch.dy;
  patch.gone.push_back(std::hypot(patch.x - patch.start_x, patch.y - patch.start_y));
  return true;
}

/// Those with the most texture, on a grid.
std::vector<Patch> textured_patches(const Image& image) {
  std::vector<std::pair<double, Patch>> all;
  for (int y = kHalf; y + kHalf < image.height; y += kHalf)
    for (int x = kHalf; x + kHalf < image.width; x += kHalf) {
      const double squares = cut_out(image, x, y).squares;
      if (squares > 0)
        all.push_back({squares, Patch{double(x), double(y), 0, 0, {0.0}, double(x), double(y)}});
    }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Patch> out;
  for (size_t i = 0; i < std::min(all.size(), kPatches); ++i) out.push_back(all[i].second);
  return out;
}

}  // namespace

Image reduced(const Image& image, int most) {
  const int block = (std::max(image.width, image.height) + most - 1) / most;
  if (block <= 1) return image;
  Image out{image.width / block, image.height / block, 1, {}};
  out.values.resize(out.pixels());
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      float sum = 0;
      for (int v = 0; v < block; ++v)
        for (int u = 0; u < block; ++u) sum += image.at(x * block + u, y * block + v);
      out.at(x, y) = sum / static_cast<float>(block * block);
    }
  return out;
}

std::vector<double> tracked_motion(const std::vector<Image>& photos) {
  if (photos.size() < 2) return {};
  std::vector<Patch> patches = textured_patches(photos.front());
  for (size_t k = 1; k < photos.size(); ++k)
    std::erase_if(patches, [&](Patch& patch) { return !follow(patch, photos[k - 1], photos[k]); });
  if (patches.size() < kFewest) return {};
  std::vector<double> out(photos.size(), 0.0);
  for (const Patch& patch : patches)
    for (size_t k = 0; k < out.size(); ++k)
      out[k] += patch.gone[k] / static_cast<double>(patches.size());
  return out;
}

}  // namespace hookeye
