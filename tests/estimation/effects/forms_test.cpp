// Forms that a refit frees: a wall that is oblique to all axes, a lamp that was moved and dimmed,
// one camera that was knocked twice.
#include <gmock/gmock.h>

#include <cmath>
#include <regex>

#include "estimation/effects/catalogue.h"
#include "estimation/fit/at_floor.h"
#include "estimation/search/contest.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

using testing::ElementsAre;

double value(const Fitted& fitted, const std::string& name) {
  const auto parameters = fitted.form.parameters();
  for (size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].name == name) return fitted.p[static_cast<Eigen::Index>(i)];
  ADD_FAILURE() << "no " << name;
  return 0.0;
}

/// Forty degrees off the nearest axis, hard: the search names it and says where it faces.
TEST(Forms, AnObliqueHardWallIsNamed) {
  const test::SmallScene small(
      {.hidden = "hidden:\n  - {effect: floor_contact, variant: \"plane towards (0.766, 0.643, 0), "
                 "position 14.2\", values: {floor_contact.k: 0.05}}\n"});
  const Discovery found = test::discover(small);
  EXPECT_THAT(found.missing, ElementsAre("floor_contact"));
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
  const Fitted& last = found.steps.back().fitted;
  EXPECT_LT(last.evaluation.chi(true), Limits{}.floor.at * found.floor.chi);
  EXPECT_NEAR(last.p[0], 0.02, 2e-4);
  const auto& wall = last.form.ingredients.back();
  const std::string said =
      find_effect("floor_contact")
          ->sentence(last.form.realise(last.p), *wall, last.p.tail(last.p.size() - 1));
  std::smatch n;
  ASSERT_TRUE(std::regex_search(said, n, std::regex("towards \\((\\S+), (\\S+), (\\S+)\\)")))
      << said;
  const Eigen::Vector3d found_normal(std::stod(n[1]), std::stod(n[2]), std::stod(n[3]));
  const double degrees =
      std::acos(found_normal.normalized().dot(Eigen::Vector3d(0.766, 0.643, 0).normalized())) *
      180.0 / EIGEN_PI;
  EXPECT_LT(degrees, 3.0) << said;
  RecordProperty("said", said);
  RecordProperty("held_out_over_floor",
                 std::to_string(last.evaluation.chi(true) / found.floor.chi));
}

/// From one example on the lamp stands 6 degrees elsewhere and gives a seventh less.
TEST(Forms, ALampThatWasMovedAndDimmed) {
  const test::SmallScene small(
      {.hidden = "hidden:\n  - {effect: light_direction, variant: lamp from side on, values: "
                 "{\"light_direction.from side on.angle1\": 0.1, \"light_direction.from side "
                 "on.strength\": -0.15}}\n"});
  const Discovery found = test::discover(small);
  EXPECT_THAT(found.missing, ElementsAre("light_direction"));
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
  EXPECT_EQ(found.steps.size(), 2u);
  const Fitted& last = found.steps.back().fitted;
  EXPECT_NEAR(value(last, "light_direction.from side on.angle1"), 0.1, 0.01);
  EXPECT_NEAR(value(last, "light_direction.from side on.strength"), -0.15, 0.015);
}

/// The lamp that was only moved has no strength left in its form.
TEST(Forms, ALampThatWasOnlyMoved) {
  const test::SmallScene small(
      {.hidden = "hidden:\n  - {effect: light_direction, variant: sun from side on, values: "
                 "{\"light_direction.from side on.angle1\": 0.15}}\n"});
  const Discovery found = test::discover(small);
  EXPECT_THAT(found.missing, ElementsAre("light_direction"));
  EXPECT_EQ(found.steps.back().fitted.form.ingredients.back()->variant(), "sun from side on");
}

TEST(Forms, OneCameraWasKnockedTwice) {
  const test::SmallScene small(
      {.hidden =
           "hidden:\n  - {effect: camera_pose, variant: cam0 from pull on, values: "
           "{\"camera_pose.cam0 from pull on.ry\": 0.004}}\n  - {effect: camera_pose, variant: "
           "cam0 from twist on, values: {\"camera_pose.cam0 from twist on.rx\": -0.003}}\n"});
  const Discovery found = test::discover(small);
  EXPECT_THAT(found.missing, ElementsAre("camera_pose"));
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
  const Fitted& last = found.steps.back().fitted;
  EXPECT_NEAR(value(last, "camera_pose.cam0 from pull on.ry"), 0.004, 4e-4);
  EXPECT_NEAR(value(last, "camera_pose.cam0 from twist on.rx"), -0.003, 4e-4);
}

}  // namespace
}  // namespace hookeye
