// CalculiX solves what was exported: nodal displacements against Hookeye's own equilibrium.
#include "core/text_file.h"
#include "estimation/effects/catalogue.h"
#include "estimation/synth/synth.h"
#include "exporters/block.h"

namespace hookeye::test {
namespace {

constexpr double kClose = 1e-4;  // of the largest displacement

/// The recipe of ./demo with photos of no use.
std::string small_photos() {
  std::string text =
      read_text(std::filesystem::path(HOOKEYE_SOURCE_DIR) / "sample_scenes/sample.yaml");
  const auto replace = [&](const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    if (at == std::string::npos) throw std::runtime_error("the sample has no " + from);
    text.replace(at, from.size(), to);
  };
  replace("count: 2, size: [360, 480]", "count: 1, size: [40, 40]");
  replace("focal: 2000", "focal: 150");
  replace("rays_per_axis: 5", "rays_per_axis: 1");
  replace("edge_factor: 0.7", "edge_factor: 1");
  return text;
}

/// An effect of the catalogue with its values, at the end of the form.
void add_effect(ModelForm& form, VectorXd& p, const std::string& name, const std::string& variant,
                const VectorXd& values) {
  const auto own = catalogue().find(name)->candidate(form.realise(p), variant);
  ASSERT_TRUE(own) << name << " " << variant;
  form.ingredients.push_back(own);
  VectorXd all(p.size() + values.size());
  all << p, values;
  p = all;
}

TEST(CalculiX, SampleWithItsHiddenWeight) {
  HOOKEYE_NEEDS_CCX();
  const TemporaryFolder folder;
  write_text(folder / "recipe.yaml", small_photos());
  const auto made = synthesize(read_recipe(folder / "recipe.yaml"), folder / "capture");
  ASSERT_TRUE(made.has_value());
  auto form = base_form(load_scene(read_capture(folder / "capture"), false));
  VectorXd p = form.initial();
  add_effect(form, p, "gravity", "", Vector3d(1500, 900, -9650));
  const Model model = form.realise(p);
  for (const char* name : {"pull", "twist", "press"})
    EXPECT_LT(distance_to_calculix(model, name), kClose) << name;
}

TEST(CalculiX, LoadsOfAllKinds) {
  HOOKEYE_NEEDS_CCX();
  const Block block;
  Model model = block.model();
  for (const char* name : {"pull", "twist", "press"})
    EXPECT_LT(distance_to_calculix(model, name), kClose) << name;
  // A pressure on a patch that cuts through faces.
  for (auto& example : model.examples)
    example.loading.forces.push_back(follower_pressure(block.region("flank"), 0.002));
  // CalculiX takes a pressure at three points of a face, Hookeye at six: 5.5e-6 of the distance.
  EXPECT_LT(distance_to_calculix(model, "bend"), kClose);
}

TEST(CalculiX, TurnsInSteps) {
  HOOKEYE_NEEDS_CCX();
  const Block block;
  Model model = block.model();
  const int e = model.scene->example_index("twist");
  model.examples[static_cast<size_t>(e)].loading.prescribe_rigid(
      block.mesh(), block.region("grip"),
      {Vector3d::UnitZ(), 100.0, Vector3d(0, 0, 40), Vector3d::Zero()});
  EXPECT_EQ(solver_model(model).cases[static_cast<size_t>(e)].shares.size(), 4u);
  EXPECT_LT(distance_to_calculix(model, "twist"), kClose);
}

struct Law {
  std::string name;
  std::vector<std::shared_ptr<const EnergyTerm>> terms;
};

class CalculiXLaw : public testing::TestWithParam<Law> {};

TEST_P(CalculiXLaw, IsTheSame) {
  HOOKEYE_NEEDS_CCX();
  const Block block;
  Model model = block.model();
  model.energy.parts.clear();
  for (const auto& term : GetParam().terms) model.energy.parts.push_back({term, {}});
  std::vector<std::string> lacks;
  EXPECT_LT(distance_to_calculix(model, "pull", &lacks), kClose);
  EXPECT_TRUE(lacks.empty()) << lacks.front();
}

OrthotropicValues stiff_along_x() {
  OrthotropicValues out;
  out.c << 0.4, 0.1, 0.12, 0.1, 0.3, 0.09, 0.12, 0.09, 0.25;
  out.g << 0, 0.05, 0.06, 0.05, 0, 0.07, 0.06, 0.07, 0;
  out.frame = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  return out;
}

INSTANTIATE_TEST_SUITE_P(
    Laws, CalculiXLaw,
    testing::Values(Law{"mooney_rivlin", {mooney_rivlin(0.02, 0.01, 0.5)}},
                    Law{"yeoh", {yeoh(0.025, 0.01, 0.002, 0.5)}},
                    Law{"ogden", {ogden({0.04, -0.01}, {1.8, -2.5}, 0.5)}},
                    Law{"power_of_stretch",
                        {neo_hookean(0.05, 0.5),
                         combination({{0.01, ogden({0.25}, {8}, 0)}, {-0.01, neo_hookean(1, 0)}})}},
                    Law{"polynomial", {mooney_rivlin(0.02, 0.005, 0.5), yeoh(0, 0.01, 0.002, 0)}},
                    Law{"stvk", {stvk(0.4, 0.05)}},
                    Law{"orthotropic", {orthotropic(stiff_along_x())}},
                    Law{"rubber_and_orthotropic",
                        {neo_hookean(0.05, 0.5), orthotropic(stiff_along_x())}}),
    [](const auto& info) { return info.param.name; });

TEST(CalculiX, StiffnessField) {
  HOOKEYE_NEEDS_CCX();
  const Block block;
  Model model = block.model();
  VectorXd weight = VectorXd::Ones(block.mesh().size());
  for (int e = 0; e < block.mesh().size(); ++e)
    if (block.mesh().X.col(block.mesh().elements(0, e)).x() > 0) weight[e] = 3.0;
  model.energy.parts[0].weight = weight;
  EXPECT_LT(distance_to_calculix(model, "pull"), kClose);
}

TEST(CalculiX, History) {
  HOOKEYE_NEEDS_CCX();
  const Block block;
  Model model = block.model();
  for (auto& example : model.examples) example.stiffness = 0.8;
  EXPECT_LT(distance_to_calculix(model, "pull"), kClose);
}

/// CalculiX takes the thermal strain off the Green strain, and no factor out of F: the same where
/// the body is free, else to first order, which is said.
TEST(CalculiX, Swelling) {
  HOOKEYE_NEEDS_CCX();
  const Block block;
  Model model = block.model();
  model.energy.swelling = VectorXd::Constant(block.mesh().size(), 1.05);
  std::vector<std::string> lacks;
  EXPECT_LT(distance_to_calculix(model, "pull", &lacks), 0.02);
  EXPECT_TRUE(mentions(lacks, "swelling"));
  auto& loading = model.examples[static_cast<size_t>(model.scene->example_index("rest"))].loading;
  loading.release(block.region("base"));
  const Region& base = block.region("base");
  for (int i = 0; i < 3; ++i) {  // stands on three nodes as little as needed
    Region node;
    node.nodes = {base.nodes[static_cast<size_t>(i)]};
    loading.prescribe(block.mesh(), node, 2,
                      0.05 * block.mesh().X(2, base.nodes[static_cast<size_t>(i)]));
  }
  Region first, second;
  first.nodes = {base.nodes[0]}, second.nodes = {base.nodes[1]};
  for (int c = 0; c < 2; ++c)
    loading.prescribe(block.mesh(), first, c, 0.05 * block.mesh().X(c, base.nodes[0]));
  const Vector3d apart = block.mesh().X.col(base.nodes[1]) - block.mesh().X.col(base.nodes[0]);
  const int across = std::abs(apart.x()) > std::abs(apart.y()) ? 1 : 0;
  loading.prescribe(block.mesh(), second, across, 0.05 * block.mesh().X(across, base.nodes[1]));
  EXPECT_LT(distance_to_calculix(model, "rest"), kClose);
}

/// Lumped springs are not the bed itself: near, and said.
TEST(CalculiX, SoftClamp) {
  HOOKEYE_NEEDS_CCX();
  const Block block;
  Model model = block.model();
  auto& loading = model.examples[static_cast<size_t>(model.scene->example_index("bend"))].loading;
  loading.release(block.region("base"));
  loading.forces.push_back(
      elastic_foundation(block.region("base"), 0.05, 0.02, block.mesh().X.reshaped()));
  std::vector<std::string> lacks;
  EXPECT_LT(distance_to_calculix(model, "bend", &lacks), 0.03);
  EXPECT_TRUE(mentions(lacks, "lumped"));
}

}  // namespace
}  // namespace hookeye::test
