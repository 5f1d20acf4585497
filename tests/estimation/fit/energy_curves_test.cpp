// What a step tells of an additive material's energy, and of any law's ellipticity, at known
// strains.
#include "estimation/fit/energy_curves.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/distributions.h"
#include "estimation/effects_scene.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/fit/lost_ellipticity.h"

namespace hookeye::test {
namespace {

using nlohmann::json;

/// The block with another material, `fit` of it free.
std::shared_ptr<const Scene> block_of(const MaterialSpec& material, std::vector<std::string> fit) {
  auto scene = std::make_shared<Scene>(*block_scene());
  const std::string region = scene->capture.materials.at(0).region;
  scene->capture.materials[0] = material;
  scene->capture.materials[0].region = region;
  scene->capture.fit = std::move(fit);
  scene->capture.fit_places.assign(scene->capture.fit.size(), {});
  return scene;
}

MaterialSpec law(const std::string& name, const std::map<std::string, double>& values) {
  MaterialSpec out;
  out.law = name;
  for (const auto& [key, value] : values) out.parameters[key].numbers = {value};
  return out;
}

/// All examples at the same uniaxial stretch along x, whatever their loads.
Fitted stretched(const std::shared_ptr<const Scene>& scene, double stretch) {
  Fitted fitted;
  fitted.form = base_form(scene);
  fitted.p = fitted.form.initial();
  auto state = std::make_shared<Equilibrium>();
  Matrix3Xd x = scene->body->mesh.X;
  x.row(0) *= stretch;
  state->q = x.reshaped();
  ExampleEvaluation example;
  example.equilibrium = state;
  fitted.evaluation.examples = {example};
  return fitted;
}

TEST(LostEllipticity, IsToldOfTextbookLawsToo) {
  // mu = 0.05, lambda = 0: lost at a stretch of 1/sqrt(3) = 0.577 (Ellipticity.StVk...).
  const auto scene = block_of(law("stvk", {{"lambda", 0.0}, {"mu", 0.05}}), {"mu"});
  const int elements = scene->body->mesh.size();
  const json lost = lost_ellipticity(*scene, stretched(scene, 0.5));
  EXPECT_EQ(lost.at("elements_lost"), elements);
  EXPECT_NEAR(lost.at("smallest").get<double>(), 0.05 * (3 * 0.25 - 1), 1e-9);
  EXPECT_EQ(lost.at("example"), "rest");
  EXPECT_EQ(lost_ellipticity(*scene, stretched(scene, 0.55)).at("elements_lost"), elements);
  const json kept = lost_ellipticity(*scene, stretched(scene, 0.61));
  EXPECT_EQ(kept.at("elements_lost"), 0);
  EXPECT_GT(kept.at("smallest").get<double>(), 0.0);
}

/// Elements that one side compresses and the other stretches by more: what is lost is on the side
/// of the smaller strain.
TEST(LostEllipticity, IsFoundInTheCompressedCornerOfAStretchedElement) {
  const auto scene = block_of(law("stvk", {{"lambda", 0.0}, {"mu", 0.05}}), {"mu"});
  const TetMesh& mesh = scene->body->mesh;
  Fitted fitted = stretched(scene, 1.0);
  const double low = mesh.X.row(0).minCoeff(), length = mesh.X.row(0).maxCoeff() - low;
  auto state = std::make_shared<Equilibrium>();
  Matrix3Xd x = mesh.X;
  for (auto& value : x.row(0)) {
    const double s = (value - low) / length;
    value = length * (0.3 * s + 2.5 * s * s);  // stretches from 0.3 to 5.3
  }
  state->q = x.reshaped();
  fitted.evaluation.examples[0].equilibrium = state;
  const auto F = deformation_gradients(mesh, state->q);
  const size_t points = F.size() / static_cast<size_t>(mesh.size());
  int lost = 0, hidden = 0;  // an element's point below 0.577, and another farther from rest
  for (size_t e = 0; e < static_cast<size_t>(mesh.size()); ++e) {
    double least = 10.0, most = 0.0;
    for (size_t i = 0; i < points; ++i) {
      const double stretch = F[e * points + i](0, 0);
      least = std::min(least, stretch), most = std::max(most, stretch);
    }
    lost += least < 1.0 / std::sqrt(3.0);
    hidden += least < 1.0 / std::sqrt(3.0) && most * most - 1.0 > 1.0 - least * least;
  }
  ASSERT_GT(hidden, 0);
  EXPECT_EQ(lost_ellipticity(*scene, fitted).at("elements_lost"), lost);
}

/// The block told additively, at its equilibria: curves, bands and what they are made of.
class AdditiveBlock : public testing::Test {
 protected:
  static MaterialSpec material() {
    MaterialSpec out;
    out.law = "additive";
    out.parameters["I1bar.at"].numbers = {0.0, 0.2};
    out.parameters["I1bar.stiffness"].numbers = {0.05, 0.06};
    out.parameters["J.at"].numbers = {0.0};
    out.parameters["J.stiffness"].numbers = {0.5};
    return out;
  }
};

TEST_F(AdditiveBlock, VisitsWhatItIsStretchedToAndCountsWhatIsBeyond) {
  const auto scene = block_of(material(), {"I1bar.1"});
  const double l = 1.5, J = l;
  const json curves = energy_curves(*scene, stretched(scene, l));
  ASSERT_EQ(curves.size(), 2U);
  const double i1bar = std::sqrt((l * l + 2.0) / std::pow(J, 2.0 / 3.0) - 3.0);
  ASSERT_GT(i1bar, 0.2);
  EXPECT_NEAR(curves[0].at("visited")[1].get<double>(), i1bar, 1e-9);
  EXPECT_EQ(curves[0].at("visited")[0].get<double>(), 0.0);
  EXPECT_NEAR(curves[1].at("visited")[1].get<double>(), J - 1.0, 1e-9);
  EXPECT_EQ(curves[0].at("beyond"), scene->body->mesh.size());
  EXPECT_EQ(curves[0].at("elements"), scene->body->mesh.size());
  // i1bar = 0.12, inside of the control points
  EXPECT_EQ(energy_curves(*scene, stretched(scene, 1.1))[0].at("beyond"), 0);
}

/// A band is the curve's derivative by the fitted values through their covariance; a value that is
/// held has none.
TEST_F(AdditiveBlock, BandsAreTheFittedValuesIntervals) {
  const auto scene = block_of(material(), {"I1bar.2"});
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  Fitted fitted = assess(workspace, form, form.initial()).value();
  const auto all =
      parameter_covariance(fitted.evaluation, fitted.form.parameters(), fitted.p).all();
  Eigen::Index own = 0;
  while (fitted.form.parameters().at(static_cast<size_t>(own)).name != "I1bar.2") ++own;
  const json curves = energy_curves(*scene, fitted);
  Fitted up = fitted;
  const double h = 1e-3 * fitted.p[own];
  up.p[own] += h;
  const json higher = energy_curves(*scene, up);
  double widest = 0.0;
  for (size_t i = 0; i < curves[0].at("value").size(); ++i) {
    ASSERT_EQ(curves[0].at("stretch")[i], higher[0].at("stretch")[i]);
    const double value = curves[0].at("value")[i];
    const double gradient = (higher[0].at("value")[i].get<double>() - value) / h;
    const double half = kNormal95 * std::abs(gradient) * std::sqrt(all(own, own));
    EXPECT_NEAR(curves[0].at("high")[i].get<double>() - value, half, 1e-6 * half + 1e-15);
    EXPECT_NEAR(value - curves[0].at("low")[i].get<double>(), half, 1e-6 * half + 1e-15);
    widest = std::max(widest, half);
  }
  EXPECT_GT(widest, 0.0);
  EXPECT_EQ(curves[1].at("low"), curves[1].at("high"));
  const json told = additive_metrics(fitted);
  EXPECT_GT(told.at("smallest_eigenvalue").get<double>(), 0.0);
  EXPECT_TRUE(told.at("least_over_accepted_steps").is_null());
}

}  // namespace
}  // namespace hookeye::test
