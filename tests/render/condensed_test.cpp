// The condensed sums against explicit rows J.
#include "render/condensed.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "scene.h"

namespace hookeye {
namespace {

TEST(condensed, equals_explicit_rows) {
  const SurfaceMesh surface = test::both(test::sphere({0, 0, -9}, 4, 2, 0.0, {0.25, 0}),
                                         test::sphere({2, 1, 4}, 8, 2, 0.03, {-0.25, 0}));
  Renderer renderer(surface);
  Texture texture;
  PhotoState state = test::state(test::camera("perspective", false));
  state.uneven << 0.2, -0.3, 0.1, 0.25, -0.15, 0.2, -0.1, 0.3;
  for (bool from_photo : {false, true}) {
    if (from_photo) {
      texture.source = Texture::Source::photo;
      texture.photo = test::waves(state.camera.width, state.camera.height, 3);
      texture.reference_camera = state.camera;
      state.shaded = false;
    }
    const Matrix3Xd x = surface.X + 0.1 * test::field(surface.X, 0.2);
    const Rendering out = renderer.render(x, &surface.X, texture, state, {}, true);
    const test::Joined dI = test::joined(out.dI);
    const Eigen::Index n = Eigen::Index(dI.pixel.size()), m = 7, nv = 3 * x.cols();
    srand(1);
    VertexSensitivity S;
    S.position = Eigen::MatrixXd::Random(nv, m);
    S.second = Eigen::MatrixXd::Random(nv, m);
    S.photo = Eigen::MatrixXd::Random(kPhotoColumns, m);
    S.position.col(2).setZero(), S.second.col(2).setZero();  // the photo's numbers alone
    S.position.col(4).setZero(), S.photo.col(5).setZero();
    const VectorXd r = VectorXd::Random(n), w = VectorXd::Random(n).array() + 1.5;
    const VectorXd wr = w.cwiseProduct(r);
    Eigen::MatrixXd J = dI.d_photo.cast<double>().transpose() * S.photo;
    for (Eigen::Index i = 0; i < n; ++i)
      for (int s = dI.first[i]; s < dI.first[i + 1]; ++s)
        for (int k = 0; k < 3; ++k) {
          const DerivativeSegment& g = dI.segments[s];
          const int v = 3 * surface.triangles[g.triangle][k];
          J.row(i) +=
              g.d_position().col(k).cast<double>().transpose() * S.position.middleRows(v, 3);
          J.row(i) += g.d_second().col(k).cast<double>().transpose() * S.second.middleRows(v, 3);
        }
    J = (w.asDiagonal() * J).eval();
    const auto sums = NodeNormalEquations::accumulate(surface, out.dI, wr, w, wr, {});
    const CondensedPhoto c = sums.reduce(S);
    EXPECT_LT((c.JtJ - J.transpose() * J).norm(), 1e-5 * c.JtJ.norm());
    EXPECT_LT((c.Jtr - J.transpose() * r).norm(), 1e-5 * c.Jtr.norm());
    EXPECT_EQ(c.count, size_t(n));
    VertexSensitivity still = S;
    still.position.setZero(), still.second.setZero();
    const Eigen::MatrixXd by_photo =
        w.asDiagonal() * (dI.d_photo.cast<double>().transpose() * S.photo);
    EXPECT_LT((sums.reduce(still).JtJ - by_photo.transpose() * by_photo).norm(),
              1e-5 * by_photo.squaredNorm());
    // What is told to be zero is not summed.
    VertexSensitivity motion = S;
    motion.photo.setZero();
    const CondensedPhoto all = sums.reduce(motion);
    const CondensedPhoto less =
        NodeNormalEquations::accumulate(surface, out.dI, wr, w, wr, {true, false}).reduce(motion);
    EXPECT_LT((less.JtJ - all.JtJ).norm(), 1e-6 * all.JtJ.norm());
    EXPECT_LT((less.Jtr - all.Jtr).norm(), 1e-6 * all.Jtr.norm());
  }
}

void expect_same(const ImageDerivative& first, const ImageDerivative& second) {
  const test::Joined a = test::joined(first), b = test::joined(second);
  EXPECT_EQ(a.pixel, b.pixel);
  EXPECT_TRUE(a.d_photo == b.d_photo);
  ASSERT_EQ(a.segments.size(), b.segments.size());
  for (size_t i = 0; i < a.segments.size(); ++i)
    ASSERT_TRUE(a.segments[i].d_position() == b.segments[i].d_position());
}

TEST(condensed, without_parameters_and_without_a_body) {
  const SurfaceMesh surface = test::sphere(Vector3d::Zero(), 8, 2, 0.05);
  const PhotoState state = test::state(test::camera("perspective", false));
  Renderer renderer(surface);
  testing::internal::CaptureStdout();
  for (const double aside : {0.0, 1e3}) {
    const Matrix3Xd x = surface.X.array() + aside;
    const Rendering out = renderer.render(x, nullptr, {}, state, {}, true);
    const VectorXd r = VectorXd::Ones(Eigen::Index(out.dI.pixels()));
    const auto sums = NodeNormalEquations::accumulate(surface, out.dI, r, r, r, {});
    for (const Eigen::Index m : {0, 2}) {
      const CondensedPhoto c =
          sums.reduce({RowMatrix::Zero(3 * x.cols(), m), RowMatrix::Zero(3 * x.cols(), m),
                       Eigen::MatrixXd::Zero(kPhotoColumns, m)});
      EXPECT_EQ(c.JtJ.rows(), m);
      EXPECT_EQ(c.Jtr.size(), m);
      EXPECT_EQ(c.count, size_t(r.size()));
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "") << "BLAS complains there";
}

TEST(renderer, threads_agree_bit_by_bit) {
  const SurfaceMesh surface = test::sphere(Vector3d::Zero(), 8, 3, 0.05);
  Renderer renderer(surface);
  Texture texture;
  const PhotoState state = test::state(test::camera("perspective", false));
  RenderOptions one, two;
  two.parallel = true;
  const Rendering a = renderer.render(surface.X, nullptr, texture, state, one, true);
  const Rendering b = renderer.render(surface.X, nullptr, texture, state, two, true);
  EXPECT_EQ(a.I.values, b.I.values);
  expect_same(a.dI, b.dI);
}

// Many fits have no camera, light or exposure among their parameters.
TEST(renderer, without_the_photos_numbers_motions_stay_the_same) {
  const SurfaceMesh surface = test::sphere(Vector3d::Zero(), 8, 3, 0.05);
  Renderer renderer(surface);
  PhotoState state = test::state(test::camera("perspective", false));
  for (const int rays : {1, 3}) {
    RenderOptions with, without;
    with.rays_per_axis = without.rays_per_axis = rays;
    without.photo_derivative = false;
    const Rendering all = renderer.render(surface.X, nullptr, {}, state, with, true);
    const Rendering some = renderer.render(surface.X, nullptr, {}, state, without, true);
    EXPECT_EQ(all.I.values, some.I.values);
    ASSERT_EQ(all.dI.parts.size(), some.dI.parts.size());
    for (size_t i = 0; i < all.dI.parts.size(); ++i) {
      const auto &a = all.dI.parts[i], &b = some.dI.parts[i];
      EXPECT_TRUE(b.photo.empty());
      EXPECT_TRUE(b.uneven.empty());
      EXPECT_EQ(a.pixel, b.pixel);
      EXPECT_EQ(a.first, b.first);
      ASSERT_EQ(a.segments.size(), b.segments.size());
      for (size_t s = 0; s < a.segments.size(); ++s) {
        EXPECT_EQ(a.segments[s].triangle, b.segments[s].triangle);
        EXPECT_EQ(a.segments[s].d_position(), b.segments[s].d_position());
        EXPECT_EQ(a.segments[s].d_second(), b.segments[s].d_second());
      }
    }
    const Eigen::Index m = 3, nv = 3 * surface.X.cols();
    const VertexSensitivity S{Eigen::MatrixXd::Random(nv, m), Eigen::MatrixXd::Random(nv, m),
                              Eigen::MatrixXd::Zero(kPhotoColumns, m)};
    const VectorXd r = VectorXd::Random(Eigen::Index(all.dI.pixels()));
    const auto reduced = [&](const Rendering& rendering, CondensedColumns columns) {
      return NodeNormalEquations::accumulate(surface, rendering.dI, r, r, r, columns).reduce(S);
    };
    const CondensedPhoto a = reduced(all, {}), b = reduced(some, {true, false});
    EXPECT_LT((a.JtJ - b.JtJ).norm(), 1e-6 * a.JtJ.norm());
    EXPECT_LT((a.Jtr - b.Jtr).norm(), 1e-6 * a.Jtr.norm());
  }
}

// Those of an uneven sky alone are left out where the light is told, or is a sky and a sun.
TEST(renderer, without_uneven_light_the_other_numbers_stay_the_same) {
  const SurfaceMesh surface = test::sphere(Vector3d::Zero(), 8, 3, 0.05);
  Renderer renderer(surface);
  const PhotoState state = test::state(test::camera("perspective", false));
  for (const int rays : {1, 3}) {
    RenderOptions with, without;
    with.rays_per_axis = without.rays_per_axis = rays;
    without.uneven_derivative = false;
    const Rendering all = renderer.render(surface.X, nullptr, {}, state, with, true);
    const Rendering some = renderer.render(surface.X, nullptr, {}, state, without, true);
    EXPECT_EQ(all.I.values, some.I.values);
    const test::Joined a = test::joined(all.dI), b = test::joined(some.dI);
    EXPECT_TRUE(a.d_photo.topRows<kUneven>() == b.d_photo.topRows<kUneven>());
    EXPECT_GT(a.d_photo.bottomRows<kUnevenNumbers>().norm(), 1.0f);
    EXPECT_EQ(b.d_photo.bottomRows<kUnevenNumbers>().norm(), 0.0f);
    const Eigen::Index m = 5, nv = 3 * surface.X.cols();
    VertexSensitivity S{Eigen::MatrixXd::Random(nv, m), Eigen::MatrixXd::Random(nv, m),
                        Eigen::MatrixXd::Random(kPhotoColumns, m)};
    S.photo.bottomRows<kUnevenNumbers>().setZero();
    const VectorXd r = VectorXd::Random(Eigen::Index(all.dI.pixels()));
    const auto reduced = [&](const Rendering& rendering) {
      return NodeNormalEquations::accumulate(surface, rendering.dI, r, r, r, {}).reduce(S);
    };
    const CondensedPhoto of_all = reduced(all), of_some = reduced(some);
    EXPECT_LT((of_all.JtJ - of_some.JtJ).norm(), 1e-6 * of_all.JtJ.norm());
    EXPECT_LT((of_all.Jtr - of_some.Jtr).norm(), 1e-6 * of_all.Jtr.norm());
  }
}

// Pictures of other sizes and of other bodies may have been in the memory before.
TEST(renderer, memory_used_again_leaves_nothing_behind) {
  const SurfaceMesh surface = test::sphere(Vector3d::Zero(), 8, 3, 0.05);
  Renderer renderer(surface);
  Texture texture;
  PhotoState state = test::state(test::camera("perspective", false));
  const Rendering fresh = renderer.render(surface.X, nullptr, texture, state, {}, true);
  Rendering again;
  PhotoState large = state;
  large.camera.width += 60, large.camera.height += 90;
  large.background = 0.7;
  renderer.render(1.1 * surface.X, nullptr, texture, large, {}, true, nullptr, &again);
  renderer.render(surface.X, nullptr, texture, state, {}, true, nullptr, &again);
  EXPECT_EQ(fresh.I.values, again.I.values);
  EXPECT_EQ(fresh.coverage.values, again.coverage.values);
  EXPECT_EQ(fresh.triangle, again.triangle);
  expect_same(fresh.dI, again.dI);
}

// The program runs on whatever the processor has; the pictures may not depend on it.
TEST(renderer, instruction_sets_agree) {
  const SurfaceMesh surface = test::sphere(Vector3d::Zero(), 8, 3, 0.05);
  Texture texture;
  texture.source = Texture::Source::image;
  texture.image = test::waves(256, 256, 4);
  const PhotoState state = test::state(test::camera("perspective", false));
  const auto picture = [&](int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    return Renderer(surface).render(surface.X, nullptr, texture, state, {}, true);
  };
  const Rendering best = picture(0);
  const std::vector<int64_t> targets = hwy::SupportedAndGeneratedTargets();
  for (int64_t target : targets) {
    SCOPED_TRACE(hwy::TargetName(target));
    const Rendering other = picture(target);
    const test::Joined a = test::joined(other.dI), b = test::joined(best.dI);
    ASSERT_EQ(a.pixel, b.pixel);
    ASSERT_EQ(a.segments.size(), b.segments.size());
    EXPECT_LT((a.d_photo - b.d_photo).norm(), 1e-5f * b.d_photo.norm());
    for (size_t i = 0; i < best.I.values.size(); ++i)
      ASSERT_NEAR(other.I.values[i], best.I.values[i], 1e-6f);
    for (size_t i = 0; i < b.segments.size(); ++i)
      ASSERT_LT((a.segments[i].d_position() - b.segments[i].d_position()).norm(),
                1e-4f + 1e-4f * b.segments[i].d_position().norm());
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace hookeye
