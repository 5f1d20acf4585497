#include "render/texture_lookup.h"

#include <algorithm>
#include <cmath>

namespace hookeye {

using Eigen::Vector2d;

namespace {

/// In-place B-spline prefilter along a line (pole sqrt(3) - 2, mirror border).
void prefilter(double* c, int n, int step) {
  if (n < 2) return;
  const double z = std::sqrt(3.0) - 2;
  const auto at = [&](int i) -> double& { return c[static_cast<size_t>(i) * step]; };
  for (int i = 0; i < n; ++i) at(i) *= 6;
  const int horizon = std::min(n, 40);  // |z|^40 < 1e-22
  double power = z, start = at(0);
  for (int i = 1; i < horizon; ++i, power *= z) start += power * at(i);
  at(0) = start;
  for (int i = 1; i < n; ++i) at(i) += z * at(i - 1);
  at(n - 1) = z / (z * z - 1) * (at(n - 1) + z * at(n - 2));
  for (int i = n - 2; i >= 0; --i) at(i) = z * (at(i + 1) - at(i));
}

int mirror(int i, int n) {
  if (n == 1) return 0;
  while (i < 0 || i >= n) i = i < 0 ? -i : 2 * (n - 1) - i;
  return i;
}

void spline_weights(double t, double w[4], double d[4]) {
  const double s = 1 - t;
  w[0] = s * s * s / 6, w[3] = t * t * t / 6;
  w[1] = 2.0 / 3 - t * t * (2 - t) / 2, w[2] = 2.0 / 3 - s * s * (2 - s) / 2;
  d[0] = -s * s / 2, d[3] = t * t / 2;
  d[1] = t * (3 * t - 4) / 2, d[2] = -s * (3 * s - 4) / 2;
}

}  // namespace

SplineImage::SplineImage(std::shared_ptr<const Image> image) : image_(std::move(image)) {
  const int w = image_->width, h = image_->height;
  c_.resize(image_->pixels());
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) c_[static_cast<size_t>(y) * w + x] = image_->at(x, y);
  for (int y = 0; y < h; ++y) prefilter(c_.data() + static_cast<size_t>(y) * w, w, 1);
  for (int x = 0; x < w; ++x) prefilter(c_.data() + x, h, w);
}

Lookup SplineImage::at(const Vector2d& px) const {
  const int w = image_->width, h = image_->height;
  const double fx = std::floor(px.x()), fy = std::floor(px.y());
  double wx[4], dx[4], wy[4], dy[4];
  spline_weights(px.x() - fx, wx, dx);
  spline_weights(px.y() - fy, wy, dy);
  int ix[4];
  for (int i = 0; i < 4; ++i) ix[i] = mirror(int(fx) - 1 + i, w);
  Lookup out{0, Vector2d::Zero()};
  for (int j = 0; j < 4; ++j) {
    const double* row = c_.data() + static_cast<size_t>(mirror(int(fy) - 1 + j, h)) * w;
    double value = 0, slope = 0;
    for (int i = 0; i < 4; ++i) value += wx[i] * row[ix[i]], slope += dx[i] * row[ix[i]];
    out.value += wy[j] * value;
    out.gradient += Vector2d(wy[j] * slope, dy[j] * value);
  }
  return out;
}

}  // namespace hookeye
