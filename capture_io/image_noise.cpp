// Luminance and the noise of one photo alone.
//
// Noise: as in Immerkaer (Fast noise variance estimation, CVIU 64, 1996) a high-pass residual of
// known gain, here the fourth difference along both axes: it blocks all that is cubic over five
// pixels and looks at the highest frequencies, where optics leave little texture. The affine law
// sigma^2 = read^2 + I / full_well is that of Foi et al. (Practical Poissonian-Gaussian noise
// modeling, IEEE TIP 17, 2008). Texture that passes the filter would count as noise, so in every
// band of intensity only the calmest blocks speak, and the chi-square quantile says how far below
// the truth those lie. Where even those hold texture, calm_noise.cpp is heard. Noise that is
// correlated between pixels (demosaicing, JPEG) is underestimated: say `noise:` there.
#include <algorithm>
#include <cmath>

#include "capture_io/calm_noise.h"
#include "core/distributions.h"

namespace hookeye {
namespace {

constexpr int block = 8;            ///< side of a block [px]
constexpr double calm_share = 0.2;  ///< of the blocks of a band
/// Independent residuals in a block of 64: n^2 / sum rho_ij^2 over the filter's autocorrelation
/// (70, -56, 28, -8, 1) / 70 along each axis gives 3.37^2.
constexpr double independent = 11.3;
/// What the calmest spots say over what the blocks say: below the first the blocks hold texture;
/// below the second the photo holds hardly anything else, and the spots themselves may. Below so
/// many pixels there are too few spots: speckle of three pixels passed for seven times the noise.
constexpr double same_answer = 0.75, sure_answer = 0.5, sure_pixels = 8000;
constexpr int reach = 2;                                         ///< of the filter [px]
constexpr double difference[2 * reach + 1] = {1, -4, 6, -4, 1};  ///< squares sum to 70

struct Block {
  double intensity;
  double variance;
};

/// Mean square of the residuals of the block from (x0, y0), each with the standard deviation of the
/// noise.
double residual_variance(const Image& image, int x0, int y0, int channel) {
  double along[block + 2 * reach][block];  // differences along the rows
  for (int j = 0; j < block + 2 * reach; ++j)
    for (int i = 0; i < block; ++i) {
      double row = 0;
      for (int dx = -reach; dx <= reach; ++dx)
        row += difference[dx + reach] * image.at(x0 + i + dx, y0 + j - reach, channel);
      along[j][i] = row;
    }
  double squares = 0;
  for (int j = 0; j < block; ++j)
    for (int i = 0; i < block; ++i) {
      double sum = 0;
      for (int dy = 0; dy <= 2 * reach; ++dy) sum += difference[dy] * along[j + dy][i];
      squares += (sum / 70) * (sum / 70);
    }
  return squares / (block * block);
}

/// Mean and residual variance of every block without clipped pixels.
std::vector<Block> calm_blocks(const Image& image, int channel) {
  std::vector<Block> blocks;
  for (int y0 = reach; y0 + block + reach <= image.height; y0 += block) {
    for (int x0 = reach; x0 + block + reach <= image.width; x0 += block) {
      double sum = 0;
      bool clipped = false;
      for (int y = y0; y < y0 + block && !clipped; ++y) {
        for (int x = x0; x < x0 + block; ++x) {
          const double value = image.at(x, y, channel);
          clipped |= value <= 0 || value >= 0.999;
          sum += value;
        }
      }
      if (!clipped)
        blocks.push_back({sum / (block * block), residual_variance(image, x0, y0, channel)});
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
  const double below = chi2_quantile(calm_share, independent) / independent;
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

NoiseModel estimate_noise(const Image& image, bool white) {
  NoiseModel noise;
  noise.estimated = true;
  std::vector<Block> blocks;
  for (int c = 0; c < image.channels; ++c) {
    const std::vector<Block> more = calm_blocks(image, c);
    blocks.insert(blocks.end(), more.begin(), more.end());
  }
  if (blocks.empty()) return noise;
  double intensity = 0;
  for (const Block& one : blocks) intensity += one.intensity / static_cast<double>(blocks.size());
  const double pixels = static_cast<double>(blocks.size()) * block * block / image.channels;
  double offset = 0, slope = 0;
  fit_law(bands_of(std::move(blocks)), offset, slope);
  noise.read = std::sqrt(offset);
  if (slope > 0) noise.full_well = 1 / slope;
  noise.doubtful = !white;
  if (!white || !(noise.sigma(intensity) > 0)) return noise;
  const std::optional<NoiseModel> calm = calm_noise(image);
  const double ratio = calm ? calm->sigma(intensity) / noise.sigma(intensity) : 0;
  if (calm && ratio < same_answer) noise = *calm;
  noise.doubtful = ratio < sure_answer || pixels < sure_pixels;
  return noise;
}

}  // namespace hookeye
