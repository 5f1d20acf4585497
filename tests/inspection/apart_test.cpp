// What lowers the overlap of silhouettes: a clamp in view is told apart from a body out of place.
#include <gmock/gmock.h>

#include <algorithm>

#include "inspection/inspected_capture.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

/// A grey block in the lower right corner of every photo by cam0, as a clamp or a table would be.
void put_clamp(InspectedCapture& capture, int width, int height, bool moves = false) {
  int k = 0;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(capture.folder() / "photos"))
    if (entry.path().string().find("cam0") != std::string::npos) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    Image image = read_image(file, Encoding{});
    const int right = image.width - 10 - (moves ? 12 * k++ : 0);
    for (int y = image.height - 10 - height; y < image.height - 10; ++y)
      for (int x = right - width; x < right; ++x)
        image.at(x, y) = 0.35f + 0.1f * static_cast<float>((x / 7 + y / 7) % 2);
    write_image(file, image);
  }
}

const PhotoLook& cam0(const Inspection& seen) { return seen.cameras.front(); }

TEST(ApartFrom, ARightCaptureHasNothingToTell) {
  for (const PhotoLook& look : InspectedCapture().inspect({.first_guess = false}).cameras)
    EXPECT_FALSE(look.apart);
}

TEST(ApartFrom, AClampStandsStillAndIsNoFaultOfTheCamera) {
  InspectedCapture capture;
  put_clamp(capture, 90, 120);
  const Inspection seen = capture.inspect({.first_guess = false});
  EXPECT_EQ(said(seen), "");
  EXPECT_LT(cam0(seen).overlap, 0.9);
  ASSERT_TRUE(cam0(seen).apart);
  const Apart& apart = *cam0(seen).apart;
  EXPECT_TRUE(apart.largest_still);
  EXPECT_EQ(apart.photos, 5);
  EXPECT_GT(apart.without_still, 0.95);
  EXPECT_NEAR(apart.x, 400 - 10 - 45, 6);
  EXPECT_NEAR(apart.y, 480 - 10 - 60, 6);
  EXPECT_NEAR(apart.width, 90, 8);
  EXPECT_NEAR(apart.height, 120, 8);
  EXPECT_LT(apart.model_alone, 0.03);
}

TEST(ApartFrom, WhatMovesIsNoClamp) {
  InspectedCapture capture;
  put_clamp(capture, 90, 120, true);
  const Inspection seen = capture.inspect({.first_guess = false});
  ASSERT_TRUE(cam0(seen).apart);
  EXPECT_FALSE(cam0(seen).apart->largest_still);
  EXPECT_NEAR(cam0(seen).apart->without_still, cam0(seen).overlap, 1e-3);
}

/// Without a texture only silhouettes tell whether a camera is right.
TEST(ApartFrom, ALargeClampIsNotTakenForAWrongCamera) {
  InspectedCapture capture;
  capture.change("texture: \\{image[^}]*\\}", "texture: {uniform: 0.5}");
  put_clamp(capture, 190, 420);
  const Inspection seen = capture.inspect({.first_guess = false});
  EXPECT_LT(cam0(seen).overlap, 0.7);
  EXPECT_EQ(said(seen), "");
}

TEST(ApartFrom, AWrongCameraIsToldAllTheSame) {
  InspectedCapture capture;
  capture.change("texture: \\{image[^}]*\\}", "texture: {uniform: 0.5}");
  capture.change("fx: 2100, fy: 2100", "fx: 1100, fy: 1100");
  EXPECT_THAT(said(capture.inspect({.first_guess = false})), HasSubstr("does not see the body"));
}

}  // namespace
}  // namespace hookeye::test
