// What the mesh's own error may be taken for.
#include "estimation/diagnosis/mesh_error.h"

#include <gtest/gtest.h>

#include "estimation/effects/catalogue.h"
#include "estimation/effects/toolbox.h"
#include "estimation/effects_scene.h"

namespace hookeye {

namespace {

/// A share of a refined mesh beside a modulus, fitted; columns: share, modulus, one effect.
struct Refined {
  Fitted fitted;
  DiagnosisSums sums;
  Hypothesis effect;
};

std::shared_ptr<const Ingredient> ingredient(const std::string& name, const std::string& variant,
                                             double typical) {
  IngredientSpec spec;
  spec.name = name, spec.variant = variant;
  spec.parameters = {{name + ".s", "", "", 0.0, -1.0, 1.0, typical, false}};
  spec.apply = [](const VectorXd&, Model&) {};
  return make_ingredient(std::move(spec));
}

/// Residuals of 100 pixels; the columns of the share, the modulus and the effect.
Refined refined(const Eigen::MatrixXd& J) {
  Refined out;
  out.fitted.form.ingredients = {ingredient("mesh_resolution", "order 2", 0.1),
                                 ingredient("material", "", 1.0)};
  out.fitted.p = VectorXd::Zero(2);
  out.fitted.low = VectorXd::Constant(2, -1e9), out.fitted.high = VectorXd::Constant(2, 1e9);
  out.sums.fitted.JtJ = J.transpose() * J;
  out.sums.photo_count = static_cast<double>(J.rows());
  out.sums.seen_held_out.JtJ =
      4.0 * out.sums.fitted.JtJ;  // half as many pixels, of twice the change
  out.sums.held_count = 0.5 * out.sums.photo_count;
  out.effect.first = 2, out.effect.count = 1;
  out.effect.typical = VectorXd::Ones(1);
  return out;
}

}  // namespace

/// By cos^2 of the angle between the two after the modulus has taken what it can of both.
TEST(MeshError, AnEffectImitatesWhatItLooksLike) {
  const Eigen::MatrixXd basis = Eigen::MatrixXd::Random(100, 3).householderQr().householderQ() *
                                Eigen::MatrixXd::Identity(100, 3);
  for (const double angle : {0.0, 0.3, 1.0, 1.5708}) {
    Eigen::MatrixXd J(100, 3);
    J.col(0) = 20.0 * basis.col(0) + 7.0 * basis.col(1);
    J.col(1) = 3.0 * basis.col(1);
    J.col(2) = std::cos(angle) * basis.col(0) + std::sin(angle) * basis.col(2) + basis.col(1);
    const Refined model = refined(J);
    Diagnosis out;
    tell_of_refined_mesh(model.fitted, Evaluation(), model.sums, out);
    EXPECT_NEAR(out.mesh_fall, std::pow(0.1 * 20.0, 2) / 100.0, 1e-12);
    EXPECT_NEAR(out.mesh_fall_held_out, 8.0 * out.mesh_fall, 1e-12) << "the modulus follows";
    EXPECT_NEAR(imitated_by_mesh(model.fitted, model.sums, model.effect),
                out.mesh_fall * std::pow(std::cos(angle), 2), 1e-12)
        << angle;
  }
}

/// The force that stands for a share of the refinement moves a stiffer body less. That is no reason
/// to trade the modulus for the share.
TEST(MeshError, AFinerMeshIsNoModulus) {
  ModelForm form = test::base();
  form.ingredients.push_back(
      find_effect("mesh_resolution")->rebuild(test::base_model(), "edge times 0.7"));
  ASSERT_TRUE(form.ingredients.back());
  Fitted fitted;
  fitted.form = form;
  fitted.p = form.initial();
  const Eigen::Index n = fitted.p.size(), share = n - 1;
  fitted.p[share] = 0.2;
  fitted.low = VectorXd::Constant(n, -1e9), fitted.high = VectorXd::Constant(n, 1e9);
  Eigen::MatrixXd J = Eigen::MatrixXd::Random(60, n).householderQr().householderQ() *
                      Eigen::MatrixXd::Identity(60, n);
  Eigen::Index mu = -1;
  const auto parameters = form.parameters();
  for (size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].name == "mu") mu = static_cast<Eigen::Index>(i);
  ASSERT_GE(mu, 0);
  J.col(share) *= 30.0;
  J.col(mu) -= fitted.p[share] / fitted.p[mu] * J.col(share);
  DiagnosisSums sums;
  sums.fitted.JtJ = J.transpose() * J;
  sums.seen_held_out.JtJ = sums.fitted.JtJ;
  sums.photo_count = sums.held_count = 60.0;
  Diagnosis out;
  tell_of_refined_mesh(fitted, Evaluation(), sums, out);
  EXPECT_LT(out.mesh_shift.cwiseAbs().maxCoeff(), 1e-6);
  const double next = parameters.back().typical;
  EXPECT_NEAR(out.mesh_fall, std::pow(30.0 * next, 2) / 60.0, 1e-6);
  EXPECT_NEAR(out.mesh_fall_held_out, out.mesh_fall, 1e-6);
}

TEST(MeshError, AModelOnItsToldMeshHasNone) {
  Refined model = refined(Eigen::MatrixXd::Random(100, 3));
  model.fitted.form.ingredients.front() = ingredient("gravity", "", 1.0);
  Diagnosis out;
  tell_of_refined_mesh(model.fitted, Evaluation(), model.sums, out);
  EXPECT_EQ(out.mesh_fall, 0.0);
  EXPECT_EQ(out.mesh_fall_held_out, 0.0);
  EXPECT_EQ(imitated_by_mesh(model.fitted, model.sums, model.effect), 0.0);
}

/// A finer mesh hides what moves the body by less than it would, and no shine.
TEST(MeshError, BrightnessIsHeldToWhatItImitatesOfIt) {
  Diagnosis diagnosis;
  diagnosis.mesh_fall = 0.4;
  for (const char* name : {"specular", "gravity"}) {
    EffectScore score;
    score.effect = name, score.evidence = 50.0, score.fall = 0.3;
    score.best = ingredient(name, "", 1.0);
    score.mesh_fall = score.effect == "gravity" ? 0.4 : 0.01;
    diagnosis.effects.push_back(score);
  }
  EXPECT_EQ(leaders(diagnosis), std::vector<std::string>{"specular"});
  EXPECT_EQ(least_fall(diagnosis, "gravity"), 0.4);
  EXPECT_EQ(least_fall(diagnosis, "specular"), 0.01);
  EXPECT_EQ(least_fall(diagnosis, "not tested"), 0.4);
}

}  // namespace hookeye
