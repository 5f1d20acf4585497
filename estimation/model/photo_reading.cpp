#include "estimation/model/photo_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/fingerprint.h"
#include "estimation/model/photo_pyramid.h"
#include "render/renderer.h"

namespace hookeye {

namespace {

constexpr int kMostHalvings = 4;

/// Pixels of the body at rest that the camera sees, from a small picture of it.
double body_pixels(const Camera& camera, const SurfaceMesh& surface) {
  constexpr int kSmall = 400;  // px
  const double factor = std::min(1.0, double(kSmall) / std::max(camera.width, camera.height));
  PhotoState state;
  state.camera = camera.resized(factor);
  state.camera.width = std::max(1, static_cast<int>(camera.width * factor));
  state.camera.height = std::max(1, static_cast<int>(camera.height * factor));
  state.shaded = false;
  RenderOptions options;
  options.rays_per_axis = 1;
  options.visibility_rays = 0;
  options.derivatives = options.cast_shadows = false;
  const Rendering seen =
      Renderer(surface).render(surface.X, nullptr, Texture{}, state, options, false);
  const auto count = std::count_if(seen.triangle.begin(), seen.triangle.end(),
                                   [](int triangle) { return triangle >= 0; });
  return static_cast<double>(count) / (factor * factor);
}

/// Fourth-order central difference, as motions are found with.
double slope(const Image& I, size_t at, size_t step) {
  const float* v = I.values.data() + at;
  return (8.0 * (double(v[step]) - v[-static_cast<std::ptrdiff_t>(step)]) -
          (double(v[2 * step]) - v[-2 * static_cast<std::ptrdiff_t>(step)])) /
         12.0;
}

double information(const PhotoPlane& plane) {
  constexpr double kOfNoise = 2.0 * (64.0 + 1.0) / 144.0;  // variance of a slope over sigma^2
  const Image& I = plane.I;
  double sum = 0.0;
  for (int y = 2; y + 2 < I.height; ++y)
    for (int x = 2; x + 2 < I.width; ++x) {
      const size_t at = static_cast<size_t>(y) * I.width + x;
      if (!(*plane.valid)[at]) continue;
      const double gx = slope(I, at, 1), gy = slope(I, at, static_cast<size_t>(I.width));
      const double sigma = plane.sigma->values[at];
      sum += (gx * gx + gy * gy) / (sigma * sigma) - 2.0 * kOfNoise;
    }
  return std::max(sum, 0.0);
}

void halve(PhotoPlane* plane) {
  plane->valid = halved_valid(plane->valid, plane->I->width, plane->I->height);
  plane->I = halved(plane->I);
  plane->sigma = halved_sigma(plane->sigma);
}

template <class T>
std::vector<T> cut(const std::vector<T>& values, int width, const PhotoWindow& window) {
  std::vector<T> out;
  out.reserve(static_cast<size_t>(window.width) * window.height);
  for (int y = window.y; y < window.y + window.height; ++y) {
    const auto row = values.begin() + static_cast<std::ptrdiff_t>(y) * width + window.x;
    out.insert(out.end(), row, row + window.width);
  }
  return out;
}

/// 0 to 1, the same whatever the processor and whichever other tiles there are.
double drawn(const std::string& name, int column, int row) {
  const std::string mark = fingerprint_of(fmt::format("{} {} {}", name, column, row));
  const auto digits = mark.substr(mark.find(':') + 1, 13);  // 52 bits
  return static_cast<double>(std::stoull(digits, nullptr, 16)) / std::exp2(52);
}

void keep_tiles(Photo& photo, double share, const std::string& name) {
  const int width = photo.planes.front()->width, height = photo.planes.front()->height;
  std::vector<unsigned char>& valid = photo.valid.own();
  for (int row = 0; row * kTile < height; ++row)
    for (int column = 0; column * kTile < width; ++column) {
      if (drawn(name, column, row) < share) continue;
      const int x0 = column * kTile, x1 = std::min(x0 + kTile, width);
      for (int y = row * kTile; y < std::min((row + 1) * kTile, height); ++y)
        std::fill(valid.begin() + static_cast<std::ptrdiff_t>(y) * width + x0,
                  valid.begin() + static_cast<std::ptrdiff_t>(y) * width + x1, 0);
    }
}

}  // namespace

Image cut(const Image& image, const PhotoWindow& window) {
  return {window.width, window.height, 1, cut(image.values, image.width, window)};
}

void cut(Photo& photo, const PhotoWindow& window) {
  const int width = photo.planes.front()->width, height = photo.planes.front()->height;
  if (window.empty() || window.x < 0 || window.y < 0 || window.x + window.width > width ||
      window.y + window.height > height)
    return;
  photo.valid = cut(*photo.valid, width, window);
  for (auto& plane : photo.planes) plane = cut(plane, window);
  for (auto& sigma : photo.sigma) sigma = cut(sigma, window);
  for (auto& backdrop : photo.backdrop) backdrop = cut(backdrop, window);
}

double told_of_motion(const Photo& photo, int plane, int halvings) {
  PhotoPlane at{photo.planes[plane], photo.sigma[plane], photo.valid, nullptr};
  for (int i = 0; i < halvings; ++i) halve(&at);
  // A pixel is 2^halvings of the whole photo's wide: its slope is that much larger.
  return information(at) / std::pow(4.0, halvings);
}

PhotoReading reading_of(const Photo& photo, const Camera& camera, const SurfaceMesh& surface,
                        const FitLimits& limits) {
  PhotoReading out;
  const double most = limits.pixels;
  if (most <= 0.0 || double(camera.width) * camera.height <= most) return out;
  out.body_px = body_pixels(camera, surface);
  const bool silhouette = photo.kind == PhotoSpec::Kind::silhouette;
  const int plane = photo.planes.size() == 3 ? 1 : 0;
  const double all = silhouette ? 1.0 : told_of_motion(photo, plane, 0);
  while (out.body_px > most && out.halvings < kMostHalvings && all > 0.0) {
    // A silhouette's rim is as sharp in larger pixels, which tell of its place by their grey.
    const double kept =
        silhouette ? 1.0 : std::min(1.0, told_of_motion(photo, plane, out.halvings + 1) / all);
    if (kept < limits.pixels_keep) break;
    out.kept = kept;
    ++out.halvings;
    out.body_px /= 4.0;
  }
  if (out.body_px > most && !silhouette) {
    out.share = most / out.body_px;
    out.body_px = most;
  }
  return out;
}

PhotoReading within_memory(PhotoReading reading, const Camera& camera, const SurfaceMesh& surface,
                           double photos, double planes, double bytes) {
  // Value and sigma of every plane, and what counts; a third more for the coarse levels.
  const double of_pixel = (2.0 * sizeof(float) * planes + 1.0) * 4.0 / 3.0;
  for (; reading.halvings < kMostHalvings; ++reading.halvings) {
    const int width = camera.width >> reading.halvings, height = camera.height >> reading.halvings;
    const PhotoWindow body = window_of_body(camera, surface, reading.halvings);
    const PhotoWindow room = with_margin(body, width, height);
    const double pixels = room.empty() ? double(width) * height : double(room.width) * room.height;
    if (photos * pixels * of_pixel <= bytes) break;
    // Bodies move: what a window leaves out is a guess until all photos are read.
    reading.for_memory = true;
    reading.share = 1.0;
    reading.body_px /= 4.0;
  }
  return reading;
}

double decoding_bytes(const Camera& camera) {
  // Of three channels the codes, the values and the means of neighbours; plane and sigma, what
  // counts.
  return double(camera.width) * camera.height * (3 * 9.0 + 10.0);
}

PhotoWindow PhotoWindow::with(const PhotoWindow& other) const {
  if (empty()) return other;
  if (other.empty()) return *this;
  const int x0 = std::min(x, other.x), y0 = std::min(y, other.y);
  return {x0, y0, std::max(x + width, other.x + other.width) - x0,
          std::max(y + height, other.y + other.height) - y0};
}

PhotoWindow window_of_body(const Camera& camera, const SurfaceMesh& surface, int halvings) {
  PhotoReading halved_only;
  halved_only.halvings = halvings;
  const Camera small = as_read(camera, halved_only);
  Eigen::Vector2d low(1e30, 1e30), high = -low;
  for (Eigen::Index v = 0; v < surface.X.cols(); ++v) {
    const Eigen::Vector2d px = small.project(surface.X.col(v));
    if (!px.allFinite()) return {0, 0, small.width, small.height};  // behind the camera
    low = low.cwiseMin(px), high = high.cwiseMax(px);
  }
  const auto within = [](double at, int size) {
    return static_cast<int>(std::clamp(std::floor(at), 0.0, double(size)));
  };
  const int x = within(low.x(), small.width), y = within(low.y(), small.height);
  return {x, y, within(high.x() + 1.0, small.width) - x, within(high.y() + 1.0, small.height) - y};
}

PhotoWindow changed_between(const Photo& one, const Photo& other) {
  constexpr int kCoarser = 2;      // halvings: single pixels are noise
  constexpr double kSigmas = 8.0;  // of the difference: no pixel of a thousand photos by chance
  PhotoWindow out;
  for (size_t plane = 0; plane < one.planes.size() && plane < other.planes.size(); ++plane) {
    Image a = one.planes[plane], b = other.planes[plane];
    Image sigma_a = one.sigma[plane], sigma_b = other.sigma[plane];
    for (int i = 0; i < kCoarser; ++i) {
      a = halved(a), b = halved(b);
      sigma_a = halved_sigma(sigma_a), sigma_b = halved_sigma(sigma_b);
    }
    const int size = 1 << kCoarser;
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x)
        if (std::abs(a.at(x, y) - b.at(x, y)) >
            kSigmas * std::hypot(sigma_a.at(x, y), sigma_b.at(x, y)))
          out = out.with({x * size, y * size, size, size});
  }
  return out;
}

PhotoWindow with_margin(const PhotoWindow& window, int width, int height) {
  constexpr double kMargin = 0.06;  // of the window's longer side
  constexpr int kStep = 16;         // px: cells of motions lie as in the whole photo
  constexpr double kWorth = 0.8;    // of the photo
  constexpr int kLeast = 128;       // px: coarse pictures are a 32nd of it
  if (window.empty()) return {};    // the camera looks past the body, and nothing moves
  const auto margin =
      static_cast<int>(std::lround(kMargin * std::max(window.width, window.height))) + kStep;
  const int x0 = std::max(0, (window.x - margin) / kStep * kStep);
  const int y0 = std::max(0, (window.y - margin) / kStep * kStep);
  const int x1 = std::min(width, std::max(window.x + window.width + margin, x0 + kLeast));
  const int y1 = std::min(height, std::max(window.y + window.height + margin, y0 + kLeast));
  if (x1 - x0 < kLeast || y1 - y0 < kLeast) return {};  // at the far border
  if (double(x1 - x0) * (y1 - y0) > kWorth * width * height) return {};
  return {x0, y0, x1 - x0, y1 - y0};
}

Camera as_read(const Camera& camera, const PhotoReading& reading) {
  Camera out = camera.resized(std::pow(0.5, reading.halvings));
  out.width = camera.width >> reading.halvings;
  out.height = camera.height >> reading.halvings;
  if (reading.window.empty()) return out;
  out.cx -= reading.window.x, out.cy -= reading.window.y;
  out.width = reading.window.width, out.height = reading.window.height;
  return out;
}

Camera as_taken(const Camera& read, const PhotoReading& reading) {
  const int side = 1 << reading.halvings;
  Camera out = read.resized(side);
  out.width = read.width * side, out.height = read.height * side;
  return out;
}

Photo as_read(Photo photo, const PhotoReading& reading, const std::string& name) {
  for (int i = 0; i < reading.halvings; ++i) {
    photo.valid =
        halved_valid(photo.valid, photo.planes.front()->width, photo.planes.front()->height);
    for (auto& plane : photo.planes) plane = halved(plane);
    for (auto& sigma : photo.sigma) sigma = halved_sigma(sigma);
    for (auto& backdrop : photo.backdrop) backdrop = halved(backdrop);
  }
  cut(photo, reading.window);
  if (reading.share < 1.0) keep_tiles(photo, reading.share, name);
  return photo;
}

std::string described(const std::string& camera, const PhotoReading& reading) {
  std::string how;
  if (reading.halvings > 0)
    how = fmt::format("at 1/{} of their width, which keeps {:.0f} % of what they tell of motion",
                      1 << reading.halvings, 100.0 * reading.kept);
  if (reading.share < 1.0)
    how += fmt::format("{}in {:.0f} % of their tiles", how.empty() ? "" : ", and ",
                       100.0 * reading.share);
  if (reading.for_memory) how += ", as memory (--memory) allows no more";
  if (!reading.window.empty())
    how += fmt::format("{}in the {} x {} pixels where the body is or anything changes",
                       how.empty() ? "" : ", ", reading.window.width, reading.window.height);
  return fmt::format(
      "photos of camera {} are compared {}: {:.2g} million pixels of the body a "
      "photo (--set fit.pixels=0 takes all)",
      camera, how, reading.body_px / 1e6);
}

}  // namespace hookeye
