// Patches found again in pictures made of formulas: speckled faces of unlike brightness, whose
// edges are straight, moved and turned by what is known.
#include "estimation/inspection/patches.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>

#include "inspection/synthetic_photos.h"

namespace hookeye::test {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using inspection::find_patches;
using inspection::Patch;
using inspection::PatchField;

constexpr int kSide = 420, kMargin = 20;

/// Strips of 100 px in turn bright and `dark` times as bright, with speckles of some size [px] and
/// contrast.
struct Strips {
  double dark = 0.15, speckle = 4.0, contrast = 0.15;
  double at(const Vector2d& X, const Speckle& speckles) const {
    const double from_edge = std::fmod(X.x() - 0.1 * X.y() + 810.0, 200.0) - 100.0;
    const double bright = 1.0 / (1.0 + std::exp(-from_edge / 0.7));
    return (1.0 - contrast + contrast * speckles.at(X)) * (dark + (1.0 - dark) * bright);
  }
};

/// Turned about the middle, then shifted mostly along the edges.
struct Moved {
  double turn = 0.0;
  Vector2d shift{5.3, 27.6};
  Matrix2d R() const { return Eigen::Rotation2Dd(turn).toRotationMatrix(); }
  static Vector2d middle() { return {kSide / 2.0, kSide / 2.0}; }
  Vector2d of(const Vector2d& X) const { return middle() + R() * (X - middle()) + shift; }
  Vector2d before(const Vector2d& x) const {
    return middle() + R().transpose() * (x - middle() - shift);
  }
};

PatchField found_again(const Strips& strips, const Moved& moved) {
  const Speckle speckles(3, strips.speckle);
  const auto light = [&](double light, const Vector2d& X) {
    return 0.01 + 0.8 * light * strips.at(X, speckles);
  };
  const Image from = photographed(
      kSide, kSide, [&](const Vector2d& x) { return light(1.0, x); }, 0.004, 1);
  const Image to = photographed(
      kSide, kSide, [&](const Vector2d& x) { return light(0.9, moved.before(x)); }, 0.004, 2);
  std::vector<unsigned char> body(from.pixels(), 0);
  for (int y = kMargin; y < kSide - kMargin; ++y)
    for (int x = kMargin; x < kSide - kMargin; ++x) body[size_t(y * kSide + x)] = 1;
  return find_patches(from, body, to, 77.0, {});
}

/// Found ones that are not where they went, by more than 5 px.
int wrong(const PatchField& field, const Moved& moved) {
  int out = 0;
  for (const Patch& patch : field.patches)
    out += patch.found && (moved.of(patch.at) - patch.at - patch.shift).norm() > 5.0;
  return out;
}

/// Patches are sought by all threads at once, and stand in the order of one.
TEST(Patches, AreTheSameByOneThreadAndByMany) {
  const auto all = [](size_t threads) {
    const tbb::global_control most(tbb::global_control::max_allowed_parallelism, threads);
    std::vector<double> out;
    for (const Patch& patch : found_again({}, {0.1}).patches)
      for (const double value : {patch.at.x(), patch.at.y(), patch.shift.x(), patch.shift.y(),
                                 patch.likeness, patch.elsewhere, double(patch.found)})
        out.push_back(value);
    return out;
  };
  const auto one = all(1);
  EXPECT_GT(one.size(), 70U);
  EXPECT_EQ(all(4), one);
}

TEST(Patches, FaintTextureBesideBrightEdgesDoesNotSlideAlongThem) {
  int found = 0, astray = 0;
  for (const double dark : {0.05, 0.15, 0.3})
    for (const double speckle : {4.0, 6.0})
      for (const double turn : {-0.1, 0.0, 0.1}) {
        const Moved moved{turn};
        const PatchField field = found_again({dark, speckle, 0.15}, moved);
        found += field.found(), astray += wrong(field, moved);
      }
  EXPECT_GT(found, 120);
  EXPECT_LE(astray, found / 40);
}

TEST(Patches, AnEdgeAloneTellsNothing) {
  for (const double dark : {0.05, 0.1, 0.3}) {
    const PatchField field = found_again({dark, 4.0, 0.0}, {});
    EXPECT_EQ(field.found(), 0) << dark;
    EXPECT_LT(field.share(), 0.01) << dark;
  }
}

/// The same everywhere but for whole periods: each patch has many places.
TEST(Patches, APatternThatRepeatsTellsNothing) {
  const auto dots = [](const Vector2d& x) {
    return 0.4 + 0.2 * std::sin(x.x() / 3.0) + 0.2 * std::sin(x.y() / 3.0);
  };
  const Image one = photographed(kSide, kSide, dots, 0.004, 1);
  const Image other = photographed(
      kSide, kSide, [&](const Vector2d& x) { return dots(x - Vector2d(9.0, 4.0)); }, 0.004, 2);
  const std::vector<unsigned char> body(one.pixels(), 1);
  EXPECT_EQ(find_patches(one, body, other, 77.0, {}).found(), 0);
}

TEST(Patches, GoodTextureIsFoundWhereItWent) {
  for (const double dark : {0.1, 1.0})
    for (const double turn : {0.0, 0.1, 0.2}) {
      const Moved moved{turn};
      const PatchField field = found_again({dark, 6.0, 0.75}, moved);
      EXPECT_GT(field.patches.size(), 60U) << dark << " " << turn;
      EXPECT_GT(field.share(), 0.6) << dark << " " << turn;
      EXPECT_EQ(wrong(field, moved), 0) << dark << " " << turn;
    }
  double most = 0.0;
  for (const Patch& patch : found_again({1.0, 6.0, 0.75}, {}).patches)
    if (patch.found) most = std::max(most, (patch.shift - Moved{}.shift).norm());
  EXPECT_LT(most, 0.15) << "px";
}

}  // namespace
}  // namespace hookeye::test
