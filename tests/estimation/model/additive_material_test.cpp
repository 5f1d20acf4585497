// The additive material as an ingredient: what it reads, writes and starts from.
#include "estimation/model/additive_material.h"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <fstream>

#include "estimation/effects/catalogue.h"
#include "estimation/effects_scene.h"
#include "estimation/model/additive_function.h"
#include "simulation/equilibrium.h"
#include "support/derivative.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

TEST(AdditiveMaterial, IsReadBackFromItsVariantAndFile) {
  const auto scene = block_scene();
  const ModelForm base = base_form(scene);
  auto [form, p] = to_additive(base, base.initial());
  AdditiveModel model = additive_parts(form, p).at(0).model;
  model.frame = Eigen::AngleAxisd(0.4, Vector3d::UnitZ()).matrix();
  add_addend(model, "E11", {-0.1, 0.2}, {}, Eigen::Vector2d(0.01, 0.03));
  add_addend(model, "E22", {0.0}, {}, VectorXd::Constant(1, 0.02));
  add_addend(model, "E11_E22", {0.0, 0.1}, {0.0, 0.1}, Eigen::Vector4d(0.001, 0.002, 0.001, 0.002));
  add_addend(model, "fibre1", {0.0}, {}, VectorXd::Constant(1, 0.02));
  model.components[component_index(model, "fibre1")].direction = Vector3d(0.6, 0.8, 0);
  std::tie(form, p) = with_structures(form, p, {model});
  const TemporaryFolder folder;
  const auto file = folder / "model.yaml";
  std::ofstream(file) << write_model(form, p, catalogue());
  const auto [again, q] = read_model(file, scene, catalogue());
  EXPECT_EQ(q, p);
  const VectorXd x = deformed_state(*scene);
  EXPECT_EQ(signature(again.realise(q), x), signature(form.realise(p), x));
  EXPECT_EQ(again.ingredients[0]->variant(), form.ingredients[0]->variant());
  const std::string variant = form.ingredients[0]->variant();
  const auto damaged = [&](const std::string& from, const std::string& to) {
    std::string text = variant;
    const size_t at = text.find(from);
    if (at == std::string::npos) return "no " + from + " in " + text;
    try {
      additive_material_from(text.replace(at, from.size(), to), scene->capture.units);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(damaged("[-0.1,0.2]", "[0.2,-0.1]"), testing::HasSubstr("out of order"));
  EXPECT_THAT(damaged("[-0.1,0.2]", "[]"), testing::HasSubstr("values"));
  EXPECT_THAT(damaged("[0.6,0.8,0.0]", "[0,0,2]"), testing::HasSubstr("no unit vector"));
  EXPECT_THAT(damaged("\"barrier\":[", "\"barrier\":[1,1.5],\"y\":["),
              testing::HasSubstr("begins at J = 1.5"));
  EXPECT_THAT(damaged("\"barrier\":[", "\"barrier\":[-1,0.99],\"y\":["),
              testing::HasSubstr("modulus is -1"));
  EXPECT_THAT(damaged("\"frame\":[", "\"frame\":[2,0,0,0,1,0,0,0,1],\"x\":["),
              testing::HasSubstr("not orthonormal"));
  EXPECT_THROW(additive_material_from("{\"additive\": 1}", scene->capture.units),
               std::invalid_argument);
}

TEST(AdditiveMaterial, ValuesOfAFileMustBeConvex) {
  const auto scene = block_scene();
  const ModelForm base = base_form(scene);
  auto [form, p] = to_additive(base, base.initial());
  AdditiveModel model = additive_parts(form, p).at(0).model;
  for (const char* name : {"E11", "E22"})
    add_addend(model, name, {0.0}, {}, VectorXd::Constant(1, 0.01));
  add_addend(model, "E11_E22", {0.0}, {0.0}, VectorXd::Constant(1, 0.02));
  std::tie(form, p) = with_structures(form, p, {model});
  const TemporaryFolder folder;
  const auto file = folder / "model.yaml";
  std::ofstream(file) << write_model(form, p, catalogue());
  try {
    read_model(file, scene, catalogue());
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.wrong(), testing::HasSubstr("not convex at E11 = 0, E22 = 0"));
  }
}

TEST(AdditiveMaterial, FramesOfATubeReachTheElements) {
  auto scene = std::make_shared<Scene>(*block_scene());
  MaterialSpec& spec = scene->capture.materials.at(0);
  spec.law = "additive";
  spec.parameters = {{"frame.axis", {{1, 0, 0}, {}}},
                     {"frame.center", {{0, 0, 20}, {}}},
                     {"I1bar.at", {{0}, {}}},
                     {"I1bar.stiffness", {{0.05}, {}}},
                     {"J.at", {{0}, {}}},
                     {"J.stiffness", {{0.5}, {}}},
                     {"E22.at", {{0}, {}}},
                     {"E22.stiffness", {{0.5}, {}}}};
  scene->capture.fit = {"additive"};
  scene->capture.fit_places.assign(1, {});
  const ModelForm form = base_form(scene);
  const Model model = form.realise(form.initial());
  ASSERT_EQ(model.energy.parts.at(0).frames.cols(), scene->body->mesh.size());
  // Axis 3 is the tube's in every element, axis 2 goes around it.
  const Eigen::Map<const Matrix3d> A(model.energy.parts[0].frames.col(0).data());
  EXPECT_NEAR(A(0, 2), 1.0, 1e-12);
  EXPECT_NEAR(A(0, 1), 0.0, 1e-12);
}

TEST(AdditiveMaterial, KeepsTheFrameOfAFibreReinforcedLaw) {
  auto scene = std::make_shared<Scene>(*block_scene());
  MaterialSpec& spec = scene->capture.materials.at(0);
  spec.law = "holzapfel";
  spec.parameters = {{"mu", {{0.05}, {}}},     {"k1", {{0.1}, {}}},
                     {"k2", {{2.0}, {}}},      {"kappa", {{0.5}, {}}},
                     {"angles", {{30.0}, {}}}, {"frame", {{0, 1, 0, 0, 0, 1, 1, 0, 0}, {}}}};
  scene->capture.fit = {"mu"};
  scene->capture.fit_places.assign(1, {});
  const ModelForm base = base_form(scene);
  const auto [form, p] = to_additive(base, base.initial());
  const AdditiveModel model = additive_parts(form, p).at(0).model;
  EXPECT_NEAR(model.frame(1, 0), 1.0, 1e-12);
  EXPECT_NEAR(model.frame(0, 2), 1.0, 1e-12);
  // At rest the fibres are slack: the moduli are the matrix's.
  const Matrix3d F = Matrix3d::Identity() * (1 + 1e-4);
  EXPECT_NEAR(form.realise(p).energy.parts.at(0).psi(0, F),
              base.realise(base.initial()).energy.parts.at(0).psi(0, F), 1e-12);
}

TEST(AdditiveMaterial, StartsAtTheEnergyOfTheTextbookLaw) {
  const auto scene = block_scene();
  const ModelForm base = base_form(scene);
  const auto [form, p] = to_additive(base, base.initial());
  const VectorXd x = deformed_state(*scene);
  const VectorXd a = signature(base.realise(base.initial()), x), b = signature(form.realise(p), x);
  EXPECT_LE((a - b).norm(), 1e-12 * a.norm());
}

TEST(AdditiveMaterial, ForceDerivativesAreThoseOfTheAssembly) {
  const auto scene = block_scene();
  const ModelForm base = base_form(scene);
  auto [form, p] = to_additive(base, base.initial());
  AdditiveModel model = refined(additive_parts(form, p).at(0).model, 0, 0.2);
  add_addend(model, "E33", {-0.1, 0.1}, {}, Eigen::Vector2d(0.01, 0.02));
  std::tie(form, p) = with_structures(form, p, {model});
  Equilibrium at;
  at.q = deformed_state(*scene);
  const Model now = form.realise(p);
  const auto R = [&](int k, double h) {
    VectorXd moved = p;
    moved[k] += h;
    const Model there = form.realise(moved);
    return residual(scene->body->mesh, there.energy_of(1), there.examples[1].loading, at.q);
  };
  for (int k = 0; k < model.size(); ++k) {
    MechanicsDerivative out;
    ASSERT_TRUE(
        form.ingredients[0]->mechanics_derivative(p.head(model.size()), now, 1, at, k, out));
    expect_derivative([&](double h) { return R(k, h); }, out.dR_dt, 1e-3, 1e-8, std::to_string(k));
  }
}

}  // namespace
}  // namespace hookeye::test
