#include "estimation/evaluation/compared_pixels.h"

#include <cmath>
#include <limits>
#include <optional>

#include "estimation/images/unresolved.h"

namespace hookeye {

namespace {

/// Where the photo shows something that is not the told background although the model has none
/// there: such pixels count, else a body that left the model's silhouette would cost nothing.
bool shows_body(const PhotoPlane& photo, size_t i, const PhotoState& state) {
  return std::abs(photo.I->values[i] - state.behind(i)) > 6.0 * photo.sigma->values[i];
}

}  // namespace

double loss(const Image& residual, double huber) {
  double sum = 0.0;
  for (const float value : residual.values) {
    if (std::isnan(value)) continue;
    const double r = std::abs(value);
    sum += huber > 0.0 && r > huber ? huber * (2.0 * r - huber) : r * r;
  }
  return sum;
}

Image sigma_beside_photo(const Image& sigma, const Image& unresolved, double times) {
  Image out = sigma;
  for (size_t i = 0; i < out.values.size(); ++i) {
    const float s = sigma.values[i];
    out.values[i] = std::sqrt(2.0f * s * s + static_cast<float>(times) * unresolved.values[i]);
  }
  return out;
}

SigmaOfBlur sigma_of_blur(double blur_variance_px2) {
  const auto [share, by_variance] = blurred_noise(blur_variance_px2);
  return {std::sqrt((1.0 + share) / 2.0), by_variance / (2.0 * (1.0 + share))};
}

void add_sigma_of_blur(const SigmaOfBlur& sigma_falls, const Image& residual, const Image& sigma,
                       ImageDerivative* dI) {
  for (ImageDerivative::Part& part : dI->parts)
    for (size_t i = 0; i < part.photo.size(); ++i) {
      const auto pixel = static_cast<size_t>(part.pixel[i]);
      if (std::isnan(residual.values[pixel])) continue;
      part.photo[i][kBlur] -= static_cast<float>(sigma_falls.log_by_blur) * residual.values[pixel] *
                              sigma.values[pixel];
    }
}

Comparison compare_pixels(const Rendering& rendering, const PhotoPlane& photo, const Image& sigma,
                          ComparedAs as, const PhotoState& state) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  Comparison out;
  const Image& I = photo.I;
  const std::vector<unsigned char>& valid = photo.valid;
  out.residual = Image{I.width, I.height, 1, {}};
  out.residual.values.resize(I.pixels());
  const auto telling = as.mask ? telling_pixels(rendering.I, I) : std::vector<unsigned char>();
  size_t count = 0;
  for (size_t i = 0; i < I.pixels(); ++i) {
    const float coverage = rendering.coverage.values[i];
    const bool counts = as.mask         ? telling[i] != 0
                        : as.silhouette ? coverage > 0.0f || shows_body(photo, i, state)
                                        : coverage > 1.0f - 1e-6f;
    out.residual.values[i] = kNone;
    if (!counts || (!valid.empty() && !valid[i])) continue;
    const float r = (rendering.I.values[i] - I.values[i]) / sigma.values[i];
    out.residual.values[i] = r;
    out.r2 += double(r) * r;
    ++count;
  }
  out.count = static_cast<double>(count);
  return out;
}

namespace {

/// Square root of Huber's weight by iteratively reweighted squares.
double root_weight(double residual, double huber) {
  return huber > 0.0 && std::abs(residual) > huber ? std::sqrt(huber / std::abs(residual)) : 1.0;
}

/// w r of all pixels by the model's own picture, 0 where nothing counts.
Image adjoint(const Image& residuals, const Image& sigma, double huber,
              const Brightness* brightness) {
  Image out{sigma.width, sigma.height, 1, std::vector<float>(sigma.pixels(), 0.0f)};
  for (size_t i = 0; i < out.values.size(); ++i) {
    const double residual = residuals.values[i];
    if (std::isnan(residual)) continue;
    const double weight = root_weight(residual, huber);
    out.values[i] = static_cast<float>(weight * weight * residual / sigma.values[i]);
  }
  return brightness ? brightness->adjoint(out) : out;
}

/// Of pixels that the derivative has no row of.
SumsBehind sums_behind(const ImageDerivative& dI, const Image& residuals, const Image& sigma,
                       const Image& Bt_r, double huber) {
  std::vector<unsigned char> has_row(sigma.pixels(), 0);
  dI.for_each_pixel([&](size_t, int pixel) { has_row[pixel] = 1; });
  SumsBehind out;
  for (size_t i = 0; i < has_row.size(); ++i) {
    if (has_row[i]) continue;
    out.Bt_r += Bt_r.values[i];
    const double residual = residuals.values[i];
    if (!std::isnan(residual))
      out.ww += std::pow(root_weight(residual, huber) / sigma.values[i], 2);
  }
  return out;
}

/// d(residual)/d(followed picture) of each row, 0: does not count.
VectorXd weights_of(const ImageDerivative& dI, const Image& residuals, const Image& sigma,
                    double huber) {
  VectorXd w = VectorXd::Zero(static_cast<Eigen::Index>(dI.pixels()));
  dI.for_each_pixel([&](size_t k, int pixel) {
    const double residual = residuals.values[pixel];
    if (!std::isnan(residual)) w[k] = root_weight(residual, huber) / sigma.values[pixel];
  });
  return w;
}

VectorXd rows_of(const ImageDerivative& dI, const Image& image) {
  VectorXd out(static_cast<Eigen::Index>(dI.pixels()));
  dI.for_each_pixel([&](size_t k, int pixel) { out[k] = image.values[pixel]; });
  return out;
}

}  // namespace

CondensedPhoto condense(const Rendering& rendering, const Image& residuals, const Image& sigma,
                        const SurfaceMesh& surface, const PhotoState& state, double huber,
                        const Brightness* brightness, const VertexSensitivity& S) {
  const ImageDerivative& dI = rendering.dI;
  const CondensedColumns columns{S.second.size() > 0, !S.photo.isZero(0.0)};
  const Image wr = adjoint(residuals, sigma, huber, brightness);
  const Image Bt_r = state.blur_variance > 0.0 ? blur(wr, state.blur_variance) : wr;
  VectorXd w = weights_of(dI, residuals, sigma, huber);
  std::optional<BrightnessSums> of_gains;
  if (brightness) {
    of_gains.emplace(*brightness, surface, dI, w, columns);
    dI.for_each_pixel([&](size_t k, int pixel) { w[k] *= brightness->gain(pixel); });
  }
  const bool level = columns.photo && !state.backdrop;
  CondensedPhoto out = NodeNormalEquations::accumulate(
                           surface, dI, rows_of(dI, wr), w, rows_of(dI, Bt_r), columns,
                           level ? sums_behind(dI, residuals, sigma, Bt_r, huber) : SumsBehind{})
                           .reduce(S);
  if (of_gains) of_gains->add_to(&out, S);
  return out;
}

}  // namespace hookeye
