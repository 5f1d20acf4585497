// Laws blended over the body: control values that vary along it, found from positions and a force.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "estimation/effects/catalogue.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/fit/energy_curves.h"
#include "estimation/fit/fit.h"
#include "estimation/model/additive_material.h"
#include "estimation/search/progressive.h"
#include "simulation/equilibrium.h"
#include "support/temporary_folder.h"

namespace hookeye {
namespace {

/// A bar along z, 60 long, of one law at its foot and another at its head, blended along it.
std::shared_ptr<const Scene> bar_of(const std::filesystem::path& folder, const std::string& foot,
                                    const std::string& head, const std::string& fit,
                                    const std::string& measured) {
  std::ofstream(folder / "bar.obj")
      << "v 0 0 0\nv 12 0 0\nv 12 12 0\nv 0 12 0\nv 0 0 60\nv 12 0 60\nv 12 12 60\nv 0 12 60\n"
         "f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\n"
         "f 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n";
  std::ofstream(folder / "capture.yaml") << fmt::format(
      R"(hookeye: 1
units: {{length: mm, force: N}}
body: {{surface: bar.obj, mesh: {{edge: 8, order: 2}}}}
model:
  material:
    foot: {{{}, blend: {{along: [0, 0, 1], at: [0, 60], weight: [1, 0]}}}}
    head: {{{}, blend: {{along: [0, 0, 1], at: [0, 60], weight: [0, 1]}}}}
  fit: {}
regions:
  base: {{box: [[-1, -1, -0.1], [13, 13, 0.1]]}}
  top: {{box: [[-1, -1, 59.9], [13, 13, 60.1]]}}
examples:
  pull:
    supports: [{{region: base, fix: [x, y, z]}}]
    loads: [{{region: top, force: [0, 0, 1.2]}}]
{})",
      foot, head, fit, measured);
  return load_scene(read_capture(folder));
}

/// An additive law, its bulk modulus known.
std::string constant(double mu) {
  return fmt::format(
      "law: additive, I1bar: {{at: [0], stiffness: [{}]}}, J: {{at: [0], stiffness: [0.2]}}", mu);
}

/// Values that go from `foot` to `head` along it.
std::shared_ptr<const Scene> bar(const std::filesystem::path& folder, double foot, double head,
                                 const std::string& measured = "") {
  return bar_of(folder, constant(foot), constant(head), "[foot.I1bar, head.I1bar]", measured);
}

/// Where points along the bar are predicted.
std::vector<Vector3d> places(const std::shared_ptr<const Scene>& scene) {
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  auto result = workspace.evaluate(form, form.initial(), {});
  std::vector<Vector3d> out;
  for (const auto& one : result->examples.at(0).measured) out.push_back(one.predicted);
  return out;
}

std::string positions(const std::vector<Vector3d>& found = std::vector<Vector3d>(3),
                      double sigma = 0.01) {
  std::string text = "    measured:\n";
  for (size_t i = 0; i < found.size(); ++i)
    text += fmt::format(
        "      - {{position_of: [0, 6, {}], value: [{:.9g}, {:.9g}, {:.9g}], sigma: {}}}\n",
        60 * (i + 1) / found.size(), found[i].x(), found[i].y(), found[i].z(), sigma);
  return text;
}

TEST(Blend, TheSameLawTwiceIsThatLaw) {
  const test::TemporaryFolder folder;
  const auto blended = bar(folder.path(), 0.03, 0.03);
  const ModelForm form = base_form(blended);
  const Model model = form.realise(form.initial());
  ASSERT_EQ(model.energy.parts.size(), 2u);
  const VectorXd sum = model.energy.parts[0].weight + model.energy.parts[1].weight;
  EXPECT_LT((sum.array() - 1.0).abs().maxCoeff(), 1e-14);
  EXPECT_LT(model.energy.parts[0].weight.minCoeff(), 0.1);
  EXPECT_GT(model.energy.parts[0].weight.maxCoeff(), 0.9);
}

TEST(Blend, ValuesAtBothEndsAreFoundFromPositions) {
  const test::TemporaryFolder folder;
  const auto truth = places(bar(folder.path(), 0.02, 0.06, positions()));
  ASSERT_EQ(truth.size(), 3u);
  const auto scene = bar(folder.path(), 0.035, 0.035, positions(truth));
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto result = fit(workspace, form, form.initial());
  ASSERT_TRUE(result.has_value());
  const Fitted& fitted = *result;
  EXPECT_EQ(form.parameters()[0].name, "foot.I1bar.1");
  EXPECT_NEAR(fitted.p[0], 0.02, 2e-5);
  EXPECT_NEAR(fitted.p[1], 0.06, 6e-5);
}

std::vector<std::string> names_of(const ModelForm& form) {
  std::vector<std::string> names;
  for (const Parameter& one : form.parameters()) names.push_back(one.name);
  return names;
}

/// Fitted as `hookeye fit --material additive` does, from laws that know nothing of each other.
Fitted fitted_additively(const std::shared_ptr<const Scene>& scene, int refinements) {
  Workspace workspace(scene);
  const ModelForm base = base_form(scene);
  ProgressiveOptions options;
  options.most_refinements = refinements;
  auto result = fit_progressive(workspace, {to_additive(base, base.initial())}, options);
  if (!result) throw std::runtime_error(result.error().reason);
  return *std::move(result);
}

TEST(Blend, BothLawsAreToldAdditively) {
  const test::TemporaryFolder folder;
  const auto truth = places(bar(folder.path(), 0.02, 0.06, positions()));
  const std::string told = "law: neo-hookean, mu: 0.035, kappa: 0.2";
  const auto scene = bar_of(folder.path(), told, told, "[foot.mu, head.mu]", positions(truth));
  const ModelForm base = base_form(scene);
  const auto [form, p] = to_additive(base, base.initial());
  EXPECT_THAT(names_of(form),
              testing::ElementsAre("foot.I1bar.1", "foot.J.1", "head.I1bar.1", "head.J.1"));
  // the same energy, and the assembly's derivatives
  const VectorXd q =
      Eigen::Map<const VectorXd>(scene->body->mesh.X.data(), scene->body->mesh.X.size()) * 1.05;
  const auto forces = [&](const ModelForm& any, const VectorXd& at) {
    return element_forces(scene->body->mesh, any.realise(at).energy_of(0), q);
  };
  const Eigen::MatrixXd as_law = forces(base, base.initial());
  EXPECT_LE((forces(form, p) - as_law).norm(), 1e-12 * as_law.norm());
  const Fitted fitted = fitted_additively(scene, 0);
  EXPECT_NEAR(fitted.p[0], 0.02, 2e-4);
  EXPECT_NEAR(fitted.p[2], 0.06, 6e-4);
  EXPECT_GE(fitted.smallest_eigenvalue, 0.0);
  // read back, and on another mesh
  const auto file = folder.path() / "model.yaml";
  std::ofstream(file) << write_model(fitted.form, fitted.p, catalogue());
  const auto [again, values] = read_model(file, scene, catalogue());
  EXPECT_EQ(values, fitted.p);
  EXPECT_EQ(forces(again, values), forces(fitted.form, fitted.p));
  std::string damaged = write_model(fitted.form, fitted.p, catalogue());
  const std::string place = R"(\"material\":[1,\"head\"])";
  ASSERT_NE(damaged.find(place), std::string::npos) << damaged;
  for (const char* wrong : {R"(\"material\":[7,\"head\"])", R"(\"material\":[1,\"foot\"])"}) {
    std::string text = damaged;
    std::ofstream(file) << text.replace(text.find(place), place.size(), wrong);
    try {
      read_model(file, scene, catalogue());
      ADD_FAILURE() << "accepted " << wrong;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("the capture has no such material"));
    }
  }
  const auto finer = remeshed(*scene, 0.8, 0, false);
  const auto [moved, same] = transfer(fitted.form.realise(fitted.p), finer, catalogue());
  EXPECT_EQ(names_of(moved), names_of(fitted.form));
  EXPECT_EQ(same, fitted.p);
  EXPECT_EQ(moved.realise(same).energy.parts[1].weight.size(), finer->body->mesh.size());
  EXPECT_TRUE(additive_model(*moved.realise(same).energy.parts[1].term));
}

TEST(Blend, EachLawIsRefinedWhereItLacksSomething) {
  const test::TemporaryFolder folder;
  const std::string stiffening =
      "law: additive, I1bar: {at: [0, 0.25], stiffness: [0.02, 0.06]}, J: {at: [0], stiffness: "
      "[0.2]}";
  const auto truth =
      places(bar_of(folder.path(), stiffening, constant(0.06), "[foot.I1bar, head.I1bar]",
                    positions(std::vector<Vector3d>(10))));
  const auto scene =
      bar_of(folder.path(), constant(0.03), constant(0.06), "[additive]", positions(truth, 0.001));
  const ModelForm base = base_form(scene);
  EXPECT_THAT(names_of(base),
              testing::ElementsAre("foot.I1bar.1", "foot.J.1", "head.I1bar.1", "head.J.1"));
  const Fitted plain = fitted_additively(scene, 0), refined = fitted_additively(scene, 2);
  for (const Refinement& one : refinements(plain.form, plain))
    EXPECT_THAT(one.what, testing::AnyOf(testing::HasSubstr("foot."), testing::HasSubstr("head.")));
  const auto curves = energy_curves(*scene, refined);
  ASSERT_GE(curves.size(), 4u);
  EXPECT_EQ(curves[0]["name"], "foot.I1bar");
  const auto told = additive_metrics(refined);
  EXPECT_GE(told["smallest_eigenvalue"].get<double>(), 0.0);
  ASSERT_GE(refined.refinements.size(), 2u)
      << "nothing refined at " << normal_equations(plain.evaluation).r2;
  EXPECT_GT(refined.refinements.back().values, 4);
  EXPECT_LT(normal_equations(refined.evaluation).r2, 0.1 * normal_equations(plain.evaluation).r2);
}

TEST(Blend, APartWithoutMaterialIsNamed) {
  const test::TemporaryFolder folder;
  std::string fault;
  try {
    const auto scene = bar(folder.path(), 0.03, 0.03);
    Capture capture = scene->capture;
    capture.materials.pop_back();
    capture.materials[0].blend->at = {0.0, 30.0};
    auto copy = std::make_shared<Scene>(*scene);
    copy->capture = capture;
    copy->capture.fit = {"foot.I1bar"};
    base_form(copy);
  } catch (const InputError& error) {
    fault = error.what();
  }
  EXPECT_THAT(fault, testing::HasSubstr("elements have no material"));
  EXPECT_THAT(fault, testing::HasSubstr("capture.yaml:6:"));
}

}  // namespace
}  // namespace hookeye
