// Rays against the bare library call, and one photo's whole share of a Gauss-Newton iteration.
// Ratios count: everything here runs on the same machine at the same time.
#include <benchmark/benchmark.h>

#include "estimation/evaluation.h"
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
    Camera c = test::camera(Camera::Projection::perspective, false);
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

void rays_of_the_library(benchmark::State& s) {
  Bench& b = bench();
  const RayScene scene(b.surface.triangles, b.surface.X);
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
  alignas(64) int active[16];
  std::fill(active, active + 16, -1);
  for (auto _ : s)
    for (const RayPacket& p : packets) {
      RayPacket rays = p;
      scene.intersect(rays, active);
      benchmark::DoNotOptimize(rays.triangle[0]);
    }
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

/// Refit, rays, residual, derivative, J^T J. Arguments: rays per axis, parameters, threads, and
/// whether the sun casts shadows and gloss (the floors count neither).
void one_view(benchmark::State& s) {
  Bench& b = bench();
  RenderOptions options;
  options.rays_per_axis = int(s.range(0));
  options.filter_width_px = options.rays_per_axis == 1 ? 0.5 : 3.0;
  options.visibility_rays = 0;
  options.threads = int(s.range(2));
  options.cast_shadows = options.gloss_derivative = s.range(3) != 0;
  options.centres = options.blur_derivative = false;  // as in a fit
  // nor do they count the photo's own numbers, which many fits leave as told
  options.photo_derivative = s.range(3) != 0;
  const Eigen::Index m = s.range(1), nv = 3 * b.surface.X.cols();
  VertexSensitivity S{Eigen::MatrixXd::Random(nv, m), Eigen::MatrixXd::Random(nv, m),
                      Eigen::MatrixXd::Random(kPhotoColumns, m)};
  const CondensedColumns columns{true, options.photo_derivative};
  double shift = 0;
  Rendering r;
  for (auto _ : s) {
    const Matrix3Xd x = b.surface.X.array() + (shift += 1e-3);  // new positions: a refit
    b.renderer.render(x, nullptr, b.texture, b.state, options, true, nullptr, &r);
    VectorXd residual(Eigen::Index(r.dI.pixels()));
    r.dI.for_each_pixel([&](size_t i, int pixel) { residual[i] = 0.5 - r.I.values[pixel]; });
    const VectorXd w = VectorXd::Ones(residual.size());
    const auto sums =
        NodeNormalEquations::accumulate(b.surface, r.dI, residual, w, residual, columns);
    benchmark::DoNotOptimize(sums.reduce(S).r2);
    s.counters["active_px"] = double(residual.size());
  }
}

BENCHMARK(rays_of_the_library)->Unit(benchmark::kMillisecond);
BENCHMARK(rays_of_the_product)->Unit(benchmark::kMillisecond);
BENCHMARK(one_view)
    ->Args({1, 10, 1, 0})
    ->Args({1, 100, 1, 0})
    ->Args({1, 10, 1, 1})
    ->Args({3, 10, 1, 1})
    ->Args({3, 10, 2, 1})
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
