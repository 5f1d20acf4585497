// Printed elastomer sheets in tension: silhouettes and grip forces, a modulus from one sheet,
// another sheet predicted with it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "real/cases.h"
#include "support/shared_data.h"
#include "support/temporary_folder.h"

namespace hookeye {
namespace {

const char* const kData = "real/tango_elastomer_sheet";
constexpr double kExpectedMu = 0.2065;  // MPa, the data's README

real::Case two_holes(const real::Tension& tension, const std::filesystem::path& folder) {
  real::write_tango_holes(test::shared_data() / kData, folder, tension);
  return real::fit_capture(folder);
}

/// Of the sheet with two holes, the jaw fitted or as the photos' edges tell. Each is fitted once.
real::Case::Value shear_modulus(bool fit_jaw) {
  const auto of = [](bool fitted) {
    const test::TemporaryFolder folder;
    real::Tension tension;
    tension.frames = {10, 20, 40, 60};
    tension.fit_jaw = fitted;
    return two_holes(tension, folder.path()).parameter("mu");
  };
  if (fit_jaw) return of(true);
  static const real::Case::Value told = of(false);
  return told;
}

TEST(ElastomerSheet, ShearModulusFromTwoHoles) {
  HOOKEYE_NEEDS_DATA(kData);
  for (bool fit_jaw : {false, true}) {
    const auto mu = shear_modulus(fit_jaw);
    fmt::print("jaw {}: mu {:.5f} ({:.5f} .. {:.5f}) MPa\n", fit_jaw ? "fitted" : "told", mu.value,
               mu.low, mu.high);
    EXPECT_NEAR(mu.value, kExpectedMu, 0.03 * kExpectedMu);
  }
}

/// The other sheet, with the modulus of the first and nothing fitted.
TEST(ElastomerSheet, NotchedSheetIsPredicted) {
  HOOKEYE_NEEDS_DATA(kData);
  const auto data = test::shared_data() / kData;
  const test::TemporaryFolder notches;
  const double mu = shear_modulus(false).value;
  for (const auto& frame : real::predict_notched(data, notches.path(), mu)) {
    fmt::print(
        "frame {}: {:.3f} N where {:.3f} N were measured; mouth {:.1f} px, photo {:.1f} px\n",
        frame.frame, frame.predicted_N, frame.measured_N, frame.mouth_px, frame.seen_px);
    EXPECT_NEAR(frame.predicted_N, frame.measured_N, 0.05 * frame.measured_N);
    // A pixel here is 0.16 mm; the notch is 3 px wide at rest.
    EXPECT_NEAR(frame.mouth_px, frame.seen_px, 1.0);
  }
}

/// The load cell's zero is not told: forces do not rise from nought, and that is named before
/// anything else although the photos have misfits of their own.
TEST(ElastomerSheet, ForceZeroIsFound) {
  HOOKEYE_NEEDS_DATA(kData);
  const test::TemporaryFolder folder;
  real::Tension tension;
  tension.frames = {0, 10, 20, 40, 60};
  tension.fit_jaw = false;
  tension.load_cell_zero_N = 0.0;
  real::Case sheet = two_holes(tension, folder.path());
  const Diagnosis diagnosis = real::diagnose_case(sheet);
  fmt::print("{}", real::table(diagnosis));
  const EffectScore& zero = diagnosis.effects.front();
  ASSERT_EQ(zero.effect, "force_zero");
  EXPECT_TRUE(nameable(zero, diagnosis));
  // 0.15 N before the pull and 0.18 N after rupture, along the pull.
  EXPECT_NEAR(zero.values[0], -0.165, 0.04);
}

}  // namespace
}  // namespace hookeye
