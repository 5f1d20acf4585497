// Searches in captures whose cameras are known as well as a calibration tells.
#include <gmock/gmock.h>

#include "tests/estimation/small_capture.h"

namespace hookeye::test {
namespace {

Discovery searched(double deviations) {
  const SmallScene small(
      {.hidden = deviations > 0.0 ? knocked(deviations) : "", .same_renderer = true});
  const auto scene = with_known_cameras(*small.scene);
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  return discover(workspace, form, form.initial(), {}).value();
}

/// What a calibration may be off by is no effect that a model lacks.
TEST(KnownCameras, ADeviationIsNoEffect) {
  const Discovery found = searched(1.0);
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
  EXPECT_THAT(found.missing, testing::IsEmpty());
}

TEST(KnownCameras, TenDeviationsAreAKnockedCamera) {
  const Discovery found = searched(10.0);
  EXPECT_EQ(found.verdict, Verdict::explained) << found.sentence;
  EXPECT_THAT(found.missing, testing::ElementsAre("camera_pose"));
  EXPECT_NEAR(value_of(found.steps.back().fitted, "mu"), 0.02, 0.02 * 0.005);
}

}  // namespace
}  // namespace hookeye::test
