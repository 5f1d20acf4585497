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
  PhotoState state = test::state(test::camera(Camera::Projection::perspective, false));
  for (bool from_photo : {false, true}) {
    if (from_photo) {
      texture.source = Texture::Source::photo;
      texture.photo = test::waves(state.camera.width, state.camera.height, 3);
      texture.reference_camera = state.camera;
      state.shaded = false;
    }
    const Matrix3Xd x = surface.X + 0.1 * test::field(surface.X, 0.2);
    const Rendering out = renderer.render(x, &surface.X, texture, state, {}, true);
    const Eigen::Index n = Eigen::Index(out.dI.pixel.size()), m = 7, nv = 3 * x.cols();
    srand(1);
    VertexSensitivity S;
    S.position = Eigen::MatrixXd::Random(nv, m);
    S.second = Eigen::MatrixXd::Random(nv, m);
    S.photo = Eigen::MatrixXd::Random(kPhotoColumns, m);
    const VectorXd r = VectorXd::Random(n), w = VectorXd::Random(n).array() + 1.5;
    const VectorXd Bt_r = w.cwiseProduct(r);
    Eigen::MatrixXd J = out.dI.d_photo.cast<double>().transpose() * S.photo;
    for (Eigen::Index i = 0; i < n; ++i)
      for (int s = out.dI.first[i]; s < out.dI.first[i + 1]; ++s)
        for (int k = 0; k < 3; ++k) {
          const DerivativeSegment& g = out.dI.segments[s];
          const int v = 3 * surface.triangles[g.triangle][k];
          J.row(i) += g.d_position.col(k).cast<double>().transpose() * S.position.middleRows(v, 3);
          J.row(i) += g.d_second.col(k).cast<double>().transpose() * S.second.middleRows(v, 3);
        }
    J = (w.asDiagonal() * J).eval();
    const auto sums = NodeNormalEquations::accumulate(surface, out.dI, r, w, Bt_r, true);
    const CondensedPhoto c = sums.reduce(S);
    EXPECT_LT((c.JtJ - J.transpose() * J).norm(), 1e-5 * c.JtJ.norm());
    EXPECT_LT((c.Jtr - J.transpose() * r).norm(), 1e-5 * c.Jtr.norm());
    EXPECT_NEAR(c.r2, r.squaredNorm(), 1e-9 * c.r2);
    EXPECT_EQ(c.count, size_t(n));
  }
}

TEST(renderer, threads_agree_bit_by_bit) {
  const SurfaceMesh surface = test::sphere(Vector3d::Zero(), 8, 3, 0.05);
  Renderer renderer(surface);
  Texture texture;
  const PhotoState state = test::state(test::camera(Camera::Projection::perspective, false));
  RenderOptions one, two;
  two.threads = 2;
  const Rendering a = renderer.render(surface.X, nullptr, texture, state, one, true);
  const Rendering b = renderer.render(surface.X, nullptr, texture, state, two, true);
  EXPECT_EQ(a.I.values, b.I.values);
  EXPECT_EQ(a.dI.pixel, b.dI.pixel);
  EXPECT_TRUE(a.dI.d_photo == b.dI.d_photo);
  ASSERT_EQ(a.dI.segments.size(), b.dI.segments.size());
  for (size_t i = 0; i < a.dI.segments.size(); ++i)
    ASSERT_TRUE(a.dI.segments[i].d_position == b.dI.segments[i].d_position);
}

// The program runs on whatever the processor has; the pictures may not depend on it.
TEST(renderer, instruction_sets_agree) {
  const SurfaceMesh surface = test::sphere(Vector3d::Zero(), 8, 3, 0.05);
  Texture texture;
  texture.source = Texture::Source::image;
  texture.image = test::waves(256, 256, 4);
  const PhotoState state = test::state(test::camera(Camera::Projection::perspective, false));
  const auto picture = [&](int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    return Renderer(surface).render(surface.X, nullptr, texture, state, {}, true);
  };
  const Rendering best = picture(0);
  const std::vector<int64_t> targets = hwy::SupportedAndGeneratedTargets();
  for (int64_t target : targets) {
    SCOPED_TRACE(hwy::TargetName(target));
    const Rendering other = picture(target);
    ASSERT_EQ(other.dI.pixel, best.dI.pixel);
    ASSERT_EQ(other.dI.segments.size(), best.dI.segments.size());
    EXPECT_LT((other.dI.d_photo - best.dI.d_photo).norm(), 1e-5f * best.dI.d_photo.norm());
    for (size_t i = 0; i < best.I.values.size(); ++i)
      ASSERT_NEAR(other.I.values[i], best.I.values[i], 1e-6f);
    for (size_t i = 0; i < best.dI.segments.size(); ++i)
      ASSERT_LT((other.dI.segments[i].d_position - best.dI.segments[i].d_position).norm(),
                1e-4f + 1e-4f * best.dI.segments[i].d_position.norm());
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace hookeye
