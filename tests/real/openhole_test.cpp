// Open-hole tension of a carbon/epoxy bar: the standard use of digital image correlation, on photos
// of the 2D DIC Challenge.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "real/cases.h"
#include "support/shared_data.h"
#include "support/temporary_folder.h"

namespace hookeye {
namespace {

const char* const kData = "real/openhole_cfrp";

class OpenHole : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const auto data = test::shared_data() / kData;
    if (!std::filesystem::exists(data)) return;
    folder_ = std::make_unique<test::TemporaryFolder>();
    real::write_openhole(data, folder_->path(), {4, 9, 11});
    bar_ = std::make_unique<real::Case>(real::fit_capture(folder_->path()));
  }
  static void TearDownTestSuite() {
    bar_.reset();
    folder_.reset();
  }
  void SetUp() override { HOOKEYE_NEEDS_DATA(kData); }

  inline static std::unique_ptr<test::TemporaryFolder> folder_;
  inline static std::unique_ptr<real::Case> bar_;
};

/// What the model has plus what it lacks is the published displacement, point by point.
TEST_F(OpenHole, ModelPlusResidualIsThePublishedDisplacement) {
  for (int step : {4, 9, 11}) {
    const auto seen = real::compare_with_dic(*bar_, test::shared_data() / kData, step);
    fmt::print(
        "step {}: model {:.4f} px rms from the published, with its residual {:.4f} (most "
        "{:.3f}), {} points, {} outside\n",
        step, seen.model_px, seen.with_residual_px, seen.largest_px, seen.points, seen.outside);
    ASSERT_EQ(seen.points + seen.outside, 230);
    EXPECT_GE(seen.points, 225);
    EXPECT_LT(seen.with_residual_px, 0.05) << "step " << step;
  }
}

/// What an isotropic sheet cannot do stands in the residual displacement that `compare` draws:
/// around the hole, where the fields of the two differ, and far less elsewhere.
TEST_F(OpenHole, TheIsotropicMisfitIsVisibleAroundTheHole) {
  const FlowField& lacking =
      bar_->fitted.evaluation.find(bar_->scene->example_index("step11"))->photos.at(0).flow;
  const Vector2d hole(193.0, 541.0);  // px; radius 5 mm of 0.095 a pixel
  double sum[2] = {}, count[2] = {};
  for (const auto& cell : lacking.cells) {
    if (!cell.reliable) continue;
    const bool near = (cell.centre_px - hole).norm() < 2.5 * 5.0 / 0.095;
    sum[near] += cell.estimate.head<2>().squaredNorm() / 2.0;
    count[near] += 1.0;
  }
  const double around = std::sqrt(sum[1] / count[1]), elsewhere = std::sqrt(sum[0] / count[0]);
  fmt::print("residual displacement at step 11: {:.4f} px around the hole, {:.4f} px elsewhere\n",
             around, elsewhere);
  EXPECT_GT(around, 1.5 * elsewhere);
  EXPECT_LT(flow_statistics(lacking).whiteness_p, 1e-6);
}

/// The laminate, not the camera, the jaws or the mesh.
TEST_F(OpenHole, OrthotropyIsNamed) {
  const Diagnosis diagnosis = real::diagnose_case(*bar_);
  fmt::print("{}", real::table(diagnosis));
  const EffectScore& first = diagnosis.effects.front();
  EXPECT_EQ(first.effect, "anisotropy");
  EXPECT_TRUE(nameable(first, diagnosis));
  EXPECT_GT(first.evidence, diagnosis.effects[1].evidence + Limits{}.diagnosis.tie);
}

}  // namespace
}  // namespace hookeye
