#include "render/picture.h"

#include <algorithm>
#include <limits>

#include "render/ray_sums.h"

namespace hookeye {

namespace {

using PhotoRow = Eigen::Matrix<float, kPhotoColumns, 1>;

constexpr int kTileRays = 144;  ///< along a row; the rays of a tile stay in the second-level cache

/// The rays of a rectangle of pixels and of the margin that their filter reaches.
class Tile {
 public:
  Tile(const BandTask& task, int column, int last_column, int row, int last_row)
      : task_(task), column_(column), row_(row) {
    const int n = task.filter.n, m = task.filter.margin;
    columns_ = (last_column - column) * n + 2 * m, rows_ = (last_row - row) * n + 2 * m;
    const size_t rays = static_cast<size_t>(columns_) * rows_;
    grow(store_.triangle, rays + PixelFilter::kPad);
    grow(store_.I, rays + PixelFilter::kPad);
    grow(store_.uv, rays);
    if (task.frame.options.derivatives) grow(store_.rays, rays);
    // Blocks of 4 x 4 rays stay together in the tree.
    for (int y = 0; y < rows_; y += 4)
      for (int x = 0; x < columns_; x += 4) follow_block(x, y);
  }
  /// First tap of a pixel; the next of its row follow, those of the next row `stride` later.
  Taps at(int x, int y) const {
    const int n = task_.filter.n;
    const size_t first = static_cast<size_t>((y - row_) * n) * columns_ + (x - column_) * n;
    return {store_.triangle.data() + first, store_.I.data() + first, store_.uv.data() + first,
            store_.rays.data() + first, columns_};
  }

 private:
  /// Kept by its thread from tile to tile.
  struct Store {
    std::vector<int> triangle;
    std::vector<float> I;
    std::vector<Eigen::Vector2f> uv;
    std::vector<RayRow> rays;
  };

  template <class T>
  static void grow(std::vector<T>& v, size_t size) {
    if (v.size() < size) v.resize(size);
  }

  void follow_block(int x, int y) {
    const PixelFilter& filter = task_.filter;
    const int w = std::min(4, columns_ - x), rows = std::min(4, rows_ - y);
    const int ix = column_ * filter.n - filter.margin + x;
    const int iy = row_ * filter.n - filter.margin + y;
    const bool derivatives = task_.frame.options.derivatives;
    Vector2d h[kLanes];
    Samples samples;
    Shading shading;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < w; ++i) h[j * w + i] = task_.grid.h(ix + i, iy + j);
    trace(task_.frame, h, w * rows, &samples);
    const bool any = std::any_of(samples.triangle, samples.triangle + w * rows,
                                 [](int triangle) { return triangle >= 0; });
    if (any && derivatives && task_.grid.distorted())
      for (int i = 0; i < w * rows; ++i) {
        const Vector2d zoom = task_.grid.zoom(ix + i % w, iy + i / w);
        for (int c = 0; c < 2; ++c) samples.zoom[c][i] = static_cast<float>(zoom[c]);
      }
    if (any) shade(task_.frame, samples, derivatives, &shading);
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < w; ++i)
        keep(samples, shading, j * w + i, static_cast<size_t>(y + j) * columns_ + x + i);
  }

  void keep(const Samples& samples, const Shading& shading, int lane, size_t at) {
    const bool hit = samples.triangle[lane] >= 0;
    store_.triangle[at] = samples.triangle[lane];
    store_.I[at] = hit ? shading.I[lane] : 0.0f;  // what is behind comes in with the pixel
    if (!hit) return;
    store_.uv[at] = {samples.bary[1][lane], samples.bary[2][lane]};
    if (task_.frame.options.derivatives) store_.rays[at] = shading.ray[lane];
  }

  static thread_local Store store_;
  const BandTask& task_;
  int column_, row_, columns_, rows_;
};

thread_local Tile::Store Tile::store_;

/// The triangle's own unit normal n = c/|c|, c = e1 x e2, moves with its corners.
void add_facet_normal(const Frame& f, const Vector3d& by_n, int triangle, Matrix3d* by_position) {
  const auto& t = f.state.surface.triangles[triangle];
  const Matrix3Xd& x = f.state.x;
  const Vector3d e1 = x.col(t[1]) - x.col(t[0]), e2 = x.col(t[2]) - x.col(t[0]);
  const double length = e1.cross(e2).norm();
  if (length <= 0) return;
  const Vector3d n = f.state.facets[triangle];
  const Vector3d m = (by_n - n * n.dot(by_n)) / length;
  const Vector3d by1 = e2.cross(m), by2 = m.cross(e1);
  by_position->col(1) += by1;
  by_position->col(2) += by2;
  by_position->col(0) -= by1 + by2;
}

/// The camera moved by (w, v) moves all corners by w x p + v in its own axes.
void add_camera(const Frame& f, const Matrix3d& by_position, int triangle, PhotoRow* photo) {
  const auto& t = f.state.surface.triangles[triangle];
  const Matrix3d g = f.view.camera.R * by_position;
  Vector3d turn = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) turn += f.view.p.col(t[k]).cross(g.col(k));
  photo->segment<3>(kRotate) += turn.cast<float>();
  photo->segment<3>(kMove) += g.rowwise().sum().cast<float>();
}

class PixelSum {
 public:
  PixelSum(const BandTask& task, const Tile& tile) : task_(task), tile_(tile) {}

  /// Filtered intensity, coverage and, where wanted, the derivative of pixel (x, y).
  void add(int x, int y, Rendering* out, RowDerivative* derivative) {
    const Taps taps = tile_.at(x, y);
    const auto [I, missing] = filter_rays(taps, task_.filter);
    if (missing > 1 - 1e-6f) return;
    const int pixel = y * out->I.width + x;
    out->I.at(x, y) = I + missing * static_cast<float>(task_.frame.photo.behind(pixel));
    out->coverage.at(x, y) = 1 - missing;
    if (!task_.frame.options.derivatives || (!task_.silhouette && missing > 1e-6f) ||
        (task_.count && !(*task_.count)[pixel]))
      return;
    groups_.clear();
    sum_by_triangle(taps, task_.filter, &groups_);
    store(pixel, missing, derivative);
  }

 private:
  void store(int pixel, float missing, RowDerivative* out) {
    const Frame& f = task_.frame;
    PhotoRow photo = PhotoRow::Zero();
    photo[kBackground] = missing;
    for (const TriangleSum& g : groups_) {
      const auto at = [&](int k) { return g.sum.value + k; };
      Matrix3d by_position = Eigen::Map<const Eigen::Matrix3f>(at(kByPosition)).cast<double>();
      add_camera(f, by_position, g.triangle, &photo);
      photo.segment<3>(kRotate) += Eigen::Map<const Eigen::Vector3f>(at(kByTurn));
      photo[kZoom] += *at(kByZoom);
      photo[kLogGain] += *at(kByLogGain);
      photo[kAmbient] += *at(kByAmbient);
      photo.segment<3>(kSun) += Eigen::Map<const Eigen::Vector3f>(at(kBySun));
      photo[kSpecular] += *at(kBySpecular);
      if (f.photo.shaded)
        add_facet_normal(f, Eigen::Map<const Eigen::Vector3f>(at(kByFacet)).cast<double>(),
                         g.triangle, &by_position);
      out->segments.push_back({g.triangle, by_position.cast<float>(),
                               Eigen::Map<const Eigen::Matrix3f>(at(kBySecond))});
    }
    out->pixel.push_back(pixel);
    out->first.push_back(static_cast<int>(out->segments.size()));
    out->photo.push_back(photo);
  }

  const BandTask& task_;
  const Tile& tile_;
  std::vector<TriangleSum> groups_;
};

/// Triangle and barycentric coordinates under the centres of pixels [first, last) of a row.
void mark_centres(const BandTask& task, const Tile& tile, int first, int last, int y,
                  Rendering* out) {
  const PixelFilter& filter = task.filter;
  const auto mark = [&](int x, int triangle, const Eigen::Vector2f& uv) {
    const size_t pixel = static_cast<size_t>(y) * out->I.width + x;
    out->triangle[pixel] = triangle;
    if (triangle >= 0) out->uv[pixel] = uv;
  };
  if (filter.n % 2 == 1) {
    const int middle = filter.margin + filter.n / 2;
    for (int x = first; x < last; ++x) {
      const Taps taps = tile.at(x, y);
      const int at = middle * taps.stride + middle;
      mark(x, taps.triangle[at], taps.uv[at]);
    }
    return;
  }
  for (int x = first; x < last; x += kLanes) {
    Vector2d h[kLanes];
    Samples samples;
    const int count = std::min(kLanes, last - x);
    const int half = filter.n / 2;  // the mean of the four middle rays is the centre
    for (int i = 0; i < count; ++i)
      h[i] = (task.grid.h((x + i) * filter.n + half - 1, y * filter.n + half - 1) +
              task.grid.h((x + i) * filter.n + half, y * filter.n + half)) /
             2;
    trace(task.frame, h, count, &samples);
    for (int i = 0; i < count; ++i)
      mark(x + i, samples.triangle[i], {samples.bary[1][i], samples.bary[2][i]});
  }
}

}  // namespace

void render_band(const BandTask& task, int row, int last_row, Rendering* out,
                 BandDerivative* derivative) {
  const View& view = task.frame.view;
  derivative->rows.resize(last_row - row);
  const int columns = std::max(8, kTileRays / task.filter.n);
  for (int x0 = view.x0; x0 < view.x1; x0 += columns) {
    const int x1 = std::min(x0 + columns, view.x1);
    const Tile tile(task, x0, x1, row, last_row);
    PixelSum sum(task, tile);
    for (int y = row; y < last_row; ++y) {
      for (int x = x0; x < x1; ++x) sum.add(x, y, out, &derivative->rows[y - row]);
      mark_centres(task, tile, x0, x1, y, out);
    }
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
  out->segments.push_back({e.triangle, e.d_position.cast<float>(), Eigen::Matrix3f::Zero()});
}

}  // namespace

ImageDerivative join(const std::vector<BandDerivative>& bands, std::vector<EdgeSegment> edges,
                     const BandTask& task) {
  std::stable_sort(edges.begin(), edges.end(),
                   [](const EdgeSegment& a, const EdgeSegment& b) { return a.pixel < b.pixel; });
  ImageDerivative out;
  std::vector<PhotoRow> photo;
  size_t pixels = 0, segments = 0;
  for (const BandDerivative& band : bands)
    for (const RowDerivative& r : band.rows)
      pixels += r.pixel.size(), segments += r.segments.size();
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
  for (const BandDerivative& band : bands)
    for (const RowDerivative& r : band.rows)
      for (size_t i = 0; i < r.pixel.size(); ++i) {
        edges_before(r.pixel[i]);
        for (int s = i ? r.first[i - 1] : 0; s < r.first[i]; ++s)
          out.segments.push_back(r.segments[s]);
        photo.push_back(r.photo[i]);
        take_edges(r.pixel[i]);
        close(r.pixel[i]);
      }
  edges_before(std::numeric_limits<int>::max());
  out.d_photo.resize(kPhotoColumns, static_cast<Eigen::Index>(photo.size()));
  for (size_t i = 0; i < photo.size(); ++i) out.d_photo.col(i) = photo[i];
  return out;
}

}  // namespace hookeye
