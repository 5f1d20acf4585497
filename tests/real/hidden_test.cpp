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

struct Misfit {
  double r2 = 0.0, count = 0.0;
  double chi() const { return std::sqrt(r2 / count); }
};

TEST(HiddenCase, WhereNothingIsHiddenTheBaseModelFits) {
  HOOKEYE_NEEDS_DATA("hidden/case_b4");
  const real::Case block = real::fit_capture(test::shared_data() / "hidden/case_b4");
  Misfit rest, loaded, held_out;
  for (const auto& example : block.fitted.evaluation.examples) {
    Misfit& sum = example.held_out                                          ? held_out
                  : is_rest(block.scene->capture.examples[example.example]) ? rest
                                                                            : loaded;
    for (const auto& photo : example.photos) sum.r2 += photo.r2, sum.count += photo.count;
  }
  nlohmann::json truth;
  std::ifstream(test::shared_data() / "hidden/truth/case_b4.json") >> truth;
  const double mu = block.parameter("mu").value, true_mu = truth.at("mu_true_MPa");
  fmt::print("chi at rest {:.3f}, loaded {:.3f}, held out {:.3f}; mu {:+.3f} %\n", rest.chi(),
             loaded.chi(), held_out.chi(), 100.0 * (mu / true_mu - 1.0));
  EXPECT_LE(loaded.chi(), 1.3 * rest.chi());
  EXPECT_LE(held_out.chi(), 1.3 * rest.chi());
  EXPECT_NEAR(mu, true_mu, 0.01 * true_mu);
}

}  // namespace
}  // namespace hookeye
