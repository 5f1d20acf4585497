#include <gtest/gtest.h>

#include <cmath>

#include "capture_io/capture.h"
#include "capture_io/capture_folder.h"
#include "capture_io/photo_reader.h"
#include "support/shared_data.h"

namespace hookeye::test {
namespace {

Camera camera_of(int width, int height) {
  Camera camera;
  camera.name = "front";
  camera.width = width, camera.height = height;
  return camera;
}

PhotoSpec spec_of(const std::filesystem::path& file) {
  PhotoSpec spec;
  spec.camera = "front";
  spec.file = file;
  spec.place = {"capture.yaml", 7, 3};
  spec.noise = NoiseModel{10000, 0.002, false};
  return spec;
}

const Image colours{2, 1, 3, {0.5f, 0.25f, 0.125f, 0.1f, 1.0f, 0.2f}};

TEST(ReadPhotoTest, ColourBecomesLuminanceWithItsNoise) {
  const TemporaryFolder folder;
  write_image(folder / "a.exr", colours);
  const Photo photo = read_photo(spec_of(folder / "a.exr"), camera_of(2, 1));
  ASSERT_EQ(photo.planes.size(), 1u);
  EXPECT_NEAR(photo.planes[0]->at(0, 0), 0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722 * 0.125, 1e-6);
  EXPECT_EQ(photo.channel_weights, (std::vector<double>{0.2126, 0.7152, 0.0722}));
  const double r = 4e-6;  // read noise squared
  const double variance = std::pow(0.2126, 2) * (r + 0.5 / 1e4) +
                          std::pow(0.7152, 2) * (r + 0.25 / 1e4) +
                          std::pow(0.0722, 2) * (r + 0.125 / 1e4);
  EXPECT_NEAR(photo.sigma[0]->at(0, 0), std::sqrt(variance), 1e-7);
  EXPECT_EQ(*photo.valid, (std::vector<unsigned char>{1, 1})) << "floats do not saturate";
}

TEST(ReadPhotoTest, RgbKeepsThreePlanes) {
  const TemporaryFolder folder;
  write_image(folder / "a.exr", colours);
  PhotoSpec spec = spec_of(folder / "a.exr");
  spec.rgb = true;
  const Photo photo = read_photo(spec, camera_of(2, 1));
  ASSERT_EQ(photo.planes.size(), 3u);
  EXPECT_EQ(photo.planes[2]->at(1, 0), 0.2f);
  EXPECT_EQ(photo.channel_weights, (std::vector<double>{1, 1, 1}));
  EXPECT_NEAR(photo.sigma[1]->at(0, 0), std::sqrt(4e-6 + 0.25 / 1e4), 1e-8);
}

TEST(ReadPhotoTest, SaturatedAndMaskedPixelsDoNotCount) {
  const TemporaryFolder folder;
  write_image(folder / "a.png", colours, {Encoding::Kind::srgb, 1});
  PhotoSpec spec = spec_of(folder / "a.png");
  EXPECT_EQ(*read_photo(spec, camera_of(2, 1)).valid, (std::vector<unsigned char>{1, 0}));
  write_image(folder / "mask.png", {2, 1, 1, {0, 1}});
  spec.mask = folder / "mask.png";
  EXPECT_EQ(*read_photo(spec, camera_of(2, 1)).valid, (std::vector<unsigned char>{0, 0}));
}

TEST(ReadPhotoTest, SilhouettesKeepTheirValues) {
  const TemporaryFolder folder;
  write_image(folder / "a.png", {3, 1, 1, {0, 0.4f, 1}});
  PhotoSpec spec = spec_of(folder / "a.png");
  spec.kind = PhotoSpec::Kind::silhouette;
  spec.noise.reset();
  const Photo photo = read_photo(spec, camera_of(3, 1));
  EXPECT_EQ(photo.planes[0]->at(0, 0), 0);
  EXPECT_NEAR(photo.planes[0]->at(1, 0), 0.4, 1e-6);
  EXPECT_EQ(photo.planes[0]->at(2, 0), 1);
  EXPECT_EQ(*photo.valid, (std::vector<unsigned char>{1, 1, 1}));
  EXPECT_GT(photo.sigma[0]->at(0, 0), 0);
}

TEST(ReadPhotoTest, EstimatedNoiseIsNeverBelowRounding) {
  const TemporaryFolder folder;
  write_image(folder / "a.png", {32, 32, 1, std::vector<float>(1024, 0.5f)});
  PhotoSpec spec = spec_of(folder / "a.png");
  spec.noise.reset();
  spec.encoding = Encoding{};
  const Photo photo = read_photo(spec, camera_of(32, 32));
  EXPECT_TRUE(photo.noise.estimated);
  EXPECT_NEAR(photo.noise.read, 1 / (256 * std::sqrt(12.0)), 1e-9);
}

TEST(ReadPhotoTest, SizeIsTheCamerasSize) {
  const TemporaryFolder folder;
  write_image(folder / "a.exr", colours);
  try {
    read_photo(spec_of(folder / "a.exr"), camera_of(1, 2));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "capture.yaml:7:3: the photo has 2 x 1 pixels, camera `front` has 1 x 2\n"
                 "  photos are compared at the size that the camera was calibrated for");
  }
}

TEST(PhotoReaderTest, WhatPhotosShareIsReadOnceAndHeldOnce) {
  const TemporaryFolder folder;
  for (const char* name : {"a.exr", "b.exr", "empty.exr"}) write_image(folder / name, colours);
  write_image(folder / "mask.png", {2, 1, 1, {0, 1}});
  PhotoSpec spec = spec_of(folder / "a.exr");
  spec.mask = folder / "mask.png";
  spec.background.kind = BackgroundSpec::Kind::photo;
  spec.background.photo = folder / "empty.exr";
  PhotoReader reader;
  const Photo first = reader.read(spec, camera_of(2, 1), Weighed::yes);
  std::filesystem::remove(folder / "mask.png");
  std::filesystem::remove(folder / "empty.exr");
  spec.file = folder / "b.exr";
  const Photo second = reader.read(spec, camera_of(2, 1), Weighed::no);
  EXPECT_EQ(*second.valid, (std::vector<unsigned char>{0, 1}));
  EXPECT_EQ(second.backdrop.at(0).pointer(), first.backdrop.at(0).pointer());
  EXPECT_EQ(second.backdrop[0]->values, second.planes[0]->values);
  EXPECT_EQ(second.planes[0]->values, first.planes[0]->values);
  EXPECT_TRUE(second.sigma.empty());
  // By channels it is read another way.
  spec.rgb = true;
  EXPECT_THROW(reader.read(spec, camera_of(2, 1), Weighed::no), InputError);
}

/// Photos of another program. To the law that was added come rounding and whatever the renderer's
/// own sampling leaves, so the estimate may lie above the told law, never below it.
TEST(ReadPhotoTest, NoiseOfRenderedPhotosIsFound) {
  HOOKEYE_NEEDS_DATA("hidden/case_a2");
  const Capture capture = read_capture(shared_data() / "hidden/case_a2");
  PhotoSpec spec = capture.examples[0].photos[0];
  const NoiseModel told = *spec.noise;
  spec.noise.reset();
  const NoiseModel found = read_photo(spec, capture.camera(spec.camera)).noise;
  for (const double intensity : {0.2, 0.4, 0.6}) {
    const double expected = std::hypot(told.sigma(intensity), 1 / (255 * std::sqrt(12.0)));
    EXPECT_GT(found.sigma(intensity) / expected, 0.95) << "at " << intensity;
    EXPECT_LT(found.sigma(intensity) / expected, 1.5) << "at " << intensity;
  }
}

}  // namespace
}  // namespace hookeye::test
