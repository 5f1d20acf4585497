#include "render/renderer.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <deque>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "core/work_clock.h"
#include "render/frame.h"
#include "render/picture.h"
#include "render/ray_scene.h"
#include "render/vertex_normals.h"

namespace hookeye {

namespace {

constexpr size_t kKept = 16;  ///< cameras and reference photos whose preparation is kept
constexpr int kBandRows = 8;

/// Same results for any number of threads: every task has its own output. Where the caller is one
/// of several tasks, a core that waits for these begins no other of them.
template <class Body>
void for_each_task(int tasks, bool parallel, const Body& body) {
  if (!parallel || tasks <= 1) {
    const Working part(WorkPart::rays);
    for (int i = 0; i < tasks; ++i) body(i);
    return;
  }
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(0, tasks, [&](int i) {
      const Working part(WorkPart::rays);
      body(i);
    });
  });
}

std::vector<Vector3d> facet_normals(const std::vector<std::array<int, 3>>& triangles,
                                    const Matrix3Xd& x) {
  std::vector<Vector3d> out;
  for (const auto& t : triangles)
    out.push_back((x.col(t[1]) - x.col(t[0])).cross(x.col(t[2]) - x.col(t[0])).stableNormalized());
  return out;
}

}  // namespace

struct Renderer::Impl {
  explicit Impl(SurfaceMesh s)
      : surface(std::move(s)),
        vertex_normals(surface),
        own_normals(surface.cut_from.empty()
                        ? std::optional<VertexNormals>()
                        : VertexNormals({surface.X, surface.triangles, {}, {}, {}})),
        edges(surface_edges(surface)),
        scene(surface.triangles, surface.X) {}

  SurfaceMesh surface;
  VertexNormals vertex_normals;
  /// Of a subdivided surface: its own. What they see of the sky hides nothing behind the facet that
  /// they stand on, as interpolated ones would; empty: vertex_normals are.
  std::optional<VertexNormals> own_normals;
  std::vector<SurfaceEdge> edges;
  RayScene scene;
  std::unique_ptr<RayScene> reference_scene;
  Matrix3Xd reference_x;
  // Of the last positions; several cameras look at the same state.
  Matrix3Xd seen_x, seen_normals;
  std::vector<Vector3d> seen_facets;
  std::vector<double> seen_visibility;
  int seen_rays = -1;
  std::deque<RayGrid> grids;
  std::deque<SplineImage> splines;

  void set_state(const Matrix3Xd& x, int rays);
  void set_reference(const Matrix3Xd& x);
  const RayGrid& grid(const Camera& camera, const PixelFilter& filter);
  const SplineImage& spline(const std::shared_ptr<const Image>& image);
};

void Renderer::Impl::set_state(const Matrix3Xd& x, int rays) {
  const bool same = seen_x.cols() == x.cols() && seen_x == x;
  if (!same) {
    scene.set_positions(x);
    seen_normals = vertex_normals.at(x);
    seen_facets = facet_normals(surface.triangles, x);
    seen_x = x;
  }
  if (same && rays == seen_rays) return;
  seen_visibility = sky_visibility(scene, x, own_normals ? own_normals->at(x) : seen_normals, rays);
  seen_rays = rays;
}

void Renderer::Impl::set_reference(const Matrix3Xd& x) {
  if (reference_scene && reference_x == x) return;
  reference_x = x;
  if (reference_scene)
    reference_scene->set_positions(x);
  else
    reference_scene = std::make_unique<RayScene>(surface.triangles, x);
}

const RayGrid& Renderer::Impl::grid(const Camera& camera, const PixelFilter& filter) {
  for (const RayGrid& g : grids)
    if (g.serves(camera, filter)) return g;
  if (grids.size() >= kKept) grids.pop_front();
  return grids.emplace_back(camera, filter);
}

const SplineImage& Renderer::Impl::spline(const std::shared_ptr<const Image>& image) {
  for (const SplineImage& s : splines)
    if (s.image() == image) return s;
  if (splines.size() >= kKept) splines.pop_front();
  return splines.emplace_back(image);
}

Renderer::Renderer(SurfaceMesh surface) : impl_(std::make_unique<Impl>(std::move(surface))) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

const SurfaceMesh& Renderer::surface() const { return impl_->surface; }
Matrix3Xd Renderer::normals(const Matrix3Xd& x) const { return impl_->vertex_normals.at(x); }
Eigen::SparseMatrix<double, Eigen::RowMajor> Renderer::normal_derivative(const Matrix3Xd& x) const {
  return impl_->vertex_normals.derivative(x);
}

namespace {

void clear(const PhotoState& photo, bool centres, Rendering* out) {
  out->I.width = out->coverage.width = photo.camera.width;
  out->I.height = out->coverage.height = photo.camera.height;
  out->I.channels = out->coverage.channels = 1;
  if (photo.backdrop)
    out->I.values = photo.backdrop->values;
  else
    out->I.values.assign(out->I.pixels(), static_cast<float>(photo.background));
  out->coverage.values.assign(out->I.pixels(), 0.0f);
  out->triangle.assign(centres ? out->I.pixels() : 0, -1);
  out->uv.assign(centres ? out->I.pixels() : 0, Eigen::Vector2f::Zero());
}

/// dI/dv of the blurred picture: T(n, v) is the diffusion semigroup, dT/dv = 1/2 second difference.
void set_blur_column(const Image& I, ImageDerivative::Part* part) {
  for (size_t i = 0; i < part->pixel.size(); ++i) {
    const int x = part->pixel[i] % I.width, y = part->pixel[i] / I.width;
    const double sum = double(I.at(std::max(x - 1, 0), y)) + I.at(std::min(x + 1, I.width - 1), y) +
                       I.at(x, std::max(y - 1, 0)) + I.at(x, std::min(y + 1, I.height - 1));
    part->photo[i][kBlur] = static_cast<float>(sum / 2 - 2.0 * I.at(x, y));
  }
}

/// All in ascending order of pixels, otherwise as they come. Segments are large and may be many:
/// each moves once, after references to them that are sorted row by row.
std::vector<EdgeSegment> by_pixel(const std::vector<std::vector<EdgeSegment>>& parts, int width,
                                  int height) {
  struct Key {
    int pixel;
    const EdgeSegment* segment;
  };
  std::vector<size_t> end(height + 1, 0);
  for (const auto& part : parts)
    for (const EdgeSegment& e : part) ++end[e.pixel / width + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<Key> keys(end.back());
  std::vector<size_t> next(end.begin(), end.end());
  for (const auto& part : parts)
    for (const EdgeSegment& e : part) keys[next[e.pixel / width]++] = {e.pixel, &e};
  std::vector<EdgeSegment> out;
  out.reserve(keys.size());
  for (int row = 0; row < height; ++row)
    std::stable_sort(keys.data() + end[row], keys.data() + end[row + 1],
                     [](const Key& a, const Key& b) { return a.pixel < b.pixel; });
  for (const Key& key : keys) out.push_back(*key.segment);
  return out;
}

/// By pixel in ascending order.
std::vector<EdgeSegment> contours(const Frame& frame, const PixelFilter& filter,
                                  const std::vector<SurfaceEdge>& edges, bool parallel) {
  constexpr size_t kEdges = 2048;
  const int tasks = static_cast<int>((edges.size() + kEdges - 1) / kEdges);
  std::vector<std::vector<EdgeSegment>> part(tasks);
  for_each_task(tasks, parallel, [&](int i) {
    const size_t first = i * kEdges, last = std::min(edges.size(), first + kEdges);
    silhouette_segments(frame, filter, edges, first, last, &part[i]);
    shadow_segments(frame, filter, edges, first, last, &part[i]);
  });
  return by_pixel(part, frame.view.camera.width, frame.view.camera.height);
}

}  // namespace

Rendering Renderer::render(const Matrix3Xd& x, const Matrix3Xd* x_reference, const Texture& texture,
                           const PhotoState& photo, const RenderOptions& options, bool silhouette,
                           const std::vector<unsigned char>* count) {
  Rendering out;
  render(x, x_reference, texture, photo, options, silhouette, count, &out);
  return out;
}

void Renderer::render(const Matrix3Xd& x, const Matrix3Xd* x_reference, const Texture& texture,
                      const PhotoState& photo, const RenderOptions& options, bool silhouette,
                      const std::vector<unsigned char>* count, Rendering* out) {
  const Working part(WorkPart::rays);
  Impl& m = *impl_;
  if (x.cols() != m.surface.X.cols()) throw std::invalid_argument("render: wrong vertex count");
  if (photo.backdrop && (photo.backdrop->width != photo.camera.width ||
                         photo.backdrop->height != photo.camera.height))
    throw std::invalid_argument("render: the backdrop has another size than the camera's pictures");
  const bool from_photo = texture.source == Texture::Source::photo;
  if (from_photo && photo.shaded)
    throw std::invalid_argument("render: a texture that is a photo has its light in it");
  m.set_state(x, photo.shaded ? options.visibility_rays : 0);
  const View view(photo.camera, x, m.surface.triangles);
  const PixelFilter filter(options.rays_per_axis, options.filter_width_px, options.halvings);
  const SurfaceState state{m.surface, x, m.seen_normals, m.seen_facets, m.seen_visibility};
  const TriangleTable table = triangle_table(state, view, m.scene.centre(), texture);
  Frame frame{state, view, m.scene, table, texture, photo, options};
  std::optional<View> reference_view;
  if (from_photo) {
    if (!x_reference) throw std::invalid_argument("render: photo texture without reference state");
    m.set_reference(*x_reference);
    reference_view.emplace(texture.reference_camera, *x_reference, m.surface.triangles);
    frame.x_reference = x_reference;
    frame.reference_scene = m.reference_scene.get();
    frame.reference_view = &*reference_view;
    frame.spline = &m.spline(texture.photo);
  }
  clear(photo, options.centres, out);
  const std::vector<EdgeSegment> edges = options.derivatives
                                             ? contours(frame, filter, m.edges, options.parallel)
                                             : std::vector<EdgeSegment>();
  const BandTask task{frame, filter, m.grid(photo.camera, filter), silhouette, count, edges};
  const int bands = (view.y1 - view.y0 + kBandRows - 1) / kBandRows;
  auto& parts = out->dI.parts;
  parts.resize(bands + 1);
  for_each_task(bands, options.parallel, [&](int i) {
    const int row = view.y0 + i * kBandRows;
    parts[i].clear();
    render_band(task, row, std::min(row + kBandRows, view.y1), out, &parts[i]);
  });
  parts[bands].clear();
  add_outer_edges(task, &parts[bands]);
  if (photo.blur_variance > 0) out->I = blur(out->I, photo.blur_variance);
  if (options.derivatives && options.photo_derivative && options.blur_derivative)
    for_each_task(bands + 1, options.parallel, [&](int i) { set_blur_column(out->I, &parts[i]); });
}

void ImageDerivative::Part::clear() {
  pixel.clear(), segments.clear(), photo.clear(), uneven.clear();
  first.assign(1, 0);
}

size_t ImageDerivative::pixels() const {
  size_t sum = 0;
  for (const Part& part : parts) sum += part.pixel.size();
  return sum;
}

}  // namespace hookeye
