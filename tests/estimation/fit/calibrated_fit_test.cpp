// Cameras that are off by what their calibration may be off: the material does not pay for it.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimation/small_capture.h"

namespace hookeye::test {
namespace {

constexpr double kTrueMu = 0.02;

Fitted fitted_to(const std::shared_ptr<const Scene>& scene) {
  Workspace workspace(scene);
  return base_fit(workspace);
}

TEST(CalibratedFit, AKnockWithinTheCalibrationDoesNotBendTheMaterial) {
  const SmallScene small({.hidden = knocked(1.0), .same_renderer = true});
  const double exact = value_of(fitted_to(small.scene), "mu");
  const Fitted known = fitted_to(with_known_cameras(*small.scene));
  const double mu = value_of(known, "mu");
  EXPECT_GT(std::abs(exact - kTrueMu), 3.0 * std::abs(mu - kTrueMu)) << exact << " and " << mu;
  EXPECT_NEAR(mu, kTrueMu, 0.002 * kTrueMu);
  EXPECT_GT(known.high[0], kTrueMu);
  EXPECT_LT(known.low[0], kTrueMu);
  EXPECT_LT(known.evaluation.chi(false), 1.1) << "noise alone is left";
  const auto u = known.p.tail(14);
  EXPECT_LT(u.head(7).norm(), 2.5) << "nothing knocked this one";
  EXPECT_LT(u.tail(7).norm(), 4.0) << "six deviations of 1";
  EXPECT_GT(u.tail(7).norm(), 1.5);
}

}  // namespace
}  // namespace hookeye::test
