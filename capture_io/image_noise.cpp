// Luminance and the noise of one photo alone.
//
// Noise: Immerkaer's difference of two Laplacians (Fast noise variance estimation, CVIU 64, 1996)
// blocks out everything that is linear over three pixels; the affine law sigma^2 = read^2 + I / n
// is that of Foi et al. (Practical Poissonian-Gaussian noise modeling, IEEE TIP 17, 2008). Texture
// that passes the filter would count as noise, so in every band of intensity only the calmest
// blocks speak, and the chi-square quantile says how far below the truth those lie.
#include <algorithm>
#include <cmath>

#include "capture_io/image.h"

namespace hookeye {
namespace {

constexpr int block = 8;                 ///< side of a block [px]
constexpr double calm_share = 0.2;       ///< of the blocks of a band
constexpr double calm_normal = -0.8416;  ///< normal quantile at calm_share
/// Independent residuals in a block of 64: n / sum rho^2 over the filter's autocorrelation
/// (1, -2/3, 1/6 along each axis; sum rho^2 = (35/18)^2), the block's rim counted.
constexpr double independent = 19.0;

struct Block {
  double intensity;
  double variance;
};

/// Mean and residual variance of every block without clipped pixels.
std::vector<Block> calm_blocks(const Image& image, int channel) {
  std::vector<Block> blocks;
  for (int y0 = 1; y0 + block < image.height; y0 += block) {
    for (int x0 = 1; x0 + block < image.width; x0 += block) {
      double sum = 0, squares = 0;
      bool clipped = false;
      for (int y = y0; y < y0 + block; ++y) {
        for (int x = x0; x < x0 + block; ++x) {
          const auto v = [&](int dx, int dy) -> double {
            return image.at(x + dx, y + dy, channel);
          };
          const double centre = v(0, 0);
          clipped |= centre <= 0 || centre >= 0.999;
          sum += centre;
          const double residual = (v(-1, -1) + v(1, -1) + v(-1, 1) + v(1, 1) -
                                   2 * (v(0, -1) + v(0, 1) + v(-1, 0) + v(1, 0)) + 4 * centre) /
                                  6;
          squares += residual * residual;
        }
      }
      if (!clipped) blocks.push_back({sum / (block * block), squares / (block * block)});
    }
  }
  return blocks;
}

/// One point of the noise law: the variance at an intensity, with its weight (blocks behind it).
struct Band {
  double intensity, variance, weight;
};

/// Bands of equal numbers of blocks, each with its calmest blocks' variance made unbiased.
std::vector<Band> bands_of(std::vector<Block> blocks) {
  std::sort(blocks.begin(), blocks.end(),
            [](const Block& a, const Block& b) { return a.intensity < b.intensity; });
  const size_t count = std::clamp<size_t>(blocks.size() / 40, 1, 24);
  // Wilson and Hilferty: quantile of chi^2/m.
  const double spread = 2 / (9 * independent);
  const double below = std::pow(1 - spread + calm_normal * std::sqrt(spread), 3);
  std::vector<Band> bands;
  for (size_t i = 0; i < count; ++i) {
    const auto first = blocks.begin() + blocks.size() * i / count;
    const auto last = blocks.begin() + blocks.size() * (i + 1) / count;
    if (first == last) continue;
    const auto middle = first + (last - first) / 2;
    const double intensity = middle->intensity;
    const auto calm = first + static_cast<long>((last - first) * calm_share);
    std::nth_element(first, calm, last,
                     [](const Block& a, const Block& b) { return a.variance < b.variance; });
    bands.push_back({intensity, calm->variance / below, double(last - first)});
  }
  return bands;
}

/// Weighted least squares of variance = offset + slope * intensity, both >= 0. A variance's own
/// error grows with the variance, hence the weights 1 / predicted^2, iterated; bands above the law
/// hold texture and count less (Huber at twice the predicted spread).
void fit_law(const std::vector<Band>& bands, double& offset, double& slope) {
  offset = 0, slope = 0;
  double mean = 0, total = 0;
  for (const Band& b : bands) mean += b.weight * b.variance, total += b.weight;
  mean /= total;
  if (!(mean > 0)) return;
  offset = mean;
  for (int iteration = 0; iteration < 20; ++iteration) {
    double s0 = 0, s1 = 0, s2 = 0, t0 = 0, t1 = 0;
    for (const Band& b : bands) {
      const double predicted = std::max(offset + slope * b.intensity, 0.01 * mean);
      const double excess = (b.variance - predicted) / predicted;
      const double w = b.weight / (predicted * predicted) / std::max(1.0, excess / 0.3);
      s0 += w, s1 += w * b.intensity, s2 += w * b.intensity * b.intensity;
      t0 += w * b.variance, t1 += w * b.intensity * b.variance;
    }
    const double determinant = s0 * s2 - s1 * s1;
    offset = t0 / s0, slope = 0;
    if (determinant > 1e-9 * s0 * s2) {
      slope = (s0 * t1 - s1 * t0) / determinant;
      offset = (s2 * t0 - s1 * t1) / determinant;
      if (slope < 0) slope = 0, offset = t0 / s0;
      if (offset < 0) offset = 0, slope = t1 / s2;
    }
  }
}

}  // namespace

double NoiseModel::sigma(double intensity) const {
  const double photons = full_well > 0 ? std::max(intensity, 0.0) / full_well : 0.0;
  return std::sqrt(read * read + photons);
}

Image luminance(const Image& image) {
  if (image.channels == 1) return image;
  Image grey{image.width, image.height, 1, {}};
  grey.values.resize(image.pixels());
  for (size_t p = 0; p < image.pixels(); ++p) {
    const float* rgb = &image.values[p * image.channels];
    grey.values[p] = 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
  }
  return grey;
}

NoiseModel estimate_noise(const Image& image) {
  NoiseModel noise;
  noise.estimated = true;
  std::vector<Block> blocks;
  for (int c = 0; c < image.channels; ++c) {
    const std::vector<Block> more = calm_blocks(image, c);
    blocks.insert(blocks.end(), more.begin(), more.end());
  }
  if (blocks.empty()) return noise;
  double offset = 0, slope = 0;
  fit_law(bands_of(std::move(blocks)), offset, slope);
  noise.read = std::sqrt(offset);
  if (slope > 0) noise.full_well = 1 / slope;
  return noise;
}

}  // namespace hookeye
