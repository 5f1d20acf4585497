// The floor: what rest photos keep, and the loaded ones where there are none of those.
#include "estimation/fit/floor.h"

#include <gmock/gmock.h>

#include "estimation/effects/catalogue.h"
#include "estimation/fit/fit.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

using test::SmallScene;

/// Without photos of the unloaded body, the loaded ones tell what no model could take from them.
TEST(Floor, LoadedPhotosTellWhatNoModelCouldTake) {
  const SmallScene small({.same_renderer = true});
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  Fitted fitted = assess(workspace, form, form.initial()).value();
  const Floor rest = measure_floor(*small.scene, fitted.evaluation);
  EXPECT_EQ(rest.source, "rest photos");
  EXPECT_EQ(rest.copies, 0.0);
  Evaluation loaded = fitted.evaluation;
  std::erase_if(loaded.examples, [&](const auto& example) {
    return is_rest(small.scene->capture.examples[example.example]);
  });
  const Floor floor = measure_floor(*small.scene, loaded);
  EXPECT_EQ(floor.source, "loaded photos");
  EXPECT_NEAR(floor.chi, 1.0, 0.05);
  EXPECT_THAT(floor.by_camera, testing::SizeIs(2));
  // Reference images that repeat the noise of what they are compared with.
  Evaluation copied = fitted.evaluation;
  for (auto& example : copied.examples)
    if (is_rest(small.scene->capture.examples[example.example]))
      for (auto& photo : example.photos)
        for (auto& cell : photo.flow.cells) cell.r2 *= 0.04, cell.estimate *= 0.2, cell.z *= 0.2;
  const Floor of_copies = measure_floor(*small.scene, copied);
  EXPECT_EQ(of_copies.source, "loaded photos");
  EXPECT_NEAR(of_copies.copies, 0.2, 0.02);
  EXPECT_NEAR(of_copies.chi, floor.chi, 1e-12);
}

/// A camera that has been zoomed shows the body moved where nothing has moved it; a weight moves
/// it.
TEST(Floor, RestPhotosTellWhatMovesABodyThatNothingMoves) {
  const auto told = [](const SmallScene& small, const ModelForm& form, const VectorXd& p) {
    Workspace workspace(small.scene);
    const Fitted fitted = assess(workspace, form, p).value();
    return measure_floor(*small.scene, fitted.evaluation);
  };
  const auto cameras = [](const Floor& floor) {
    std::vector<std::string> out;
    for (const auto& [camera, fall] : floor.moved_at_rest)
      if (fall > renderers_err_by(floor)) out.push_back(camera);
    return out;
  };
  struct Case {
    std::string hidden;
    std::vector<std::string> cameras;
  };
  const Case zoomed{"{effect: focal_length, variant: cam1, values: {focal_length.cam1: 0.003}}",
                    {"cam1"}};
  const Case heavy{"{effect: gravity, values: {gravity.z: -9650}}", {"cam0", "cam1"}};
  const Case bright{"{effect: exposure, variant: cam1 from the start, rms_px: 1.5}", {}};
  for (const Case& one : {zoomed, heavy, bright}) {
    const SmallScene small({.hidden = "hidden:\n  - " + one.hidden + "\n", .same_renderer = true});
    const ModelForm base = base_form(small.scene);
    EXPECT_THAT(cameras(told(small, base, base.initial())), testing::ElementsAreArray(one.cameras))
        << one.hidden;
    if (one.hidden != heavy.hidden) continue;
    ModelForm form = base;
    const Model model = base.realise(base.initial());
    form.ingredients.push_back(find_effect("gravity")->candidates(model, nullptr).front());
    VectorXd p = form.initial();
    p[p.size() - 1] = -4000.0;  // too little, but the body is no longer as it was given
    EXPECT_THAT(told(small, form, p).moved_at_rest, testing::IsEmpty());
  }
}

}  // namespace
}  // namespace hookeye
