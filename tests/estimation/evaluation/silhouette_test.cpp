// Silhouettes: contours lead a far body home, and a held-out example's own motion is fitted to it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "estimation/fit/fit.h"
#include "estimation/fit/floor.h"
#include "estimation/images/registration.h"
#include "support/temporary_folder.h"

namespace hookeye {
namespace {

using Eigen::Vector2d;
constexpr int kSize = 200;
constexpr double kScale = 3.0;  // px/mm
constexpr double kHalf = 15.0;  // mm: the block's half width

/// Share of every pixel, by 6 x 6 samples, where `inside` holds.
template <class Inside>
Image coverage(Inside inside) {
  Image image{kSize, kSize, 1, std::vector<float>(kSize * kSize, 0.0f)};
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      for (int k = 0; k < 36; ++k) {
        const Vector2d px(x - 0.5 + (k % 6 + 0.5) / 6.0, y - 0.5 + (k / 6 + 0.5) / 6.0);
        image.at(x, y) += inside(px) ? 1.0f / 36.0f : 0.0f;
      }
  return image;
}

Image disc(const Vector2d& centre) {
  return coverage([&](const Vector2d& px) { return (px - centre).norm() < 40.0; });
}

Image difference(const Image& a, const Image& b) {
  Image out = a;
  for (size_t i = 0; i < out.values.size(); ++i) out.values[i] -= b.values[i];
  return out;
}

/// The motion of the model that `linear` asks for: least squares over the pixels.
Vector2d asked_motion(const Image& model, const Image& linear) {
  Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
  Vector2d g = Vector2d::Zero();
  for (int y = 2; y < kSize - 2; ++y)
    for (int x = 2; x < kSize - 2; ++x) {
      if (std::isnan(linear.at(x, y))) continue;
      const Vector2d by_motion = -picture_slope(model, x, y);
      H += by_motion * by_motion.transpose();
      g += by_motion * linear.at(x, y);
    }
  return -H.ldlt().solve(g);
}

Image one() { return {kSize, kSize, 1, std::vector<float>(kSize * kSize, 1.0f)}; }

TEST(SilhouetteRegistration, OneStepLeadsAFarDiscHome) {
  const Vector2d centre(100.0, 98.0), moved(113.0, 89.0);
  const Image model = disc(centre), photo = disc(moved);
  const Registration seen = register_silhouettes(model, photo, {}, difference(model, photo), one());
  EXPECT_GT(seen.rms_px, 8.0);
  // The way along the old normals is not that of the motion: one step comes within a tenth.
  EXPECT_LT((asked_motion(model, seen.linear) - (moved - centre)).norm(), 1.6);
  // The plain residual knows of one pixel.
  EXPECT_LT(asked_motion(model, difference(model, photo)).norm(), 3.0);
}

TEST(SilhouetteRegistration, SmallMotionsKeepThePlainResidual) {
  const Image model = disc({100.0, 98.0}), photo = disc({100.05, 98.0});
  const Image plain = difference(model, photo);
  const Registration seen = register_silhouettes(model, photo, {}, plain, one());
  EXPECT_EQ(seen.linear.values, plain.values);
  EXPECT_EQ(seen.rms_px, 0.0);
}

TEST(SilhouetteRegistration, WhatIsMaskedOutLeadsNowhere) {
  const Image model = disc({100.0, 98.0}), photo = disc({110.0, 98.0});
  std::vector<unsigned char> valid(kSize * kSize, 1);
  for (int y = 0; y < kSize; ++y)
    for (int x = 100; x < kSize; ++x) valid[y * kSize + x] = 0;
  Image plain = difference(model, photo);
  for (size_t i = 0; i < valid.size(); ++i)
    if (!valid[i]) plain.values[i] = std::nanf("");
  const Registration seen = register_silhouettes(model, photo, valid, plain, one());
  for (size_t i = 0; i < valid.size(); ++i)
    ASSERT_EQ(valid[i] == 0, std::isnan(seen.linear.values[i]));
  EXPECT_NEAR(asked_motion(model, seen.linear).x(), 10.0, 1.0);
}

/// A jaw of the block, moved as a whole: where its outline lies [mm], turned about the jaw's
/// middle.
struct Jaw {
  double turn;
  Vector2d move;
};

/// The outline in the picture of a camera that looks along -z.
Image outline(const Jaw& jaw) {
  const Eigen::Rotation2Dd back(-jaw.turn);
  const Vector2d centre(0.0, -kHalf), middle(kSize / 2 - 0.5, kSize / 2 - 0.5);
  return coverage([&](const Vector2d& px) {
    const Vector2d x = (px - middle).cwiseProduct(Vector2d(1.0, -1.0)) / kScale;
    const Vector2d X = centre + back * (x - jaw.move - centre);
    return X.cwiseAbs().maxCoeff() < kHalf;
  });
}

void write_capture(const std::filesystem::path& folder, const Jaw& fitted, const Jaw& held_out,
                   const std::string& support = "rigid: fit") {
  write_image(folder / "fitted.tif", outline(fitted), Encoding{});
  write_image(folder / "held.tif", outline(held_out), Encoding{});
  std::ofstream(folder / "block.obj")
      << "v -15 -15 0\nv 15 -15 0\nv 15 15 0\nv -15 15 0\nv -15 -15 -0.4\nv 15 -15 -0.4\n"
         "v 15 15 -0.4\nv -15 15 -0.4\nf 1 2 3\nf 1 3 4\nf 5 7 6\nf 5 8 7\nf 1 5 6\nf 1 6 2\n"
         "f 2 6 7\nf 2 7 3\nf 3 7 8\nf 3 8 4\nf 4 8 5\nf 4 5 1\n";
  std::ofstream(folder / "capture.yaml") << fmt::format(
      R"(hookeye: 1
units: {{length: mm, force: N}}
body: {{surface: block.obj, mesh: {{edge: 12, order: 2}}}}
model: {{material: {{law: neo-hookean, mu: 1, kappa: 1}}}}
cameras:
  front:
    size: [{0}, {0}]
    projection: orthographic
    intrinsics: {{scale: {1}, cx: {2}, cy: {2}}}
    pose: {{rotation: [[1, 0, 0], [0, -1, 0], [0, 0, -1]], translation: [0, 0, 100]}}
regions:
  bottom: {{halfspace: {{point: [0, -14.99, 0], normal: [0, -1, 0]}}}}
examples:
  fitted:
    supports: [{{region: bottom, {3}}}]
    photos: {{front: {{file: fitted.tif, kind: silhouette}}}}
  held:
    use: validate
    supports: [{{region: bottom, {3}}}]
    photos: {{front: {{file: held.tif, kind: silhouette}}}}
)",
      kSize, kScale, kSize / 2 - 0.5, support);
}

double value_of(const Fitted& fitted, const std::string& name) {
  const auto all = fitted.form.parameters();
  for (size_t i = 0; i < all.size(); ++i)
    if (all[i].name == name) return fitted.p[i];
  throw std::out_of_range(name);
}

void expect_jaw(const Fitted& fitted, const std::string& example, const Jaw& jaw) {
  // One pixel is 0.33 mm; the outline's some 300 px know it to a few hundredths of one.
  EXPECT_NEAR(value_of(fitted, example + ".bottom.tx"), jaw.move.x(), 0.02) << example;
  EXPECT_NEAR(value_of(fitted, example + ".bottom.ty"), jaw.move.y(), 0.02) << example;
  EXPECT_NEAR(value_of(fitted, example + ".bottom.rz"), jaw.turn, 0.002) << example;
}

/// Motions of a fifth of the body, from zero; the held-out one is no part of the model and is found
/// in its own photo.
TEST(Silhouette, JawsAreFoundFromFarInFittedAndHeldOutPhotos) {
  const test::TemporaryFolder folder;
  const Jaw near{0.08, {5.5, -3.0}}, held{-0.06, {-4.0, 6.0}};
  write_capture(folder.path(), near, held);
  auto scene = load_scene(read_capture(folder.path()));
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  auto result = fit(workspace, form, form.initial());
  ASSERT_TRUE(result.has_value()) << result.error().reason;
  const Fitted& fitted = *result;
  expect_jaw(fitted, "fitted", near);
  expect_jaw(fitted, "held", held);
  // Along the line of sight nothing is seen; across it everything is.
  EXPECT_THAT(fitted.undetermined, testing::Contains(testing::HasSubstr("held.bottom.tz")));
  for (const auto& sentence : fitted.undetermined)
    EXPECT_THAT(sentence, testing::Not(testing::HasSubstr("bottom.tx")));
}

/// A body at rest of another shape than the model: its contour is off by more than its pixels can
/// show, and what noise would leave is still no more than what is there.
TEST(Silhouette, TheFloorIsNoMoreThanTheMisfit) {
  const test::TemporaryFolder folder;
  write_capture(folder.path(), {0.0, {0.0, 0.0}}, {0.0, {0.0, 0.0}}, "fix: [x, y, z]");
  const Image wavy = coverage([](const Vector2d& px) {
    const Vector2d x = (px - Vector2d::Constant(kSize / 2 - 0.5)) / kScale;
    return std::abs(x.x()) < kHalf + 3.0 * std::sin(x.y()) &&
           std::abs(x.y()) < kHalf + 3.0 * std::cos(x.x());
  });
  write_image(folder.path() / "fitted.tif", wavy, Encoding{});
  auto scene = load_scene(read_capture(folder.path()));
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto fitted = assess(workspace, form, form.initial()).value();
  const Floor floor = measure_floor(*scene, fitted.evaluation);
  EXPECT_EQ(floor.source, "rest photos");
  EXPECT_LE(floor.chi, fitted.evaluation.chi(false));
  EXPECT_GT(floor.chi, 0.0);
}

}  // namespace
}  // namespace hookeye
