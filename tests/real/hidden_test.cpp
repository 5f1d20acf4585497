// A capture that two other programs made (CalculiX, Blender) and in which nothing is hidden: the
// base model leaves what it leaves in the photos at rest. The test alone knows the truth.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "real/cases.h"
#include "support/shared_data.h"

namespace hookeye {
namespace {

TEST(HiddenCase, WhereNothingIsHiddenTheBaseModelFits) {
  HOOKEYE_NEEDS_DATA("hidden/case_b4");
  const real::Case block = real::fit_capture(test::shared_data() / "hidden/case_b4");
  const real::ChiByKind chi = real::chi_by_kind(block);
  nlohmann::json truth;
  std::ifstream(test::shared_data() / "hidden/truth/case_b4.json") >> truth;
  const double mu = block.parameter("mu").value, true_mu = truth.at("mu_true_MPa");
  fmt::print("chi at rest {:.3f}, loaded {:.3f}, held out {:.3f}; mu {:+.3f} %\n", chi.rest,
             chi.loaded, chi.held_out, 100.0 * (mu / true_mu - 1.0));
  EXPECT_LE(chi.loaded, 1.3 * chi.rest);
  EXPECT_LE(chi.held_out, 1.3 * chi.rest);
  EXPECT_NEAR(mu, true_mu, 0.01 * true_mu);
}

}  // namespace
}  // namespace hookeye
