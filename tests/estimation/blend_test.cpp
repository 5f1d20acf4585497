// Laws blended over the body: control values that vary along it, found from positions and a force.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "estimation/fit.h"
#include "support/temporary_folder.h"

namespace hookeye {
namespace {

/// A bar along z, 60 long, additive law whose values go from `foot` to `head` along it.
std::shared_ptr<const Scene> bar(const std::filesystem::path& folder, double foot, double head,
                                 const std::string& measured = "") {
  std::ofstream(folder / "bar.obj")
      << "v 0 0 0\nv 12 0 0\nv 12 12 0\nv 0 12 0\nv 0 0 60\nv 12 0 60\nv 12 12 60\nv 0 12 60\n"
         "f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\n"
         "f 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n";
  const auto law = [&](double mu, const std::string& blend) {
    return fmt::format(
        "{{law: additive, I1bar: {{at: [0], stiffness: [{}]}}, J: {{at: [0], stiffness: [0.2]}}, "
        "blend: {{along: [0, 0, 1], {}}}}}",
        mu, blend);
  };
  std::ofstream(folder / "capture.yaml") << fmt::format(
      R"(hookeye: 1
units: {{length: mm, force: N}}
body: {{surface: bar.obj, mesh: {{edge: 8, order: 2}}}}
model:
  material:
    foot: {}
    head: {}
  fit: [foot.I1bar, head.I1bar]
regions:
  base: {{box: [[-1, -1, -0.1], [13, 13, 0.1]]}}
  top: {{box: [[-1, -1, 59.9], [13, 13, 60.1]]}}
examples:
  pull:
    supports: [{{region: base, fix: [x, y, z]}}]
    loads: [{{region: top, force: [0, 0, 1.2]}}]
{})",
      law(foot, "at: [0, 60], weight: [1, 0]"), law(head, "at: [0, 60], weight: [0, 1]"), measured);
  return load_scene(read_capture(folder));
}

/// Where points along the bar are predicted.
std::vector<Vector3d> places(const std::shared_ptr<const Scene>& scene) {
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  auto result = workspace.evaluate(form, form.initial(), {});
  std::vector<Vector3d> out;
  for (const auto& one : std::get<Evaluation>(result).examples.at(0).measured)
    out.push_back(one.predicted);
  return out;
}

std::string positions(const std::vector<Vector3d>& found = std::vector<Vector3d>(3)) {
  std::string text = "    measured:\n";
  for (size_t i = 0; i < found.size(); ++i)
    text += fmt::format(
        "      - {{position_of: [0, 6, {}], value: [{:.9g}, {:.9g}, {:.9g}], sigma: 0.01}}\n",
        20 * (i + 1), found[i].x(), found[i].y(), found[i].z());
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
  ASSERT_TRUE(std::holds_alternative<Fitted>(result));
  const Fitted& fitted = std::get<Fitted>(result);
  EXPECT_EQ(form.parameters()[0].name, "foot.I1bar.1");
  EXPECT_NEAR(fitted.p[0], 0.02, 2e-5);
  EXPECT_NEAR(fitted.p[1], 0.06, 6e-5);
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
