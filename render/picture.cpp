#include "render/picture.h"

#include <algorithm>
#include <cmath>

namespace hookeye {

namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;
using PhotoRow = Eigen::Matrix<float, kPhotoColumns, 1>;

/// Sums over the rays of one pixel that hit one triangle.
struct Group {
  int triangle;
  Matrix3f d_position, d_normal, d_reference;
  Vector3f by_facet;
};

/// A ray's intensity and derivatives, kept until all pixels that it reaches have been summed.
struct RayShade {
  int triangle;
  float I;
  Vector3f bary, by_motion, by_normal, by_facet, by_reference;
  PhotoRow photo;
};

/// The rays of a band of pixel rows.
class Band {
 public:
  Band(const BandTask& task, int row, int last_row) : task_(task), row_(row) {
    const int n = task.filter.n, m = task.filter.margin;
    const View& view = task.frame.view;
    column0_ = view.x0 * n - m, row0_ = row * n - m;
    columns_ = (view.x1 - view.x0) * n + 2 * m, rows_ = (last_row - row) * n + 2 * m;
    rays_.resize(static_cast<size_t>(columns_) * rows_);
    // Blocks of 4 x 4 rays stay together in the tree.
    for (int y = 0; y < rows_; y += 4)
      for (int x = 0; x < columns_; x += 4) follow_block(x, y);
  }
  /// Ray of tap (i, j) of a pixel; the next taps of the row follow it.
  const RayShade* at(int x, int y, int i, int j) const {
    const int n = task_.filter.n;
    return &rays_[static_cast<size_t>((y - row_) * n + j) * columns_ +
                  (x - task_.frame.view.x0) * n + i];
  }

 private:
  void follow_block(int x, int y) {
    Vector2d h[16];
    Sample sample[16];
    const int w = std::min(4, columns_ - x), rows = std::min(4, rows_ - y);
    for (int i = 0; i < w * rows; ++i) h[i] = task_.grid.h(column0_ + x + i % w, row0_ + y + i / w);
    trace(task_.frame, h, w * rows, sample);
    for (int i = 0; i < w * rows; ++i)
      look(sample[i], &rays_[static_cast<size_t>(y + i / w) * columns_ + x + i % w]);
  }

  void look(const Sample& s, RayShade* out) const {
    out->triangle = s.triangle;
    out->I = static_cast<float>(task_.frame.photo.background);
    if (s.triangle < 0) return;
    const bool derivatives = task_.frame.options.derivatives;
    const Shade shaded = shade(task_.frame, s, derivatives);
    out->I = static_cast<float>(shaded.I);
    out->bary = s.bary.cast<float>();
    if (!derivatives) return;
    out->by_motion = shaded.by_motion.cast<float>();
    out->by_normal = shaded.by_normal.cast<float>();
    out->by_facet = shaded.by_facet.cast<float>();
    out->by_reference = shaded.by_reference.cast<float>();
    out->photo = shaded.photo.cast<float>();
  }

  const BandTask& task_;
  int row_, column0_, row0_, columns_, rows_;
  std::vector<RayShade> rays_;
};

/// The triangle's own unit normal n = c/|c|, c = e1 x e2, moves with its corners.
void add_facet_normal(const Frame& f, Group* g) {
  const auto& t = f.surface.triangles[g->triangle];
  const Vector3d e1 = f.x.col(t[1]) - f.x.col(t[0]), e2 = f.x.col(t[2]) - f.x.col(t[0]);
  const double length = e1.cross(e2).norm();
  if (length <= 0) return;
  const Vector3d n = f.facets[g->triangle], by_n = g->by_facet.cast<double>();
  const Vector3d m = (by_n - n * n.dot(by_n)) / length;
  const Vector3f by1 = e2.cross(m).cast<float>(), by2 = m.cross(e1).cast<float>();
  g->d_position.col(1) += by1;
  g->d_position.col(2) += by2;
  g->d_position.col(0) -= by1 + by2;
}

class PixelSum {
 public:
  PixelSum(const BandTask& task, const Band& band) : task_(task), band_(band) {}

  /// Filtered intensity, coverage and, where wanted, the derivative of pixel (x, y).
  void add(int x, int y, Rendering* out, BandDerivative* derivative) {
    const PixelFilter& filter = task_.filter;
    const int taps = filter.taps();
    double I = 0, coverage = 0, missing = 0;
    for (int j = 0; j < taps; ++j) {
      const RayShade* ray = band_.at(x, y, 0, j);
      for (int i = 0; i < taps; ++i) {
        const double w = filter.weight(i, j);
        I += w * ray[i].I;
        (ray[i].triangle >= 0 ? coverage : missing) += w;
      }
    }
    if (coverage == 0) return;
    const int pixel = y * out->I.width + x;
    out->I.at(x, y) = static_cast<float>(I);
    out->coverage.at(x, y) = missing == 0 ? 1.0f : static_cast<float>(coverage);
    if (!task_.frame.options.derivatives || (!task_.silhouette && missing > 1e-6) ||
        (task_.count && !(*task_.count)[pixel]))
      return;
    groups_.clear();
    photo_.setZero();
    for (int j = 0; j < taps; ++j) {
      const RayShade* ray = band_.at(x, y, 0, j);
      for (int i = 0; i < taps; ++i)
        if (ray[i].triangle >= 0) add_ray(ray[i], static_cast<float>(filter.weight(i, j)));
    }
    photo_[kBackground] = static_cast<float>(missing);
    store(pixel, derivative);
  }

 private:
  Group& group_of(int triangle) {
    for (Group& g : groups_)
      if (g.triangle == triangle) return g;
    Group& g = groups_.emplace_back();
    g.triangle = triangle;
    g.d_position.setZero();
    g.d_normal.setZero();
    g.d_reference.setZero();
    g.by_facet.setZero();
    return g;
  }

  void add_ray(const RayShade& ray, float weight) {
    Group& group = group_of(ray.triangle);
    const Vector3f b = weight * ray.bary;
    group.d_position.noalias() += ray.by_motion * b.transpose();
    if (task_.frame.photo.shaded) {
      group.d_normal.noalias() += ray.by_normal * b.transpose();
      group.by_facet += weight * ray.by_facet;
    }
    if (task_.frame.spline) group.d_reference.noalias() += ray.by_reference * b.transpose();
    photo_ += weight * ray.photo;
  }

  void store(int pixel, BandDerivative* out) {
    for (Group& g : groups_) {
      if (task_.frame.photo.shaded) add_facet_normal(task_.frame, &g);
      out->segments.push_back({g.triangle, g.d_position, g.d_normal, g.d_reference});
    }
    out->pixel.push_back(pixel);
    out->first.push_back(static_cast<int>(out->segments.size()));
    out->photo.push_back(photo_);
  }

  const BandTask& task_;
  const Band& band_;
  std::vector<Group> groups_;
  PhotoRow photo_;
};

/// Triangle and barycentric coordinates under the centres of a row's pixels.
void mark_centres(const BandTask& task, const Band& band, int y, Rendering* out) {
  const View& view = task.frame.view;
  const PixelFilter& filter = task.filter;
  const auto mark = [&](int x, int triangle, float b1, float b2) {
    const size_t pixel = static_cast<size_t>(y) * out->I.width + x;
    out->triangle[pixel] = triangle;
    if (triangle >= 0) out->uv[pixel] = {b1, b2};
  };
  if (filter.n % 2 == 1) {
    const int middle = filter.margin + filter.n / 2;
    for (int x = view.x0; x < view.x1; ++x) {
      const RayShade& ray = *band.at(x, y, middle, middle);
      mark(x, ray.triangle, ray.bary[1], ray.bary[2]);
    }
    return;
  }
  for (int x = view.x0; x < view.x1; x += 16) {
    Vector2d h[16];
    Sample sample[16];
    const int count = std::min(16, view.x1 - x);
    const int half = filter.n / 2;  // the mean of the four middle rays is the centre
    for (int i = 0; i < count; ++i)
      h[i] = (task.grid.h((x + i) * filter.n + half - 1, y * filter.n + half - 1) +
              task.grid.h((x + i) * filter.n + half, y * filter.n + half)) /
             2;
    trace(task.frame, h, count, sample);
    for (int i = 0; i < count; ++i)
      mark(x + i, sample[i].triangle, float(sample[i].bary[1]), float(sample[i].bary[2]));
  }
}

}  // namespace

void render_band(const BandTask& task, int row, int last_row, Rendering* out,
                 BandDerivative* derivative) {
  const View& view = task.frame.view;
  if (view.x1 <= view.x0) return;
  const Band band(task, row, last_row);
  PixelSum sum(task, band);
  for (int y = row; y < last_row; ++y) {
    for (int x = view.x0; x < view.x1; ++x) sum.add(x, y, out, derivative);
    mark_centres(task, band, y, out);
  }
}

namespace {

/// Adds an edge's share to the segment of its triangle among segments[begin, end).
void add_edge(const EdgeSegment& e, size_t begin, ImageDerivative* out) {
  for (size_t s = begin; s < out->segments.size(); ++s)
    if (out->segments[s].triangle == e.triangle) {
      out->segments[s].d_position += e.d_position.cast<float>();
      return;
    }
  out->segments.push_back(
      {e.triangle, e.d_position.cast<float>(), Eigen::Matrix3f::Zero(), Eigen::Matrix3f::Zero()});
}

}  // namespace

ImageDerivative join(const std::vector<BandDerivative>& bands, std::vector<EdgeSegment> edges,
                     const BandTask& task) {
  std::stable_sort(edges.begin(), edges.end(),
                   [](const EdgeSegment& a, const EdgeSegment& b) { return a.pixel < b.pixel; });
  ImageDerivative out;
  std::vector<PhotoRow> photo;
  size_t pixels = 0, segments = 0;
  for (const BandDerivative& b : bands) pixels += b.pixel.size(), segments += b.segments.size();
  out.pixel.reserve(pixels), out.first.reserve(pixels + 1), photo.reserve(pixels);
  out.segments.reserve(segments + edges.size());
  out.first.push_back(0);
  size_t e = 0;
  const auto take_edges = [&](int pixel) {
    const size_t begin = out.first.back();
    for (; e < edges.size() && edges[e].pixel == pixel; ++e) {
      add_edge(edges[e], begin, &out);
      photo.back().head<7>() += edges[e].d_camera.cast<float>();
    }
  };
  const auto close = [&](int pixel) {
    out.pixel.push_back(pixel);
    out.first.push_back(static_cast<int>(out.segments.size()));
  };
  // Pixels that only an edge reaches: the background alone is there.
  const auto edges_before = [&](int pixel) {
    while (e < edges.size() && edges[e].pixel < pixel) {
      const int p = edges[e].pixel;
      if (!task.silhouette || (task.count && !(*task.count)[p])) {
        ++e;
        continue;
      }
      photo.emplace_back().setZero();
      photo.back()[kBackground] = 1;
      take_edges(p);
      close(p);
    }
  };
  for (const BandDerivative& b : bands)
    for (size_t i = 0; i < b.pixel.size(); ++i) {
      edges_before(b.pixel[i]);
      for (int s = i ? b.first[i - 1] : 0; s < b.first[i]; ++s)
        out.segments.push_back(b.segments[s]);
      photo.push_back(b.photo[i]);
      take_edges(b.pixel[i]);
      close(b.pixel[i]);
    }
  edges_before(std::numeric_limits<int>::max());
  out.d_photo.resize(kPhotoColumns, static_cast<Eigen::Index>(photo.size()));
  for (size_t i = 0; i < photo.size(); ++i) out.d_photo.col(i) = photo[i];
  return out;
}

}  // namespace hookeye
