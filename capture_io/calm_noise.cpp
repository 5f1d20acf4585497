// A patch of (order + 1)^2 pixels holds one residual, the binomial difference of that order along
// both axes scaled to unit norm, and what is left of its energy about the mean, its structure. Of
// white Gaussian noise the two are independent, since the filters are orthogonal: patches may be
// chosen for little structure, and the mean square of their residuals still is the variance of the
// noise, without bias. Where texture fills a photo those are the insides of single speckles, far
// too small for the blocks of image_noise.cpp. (Weak-texture patches: Liu, Tanaka and Okutomi,
// Single-image noise level estimation for blind denoising, IEEE TIP 22, 2013.)
//
// Both orders are asked and the lower answer taken: order 2 needs spots of three pixels only, order
// 4 is blind to smooth texture. A band of intensities whose chosen residuals are not Gaussian
// (their kurtosis is not 3) holds edges still, and is not heard; and the law of variance against
// intensity is fitted from below, since texture only ever adds.
#include "capture_io/calm_noise.h"

#include <algorithm>
#include <cmath>

namespace hookeye {
namespace {

constexpr size_t fewest_in_band = 400;  ///< patches
constexpr double calm_share = 0.02;     ///< of the patches of a band
constexpr size_t fewest_calm = 60;      ///< patches: 9 % of the deviation
constexpr double most_patches = 1e6;    ///< of a photo: more tell nothing new
constexpr double excess_scale = 0.3;  ///< of a variance over the law, where it begins to be texture

struct Patch {
  float intensity, structure, residual;  ///< mean, and two squares
};

struct Band {
  double intensity, variance, weight;
};

struct Law {
  double offset = 0, slope = 0;
  double at(double intensity) const { return offset + slope * intensity; }
};

/// Binomial coefficients with alternating signs, of unit norm.
std::vector<double> difference_of(int order) {
  std::vector<double> c{1};
  for (int i = 0; i < order; ++i) c.push_back(-c.back() * (order - i) / (i + 1));
  double squares = 0;
  for (const double v : c) squares += v * v;
  for (double& v : c) v /= std::sqrt(squares);
  return c;
}

/// Nothing for a patch with clipped pixels.
std::optional<Patch> patch_at(const Image& image, int x, int y, int channel,
                              const std::vector<double>& c) {
  const int side = static_cast<int>(c.size());
  double sum = 0, squares = 0, residual = 0;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const double value = image.at(x + i, y + j, channel);
      if (value <= 0 || value >= 0.999) return {};
      sum += value, squares += value * value, residual += c[i] * c[j] * value;
    }
  const double mean = sum / (side * side);
  return Patch{static_cast<float>(mean),
               static_cast<float>(squares - sum * mean - residual * residual),
               static_cast<float>(residual * residual)};
}

std::vector<Patch> patches_of(const Image& image, int order) {
  const std::vector<double> c = difference_of(order);
  const double all = static_cast<double>(image.pixels()) * image.channels;
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(all / most_patches))));
  std::vector<Patch> patches;
  for (int y = 0; y + order < image.height; y += step)
    for (int x = 0; x + order < image.width; x += step)
      for (int channel = 0; channel < image.channels; ++channel)
        if (const auto patch = patch_at(image, x, y, channel, c)) patches.push_back(*patch);
  return patches;
}

/// The patches of least structure; nothing where their residuals are not Gaussian.
std::optional<Band> calm_band(std::vector<Patch>& patches) {
  if (patches.size() < fewest_in_band) return {};
  const size_t n = std::max(fewest_calm, static_cast<size_t>(calm_share * patches.size()));
  std::nth_element(patches.begin(), patches.begin() + static_cast<long>(n), patches.end(),
                   [](const Patch& a, const Patch& b) { return a.structure < b.structure; });
  double intensity = 0, squares = 0, fourths = 0;
  for (size_t i = 0; i < n; ++i) {
    const double square = patches[i].residual;
    intensity += patches[i].intensity, squares += square, fourths += square * square;
  }
  const auto count = static_cast<double>(n);
  const double kurtosis = squares > 0 ? count * fourths / (squares * squares) : 0;
  if (!(squares > 0) || kurtosis > 3 + 3 * std::sqrt(24 / count)) return {};
  return Band{intensity / count, squares / count, count};
}

/// Empty where the calm bands cover less than half the intensities.
std::vector<Band> calm_bands(const std::vector<Patch>& patches) {
  if (patches.size() < fewest_in_band) return {};
  std::vector<float> level;
  for (const Patch& patch : patches) level.push_back(patch.intensity);
  const auto at = [&](size_t place) {
    std::nth_element(level.begin(), level.begin() + static_cast<long>(place), level.end());
    return double(level[place]);
  };
  const double low = at(level.size() / 100), high = at(level.size() - 1 - level.size() / 100);
  const size_t count = std::clamp<size_t>(patches.size() / 1000, 3, 8);
  std::vector<std::vector<Patch>> in_band(count);
  for (const Patch& patch : patches) {
    const double place = (patch.intensity - low) / std::max(high - low, 1e-9) * double(count);
    in_band[static_cast<size_t>(std::clamp<double>(place, 0, double(count - 1)))].push_back(patch);
  }
  std::vector<Band> bands;
  for (std::vector<Patch>& band : in_band)
    if (const auto calm = calm_band(band)) bands.push_back(*calm);
  if (bands.empty() || bands.back().intensity - bands.front().intensity < 0.5 * (high - low))
    return {};
  return bands;
}

/// Cauchy's weight of a variance above the law.
double excess_of(const Band& band, const Law& law) {
  return std::max(0.0, band.variance / law.at(band.intensity) - 1) / excess_scale;
}

/// The nearest law below all bands that is constant, or proportional to the intensity.
Law below(const std::vector<Band>& bands) {
  Law constant{1e30, 0}, photons{0, 1e30};
  for (const Band& band : bands) {
    constant.offset = std::min(constant.offset, band.variance);
    photons.slope = std::min(photons.slope, band.variance / band.intensity);
  }
  double cost_constant = 0, cost_photons = 0;
  for (const Band& band : bands) {
    cost_constant += band.weight * std::log1p(std::pow(excess_of(band, constant), 2));
    cost_photons += band.weight * std::log1p(std::pow(excess_of(band, photons), 2));
  }
  return cost_photons < cost_constant ? photons : constant;
}

/// Weighted least squares of variance = offset + slope * intensity, both >= 0, from below.
Law fitted(const std::vector<Band>& bands) {
  Law law = below(bands);
  for (int iteration = 0; iteration < 30; ++iteration) {
    double s0 = 0, s1 = 0, s2 = 0, t0 = 0, t1 = 0;
    for (const Band& b : bands) {
      const double w =
          b.weight / std::pow(law.at(b.intensity), 2) / (1 + std::pow(excess_of(b, law), 2));
      s0 += w, s1 += w * b.intensity, s2 += w * b.intensity * b.intensity;
      t0 += w * b.variance, t1 += w * b.intensity * b.variance;
    }
    const double determinant = s0 * s2 - s1 * s1;
    law = {t0 / s0, 0};
    if (determinant <= 1e-9 * s0 * s2) continue;
    const double slope = (s0 * t1 - s1 * t0) / determinant;
    if (slope > 0) law = {(s2 * t0 - s1 * t1) / determinant, slope};
    if (law.offset < 0) law = {0, t1 / s2};
  }
  return law;
}

}  // namespace

std::optional<NoiseModel> calm_noise(const Image& image) {
  std::optional<Law> lowest;
  for (const int order : {2, 4}) {
    const std::vector<Band> bands = calm_bands(patches_of(image, order));
    if (bands.empty()) continue;
    const Law law = fitted(bands);
    const double middle = 0.5 * (bands.front().intensity + bands.back().intensity);
    if (!lowest || law.at(middle) < lowest->at(middle)) lowest = law;
  }
  if (!lowest) return {};
  NoiseModel noise;
  noise.read = std::sqrt(lowest->offset);
  if (lowest->slope > 0) noise.full_well = 1 / lowest->slope;
  noise.estimated = true;
  return noise;
}

}  // namespace hookeye
