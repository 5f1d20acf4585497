// The material that a fit found: its card, its curves under a pull, its line of a capture.
#include "estimation/output/material_card.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "estimation/effects/catalogue.h"
#include "estimation/effects_scene.h"
#include "estimation/fit/material_scale.h"
#include "estimation/output/uniaxial.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

Fitted as_told(const std::shared_ptr<const Scene>& scene = block_scene()) {
  const ModelForm form = base_form(scene);
  Workspace workspace(scene);
  return assess(workspace, form, form.initial()).value();
}

/// block_scene() with another `material` and `fit`.
std::shared_ptr<const Scene> block_of(const MaterialSpec& material, std::vector<std::string> fit) {
  auto scene = std::make_shared<Scene>(*block_scene());
  scene->capture.materials = {material};
  scene->capture.fit = std::move(fit);
  scene->capture.fit_places.assign(scene->capture.fit.size(), Place{});
  return scene;
}

MaterialSpec law(const std::string& name,
                 const std::map<std::string, std::vector<double>>& values) {
  MaterialSpec spec;
  spec.law = name;
  for (const auto& [key, numbers] : values) spec.parameters[key].numbers = numbers;
  return spec;
}

json card_of(const Fitted& fitted) {
  return material_card(*fitted.form.scene, fitted, EnergyNeighbourhood(fitted));
}

json row_of(const json& rows, const std::string& name) {
  for (const json& one : rows)
    if (one.at("name") == name) return one;
  return {};
}

MeanEnergy mean_of(std::shared_ptr<const EnergyTerm> term) {
  EnergyModel model;
  model.parts.push_back({std::move(term), {}});
  return MeanEnergy(model);
}

TEST(MaterialCard, TellsTheLawWithItsIntervalAndWhatFollows) {
  const Fitted fitted = as_told();
  const json material = card_of(fitted), card = material.at("cards").at(0);
  EXPECT_EQ(card.at("law"), "neo-hookean");
  const json mu = row_of(card.at("parameters"), "mu");
  EXPECT_EQ(mu.at("known"), "fitted");
  EXPECT_EQ(mu.at("unit"), "MPa");
  EXPECT_DOUBLE_EQ(mu.at("value"), fitted.p[0]);
  // The same interval as the fit's own.
  EXPECT_NEAR(mu.at("low"), fitted.low[0], 1e-6 * fitted.p[0]);
  EXPECT_NEAR(mu.at("high"), fitted.high[0], 1e-6 * fitted.p[0]);
  const double m = fitted.p[0], k = 10.0 * m;
  const json E = row_of(card.at("small_strain"), "E"), nu = row_of(card.at("small_strain"), "nu");
  EXPECT_NEAR(E.at("value"), 9.0 * k * m / (3.0 * k + m), 1e-12);
  EXPECT_NEAR(nu.at("value"), (3.0 * k - 2.0 * m) / (2.0 * (3.0 * k + m)), 1e-12);
  // All scale with mu: so do their intervals. The ratio is the capture's, and has none.
  EXPECT_NEAR(E.at("high").get<double>() / E.at("value").get<double>(), fitted.high[0] / m, 1e-6);
  EXPECT_EQ(row_of(card.at("small_strain"), "kappa").at("known"), "fitted");
  EXPECT_EQ(nu.at("known"), "given");
  EXPECT_FALSE(nu.contains("low"));
  EXPECT_EQ(row_of(card.at("small_strain"), "mu"), json()) << "told twice";
  EXPECT_EQ(material.at("yaml"), "material: {law: neo-hookean, mu: 0.05, kappa_over_mu: 10}");
  EXPECT_TRUE(material.at("beside").empty());
}

/// Two that are known unlike: the interval of E is that of first order, that of nu stays below one
/// half and is mapped from the ratio's.
TEST(MaterialCard, IntervalsFollowFromTheCovariance) {
  const auto scene =
      block_of(law("neo-hookean", {{"mu", {0.05}}, {"kappa", {0.5}}}), {"mu", "kappa"});
  Fitted fitted = as_told(scene);
  const EnergyNeighbourhood near(fitted);
  const json card = material_card(*scene, fitted, near).at("cards").at(0);
  const double m = 0.05, k = 0.5, denominator = 3.0 * k + m;
  VectorXd gradient = VectorXd::Zero(fitted.p.size());
  gradient[0] = 27.0 * k * k / (denominator * denominator);
  gradient[1] = 9.0 * m * m / (denominator * denominator);
  const double value = 9.0 * k * m / denominator, half = near.spread(gradient, value).half;
  const json E = row_of(card.at("small_strain"), "E"), nu = row_of(card.at("small_strain"), "nu");
  EXPECT_NEAR(E.at("value"), value, 1e-12);
  EXPECT_NEAR(E.at("high"), value * std::exp(half / value), 1e-5 * half);
  EXPECT_NEAR(E.at("low"), value * std::exp(-half / value), 1e-5 * half);
  EXPECT_EQ(nu.at("known"), "fitted");
  EXPECT_LT(nu.at("low"), nu.at("value"));
  EXPECT_LT(nu.at("value"), nu.at("high"));
  EXPECT_LT(nu.at("high"), 0.5);
  EXPECT_EQ(row_of(card.at("parameters"), "kappa").at("known"), "fitted");
  // What an ever finer mesh would add lies on its own side alone.
  fitted.mesh_reach = VectorXd::Constant(fitted.p.size(), 0.0);
  fitted.mesh_reach[0] = 0.02 * m;
  const json reached = card_of(fitted).at("cards").at(0);
  EXPECT_EQ(row_of(reached.at("small_strain"), "E").at("low"), E.at("low"));
  EXPECT_GT(row_of(reached.at("small_strain"), "E").at("high"), E.at("high"));
}

TEST(MaterialCard, WhatWasNotFittedIsAsGiven) {
  const auto scene = block_of(
      law("yeoh", {{"c1", {0.025}}, {"c2", {0.002}}, {"c3", {0.0}}, {"kappa", {0.5}}}), {"c1"});
  const json card = card_of(as_told(scene)).at("cards").at(0);
  EXPECT_EQ(row_of(card.at("parameters"), "c1").at("known"), "fitted");
  EXPECT_EQ(row_of(card.at("parameters"), "kappa").at("known"), "given");
  EXPECT_FALSE(row_of(card.at("parameters"), "kappa").contains("low"));
  EXPECT_NEAR(row_of(card.at("small_strain"), "mu").at("value"), 0.05, 1e-9);
  EXPECT_EQ(row_of(card.at("small_strain"), "kappa"), json());             // a parameter of its own
  EXPECT_EQ(row_of(card.at("small_strain"), "nu").at("known"), "fitted");  // by c1
}

TEST(MaterialCard, AFibreMakesOneModulusAnAxisAndStandsBesideTheLaw) {
  Fitted fitted = as_told();
  const auto fibres = find_effect("anisotropy")->candidates(fitted.form.realise(fitted.p), nullptr);
  ASSERT_FALSE(fibres.empty());
  fitted.form.ingredients.push_back(fibres.front());
  VectorXd p(fitted.p.size() + fibres.front()->parameters().size());
  p << fitted.p, VectorXd::Constant(p.size() - fitted.p.size(), 0.02);
  Workspace workspace(fitted.form.scene);
  const json material = card_of(assess(workspace, fitted.form, p).value());
  EXPECT_THAT(material.at("beside"), ElementsAre("anisotropy"));
  const json& card = material.at("cards").at(0);
  EXPECT_EQ(card.at("curves").size(), 3U);
  EXPECT_EQ(row_of(card.at("small_strain"), "nu"), json());
  EXPECT_EQ(row_of(card.at("small_strain"), "Ex").at("unit"), "MPa");
}

/// Forces fix how stiff a body is, its pictures how it is shaped.
TEST(MaterialCard, SaysWhatFixesTheScale) {
  const Fitted pulled = as_told();
  EXPECT_THAT(what_fixes_the_scale(*pulled.form.scene, pulled),
              ElementsAre(HasSubstr("mu is tied to the prescribed forces (pull, bend)")));
  // Motions alone, and a force that is measured.
  auto moved = std::make_shared<Scene>(*block_scene());
  for (auto& example : moved->capture.examples)
    if (!example.loads.empty()) example.loads.clear();
  const Fitted measured = as_told(moved);
  EXPECT_THAT(what_fixes_the_scale(*moved, measured),
              ElementsAre("mu is tied to the measured forces (twist): 1 % more force is 1 % more "
                          "stiffness"));
  auto blind = std::make_shared<Scene>(*moved);
  for (auto& example : blind->capture.examples) example.measured.clear();
  const Fitted nothing = as_told(blind);
  EXPECT_THAT(what_fixes_the_scale(*blind, nothing),
              ElementsAre(HasSubstr("the photos fix only ratios of stiffness")));
  const json mu = row_of(card_of(nothing).at("cards").at(0).at("parameters"), "mu");
  EXPECT_EQ(mu.at("known"), "open");
  EXPECT_FALSE(mu.contains("low"));
  const auto fixed = block_of(law("neo-hookean", {{"mu", {0.05}}, {"kappa", {0.5}}}), {});
  EXPECT_THAT(what_fixes_the_scale(*fixed, as_told(fixed)),
              ElementsAre(HasSubstr("no modulus was fitted")));
}

TEST(Uniaxial, TheSidesAreFreeAndTheStressIsTheSlopeOfTheEnergy) {
  const MeanEnergy energies[] = {
      mean_of(neo_hookean(0.05, 0.4)), mean_of(mooney_rivlin(0.02, 0.005, 0.5)),
      mean_of(ogden({0.03, -0.01}, {3.0, -2.0}, 0.6)), mean_of(stvk(0.2, 0.05)),
      mean_of(fung(0.02,
                   (Eigen::Matrix<double, 9, 1>() << 2, 1, 3, 0.2, 0.1, 0.3, 1, 1.5, 2).finished(),
                   0.4))};
  for (const MeanEnergy& energy : energies)
    for (const int axis : {0, 2})
      for (const double stretch : {0.8, 1.0, 1.15, 1.4}) {
        const auto state = uniaxial(energy, axis, stretch);
        ASSERT_TRUE(state);
        const Matrix3d P = energy.P(state->F);
        const double scale = 0.1;
        for (int i = 0; i < 3; ++i)
          if (i != axis) {
            EXPECT_NEAR(P(i, i), 0.0, 1e-9 * scale);
          }
        EXPECT_DOUBLE_EQ(state->F(axis, axis), stretch);
        const double h = 1e-5;
        const auto more = uniaxial(energy, axis, stretch + h, state->F),
                   less = uniaxial(energy, axis, stretch - h, state->F);
        ASSERT_TRUE(more && less);
        EXPECT_NEAR(state->stress, (energy.psi(more->F) - energy.psi(less->F)) / (2.0 * h),
                    1e-6 * scale);
      }
}

TEST(Uniaxial, ARubberThatKeepsItsVolumeFollowsTheFormula) {
  const double mu = 0.05;
  const MeanEnergy energy = mean_of(neo_hookean(mu, 1e4 * mu));
  for (const double x : {0.7, 1.2, 2.0})
    EXPECT_NEAR(uniaxial(energy, 1, x)->stress, mu * (x - 1.0 / (x * x)), 1e-3 * mu);
}

/// No bar is turned inside out.
TEST(Uniaxial, WhereABarHasNoStateNoneIsTold) {
  EXPECT_FALSE(uniaxial(mean_of(neo_hookean(0.05, 0.5)), 0, -0.1));
}

TEST(Uniaxial, TheCurveBeginsWithYoungsModulusAndItsBandWithTheInterval) {
  const Fitted fitted = as_told();
  const EnergyNeighbourhood near(fitted);
  const json card = material_card(*fitted.form.scene, fitted, near).at("cards").at(0);
  const json curve = card.at("curves").at(0), E = row_of(card.at("small_strain"), "E");
  const std::vector<double> x = curve.at("stretch");
  EXPECT_TRUE(std::is_sorted(x.begin(), x.end()));
  const auto rest = std::find(x.begin(), x.end(), 1.0) - x.begin();
  ASSERT_LT(rest, static_cast<std::ptrdiff_t>(x.size()) - 1);
  EXPECT_NEAR(curve.at("value").at(rest), 0.0, 1e-12);
  const double slope = (curve.at("value").at(rest + 1).get<double>() -
                        curve.at("value").at(rest - 1).get<double>()) /
                       (x[rest + 1] - x[rest - 1]);
  EXPECT_NEAR(slope, E.at("value"), 0.05 * E.at("value").get<double>());
  // Stress is proportional to mu here.
  const size_t last = x.size() - 1;
  const double value = curve.at("value").at(last), high = curve.at("high").at(last);
  const double m = fitted.p[0], half = m * std::log(fitted.high[0] / m);
  EXPECT_NEAR((high - value) / value, half / m, 1e-4 * half / m);
  // What the photos saw lies within, and as much again about it.
  const std::vector<double> visited = curve.at("visited");
  EXPECT_LT(x.front(), visited[0]);
  EXPECT_GT(x.back(), visited[1]);
  EXPECT_GT(visited[1], 1.05);
}

/// Every law comes back from its line of a capture.
TEST(MaterialYaml, ReadsBackAsTheSameMaterial) {
  const TemporaryFolder folder;
  std::ofstream(folder / "body.obj") << "v 0 0 0\n";
  const std::vector<std::string> lines = {
      "{law: neo-hookean, mu: 0.0349957, kappa: 0.42}",
      "{law: neo-hookean, mu: 0.05, kappa_over_mu: 12}",
      "{law: stvk, lambda: 0.2, mu: 0.05}",
      "{law: mooney-rivlin, c10: 0.02, c01: -0.001, kappa: 0.5}",
      "{law: yeoh, c1: 0.02, c2: 0.003, c3: -0.0001, kappa: 0.5}",
      "{law: ogden, mu: [0.03, -0.01], alpha: [3, -2], kappa: 0.6}",
      "{law: fung, c: 0.02, b: [2, 1, 3, 0.2, 0.1, 0.3, 1, 1.5, 2.5], kappa: 0.4}",
      "{law: holzapfel, mu: 0.03, k1: 0.1, k2: 2, angles: [35, -35], kappa: 0.6, dispersion: 0.1, "
      "frame: [[0, 1, 0], [0, 0, 1], [1, 0, 0]]}",
      "{law: holzapfel, mu: 0.03, k1: 0.1, k2: 2, directions: [[1, 0, 0], [0, 1, 1]], kappa: 0.6}",
      "{law: additive, I1bar: {at: [0, 0.5], stiffness: [0.05, 0.08]}, J: {at: [0], stiffness: "
      "[0.5]}, E11: {at: [-0.1, 0, 0.3], stiffness: [0.01, 0.2, 0.9], wall: [0.4, 0.05, 20]}, "
      "fibre1: {direction: [1, 2, 0], at: [0, 0.2], stiffness: [0, 0.4]}, "
      "frame: [[0, 1, 0], [0, 0, 1], [1, 0, 0]], barrier: {modulus: 0.5, below: 0.3}}"};
  const auto read = [&](const std::string& material) {
    std::ofstream(folder / "capture.yaml")
        << "hookeye: 1\nunits: {length: mm, force: N}\nbody: {surface: body.obj}\nmodel:\n  "
        << material << "\nexamples: {rest: {}}\n";
    return read_capture(folder.path());
  };
  Matrix3d F;
  F << 1.1, 0.2, -0.05, 0.03, 0.92, 0.1, -0.08, 0.06, 1.04;
  for (const std::string& line : lines) {
    const Capture capture = read("material: " + line);
    EnergyModel model;
    model.parts.push_back({make_law(capture.materials.at(0)), {}});
    const std::string told = material_yaml(capture, model);
    const Capture again = read(told);
    EXPECT_EQ(again.materials.at(0).law, capture.materials.at(0).law) << told;
    const double psi = model.parts[0].term->psi(F);
    EXPECT_NEAR(make_law(again.materials.at(0))->psi(F), psi, 1e-5 * psi) << told;
    EXPECT_EQ(told.find('\n'), std::string::npos);
  }
}

TEST(MaterialYaml, NamesTheMaterialsOfABlend) {
  Capture capture = block_scene()->capture;
  MaterialSpec foot = law("neo-hookean", {{"mu", {0.02}}, {"kappa", {0.2}}}), head = foot;
  foot.region = "foot", head.region = "the head";
  foot.blend = MaterialSpec::Blend{{0, 0, 1}, {0, 60}, {1, 0}};
  head.blend = MaterialSpec::Blend{{0, 0, 1}, {0, 60}, {0, 1}};
  capture.materials = {foot, head};
  EnergyModel model;
  model.parts = {{neo_hookean(0.03, 0.2), {}}, {neo_hookean(0.04, 0.2), {}}};
  EXPECT_EQ(material_yaml(capture, model),
            "material: {foot: {law: neo-hookean, mu: 0.03, kappa: 0.2, blend: {along: [0, 0, 1], "
            "at: [0, 60], weight: [1, 0]}}, \"the head\": {law: neo-hookean, mu: 0.04, kappa: 0.2, "
            "blend: {along: [0, 0, 1], at: [0, 60], weight: [0, 1]}}}");
}

}  // namespace
}  // namespace hookeye::test
