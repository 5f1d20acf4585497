#include "estimation/synth/synth_body.h"

#include <algorithm>
#include <cmath>

#include "estimation/synth/synth_atlas.h"
#include "meshing/body.h"

namespace hookeye::detail {

using Eigen::Vector2d;

std::mt19937_64 random_of(unsigned seed, const std::string& purpose) {
  std::vector<unsigned> words = {seed};
  words.insert(words.end(), purpose.begin(), purpose.end());
  std::seed_seq sequence(words.begin(), words.end());
  return std::mt19937_64(sequence);
}

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

namespace {

/// Low waves over the wall: displacement in units of the largest bump, zero at bottom and top.
class Bumps {
 public:
  Bumps(unsigned seed, ShapeRecipe::Kind kind) : blob_(kind == ShapeRecipe::Kind::blob) {
    auto random = random_of(seed, "bumps");
    for (Wave& wave : waves_) {
      wave.around = 1 + static_cast<int>(uniform(random, 0.0, 3.0));
      wave.up = uniform(random, 0.7, 2.2);
      wave.phase = uniform(random, 0.0, 2.0 * EIGEN_PI);
      wave.phase_up = uniform(random, 0.0, 2.0 * EIGEN_PI);
    }
  }
  double at(double angle, double height) const {
    double sum = 0.0;
    for (const Wave& wave : waves_)
      sum += std::cos(wave.around * angle + wave.phase) *
             std::sin(2.0 * EIGEN_PI * wave.up * height + wave.phase_up);
    return std::sin(EIGEN_PI * height) * sum / 4.0;
  }
  /// Width of the body at a height over that at the bottom.
  double profile(double height, double taper) const {
    const double straight = 1.0 + (taper - 1.0) * height;
    return blob_ ? straight * (1.0 + 0.35 * std::sin(EIGEN_PI * height)) : straight;
  }

 private:
  struct Wave {
    int around;
    double up, phase, phase_up;
  };
  std::array<Wave, 4> waves_;
  bool blob_;
};

/// Grid of the caps, whose rim carries the wall.
class Grid {
 public:
  Grid(const Recipe& recipe)
      : shape_(recipe.shape),
        bumps_(recipe.seed, shape_.kind),
        nx_(count(shape_.size.x())),
        ny_(count(shape_.size.y())),
        nz_(count(shape_.size.z())) {
    for (int i = 0; i < nx_; ++i) rim_.push_back({i, 0});
    for (int j = 0; j < ny_; ++j) rim_.push_back({nx_, j});
    for (int i = nx_; i > 0; --i) rim_.push_back({i, ny_});
    for (int j = ny_; j > 0; --j) rim_.push_back({0, j});
  }
  int nx() const { return nx_; }
  int ny() const { return ny_; }
  int nz() const { return nz_; }
  int rim() const { return static_cast<int>(rim_.size()); }
  std::array<int, 2> rim_node(int k) const { return rim_[k % rim_.size()]; }

  /// Point of the cap in the bottom's measures. A circle by the elliptical map of the square
  /// (x sqrt(1 - y^2/2), y sqrt(1 - x^2/2)).
  Vector2d cap(int i, int j) const {
    double x = 2.0 * i / nx_ - 1.0, y = 2.0 * j / ny_ - 1.0;
    if (shape_.kind != ShapeRecipe::Kind::block) {
      const double round_x = x * std::sqrt(1.0 - 0.5 * y * y);
      y *= std::sqrt(1.0 - 0.5 * x * x);
      x = round_x;
    }
    return {0.5 * shape_.size.x() * x, 0.5 * shape_.size.y() * y};
  }
  Vector3d point(int i, int j, double height) const {
    Vector2d at = bumps_.profile(height, shape_.taper) * cap(i, j);
    const bool wall = i == 0 || j == 0 || i == nx_ || j == ny_;
    if (wall && height > 0.0 && height < 1.0) {
      const double bump = shape_.bumps * std::min(shape_.size.x(), shape_.size.y());
      at += bump * bumps_.at(std::atan2(at.y(), at.x()), height) * at.normalized();
    }
    return {at.x(), at.y(), height * shape_.size.z()};
  }

 private:
  int count(double length) const {
    return std::max(2, static_cast<int>(std::lround(length / shape_.facet)));
  }
  ShapeRecipe shape_;
  Bumps bumps_;
  int nx_, ny_, nz_;
  std::vector<std::array<int, 2>> rim_;
};

/// Discs of random place and size with soft edges on a bright ground. 1 channel, linear.
Image speckles(const Recipe& recipe, const Vector2d& atlas) {
  const TextureRecipe& texture = recipe.texture;
  auto random = random_of(recipe.seed, "texture");
  const int width = std::max(8, static_cast<int>(std::lround(atlas.x() / texture.texel)));
  const int height = std::max(8, static_cast<int>(std::lround(atlas.y() / texture.texel)));
  Image image{width, height, 1, {}};
  image.values.assign(image.pixels(), static_cast<float>(texture.bright));
  const double mean_area = 0.25 * EIGEN_PI * texture.speckle * texture.speckle;
  // discs overlap: a share 1 - exp(-n a/A) is covered by n of them
  const int count = static_cast<int>(-std::log(1.0 - texture.cover) * atlas.prod() / mean_area);
  const double soft = std::max(1.5, texture.soft * texture.speckle / texture.texel);  // [texels]
  for (int s = 0; s < count; ++s) {
    const double x = uniform(random, 0.0, width), y = uniform(random, 0.0, height);
    const double radius = 0.5 * texture.speckle * uniform(random, 0.6, 1.35) / texture.texel;
    const double grey = texture.dark + 0.35 * uniform(random, 0.0, 1.0) *
                                           uniform(random, 0.0, 1.0) *
                                           (texture.bright - texture.dark);
    const int reach = static_cast<int>(std::ceil(radius + soft));
    for (int v = std::max(0, static_cast<int>(y) - reach);
         v <= std::min(height - 1, static_cast<int>(y) + reach); ++v)
      for (int u = std::max(0, static_cast<int>(x) - reach);
           u <= std::min(width - 1, static_cast<int>(x) + reach); ++u) {
        const double inside = radius - std::hypot(u + 0.5 - x, v + 0.5 - y);
        const double edge = std::clamp(0.5 + inside / soft, 0.0, 1.0);
        const double share = edge * edge * (3.0 - 2.0 * edge);  // no kinks
        float& value = image.at(u, v);
        value = static_cast<float>((1.0 - share) * value + share * std::min<double>(value, grey));
      }
  }
  return image;
}

/// Area and centroid of some triangles.
SynthBody::Patch patch(const SurfaceMesh& surface, const std::vector<int>& triangles) {
  double area = 0.0;
  Vector3d moment = Vector3d::Zero();
  for (const int t : triangles) {
    const Vector3d a = surface.X.col(surface.triangles[t][0]);
    const Vector3d b = surface.X.col(surface.triangles[t][1]);
    const Vector3d c = surface.X.col(surface.triangles[t][2]);
    const double part = 0.5 * (b - a).cross(c - a).norm();
    area += part;
    moment += part * (a + b + c) / 3.0;
  }
  return {area, area > 0.0 ? Vector3d(moment / area) : moment};
}

class Builder {
 public:
  explicit Builder(const Recipe& recipe)
      : recipe_(recipe), grid_(recipe), size_(recipe.shape.size) {
    for (int k = 0; k < grid_.rim(); ++k) {
      const auto [i, j] = grid_.rim_node(k);
      const auto [i2, j2] = grid_.rim_node(k + 1);
      along_.push_back(along_.back() + (grid_.cap(i2, j2) - grid_.cap(i, j)).norm());
    }
    gap_ = 0.03 * size_.z();
  }

  SynthBody build() {
    wall();
    cap(0.0);
    cap(1.0);
    body_.surface.X.resize(3, static_cast<Eigen::Index>(points_.size()));
    for (size_t v = 0; v < points_.size(); ++v) body_.surface.X.col(v) = points_[v];
    atlas_ = {along_.back() + 2.0 * gap_ + size_.x(),
              std::max(size_.z(), 2.0 * size_.y() + gap_) + gap_};
    for (auto& corners : body_.surface.uv)
      for (Vector2d& uv : corners) uv = uv.cwiseQuotient(atlas_);
    body_.albedo = speckles(recipe_, atlas_);
    regions();
    return std::move(body_);
  }

 private:
  struct Corner {
    Vector3d x;
    Vector2d uv;  ///< [length]
  };

  int vertex(const Vector3d& x) {
    const std::array<double, 3> key = {x.x(), x.y(), x.z()};
    const auto [found, fresh] = index_.try_emplace(key, static_cast<int>(points_.size()));
    if (fresh) points_.push_back(x);
    return found->second;
  }
  void triangle(const Corner& a, const Corner& b, const Corner& c) {
    body_.surface.triangles.push_back({vertex(a.x), vertex(b.x), vertex(c.x)});
    body_.surface.uv.push_back({a.uv, b.uv, c.uv});
  }

  void wall() {
    const auto corner = [&](int k, int level) {
      const auto [i, j] = grid_.rim_node(k);
      const double height = static_cast<double>(level) / grid_.nz();
      return Corner{grid_.point(i, j, height), {along_[k], height * size_.z() + 0.5 * gap_}};
    };
    for (int k = 0; k < grid_.rim(); ++k)
      for (int level = 0; level < grid_.nz(); ++level) {
        const Corner a = corner(k, level), b = corner(k + 1, level);
        const Corner c = corner(k + 1, level + 1), d = corner(k, level + 1);
        const Vector3d centre = 0.25 * (a.x + b.x + c.x + d.x);
        const int first = static_cast<int>(body_.surface.triangles.size());
        // alternate diagonals: no preferred direction
        if ((k + level) % 2 == 0) {
          triangle(a, b, c);
          triangle(a, c, d);
        } else {
          triangle(a, b, d);
          triangle(b, c, d);
        }
        const double height = centre.z() / size_.z();
        if (height > 0.45 && height < 0.7 && centre.x() > 0.35 * size_.x() &&
            std::abs(centre.y()) < 0.3 * size_.y())
          for (int t = first; t < first + 2; ++t) side_.push_back(t);
      }
  }

  void cap(double height) {
    const Vector2d corner_uv(
        along_.back() + gap_ + 0.5 * size_.x(),
        0.5 * gap_ + (height > 0.0 ? 1.5 * size_.y() + gap_ : 0.5 * size_.y()));
    const auto corner = [&](int i, int j) {
      return Corner{grid_.point(i, j, height), corner_uv + grid_.cap(i, j)};
    };
    for (int i = 0; i < grid_.nx(); ++i)
      for (int j = 0; j < grid_.ny(); ++j) {
        Corner a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1),
               d = corner(i, j + 1);
        if (height == 0.0) std::swap(b, d);  // seen from below
        const int first = static_cast<int>(body_.surface.triangles.size());
        // Diagonals run towards the middle: on a circle a corner of the grid is nearly straight.
        const bool low = 2 * i < grid_.nx(), near = 2 * j < grid_.ny();
        if (low == near) {
          triangle(a, b, c);
          triangle(a, c, d);
        } else {
          triangle(a, b, d);
          triangle(b, c, d);
        }
        if (height > 0.0)
          for (int t = first; t < first + 2; ++t) grip_.push_back(t);
      }
  }

  void regions() {
    const Matrix3Xd& X = body_.surface.X;
    const double margin = 0.1 * size_.z(), thin = 0.0005 * size_.z();
    const Vector3d low = X.rowwise().minCoeff(), high = X.rowwise().maxCoeff();
    const auto add = [&](const char* name, auto shape) {
      RegionSpec region;
      region.name = name;
      region.shape = std::move(shape);
      body_.regions.push_back(std::move(region));
    };
    add("base", RegionSpec::Box{{low.x() - margin, low.y() - margin, -thin},
                                {high.x() + margin, high.y() + margin, thin}});
    for (const auto& [name, triangles] : {std::pair("grip", grip_), std::pair("side", side_)}) {
      if (triangles.empty()) continue;
      add(name, RegionSpec::Faces{.file = {}, .triangles = triangles, .told = {}, .told_at = {}});
      body_.patches[name] = patch(body_.surface, triangles);
    }
    if (!side_.empty()) return;
    for (const ExampleRecipe& example : recipe_.examples)
      if (example.region == "side")
        throw InputError(example.place, "the surface is too coarse for the region `side`",
                         "a smaller `facet` of the body");
  }

  const Recipe& recipe_;
  Grid grid_;
  Vector3d size_;
  double gap_;
  Vector2d atlas_;                     ///< its width and height [length]
  std::vector<int> grip_, side_;       ///< triangles
  std::vector<double> along_ = {0.0};  ///< length of the rim up to each of its nodes
  std::map<std::array<double, 3>, int> index_;
  std::vector<Vector3d> points_;
  SynthBody body_;
};

/// The surface as it is told, with the regions on the mesh that the capture will make of it.
SynthBody own_body(const Recipe& recipe) {
  SynthBody out;
  out.surface = *recipe.shape.surface;
  Capture capture;
  capture.body.surface = recipe.shape.file.path;
  capture.body.surface_place = recipe.shape.file.place;
  capture.body.edge = recipe.edge;
  capture.body.order = 1;
  capture.body.mesh_given = true;
  capture.regions = out.regions = recipe.regions;
  const Body body = make_body(capture);
  for (const RegionSpec& region : recipe.regions) {
    const Region& on_mesh = body.regions.at(region.name);
    out.patches[region.name] = {on_mesh.area, on_mesh.centroid};
  }
  if (recipe.texture.image.path.empty())
    out.albedo = speckled_atlas(recipe, out.surface);
  else
    out.albedo = luminance(read_image(recipe.texture.image, recipe.texture.encoding));
  return out;
}

}  // namespace

SynthBody make_synth_body(const Recipe& recipe) {
  return recipe.shape.own() ? own_body(recipe) : Builder(recipe).build();
}

}  // namespace hookeye::detail
