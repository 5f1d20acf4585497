// Rays against the bare library call, and one photo's whole share of a Gauss-Newton iteration.
// Ratios count: everything here runs on the same machine at the same time.
#include <benchmark/benchmark.h>

#include "bench/one_view_floor.h"
#include "estimation/evaluation/evaluation.h"
#include "render/condensed.h"
#include "render/frame.h"
#include "render/scene.h"

extern "C" void openblas_set_num_threads(int);

namespace hookeye {
namespace {

constexpr int kWidth = 1156, kHeight = 867;  // 1 Mpx

struct Bench {
  Bench() : surface(test::sphere(Vector3d::Zero(), 10, 5, 0.05)), renderer(surface) {
    texture.source = Texture::Source::image;
    texture.image = test::waves(1024, 1024, 30);
    Camera c = test::camera("perspective", false);
    c.width = kWidth, c.height = kHeight;
    c.fx = c.fy = 1780;  // the body covers 40 %
    c.cx = kWidth / 2.0, c.cy = kHeight / 2.0;
    c.t = {0, 0, 50};
    state = test::state(c);
    state.specular = 0;
  }
  SurfaceMesh surface;
  Renderer renderer;
  Texture texture;
  PhotoState state;
};

Bench& bench() {
  static Bench b;
  return b;
}

/// Calls `block` with the ray directions of each 4 x 4 block of pixels.
template <class Block>
void for_blocks(const RayGrid& grid, const Block& block) {
  Vector2d h[16];
  for (int y = 0; y + 4 <= kHeight; y += 4)
    for (int x = 0; x + 4 <= kWidth; x += 4) {
      for (int i = 0; i < 16; ++i) h[i] = grid.h(x + i % 4, y + i / 4);
      block(h);
    }
}

/// The rays of all pixels, made ahead.
std::vector<RayPacket> ray_packets(const RayScene& scene) {
  Bench& b = bench();
  const View view(b.state.camera, b.surface.X, b.surface.triangles);
  const RayGrid grid(b.state.camera, PixelFilter(1, 0.5));
  std::vector<RayPacket> packets;
  for_blocks(grid, [&](const Vector2d* h) {
    RayPacket& p = packets.emplace_back();
    p.reset(0, std::numeric_limits<float>::infinity());
    const Vector3d eye = view.eye - scene.centre();
    for (int i = 0; i < kLanes; ++i) {
      const Vector3d to = view.camera.R.transpose() * h[i].homogeneous();
      p.org_x[i] = float(eye.x()), p.org_y[i] = float(eye.y()), p.org_z[i] = float(eye.z());
      p.dir_x[i] = float(to.x()), p.dir_y[i] = float(to.y()), p.dir_z[i] = float(to.z());
    }
  });
  return packets;
}

/// Follows the packets by bare calls and hands each to `use`.
template <class Use>
void follow(const RayScene& scene, const std::vector<RayPacket>& packets, const Use& use) {
  alignas(64) int active[16];
  std::fill(active, active + 16, -1);
  for (const RayPacket& p : packets) {
    RayPacket rays = p;
    scene.intersect(rays, active);
    use(rays);
  }
}

void rays_of_the_library(benchmark::State& s) {
  const RayScene scene(bench().surface.triangles, bench().surface.X);
  const std::vector<RayPacket> packets = ray_packets(scene);
  for (auto _ : s)
    follow(scene, packets,
           [](const RayPacket& rays) { benchmark::DoNotOptimize(rays.triangle[0]); });
  s.SetItemsProcessed(int64_t(s.iterations() * packets.size() * 16));
}

void rays_of_the_product(benchmark::State& s) {
  Bench& b = bench();
  const RayScene scene(b.surface.triangles, b.surface.X);
  const View view(b.state.camera, b.surface.X, b.surface.triangles);
  const RayGrid grid(b.state.camera, PixelFilter(1, 0.5));
  const Matrix3Xd normals = b.renderer.normals(b.surface.X);
  const std::vector<double> visibility(b.surface.X.cols(), 1.0);
  const std::vector<Vector3d> facets(b.surface.triangles.size(), Vector3d::UnitZ());
  const RenderOptions options;
  PhotoState state = b.state;
  state.shaded = false;  // no shadow rays: the same rays as above
  const SurfaceState surface{b.surface, b.surface.X, normals, facets, visibility};
  const TriangleTable table = triangle_table(surface, view, scene.centre(), b.texture);
  const Frame frame{surface, view, scene, table, b.texture, state, options};
  int64_t blocks = 0;
  for (auto _ : s)
    for_blocks(grid, [&](const Vector2d* h) {
      Samples out;
      trace(frame, h, kLanes, &out);
      benchmark::DoNotOptimize(out.triangle[0]);
      ++blocks;
    });
  s.SetItemsProcessed(blocks * 16);
}

/// Options of one_view: `all` counts shadows, gloss and the photo's own numbers, which many fits
/// leave as told and the floor does not know.
RenderOptions view_options(int rays_per_axis, bool all) {
  RenderOptions options;
  options.rays_per_axis = rays_per_axis;
  options.filter_width_px = rays_per_axis == 1 ? 0.5 : 3.0;
  options.visibility_rays = 0;
  options.cast_shadows = options.gloss_derivative = options.photo_derivative = all;
  options.uneven_derivative = false;
  options.centres = options.blur_derivative = false;  // as in a fit
  return options;
}

/// A photo's share of an iteration in the memory of an earlier picture.
CondensedPhoto share_of_view(const Matrix3Xd& x, const RenderOptions& options, bool silhouette,
                             const VertexSensitivity& S, Rendering* r) {
  Bench& b = bench();
  b.renderer.render(x, nullptr, b.texture, b.state, options, silhouette, nullptr, r);
  VectorXd residual(Eigen::Index(r->dI.pixels()));
  r->dI.for_each_pixel([&](size_t i, int pixel) { residual[i] = 0.5 - r->I.values[pixel]; });
  const VectorXd w = VectorXd::Ones(residual.size());
  return NodeNormalEquations::accumulate(b.surface, r->dI, residual, w, residual,
                                         {true, options.photo_derivative})
      .reduce(S);
}

/// Refit, rays, residual, derivative, J^T J. Arguments: rays per axis, parameters, and
/// whether all counts (view_options).
void one_view(benchmark::State& s) {
  Bench& b = bench();
  const RenderOptions options = view_options(int(s.range(0)), s.range(2) != 0);
  const Eigen::Index m = s.range(1), nv = 3 * b.surface.X.cols();
  VertexSensitivity S{Eigen::MatrixXd::Random(nv, m), Eigen::MatrixXd::Random(nv, m),
                      Eigen::MatrixXd::Random(kPhotoColumns, m)};
  double shift = 0;
  Rendering r;
  for (auto _ : s) {
    const Matrix3Xd x = b.surface.X.array() + (shift += 1e-3);  // new positions: a refit
    benchmark::DoNotOptimize(share_of_view(x, options, true, S, &r).count);
    s.counters["active_px"] = double(r.dI.pixels());
  }
}

bench::FloorScene floor_scene() {
  const Bench& b = bench();
  const Image& image = *b.texture.image;
  bench::FloorScene out;
  out.vertices = int(b.surface.X.cols());
  out.texture = image.values, out.texture_width = image.width;
  out.ambient = float(b.state.gain * b.state.ambient);
  for (int c = 0; c < 3; ++c) out.sun[c] = float(b.state.gain * b.state.sun[c]);
  for (size_t t = 0; t < b.surface.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      out.triangles.push_back(b.surface.triangles[t][k]);
      out.uv.push_back(float(b.surface.uv[t][k].x() * image.width - 0.5));
      out.uv.push_back(float((1 - b.surface.uv[t][k].y()) * image.height - 0.5));
    }
  return out;
}

std::array<bench::FloorHit, 16> hits_of(const RayPacket& rays) {
  std::array<bench::FloorHit, 16> out;
  for (int i = 0; i < 16; ++i)
    out[i] = {
        int(rays.triangle[i]), rays.u[i], rays.v[i], {rays.dir_x[i], rays.dir_y[i], rays.dir_z[i]}};
  return out;
}

/// Trace of the floor's J^T J over that of the product without silhouettes: 0.8 here and 0.96
/// without ambient light, of which the product alone knows that each facet hides a part of the sky.
double agreement(const std::vector<double>& JtJ, const RowMatrix& S) {
  const Eigen::Index m = S.cols(), vertices = S.rows() / 6;
  VertexSensitivity product{RowMatrix(3 * vertices, m), RowMatrix(3 * vertices, m),
                            RowMatrix::Zero(kPhotoColumns, m)};
  for (Eigen::Index v = 0; v < vertices; ++v) {
    product.position.middleRows(3 * v, 3) = S.middleRows(6 * v, 3);
    product.second.middleRows(3 * v, 3) = S.middleRows(6 * v + 3, 3);
  }
  Rendering r;
  const auto seen = share_of_view(bench().surface.X, view_options(1, false), false, product, &r);
  return Eigen::Map<const RowMatrix>(JtJ.data(), m, m).trace() / seen.JtJ.trace();
}

/// The sum of one_view's floors, one thread. Argument: parameters.
void one_view_floor(benchmark::State& s) {
  Bench& b = bench();
  RayScene scene(b.surface.triangles, b.surface.X);
  const std::vector<RayPacket> packets = ray_packets(scene);
  bench::OneViewFloor floor(floor_scene());
  const Eigen::Index m = s.range(0);
  const RowMatrix S = RowMatrix::Random(6 * b.surface.X.cols(), m);
  std::vector<double> JtJ, Jtr;
  double shift = 0;
  const auto share = [&] {
    const Matrix3Xd x = b.surface.X.array() + shift;
    scene.set_positions(x);
    floor.begin(Eigen::Matrix3Xf(x.cast<float>()).data(),
                Eigen::Matrix3Xf(b.renderer.normals(x).cast<float>()).data());
    follow(scene, packets,
           [&](const RayPacket& rays) { floor.add(hits_of(rays).data(), 16, 0.5f); });
    floor.reduce(S.data(), int(m), &JtJ, &Jtr);
  };
  share();
  s.counters["JtJ_of_product"] = agreement(JtJ, S);
  for (auto _ : s) {
    shift += 1e-3;
    share();
    benchmark::DoNotOptimize(JtJ.data());
  }
}

BENCHMARK(rays_of_the_library)->Unit(benchmark::kMillisecond);
BENCHMARK(rays_of_the_product)->Unit(benchmark::kMillisecond);
BENCHMARK(one_view_floor)->Arg(10)->Arg(100)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(one_view)
    ->Args({1, 10, 0})
    ->Args({1, 100, 0})
    ->Args({1, 10, 1})
    ->Args({3, 10, 1})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace hookeye

int main(int argc, char** argv) {
  openblas_set_num_threads(1);   // as simulation does
  hookeye::keep_freed_memory();  // as the program does
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
