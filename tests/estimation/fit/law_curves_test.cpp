// Energy curves of materials told by laws.
#include <gtest/gtest.h>

#include <cmath>

#include "estimation/effects/catalogue.h"
#include "estimation/effects_scene.h"
#include "estimation/fit/energy_curves.h"

namespace hookeye::test {
namespace {

Fitted as_told() {
  const auto scene = block_scene();
  const ModelForm form = base_form(scene);
  Workspace workspace(scene);
  return assess(workspace, form, form.initial()).value();
}

TEST(LawCurves, NeoHookesPullIsTheFormulaAndItsBandTheModulus) {
  const Fitted fitted = as_told();
  const auto curves = law_curves(*fitted.form.scene, fitted, EnergyNeighbourhood(fitted));
  ASSERT_EQ(curves.size(), 2u);
  EXPECT_EQ(curves[0]["name"], "pull");
  EXPECT_EQ(curves[1]["name"], "volume");
  // The interval is symmetric in log mu, the band in mu.
  const double mu = fitted.p[0], half = mu * std::log(fitted.high[0] / mu);
  for (const auto& i : {0, 10, 40}) {
    const double x = curves[0]["stretch"][i], value = curves[0]["value"][i];
    const double shape = 0.5 * (x * x + 2.0 / x - 3.0);
    EXPECT_NEAR(value, mu * shape, 1e-9 * mu);
    const double band = curves[0]["high"][i].get<double>() - value;
    EXPECT_NEAR(band, half * shape, 1e-4 * half * shape + 1e-15);
  }
  // The block is pulled by its load and pressed nowhere in a fitted example.
  EXPECT_LT(curves[0]["visited"][0], 1.0);
  EXPECT_GT(curves[0]["visited"][1], 1.05);
}

/// Where a finer mesh would make the modulus larger, the band reaches there as its interval does,
/// and on that side alone.
TEST(LawCurves, BandsReachForTheMeshAsIntervalsDo) {
  Fitted fitted = as_told();
  const auto before = law_curves(*fitted.form.scene, fitted, EnergyNeighbourhood(fitted));
  fitted.mesh_reach = VectorXd::Constant(fitted.p.size(), 0.02 * fitted.p[0]);
  const auto curves = law_curves(*fitted.form.scene, fitted, EnergyNeighbourhood(fitted));
  const double value = curves[0]["value"][40];
  EXPECT_EQ(curves[0]["low"][40], before[0]["low"][40]);
  const double more = curves[0]["high"][40].get<double>() - before[0]["high"][40].get<double>();
  EXPECT_NEAR(more, 0.02 * value, 1e-4 * value);
}

TEST(LawCurves, FibresPullOtherwiseAlongThem) {
  Fitted fitted = as_told();
  const Model model = fitted.form.realise(fitted.p);
  const auto fibres = find_effect("anisotropy")->candidates(model, nullptr);
  ASSERT_FALSE(fibres.empty());
  fitted.form.ingredients.push_back(fibres.front());
  VectorXd p(fitted.p.size() + fibres.front()->parameters().size());
  p << fitted.p, VectorXd::Constant(p.size() - fitted.p.size(), 0.02);
  Workspace workspace(fitted.form.scene);
  const Fitted with = assess(workspace, fitted.form, p).value();
  const auto curves = law_curves(*fitted.form.scene, with, EnergyNeighbourhood(with));
  ASSERT_EQ(curves.size(), 4u);
  EXPECT_EQ(curves[2]["name"], "pull along z");
}

}  // namespace
}  // namespace hookeye::test
