#include "render/picture.h"

#include <algorithm>

#include "render/ray_sums.h"

namespace hookeye {

namespace {

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
    return {store_.triangle.data() + first,
            store_.I.data() + first,
            store_.uv.data() + first,
            store_.rays.data() + first,
            columns_,
            wants_uneven(task_.frame) ? kRayFloats : kFloatsWithoutUneven};
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
    if (any && derivatives && task_.grid.bent())
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
    if (!task_.frame.options.derivatives) return;
    // Of known length: a call of memmove costs as much as the copy.
    const float* from = shading.ray[lane].value;
    if (wants_uneven(task_.frame))
      std::copy_n(from, kAllFloats, store_.rays[at].value);
    else if (task_.frame.options.photo_derivative)
      std::copy_n(from, kFloatsWithoutUneven, store_.rays[at].value);
    else
      std::copy_n(from, kFloatsWithoutPhoto, store_.rays[at].value);
  }

  static thread_local Store store_;
  const BandTask& task_;
  int column_, row_, columns_, rows_;
};

thread_local Tile::Store Tile::store_;

/// Takes the silhouettes' shares in `pixel`, which begin at `edge`, and closes it. `begin`: its
/// first segment. Returns the first of another pixel.
const EdgeSegment* close_pixel(int pixel, size_t begin, const EdgeSegment* edge,
                               const EdgeSegment* end, ImageDerivative::Part* part) {
  for (; edge != end && edge->pixel == pixel; ++edge) {
    if (!part->photo.empty()) part->photo.back().head<kSpecular>() += edge->d_photo.cast<float>();
    size_t s = begin;
    while (s < part->segments.size() && part->segments[s].triangle != edge->triangle) ++s;
    if (s == part->segments.size()) part->segments.emplace_back().triangle = edge->triangle;
    part->segments[s].d_position() += edge->d_position.cast<float>();
  }
  part->pixel.push_back(pixel);
  part->first.push_back(static_cast<int>(part->segments.size()));
  return edge;
}

/// The photo's numbers of the next pixel, `missing` of whose filter no triangle covers.
void add_photo(const Frame& frame, float missing, ImageDerivative::Part* part) {
  if (!frame.options.photo_derivative) return;
  PhotoDerivative& photo = part->photo.emplace_back();
  photo.setZero();
  photo[kBackground] = missing;
  if (wants_uneven(frame)) part->uneven.emplace_back().setZero();
}

const EdgeSegment* add_edges_alone(const BandTask& task, const EdgeSegment* edge,
                                   const EdgeSegment* end, ImageDerivative::Part* part) {
  add_photo(task.frame, 1, part);
  return close_pixel(edge->pixel, part->segments.size(), edge, end, part);
}

const EdgeSegment* first_from(const std::vector<EdgeSegment>& edges, int pixel) {
  return std::lower_bound(edges.data(), edges.data() + edges.size(), pixel,
                          [](const EdgeSegment& e, int p) { return e.pixel < p; });
}

/// Filtered intensity, coverage and, where wanted, the derivative of one pixel after the other.
class PixelSum {
 public:
  PixelSum(const BandTask& task, const Tile& tile, Rendering* out, ImageDerivative::Part* part)
      : task_(task), tile_(tile), out_(out), part_(part), single_(task.filter.taps() == 1) {}

  void add_row(int first, int last, int y) {
    const int row = y * out_->I.width;
    edge_ = first_from(task_.edges, row + first);
    last_edge_ = first_from(task_.edges, row + last);
    for (int x = first; x < last; ++x) {
      add(x, y, row + x);
      while (edge_ != last_edge_ && edge_->pixel == row + x) ++edge_;
    }
  }

 private:
  void add(int x, int y, int pixel) {
    const Taps taps = tile_.at(x, y);
    const auto [I, missing] = single_ ? Filtered{*taps.I, *taps.triangle < 0 ? 1.0f : 0.0f}
                                      : filter_rays(taps, task_.filter);
    const bool body = missing <= 1 - 1e-6f;
    if (body) {
      out_->I.values[pixel] = I + missing * static_cast<float>(task_.frame.photo.behind(pixel));
      out_->coverage.values[pixel] = 1 - missing;
    }
    if (!task_.frame.options.derivatives || !task_.wants(pixel) ||
        (!task_.silhouette && missing > 1e-6f))
      return;
    if (body) {
      add_body(pixel, taps, missing);
    } else if (edge_ != last_edge_ && edge_->pixel == pixel) {
      edge_ = add_edges_alone(task_, edge_, last_edge_, part_);
    }
  }

  void add_body(int pixel, const Taps& taps, float missing) {
    const size_t begin = part_->segments.size();
    add_photo(task_.frame, missing, part_);
    if (single_) {
      add_segment(*taps.triangle, *taps.rays);
    } else {
      groups_.clear();
      sum_by_triangle(taps, task_.filter, &groups_);
      for (const TriangleSum& g : groups_) add_segment(g.triangle, g.sum);
    }
    edge_ = close_pixel(pixel, begin, edge_, last_edge_, part_);
  }
  void add_segment(int triangle, const RayRow& sum) {
    const float* at = sum.value;
    if (task_.frame.options.photo_derivative)
      part_->photo.back().head<kBlur>() +=
          Eigen::Map<const Eigen::Matrix<float, kBlur, 1>>(at + kByPhoto);
    if (task_.frame.options.photo_derivative) part_->photo.back()[kVignetting] += at[kByVignetting];
    if (!part_->uneven.empty())
      part_->uneven.back() += Eigen::Map<const UnevenDerivative>(at + kByUneven);
    part_->segments.push_back(
        {Eigen::Map<const DerivativeSegment::ByVertex>(at), {0, 0}, triangle});
  }

  const BandTask& task_;
  const Tile& tile_;
  Rendering* out_;
  ImageDerivative::Part* part_;
  bool single_;  ///< one ray is the whole pixel
  const EdgeSegment *edge_ = nullptr, *last_edge_ = nullptr;
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
                 ImageDerivative::Part* part) {
  const View& view = task.frame.view;
  const int columns = std::max(8, kTileRays / task.filter.n);
  if (task.frame.options.derivatives) {
    const size_t most = static_cast<size_t>(last_row - row) * (view.x1 - view.x0);
    part->pixel.reserve(most), part->first.reserve(most + 1);
    part->segments.reserve(most);
    if (task.frame.options.photo_derivative) part->photo.reserve(most);
    if (wants_uneven(task.frame)) part->uneven.reserve(most);
  }
  for (int x0 = view.x0; x0 < view.x1; x0 += columns) {
    const int x1 = std::min(x0 + columns, view.x1);
    const Tile tile(task, x0, x1, row, last_row);
    PixelSum sum(task, tile, out, part);
    for (int y = row; y < last_row; ++y) {
      sum.add_row(x0, x1, y);
      if (task.frame.options.centres) mark_centres(task, tile, x0, x1, y, out);
    }
  }
}

void add_outer_edges(const BandTask& task, ImageDerivative::Part* part) {
  if (!task.silhouette) return;
  const View& view = task.frame.view;
  const int width = view.camera.width;
  const EdgeSegment* const end = task.edges.data() + task.edges.size();
  for (const EdgeSegment* e = task.edges.data(); e != end;) {
    const int x = e->pixel % width, y = e->pixel / width;
    const bool inner = x >= view.x0 && x < view.x1 && y >= view.y0 && y < view.y1;
    if (inner || !task.wants(e->pixel))
      ++e;
    else
      e = add_edges_alone(task, e, end, part);
  }
}

}  // namespace hookeye
