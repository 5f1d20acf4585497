// The outline at rest gives the body's place, from 30 degrees and a third of the body off.
#include "placing/outlines.h"

#include <gmock/gmock.h>

#include "placing/placed_capture.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

std::string joined(const std::vector<std::string>& all) {
  std::string text;
  for (const std::string& one : all) text += one + "\n";
  return text;
}

TEST(Outlines, FindThePlaceFromFarOff) {
  std::mt19937 random(3);
  const Vector3d middle = middle_of(Shape::bracket);
  for (int i = 0; i < 3; ++i) {
    const PlacedCapture placed({}, random_motion(middle, 30, 18, random));
    const OutlineFit found = place_by_outlines(placed.scene(), placed.body(), {});
    EXPECT_LT(placed.off(found.placing.motion), 0.15) << i;  // half a pixel is 0.17 mm
    EXPECT_LT(found.placing.misfit, 0.5);
    EXPECT_THAT(found.placing.others, IsEmpty());
    EXPECT_THAT(found.placing.warnings, IsEmpty()) << joined(found.placing.warnings);
  }
}

TEST(Outlines, OfGreyPhotosBeforeBlackAndOfOneCamera) {
  std::mt19937 random(4);
  const Vector3d middle = middle_of(Shape::bracket);
  PlacedSetup setup;
  setup.silhouettes = false;
  const PlacedCapture grey(setup, random_motion(middle, 25, 10, random));
  EXPECT_LT(grey.off(place_by_outlines(grey.scene(), grey.body(), {}).placing.motion), 0.3);
  setup.cameras = 1;
  setup.silhouettes = true;
  const PlacedCapture one(setup, random_motion(middle, 15, 8, random));
  const OutlineFit found = place_by_outlines(one.scene(), one.body(), {});
  // Along the line of sight 1 % of 220 mm is a third of a pixel in the body's size.
  EXPECT_LT(one.off(found.placing.motion), 3.0) << joined(found.placing.warnings);
  EXPECT_LT(found.placing.misfit, 0.5);
}

TEST(Outlines, ErrorsAreThoseOfWhatIsFound) {
  std::mt19937 random(6);
  const Vector3d middle = middle_of(Shape::bracket);
  double sum = 0.0;
  constexpr int kRepeats = 4;
  for (int i = 0; i < kRepeats; ++i) {
    PlacedSetup setup;
    setup.size = {320 + 8 * i, 240 + 6 * i};  // other pixels
    const Isometry3d truth = random_motion(middle, 5, 2, random);
    const PlacedCapture placed(setup, truth);
    const OutlineFit found = place_by_outlines(placed.scene(), placed.body(), {});
    const Eigen::AngleAxisd turn(
        Eigen::Matrix3d(found.placing.motion.linear() * truth.linear().transpose()));
    Vector6d off;
    off << turn.angle() * turn.axis(), found.placing.motion * middle - truth * middle;
    sum += off.dot(found.placing.covariance.ldlt().solve(off));
  }
  // chi2 of six numbers: mean 6, here +- 1.7; too small errors are what users must not get.
  EXPECT_LT(sum / kRepeats, 12.0);
  EXPECT_GT(sum / kRepeats, 0.2);
}

TEST(Outlines, SymmetricBodiesAreToldAsAmbiguous) {
  std::mt19937 random(5);
  PlacedSetup setup;
  setup.shape = Shape::brick;
  const PlacedCapture brick(setup, random_motion(middle_of(Shape::brick), 15, 6, random));
  const OutlineFit found = place_by_outlines(brick.scene(), brick.body(), {});
  EXPECT_LT(brick.off(found.placing.motion), 0.3);  // the nearest of the four
  EXPECT_EQ(found.placing.others.size(), 3u);
  EXPECT_THAT(joined(found.placing.warnings), HasSubstr("ambiguous"));
  setup.shape = Shape::cone;
  const PlacedCapture cone(setup, random_motion(middle_of(Shape::cone), 10, 6, random));
  const OutlineFit round = place_by_outlines(cone.scene(), cone.body(), {});
  EXPECT_THAT(joined(round.placing.warnings),
              testing::AnyOf(HasSubstr("ambiguous"), HasSubstr("a turn about")));
}

TEST(Outlines, WhatShowsNoneIsRefused) {
  PlacedSetup setup;
  setup.silhouettes = false;
  const PlacedCapture placed(setup, Isometry3d::Identity());
  Scene scene = placed.scene();
  for (ExampleSpec& example : scene.capture.examples) example.photos.clear();
  for (auto& photos : scene.photos) photos.clear();
  try {
    place_by_outlines(scene, placed.body(), {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("there is no photo of the body at rest"));
    EXPECT_THAT(error.what(), HasSubstr("--pair"));
  }
}

}  // namespace
}  // namespace hookeye::test
