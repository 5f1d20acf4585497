#include "estimation/synth/synth_atlas.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "estimation/synth/synth_body.h"

namespace hookeye::detail {

using Eigen::Vector2d;

namespace {

/// Texels around a patch that go on beyond its rim: two are left at a quarter of the size.
constexpr int kMargin = 8;
constexpr int kLargest = 8192;  ///< side of the picture

double area_of(const SurfaceMesh& surface, int triangle) {
  const auto& t = surface.triangles[triangle];
  const Vector3d a = surface.X.col(t[0]), b = surface.X.col(t[1]), c = surface.X.col(t[2]);
  return 0.5 * (b - a).cross(c - a).norm();
}

}  // namespace

Speckles::Speckles(const TextureRecipe& texture, const SurfaceMesh& surface, std::mt19937_64 random)
    : bright_(texture.bright),
      soft_(std::max(1.5 * texture.texel, texture.soft * texture.speckle)) {
  std::vector<double> up_to = {0.0};
  for (size_t t = 0; t < surface.triangles.size(); ++t)
    up_to.push_back(up_to.back() + area_of(surface, static_cast<int>(t)));
  // balls overlap: a share 1 - exp(-n a/A) is covered by n of them
  const double mean_area = 0.25 * EIGEN_PI * texture.speckle * texture.speckle;
  const auto count = static_cast<int>(-std::log(1.0 - texture.cover) * up_to.back() / mean_area);
  double largest = 0.0;
  for (int i = 0; i < count; ++i) {
    const double at = uniform(random, 0.0, up_to.back());
    const auto t =
        std::min<size_t>(std::upper_bound(up_to.begin(), up_to.end(), at) - up_to.begin() - 1,
                         surface.triangles.size() - 1);
    const double root = std::sqrt(uniform(random, 0.0, 1.0)), along = uniform(random, 0.0, 1.0);
    const auto& corners = surface.triangles[t];
    Ball ball;
    ball.centre = (1.0 - root) * surface.X.col(corners[0]) +
                  root * (1.0 - along) * surface.X.col(corners[1]) +
                  root * along * surface.X.col(corners[2]);
    ball.radius = 0.5 * texture.speckle * uniform(random, 0.6, 1.35);
    ball.grey = texture.dark + 0.35 * uniform(random, 0.0, 1.0) * uniform(random, 0.0, 1.0) *
                                   (texture.bright - texture.dark);
    largest = std::max(largest, ball.radius + soft_);
    balls_.push_back(ball);
  }
  cell_ = 2.0 * largest;
  for (size_t i = 0; i < balls_.size(); ++i) {
    const Vector3d reach = Vector3d::Constant(balls_[i].radius + soft_);
    const auto low = cell_of(balls_[i].centre - reach), high = cell_of(balls_[i].centre + reach);
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int z = low[2]; z <= high[2]; ++z) near_[{x, y, z}].push_back(static_cast<int>(i));
  }
}

std::array<int, 3> Speckles::cell_of(const Vector3d& X) const {
  std::array<int, 3> cell;
  for (int i = 0; i < 3; ++i) cell[i] = static_cast<int>(std::floor(X[i] / cell_));
  return cell;
}

float Speckles::at(const Vector3d& X) const {
  double value = bright_;
  const auto found = near_.find(cell_of(X));
  if (found == near_.end()) return static_cast<float>(value);
  for (const int i : found->second) {
    const Ball& ball = balls_[i];
    const double inside = ball.radius - (X - ball.centre).norm();
    const double edge = std::clamp(0.5 + inside / soft_, 0.0, 1.0);
    const double share = edge * edge * (3.0 - 2.0 * edge);  // no kinks
    value = (1.0 - share) * value + share * std::min(value, ball.grey);
  }
  return static_cast<float>(value);
}

namespace {

/// Triangles that touch one another and face the same side of a cube.
struct Patch {
  int side = 0;  ///< 2 axis + (0: towards +, 1: towards -)
  std::vector<int> triangles;
  Vector2d low = Vector2d::Zero();  ///< least projected coordinates [length]
  int width = 0, height = 0;        ///< with margins [texels]
  int left = 0, bottom = 0;         ///< in the atlas, rows counted upwards [texels]
};

int side_of(const SurfaceMesh& surface, int triangle) {
  const auto& t = surface.triangles[triangle];
  const Vector3d a = surface.X.col(t[0]), b = surface.X.col(t[1]), c = surface.X.col(t[2]);
  const Vector3d normal = (b - a).cross(c - a);
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return 2 * axis + (normal[axis] < 0.0);
}

/// As seen from outside, counter-clockwise.
Vector2d projected(const Vector3d& X, int side) {
  const int axis = side / 2;
  const double first = X[(axis + 1) % 3], second = X[(axis + 2) % 3];
  return side % 2 == 0 ? Vector2d(first, second) : Vector2d(second, first);
}

std::vector<Patch> patches_of(const SurfaceMesh& surface) {
  const int count = static_cast<int>(surface.triangles.size());
  std::map<std::pair<int, int>, std::vector<int>> across;
  std::vector<int> side(surface.triangles.size());
  for (int t = 0; t < count; ++t) {
    side[t] = side_of(surface, t);
    for (int k = 0; k < 3; ++k)
      across[std::minmax(surface.triangles[t][k], surface.triangles[t][(k + 1) % 3])].push_back(t);
  }
  std::vector<Patch> patches;
  std::vector<char> taken(surface.triangles.size(), 0);
  for (int seed = 0; seed < count; ++seed) {
    if (taken[seed]) continue;
    Patch patch;
    patch.side = side[seed];
    patch.triangles = {seed};
    taken[seed] = 1;
    for (size_t i = 0; i < patch.triangles.size(); ++i) {
      const auto corners = surface.triangles[patch.triangles[i]];
      for (int k = 0; k < 3; ++k)
        for (const int t : across.at(std::minmax(corners[k], corners[(k + 1) % 3])))
          if (!taken[t] && side[t] == patch.side) taken[t] = 1, patch.triangles.push_back(t);
    }
    patches.push_back(std::move(patch));
  }
  return patches;
}

void measure(const SurfaceMesh& surface, double texel, Patch& patch) {
  Vector2d high = Vector2d::Constant(-std::numeric_limits<double>::infinity());
  patch.low = -high;
  for (const int t : patch.triangles)
    for (const int v : surface.triangles[t]) {
      const Vector2d at = projected(surface.X.col(v), patch.side);
      patch.low = patch.low.cwiseMin(at);
      high = high.cwiseMax(at);
    }
  const Vector2d size = (high - patch.low) / texel;
  patch.width = static_cast<int>(std::min(1e6, std::ceil(size.x()))) + 2 * kMargin + 1;
  patch.height = static_cast<int>(std::min(1e6, std::ceil(size.y()))) + 2 * kMargin + 1;
}

/// Puts the patches on shelves, highest first. Returns width and height of the atlas [texels].
Eigen::Vector2i pack(std::vector<Patch>& patches) {
  double area = 0.0;
  int width = 0;
  for (const Patch& patch : patches) {
    area += static_cast<double>(patch.width) * patch.height;
    width = std::max(width, patch.width);
  }
  width = std::max(width, static_cast<int>(std::min(1.1 * std::sqrt(area), 1e6)));
  std::vector<size_t> order(patches.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return patches[a].height > patches[b].height; });
  int left = 0, bottom = 0, shelf = 0;
  for (const size_t i : order) {
    Patch& patch = patches[i];
    if (left + patch.width > width) left = 0, bottom += shelf, shelf = 0;
    patch.left = left;
    patch.bottom = bottom;
    left += patch.width;
    shelf = std::max(shelf, patch.height);
    if (bottom + shelf > kLargest) break;
  }
  return {width, bottom + shelf};
}

/// Nearest point of a triangle in the plane, as weights of its corners, and its distance.
std::pair<Vector3d, double> nearest(const std::array<Vector2d, 3>& corner, const Vector2d& p) {
  Eigen::Matrix2d sides;
  sides << corner[1] - corner[0], corner[2] - corner[0];
  const Vector2d inside = sides.inverse() * (p - corner[0]);
  const Vector3d weights(1.0 - inside.sum(), inside.x(), inside.y());
  if (weights.minCoeff() >= 0.0) return {weights, 0.0};
  std::pair<Vector3d, double> best{Vector3d::UnitX(), std::numeric_limits<double>::infinity()};
  for (int k = 0; k < 3; ++k) {
    const Vector2d from = corner[k], along = corner[(k + 1) % 3] - from;
    const double s = std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const double distance = (p - from - s * along).norm();
    if (distance >= best.second) continue;
    best.second = distance;
    best.first.setZero();
    best.first[k] = 1.0 - s;
    best.first[(k + 1) % 3] = s;
  }
  return best;
}

/// Every texel of the patch takes the grey of the triangle that it lies on, or next to.
void paint(const SurfaceMesh& surface, const Speckles& speckles, double texel, const Patch& patch,
           Image& atlas) {
  std::vector<float> distance(static_cast<size_t>(patch.width) * patch.height,
                              std::numeric_limits<float>::infinity());
  std::vector<Vector3d> place(distance.size());
  for (const int t : patch.triangles) {
    const auto& ids = surface.triangles[t];
    std::array<Vector2d, 3> corner;  // [texels] of the patch, centres at whole numbers
    for (int k = 0; k < 3; ++k)
      corner[k] =
          ((projected(surface.X.col(ids[k]), patch.side) - patch.low) / texel).array() + kMargin;
    const Vector2d low = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]);
    const Vector2d high = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]);
    for (int y = std::max(0, static_cast<int>(low.y()) - kMargin);
         y <= std::min(patch.height - 1, static_cast<int>(high.y()) + kMargin); ++y)
      for (int x = std::max(0, static_cast<int>(low.x()) - kMargin);
           x <= std::min(patch.width - 1, static_cast<int>(high.x()) + kMargin); ++x) {
        const size_t at = static_cast<size_t>(y) * patch.width + x;
        if (distance[at] == 0.0f) continue;
        const auto [weights, off] = nearest(corner, Vector2d(x, y));
        if (!(off < distance[at])) continue;
        distance[at] = static_cast<float>(off);
        place[at] = weights[0] * surface.X.col(ids[0]) + weights[1] * surface.X.col(ids[1]) +
                    weights[2] * surface.X.col(ids[2]);
      }
  }
  for (int y = 0; y < patch.height; ++y)
    for (int x = 0; x < patch.width; ++x) {
      const size_t at = static_cast<size_t>(y) * patch.width + x;
      if (!std::isinf(distance[at]))
        atlas.at(patch.left + x, atlas.height - 1 - patch.bottom - y) = speckles.at(place[at]);
    }
}

}  // namespace

Image speckled_atlas(const Recipe& recipe, SurfaceMesh& surface) {
  const double texel = recipe.texture.texel;
  std::vector<Patch> patches = patches_of(surface);
  for (Patch& patch : patches) measure(surface, texel, patch);
  const Eigen::Vector2i size = pack(patches);
  if (size.maxCoeff() > kLargest)
    throw InputError(
        recipe.texture.place,
        fmt::format("the texture would need more than {} x {} texels", kLargest, kLargest),
        fmt::format("a texel larger than {:.3g}, about half the length that one pixel "
                    "covers; or a surface of fewer, larger triangles",
                    texel));
  Image atlas{size.x(), size.y(), 1, {}};
  atlas.values.assign(atlas.pixels(), static_cast<float>(recipe.texture.bright));
  surface.uv.resize(surface.triangles.size());
  for (const Patch& patch : patches)
    for (const int t : patch.triangles)
      for (int k = 0; k < 3; ++k) {
        const Vector2d at =
            (projected(surface.X.col(surface.triangles[t][k]), patch.side) - patch.low) / texel;
        surface.uv[t][k] = {(patch.left + kMargin + at.x() + 0.5) / size.x(),
                            (patch.bottom + kMargin + at.y() + 0.5) / size.y()};
      }
  const Speckles speckles(recipe.texture, surface, random_of(recipe.seed, "texture"));
  tbb::parallel_for(size_t{0}, patches.size(),
                    [&](size_t i) { paint(surface, speckles, texel, patches[i], atlas); });
  return atlas;
}

}  // namespace hookeye::detail
