// The material effects on top of an additive base model: null is bit-equal, derivatives are right,
// forces of the base are unchanged in kind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>

#include "estimation/effects/catalogue.h"
#include "estimation/effects_scene.h"
#include "estimation/fit/energy_curves.h"
#include "estimation/fit/fit.h"
#include "estimation/model/additive_function.h"
#include "estimation/model/additive_material.h"
#include "estimation/model/model.h"
#include "simulation/equilibrium.h"
#include "support/derivative.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

const std::vector<std::string>& material_effects() {
  static const std::vector<std::string> all = {"strain_stiffening", "anisotropy",
                                               "tension_compression_asymmetry", "compressibility",
                                               "stiffness_field"};
  return all;
}

/// The same motion the other way round, as far as it goes: compressed where the first is stretched.
VectorXd reversed_state(const Scene& scene) {
  const Matrix3Xd& X = scene.body->mesh.X;
  return 1.3 * Eigen::Map<const VectorXd>(X.data(), X.size()) - 0.3 * deformed_state(scene);
}

/// One effect's candidate on the block: null, derivatives by all parameters, its larger form.
struct Tried {
  const Scene& scene;
  const ModelForm& base;
  const Effect& effect;
  std::shared_ptr<const Ingredient> one;
  VectorXd q;

  VectorXd forces(const ModelForm& form, const VectorXd& p) const {
    const Model there = form.realise(p);
    return residual(scene.body->mesh, there.energy_of(1), there.examples[1].loading, q);
  }
  void derivatives() const {
    const ModelForm form = extended(base, one);
    const VectorXd null = with_values(form, null_values(*one));
    const Model model = base.realise(base.initial());
    Equilibrium at;
    at.q = q;
    const auto parameters = one->parameters();
    for (int k = 0; k < static_cast<int>(parameters.size()); ++k) {
      const auto R = [&](double t) {
        VectorXd moved = null;
        moved[base.size() + k] += t;
        return forces(form, moved);
      };
      const double h = 1e-3 * parameters[k].typical;
      MechanicsDerivative out;
      if (one->mechanics_derivative(null_values(*one), model, 1, at, k, out))
        expect_derivative(R, out.dR_dt, h, 1e-6, effect.name() + " " + one->variant());
      else
        EXPECT_GT((R(h) - R(-h)).norm(), 0.0) << effect.name() << " " << one->variant();
    }
  }
  void larger_form() const {
    const Model model = base.realise(base.initial());
    const VectorXd own = some_values(*one);
    EXPECT_FALSE(effect.sentence(model, *one, own).empty());
    const VectorXd scored = forces(extended(base, one), with_values(extended(base, one), own));
    const auto [larger, values, by_way_of, same_claim] = effect.refit_form(model, one, own);
    ASSERT_EQ(values.size(), static_cast<int>(larger->parameters().size()));
    EXPECT_FALSE(effect.sentence(model, *larger, values).empty());
    const ModelForm form = extended(base, larger);
    const VectorXd after = forces(form, with_values(form, values));
    EXPECT_TRUE(after.allFinite());
    // A function with a control point more is the same function.
    if (added_functions(*larger, values)) {
      EXPECT_LE((after - scored).norm(), 1e-9 * scored.norm()) << effect.name();
    }
    const auto again = effect.candidate(model, larger->variant());
    ASSERT_TRUE(again) << larger->variant();
    EXPECT_EQ(again->variant(), larger->variant());
    EXPECT_EQ(forces(extended(base, again), with_values(extended(base, again), values)), after);
  }
};

TEST(EffectsOnAdditive, NullIsBitEqualAndDerivativesHold) {
  const auto scene = additive_block({});
  const ModelForm base = base_form(scene);
  const Model model = base.realise(base.initial());
  const VectorXd stretched = deformed_state(*scene), pressed = reversed_state(*scene);
  for (const std::string& name : material_effects()) {
    const Effect& effect = *find_effect(name);
    std::string why_not;
    const auto candidates = effect.candidates(model, &why_not);
    ASSERT_FALSE(candidates.empty()) << name << ": " << why_not;
    for (const auto& one : candidates) {
      const ModelForm form = extended(base, one);
      const bool in_compression = one->variant().find("compression") != std::string::npos;
      const VectorXd& q = in_compression ? pressed : stretched;
      const VectorXd before = signature(model, q);
      EXPECT_EQ(signature(form.realise(with_values(form, null_values(*one))), q), before) << name;
      const Tried tried{*scene, base, effect, one, q};
      tried.derivatives();
      if (one == candidates.front() || one == candidates.back()) tried.larger_form();
      EXPECT_GT((signature(form.realise(with_values(form, some_values(*one))), q) - before).norm(),
                0.0)
          << name << " " << one->variant();
    }
  }
}

TEST(EffectsOnAdditive, AreToldInItsLanguageAndInItsFrame) {
  const auto told = std::make_shared<Scene>(*additive_block({}));
  told->capture.materials[0].parameters["frame"] = {{0, 1, 0, -1, 0, 0, 0, 0, 1}, {}};
  const ModelForm base = base_form(told);
  const Model model = base.realise(base.initial());
  for (const std::string name :
       {"strain_stiffening", "anisotropy", "tension_compression_asymmetry"}) {
    for (const auto& one : find_effect(name)->candidates(model, nullptr)) {
      const auto added = added_functions(*one, some_values(*one));
      ASSERT_TRUE(added) << name << " " << one->variant();
      EXPECT_EQ(added->model.frame, additive_model(*model.energy.parts[0].term)->frame);
    }
    // Of a textbook law they are what they were.
    const ModelForm law = base_form(block_scene());
    for (const auto& one : find_effect(name)->candidates(law.realise(law.initial()), nullptr))
      EXPECT_FALSE(added_functions(*one, some_values(*one))) << name << " " << one->variant();
  }
}

/// W over a state of strain, of what one candidate adds with the value 1.
double added_energy(const Model& model, const std::string& effect, const std::string& variant,
                    const Matrix3d& F) {
  const auto one = find_effect(effect)->candidate(model, variant);
  EXPECT_TRUE(one) << variant;
  return additive(added_functions(*one, VectorXd::Ones(1))->model)->psi(F);
}

TEST(EffectsOnAdditive, DamagedVariantsAreNone) {
  const ModelForm base = base_form(additive_block({}));
  const Model model = base.realise(base.initial());
  for (const char* at : {"0", "-0.1", "0.4 0.2", "0.2 0.2", "inf", ""})
    for (const std::string start : {"strain_stiffening additive at ",
                                    "tension_compression_asymmetry additive in tension at "}) {
      const auto space = start.find(' ');
      EXPECT_FALSE(
          find_effect(start.substr(0, space))->candidate(model, start.substr(space + 1) + at))
          << start << at;
    }
  EXPECT_FALSE(find_effect("anisotropy")->candidate(model, "across axis 9"));
  EXPECT_TRUE(find_effect("anisotropy")->candidate(model, "across axis 2"));
}

TEST(EffectsOnAdditive, SayWhatTheirNamesSay) {
  const ModelForm base = base_form(additive_block({}));
  const Model model = base.realise(base.initial());
  const auto diagonal = [](double x, double y, double z) {
    return Matrix3d(Vector3d(x, y, z).asDiagonal());
  };
  const auto energy = [&](const std::string& effect, const std::string& variant,
                          const Matrix3d& F) { return added_energy(model, effect, variant, F); };
  // Stiffer in tension: nothing in compression. Past the ramp the modulus is 1: E^2 / 2 and what
  // the ramp lacks.
  const std::string tca = "tension_compression_asymmetry";
  EXPECT_EQ(energy(tca, "additive in tension at 0.02", diagonal(0.8, 1, 1)), 0.0);
  EXPECT_EQ(energy(tca, "additive in compression at 0.02", diagonal(1.2, 1, 1)), 0.0);
  const double E = 0.5 * (1.2 * 1.2 - 1), e0 = 0.02;
  EXPECT_NEAR(energy(tca, "additive in tension at 0.02", diagonal(1.2, 1, 1)),
              0.5 * E * E - 0.5 * e0 * E + e0 * e0 / 6, 1e-12);
  // Across axis 1: a pull along it costs nothing, and all directions of the plane cost the same.
  EXPECT_EQ(energy("anisotropy", "across axis 1", diagonal(1.3, 1, 1)), 0.0);
  const Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d::UnitX()).matrix();
  const double along = energy("anisotropy", "across axis 1", diagonal(1, 1.3, 1));
  EXPECT_GT(along, 0.0);
  EXPECT_NEAR(energy("anisotropy", "across axis 1", turn * diagonal(1, 1.3, 1) * turn.transpose()),
              along, 1e-12);
  // Stiffening: in simple shear of amount g the modulus rises as g / 0.4 to 1: g^3 / 6 / 0.4.
  Matrix3d shear = Matrix3d::Identity();
  shear(0, 1) = 0.3;
  EXPECT_NEAR(energy("strain_stiffening", "additive at 0.4", shear), std::pow(0.3, 3) / 6 / 0.4,
              1e-12);
}

TEST(EffectsOnAdditive, StayConvexWithTheMaterial) {
  const auto scene = additive_block({"additive"});
  const ModelForm base = base_form(scene);
  const Model model = base.realise(base.initial());
  const auto one = find_effect("strain_stiffening")->candidate(model, "additive at 0.2 0.4");
  ASSERT_TRUE(one);
  const ModelForm form = extended(base, one);
  const VectorXd p = with_values(form, Eigen::Vector2d(-0.03, -0.06));
  // Softer by less than the material has is convex, although the function alone is not.
  EXPECT_FALSE(not_convex(form.realise(p)));
  const std::vector<ConvexPart> parts = convex_parts(form, p);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(VectorXd(parts[0].by_x * p), parts[0].model.values());
  EXPECT_EQ(smallest_eigenvalue(parts[0].model).smallest,
            smallest_eigenvalue(form.realise(p))->smallest);
  // By more it is not.
  const VectorXd q = with_values(form, Eigen::Vector2d(-0.03, -0.09));
  ASSERT_TRUE(not_convex(form.realise(q)));
  EXPECT_NE(not_convex(form.realise(q))->reason.find("I1bar = 0.4"), std::string::npos);
  // A file whose material is convex, and each of its numbers in range, but not their sum.
  VectorXd damaged = with_values(form, one->parameters()[1].low * Eigen::Vector2d(1, 1));
  const auto parameters = form.parameters();
  for (size_t k = 0; k < parameters.size(); ++k)
    if (parameters[k].name == "I1bar.2") damaged[static_cast<Eigen::Index>(k)] = 0.02;
  ASSERT_TRUE(not_convex(form.realise(damaged)));
  const TemporaryFolder folder;
  const auto file = folder / "model.yaml";
  std::ofstream(file) << write_model(form, damaged, catalogue());
  try {
    read_model(file, scene, catalogue());
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.wrong(), testing::HasSubstr("not convex at I1bar = "));
  }
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(q.size(), q.size());
  const ConvexProjection back = project_convex(parts, q, I);
  ASSERT_TRUE(back.converged);
  EXPECT_FALSE(not_convex(form.realise(back.x)));
  // Half by the material, half by what is added.
  EXPECT_NEAR(back.x[form.size() - 1], -0.085, 1e-3);
}

TEST(EffectsOnAdditive, PoissonsRatioIsThatOfTheWholeMaterial) {
  const auto scene = additive_block({});
  const ModelForm base = base_form(scene);
  const Model model = base.realise(base.initial());
  const Effect& effect = *find_effect("compressibility");
  const auto one = effect.candidates(model, nullptr).front();
  const VectorXd nu = VectorXd::Constant(1, null_values(*one)[0] - 0.05);
  const ModelForm form = extended(base, one);
  const Model moved = form.realise(with_values(form, nu));
  const Matrix9d D = moved.energy.parts[0].term->dP_dF(Matrix3d::Identity());
  const double mu = D(3, 3), kappa = D(0, 0) - 4.0 / 3.0 * mu, ratio = kappa / mu;
  EXPECT_NEAR((3 * ratio - 2) / (6 * ratio + 2), nu[0], 1e-9);
}

TEST(EffectsOnAdditive, AFittedVolumeAddendLeavesNothingToFree) {
  for (const auto& fit : {std::vector<std::string>{"additive"}, std::vector<std::string>{"J"}}) {
    const auto scene = additive_block(fit);
    const ModelForm base = base_form(scene);
    ASSERT_GT(base.size(), 0);
    std::string why_not;
    EXPECT_TRUE(
        find_effect("compressibility")->candidates(base.realise(base.initial()), &why_not).empty());
    EXPECT_FALSE(why_not.empty());
  }
  // A neo-Hookean capture that a fit has made additive: the told ratio no longer means anything.
  const ModelForm base = base_form(block_scene());
  const auto [form, p] = to_additive(base, base.initial());
  EXPECT_TRUE(find_effect("compressibility")->candidates(form.realise(p), nullptr).empty());
}

TEST(EffectsOnAdditive, ControlValuesKeepTheirDerivativesUnderAField) {
  const auto scene = additive_block({"additive"});
  const ModelForm base = base_form(scene);
  const auto field =
      find_effect("stiffness_field")->candidates(base.realise(base.initial()), nullptr)[0];
  const ModelForm form = extended(base, field);
  const VectorXd p = with_values(form, some_values(*field));
  const Model now = form.realise(p);
  Equilibrium at;
  at.q = deformed_state(*scene);
  int moving = 0;
  for (int k = 0; k < base.size(); ++k) {
    MechanicsDerivative out;
    ASSERT_TRUE(form.ingredients[0]->mechanics_derivative(p.head(base.size()), now, 1, at, k, out));
    if (out.dR_dt.isZero(0.0)) continue;  // the hat of a strain that this state does not visit
    ++moving;
    expect_derivative(
        [&](double h) {
          VectorXd moved = p;
          moved[k] += h;
          const Model there = form.realise(moved);
          return residual(scene->body->mesh, there.energy_of(1), there.examples[1].loading, at.q);
        },
        out.dR_dt, 1e-3, 1e-8, std::to_string(k));
  }
  EXPECT_GE(moving, 3);
}

TEST(EffectsOnAdditive, AnAddendsNameStandsForItsControlValues) {
  const auto scene = additive_block({"E33", "J.2"});
  const ModelForm base = base_form(scene);
  std::vector<std::string> names;
  for (const auto& parameter : base.parameters()) names.push_back(parameter.name);
  EXPECT_EQ(names, (std::vector<std::string>{"E33.1", "E33.2", "E33.3", "J.2"}));
}

TEST(Fit, WithoutAnythingToFitToIsAnError) {
  auto scene = std::make_shared<Scene>(*block_scene());
  for (auto& photos : scene->photos) photos.clear();
  for (ExampleSpec& example : scene->capture.examples)
    example.photos.clear(), example.measured.clear();
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  EXPECT_THROW(fit(workspace, form, form.initial()), InputError);
}

TEST(NamedAddends, AFitStaysConvex) {
  auto scene = std::make_shared<Scene>(*additive_block({"E11_E33"}));
  for (auto& photos : scene->photos) photos.clear();
  for (ExampleSpec& example : scene->capture.examples) {
    example.photos.clear();
    // Twice the force that the block gives: the coupling would grow without end.
    for (MeasuredSpec& measured : example.measured) measured.value = Vector3d(0, 0, 6);
  }
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto result = fit(workspace, form, form.initial());
  ASSERT_TRUE(result.has_value()) << result.error().reason;
  const Fitted& fitted = *result;
  EXPECT_FALSE(not_convex(fitted.form.realise(fitted.p)));
  // E11 has 0.02, and so has E33 at its softest: up to the root of their product.
  EXPECT_NEAR(std::abs(fitted.p[0]), 0.02, 0.005);
  const auto told = additive_metrics(fitted);
  EXPECT_GE(told["least_over_accepted_steps"].get<double>(), -1e-12);
  EXPECT_LE(told["least_over_accepted_steps"].get<double>(),
            told["smallest_eigenvalue"].get<double>());
}

}  // namespace
}  // namespace hookeye::test
