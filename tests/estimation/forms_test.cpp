// Forms that a refit frees: a wall that is oblique to all axes.
#include <gmock/gmock.h>

#include <cmath>
#include <regex>

#include "estimation/contest.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

using testing::ElementsAre;

/// Forty degrees off the nearest axis, hard: the search names it and says where it faces.
TEST(Forms, AnObliqueHardWallIsNamed) {
  const test::SmallScene small(
      {.hidden = "hidden:\n  - {effect: floor_contact, variant: \"plane towards (0.766, 0.643, 0), "
                 "position 14.2\", values: {floor_contact.k: 0.05}}\n"});
  const Discovery found = test::discover(small);
  EXPECT_THAT(found.missing, ElementsAre("floor_contact"));
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
  const Fitted& last = found.steps.back().fitted;
  EXPECT_LT(last.evaluation.chi(true), kAtFloor * found.floor.chi);
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

}  // namespace
}  // namespace hookeye
