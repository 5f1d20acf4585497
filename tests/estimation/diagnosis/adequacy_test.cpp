// Whether photos still show the body move: as often by chance as told, and seen where it does.
#include "estimation/diagnosis/adequacy.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "estimation/search/measured_explained.h"
#include "estimation/search/verdict.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

using test::SmallScene;

/// 12 x 10 cells of speckle that show noise alone, and `shift` px to the right.
FlowField noisy(std::mt19937& engine, double shift, double information) {
  std::normal_distribution<double> normal;
  FlowField field;
  for (int row = 0; row < 10; ++row)
    for (int column = 0; column < 12; ++column) {
      FlowCell cell{};
      cell.column = column, cell.row = row;
      cell.centre_px = {16.0 * column + 8.0, 16.0 * row + 8.0};
      cell.pixels = 256, cell.known = 3, cell.reliable = true;
      cell.information = information * Eigen::Matrix3d::Identity();
      cell.z = {normal(engine), normal(engine), normal(engine)};
      cell.z.x() += shift * std::sqrt(information);
      cell.estimate = cell.z / std::sqrt(information);
      field.cells.push_back(cell);
    }
  return field;
}

Evaluation with_fields(const Scene& scene, std::mt19937& engine, double shift) {
  Evaluation out;
  for (int e = 0; e < static_cast<int>(scene.capture.examples.size()); ++e) {
    out.examples.emplace_back();
    out.examples.back().example = e;
    for (int k = 0; k < static_cast<int>(scene.capture.examples[e].photos.size()); ++k) {
      PhotoEvaluation photo;
      photo.example = e, photo.photo = k;
      photo.flow = photo.aligned = noisy(engine, e == 0 && k == 0 ? shift : 0.0, 2000.0);
      out.examples.back().photos.push_back(std::move(photo));
    }
  }
  return out;
}

/// Photos of a right model all stay below what they may keep, but for as many cases as told.
TEST(Adequacy, ChanceAloneIsTakenForMotionAsOftenAsTold) {
  const SmallScene small({});
  Scene scene = *small.scene;
  auto limits = std::make_shared<Limits>(*scene.limits);
  limits->floor.chance = 0.1, limits->floor.moved_px = 0.0;
  scene.limits = limits;
  std::mt19937 engine(7);
  const int draws = 600;
  int alarms = 0, seen = 0;
  for (int i = 0; i < draws; ++i) {
    alarms += most_moved(motions_left(scene, with_fields(scene, engine, 0.0), {}, {})) != nullptr;
    const auto moved = motions_left(scene, with_fields(scene, engine, 0.02), {}, {});
    const MotionLeft* most = most_moved(moved);
    seen += most && most->example == 0 && most->photo == 0;
  }
  // 60 expected of 600, three standard deviations either way. The noise is the photo's own, known
  // to a tenth from 120 cells, and taken to be correlated where its lags say so by chance.
  EXPECT_LT(alarms, 82);
  EXPECT_GT(alarms, 20);
  EXPECT_GT(seen, draws * 9 / 10);
}

/// The told model of a capture that hides nothing leaves no motion; of one that hides a weight or
/// a longer lens it does, and is not the explanation whatever chi says.
TEST(Adequacy, MotionIsLeftWhereSomethingIsHidden) {
  const auto asked = [](const std::string& hidden) {
    const SmallScene small({.hidden = hidden, .same_renderer = true});
    Workspace workspace(small.scene);
    Step step = test::base_step(workspace);
    std::string why;
    const Verdict verdict = judge(step.fitted, step.diagnosis, {}, &why);
    return std::tuple(verdict, why, step.diagnosis.motions);
  };
  const auto [right, why, still] = asked("");
  EXPECT_EQ(right, Verdict::explained) << why;
  EXPECT_EQ(most_moved(still), nullptr) << why;
  EXPECT_THAT(still, testing::SizeIs(10)) << "two photos an example, the held-out one's too";
  const auto [wrong, told, moved] = asked(
      "hidden:\n  - {effect: focal_length, variant: cam1, values: {focal_length.cam1: 0.004}}\n");
  EXPECT_EQ(wrong, Verdict::unexplained);
  EXPECT_THAT(told, testing::HasSubstr("of camera 'cam1'"));
  EXPECT_THAT(told, testing::HasSubstr("still shows the body moved smoothly, by 0."));
  ASSERT_NE(most_moved(moved), nullptr);
  EXPECT_EQ(most_moved(moved)->photo, 1);
}

TEST(Adequacy, APhotoThatStillMovesIsNoExplanation) {
  const SmallScene small({.same_renderer = true});
  Workspace workspace(small.scene);
  Step step = test::base_step(workspace);
  ASSERT_TRUE(explained(step.fitted, step.diagnosis));
  step.diagnosis.motions.at(1).px = 1.01 * step.diagnosis.motions[1].most_px;
  EXPECT_FALSE(explained(step.fitted, step.diagnosis));
  EXPECT_FALSE(only_numerical_left(step.fitted, step.diagnosis));
}

}  // namespace
}  // namespace hookeye
