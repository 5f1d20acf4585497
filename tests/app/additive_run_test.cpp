// fit --material additive from outside: what it says, and what the run keeps of it.
#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "app/fitted_run.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

TEST_F(FittedRun, AnAdditiveFitKeepsItsEnergyAndItsConvexity) {
  const double textbook =
      json::parse(read(folder_ / "run/steps/00-base/metrics.json")).at("chi_fit");
  const Result result = hookeye("fit capture -o additive --material additive");
  ASSERT_EQ(result.status, 0) << result.err;
  const fs::path step = folder_ / "additive/steps/00-base";
  const json metrics = json::parse(read(step / "metrics.json"));
  EXPECT_LE(metrics.at("chi_fit").get<double>(), 1.001 * textbook);
  const json& additive = metrics.at("additive");
  EXPECT_GE(additive.at("smallest_eigenvalue").get<double>(), 0.0);
  std::set<std::string> names;
  for (const json& curve : metrics.at("energy")) names.insert(curve.at("name"));
  // of the whole law: one pull where the fit ended isotropic, else one along each axis
  std::vector<std::string> sums = {"volume", "I1bar", "J"};
  for (const char* axis : {"x", "y", "z"})
    sums.push_back(names.count("pull") ? "pull" : std::string("pull along ") + axis);
  for (const std::string& sum : sums) EXPECT_TRUE(names.count(sum)) << sum;
  for (const json& curve : metrics.at("energy")) {
    ASSERT_GT(curve.at("value").size(), 2U);
    for (const json& value : curve.at("value")) EXPECT_TRUE(std::isfinite(value.get<double>()));
  }
  EXPECT_THAT(read(step / "model.yaml"), HasSubstr("I1bar"));
  EXPECT_THAT(read(step / "deformed/pull.vtu"), HasSubstr("Name=\"beyond_control_points\""));
  EXPECT_THAT(read(step / "page/example-pull.json"), HasSubstr("\"beyond\""));
}

}  // namespace
}  // namespace hookeye::test
