// A fit that has seen a part of the pixels, told by all of them.
#include "estimation/fit/over_all_pixels.h"

#include <gmock/gmock.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "core/input_error.h"
#include "core/text_file.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/output/pixels_json.h"
#include "tests/estimation/large_photos.h"

namespace hookeye::test {
namespace {

using ::testing::HasSubstr;

/// Halved once and in half of the tiles, as photos of many megapixels are.
std::shared_ptr<const Scene> in_part() {
  static const auto scene = [] {
    auto out = std::make_shared<Scene>(*read_with(2e4, 0.3));
    PhotoReading half;
    half.share = 0.5;
    for (auto& photos : out->photos)
      for (Photo& photo : photos) photo = as_read(photo, half, photo.camera);
    for (auto& [camera, reading] : out->readings) reading.share = 0.5;
    return out;
  }();
  return scene;
}

Evaluation taken(Workspace& workspace, const Fitted& at, int tile_px, double huber = 0.0) {
  EvaluationOptions options;
  options.pictures = options.held_out = options.all_pixels = true;
  options.tile_px = tile_px;
  options.huber = huber;
  return workspace.evaluate(at.form, at.p, options).value();
}

Fitted over_all(Workspace& workspace, const Fitted& fitted) {
  auto all = over_all_pixels(workspace, fitted).value();
  EXPECT_TRUE(all.has_value());
  return all.value_or(fitted);
}

TEST(OverAllPixels, NothingIsLeftWhereTheFitHasSeenThem) {
  Workspace workspace(large_photos().scene);
  const Fitted fitted = base_fit(workspace);
  EXPECT_FALSE(over_all_pixels(workspace, fitted).value().has_value());
}

TEST(OverAllPixels, TheyTellWhatAFitToThemWouldHaveFound) {
  Workspace part(in_part()), whole(large_photos().scene);
  const Fitted fitted = base_fit(part), truth = base_fit(whole);
  const Fitted out = over_all(part, fitted);
  const AllPixels& all = *out.all_pixels;
  const double white = 1.0 / std::sqrt(normal_equations(out.evaluation).JtJ(0, 0));
  const double of_read = 1.0 / std::sqrt(normal_equations(fitted.evaluation).JtJ(0, 0));
  // Rays that change triangles make the misfit rough: a fit ends within half a standard error.
  EXPECT_NEAR(all.value[0], truth.p[0], 1.5 * white);
  EXPECT_LT(std::abs(all.value[0] - truth.p[0]), 0.3 * std::abs(fitted.p[0] - truth.p[0]));
  const double error = (truth.high[0] - truth.low[0]) / (2 * 1.96);
  EXPECT_NEAR(all.error[0], error, 0.1 * error);
  EXPECT_NEAR(all.chi_fit, truth.evaluation.chi(false), 0.005);
  EXPECT_NEAR(all.chi_validate, truth.evaluation.chi(true), 0.005);
  EXPECT_GT(all.share, 0.02);  // a few tiles, of which the body fills few
  EXPECT_LT(all.share, 0.9);
  EXPECT_EQ(out.p, fitted.p);
  EXPECT_NEAR(std::sqrt(out.low[0] * out.high[0]), all.value[0], 1e-4 * all.value[0]);
  // What the missing pixels add is the difference of the two covariances of white noise.
  EXPECT_GT(of_read, 1.3 * white) << "half of the tiles, halved";
  EXPECT_NEAR(std::hypot(all.added[0], white), of_read, 0.01 * of_read);
}

TEST(OverAllPixels, SumsAndPicturesAreThoseOfWholePhotosWhateverTheTiles) {
  Workspace part(in_part()), whole(large_photos().scene);
  const Fitted fitted = base_fit(part);
  const Evaluation one = taken(part, fitted, 4096), many = taken(part, fitted, 128);
  EvaluationOptions options;
  options.held_out = true;
  const ModelForm form = base_form(large_photos().scene);
  const Evaluation all = whole.evaluate(form, fitted.p, options).value();
  for (size_t e = 0; e < all.examples.size(); ++e)
    for (size_t k = 0; k < all.examples[e].photos.size(); ++k) {
      const PhotoEvaluation& seen = all.examples[e].photos[k];
      for (const Evaluation* tiled : {&one, &many}) {
        const PhotoEvaluation& photo = tiled->examples[e].photos[k];
        EXPECT_NEAR(photo.sums.JtJ(0, 0), seen.sums.JtJ(0, 0), 1e-4 * seen.sums.JtJ(0, 0) + 1e-9);
        EXPECT_NEAR(photo.sums.Jtr[0], seen.sums.Jtr[0],
                    1e-2 * std::sqrt(seen.sums.JtJ(0, 0)) + 1e-9);
        EXPECT_NEAR(photo.taken_count, seen.count, 2.0);  // rays through the last edge
        EXPECT_NEAR(photo.taken_r2, seen.r2, 1e-4 * seen.r2);
      }
      const PhotoEvaluation& a = one.examples[e].photos[k];
      const PhotoEvaluation& b = many.examples[e].photos[k];
      EXPECT_NEAR(a.count, b.count, 2.0);
      ASSERT_EQ(a.triangle.size(), b.triangle.size());
      double others = 0.0;
      for (size_t i = 0; i < a.triangle.size(); ++i) others += a.triangle[i] != b.triangle[i];
      EXPECT_LT(others, 1e-3 * static_cast<double>(a.triangle.size())) << "rays along an edge";
      EXPECT_GT(4.0 * a.count, 0.8 * a.taken_count) << "no gaps between tiles";
      EXPECT_NEAR(a.r2 / a.count, 1.0, 0.3);
    }
}

/// The capture with another text: whole, and read in part.
struct Retold {
  std::shared_ptr<const Scene> whole, part;
};
Retold retold(const std::string& name,
              const std::vector<std::pair<std::string, std::string>>& changes) {
  const auto told = large_photos().scene->capture.file;
  std::string text = read_text(told);
  for (const auto& [from, to] : changes) text = std::regex_replace(text, std::regex(from), to);
  const auto file = told.parent_path() / (name + ".yaml");
  write_text(file, text);
  Limits limits;
  limits.fit.brightness_cell = 0.0;  // its cells are of the size that is read
  Retold out;
  out.whole = load_scene(read_capture(file), true, limits);
  limits.fit.pixels = 2e4;
  limits.fit.pixels_keep = 0.3;
  out.part = load_scene(read_capture(file), true, limits);
  return out;
}

/// Sums of all pixels are those of the whole photos, at the values that are told.
void expect_same_sums(const Retold& scenes) {
  ASSERT_TRUE(scenes.part->in_part());
  const auto sums_of = [](const std::shared_ptr<const Scene>& scene, bool all_pixels) {
    Workspace workspace(scene);
    EvaluationOptions options;
    options.all_pixels = options.pictures = all_pixels;
    const ModelForm form = base_form(scene);
    return workspace.evaluate(form, form.initial(), options).value();
  };
  const Evaluation all = sums_of(scenes.whole, false), taken = sums_of(scenes.part, true);
  int compared = 0;
  for (size_t e = 0; e < all.examples.size(); ++e)
    for (size_t k = 0; k < all.examples[e].photos.size(); ++k) {
      const PhotoEvaluation& seen = all.examples[e].photos[k];
      const PhotoEvaluation& photo = taken.examples[e].photos.at(k);
      EXPECT_NEAR(photo.taken_count, seen.count, 0.001 * seen.count);
      EXPECT_NEAR(photo.taken_r2, seen.r2, 0.002 * seen.r2);
      EXPECT_NEAR(photo.sums.JtJ(0, 0), seen.sums.JtJ(0, 0), 0.002 * seen.sums.JtJ(0, 0) + 1e-9);
      ++compared;
    }
  EXPECT_GT(compared, 0);
}

TEST(OverAllPixels, ATextureThatIsAPhotoIsTheTakenOne) {
  expect_same_sums(
      retold("rest_texture", {{"texture: \\{image[^}]*\\}", "texture: {from: rest}"}}));
}

TEST(OverAllPixels, SilhouettesAreComparedAsTheyWereTaken) {
  expect_same_sums(retold(
      "silhouettes", {{"(cam[01]): (photos/[a-z_01.]*)", "$1: {file: $2, kind: silhouette}"}}));
}

TEST(OverAllPixels, TheSameBytesOnOneThread) {
  Workspace part(in_part());
  const Fitted fitted = base_fit(part);
  const Workspace::Place place = part.place();
  const Evaluation many = taken(part, fitted, 128);
  part.start_from(place);
  tbb::task_arena one(1);
  const Evaluation alone = one.execute([&] { return taken(part, fitted, 128); });
  part.start_from(place);
  const Evaluation again = taken(part, fitted, 128);
  for (size_t e = 0; e < many.examples.size(); ++e)
    for (size_t k = 0; k < many.examples[e].photos.size(); ++k)
      for (const Evaluation* other : {&alone, &again}) {
        const PhotoEvaluation& b = other->examples[e].photos[k];
        EXPECT_EQ(many.examples[e].photos[k].sums.JtJ, b.sums.JtJ);
        EXPECT_EQ(many.examples[e].photos[k].sums.Jtr, b.sums.Jtr);
        EXPECT_EQ(many.examples[e].photos[k].taken_r2, b.taken_r2);
      }
}

TEST(OverAllPixels, APhotoThatChangedOrWentIsNamed) {
  const SmallScene own({.recipe = kLargePhotos});
  const auto scene = read_with(2e4, 0.3, own);
  Workspace workspace(scene);
  const Fitted fitted = base_fit(workspace);
  const auto& photos = scene->capture.examples[1].photos;
  const auto file = photos[0].file, other = photos[1].file;
  std::filesystem::copy_file(other, file, std::filesystem::copy_options::overwrite_existing);
  try {
    over_all_pixels(workspace, fitted);
    FAIL() << "another photo passed for the one that was fitted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(file.filename().string()));
    EXPECT_THAT(error.what(), HasSubstr("changed"));
  }
  std::filesystem::remove(file);
  try {
    over_all_pixels(workspace, fitted);
    FAIL() << "a photo that is not there was read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(file.filename().string()));
  }
}

TEST(OverAllPixels, WhatIsWrittenIsReadBack) {
  Workspace part(in_part());
  Fitted fitted = base_fit(part);
  const Fitted out = over_all(part, fitted);
  const nlohmann::json told = all_pixels_json(out);
  const auto known = all_pixels_in(told, fitted.form.parameters());
  ASSERT_TRUE(known.has_value());
  take_all_pixels(*known, &fitted);
  EXPECT_EQ(fitted.low, out.low);
  EXPECT_EQ(fitted.high, out.high);
  EXPECT_THAT(all_pixels_in_words(told), HasSubstr("mu"));
  nlohmann::json damaged = told;
  damaged["parameters"][0]["name"] = "other";
  EXPECT_FALSE(all_pixels_in(damaged, fitted.form.parameters()).has_value());
  damaged = told;
  damaged["parameters"][0]["value"] = nullptr;
  EXPECT_FALSE(all_pixels_in(damaged, fitted.form.parameters()).has_value());
}

}  // namespace
}  // namespace hookeye::test
