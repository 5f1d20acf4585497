// Fields that start from another load case: a program took a loaded picture as its reference.
#include "estimation/evaluation/started_field.h"

#include <gmock/gmock.h>

#include "estimation/effects/catalogue.h"
#include "estimation/evaluation/field_evaluation.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/field_block.h"
#include "estimation/fit/field_floor.h"
#include "estimation/fit/fit.h"
#include "estimation/model/strain_measure.h"

namespace hookeye::test {
namespace {

const MeasuredSpec& bend_field(const Scene& scene, size_t face = 0) {
  return scene.capture.examples[static_cast<size_t>(scene.example_index("bend"))].measured[face];
}

/// Two states of the body, told: even deformations. The field's places are in the first.
struct TwoStates {
  explicit TwoStates(const FieldBlock& block)
      : scene(std::make_shared<Scene>(*block.scene())),
        form(base_form(scene)),
        model(form.realise(form.initial())) {
    A << 1.1, 0.02, 0.0, -0.05, 0.95, 0.04, 0.0, 0.1, 1.15;
    B << 0.9, 0.0, 0.1, 0.05, 1.05, 0.0, 0.03, -0.2, 1.3;
    // Points of the front at rest, moved to where the first state has them.
    MeasuredSpec& told = field();
    auto spec = std::make_shared<FieldSpec>(*told.field);
    rest.resize(3, spec->X.cols());
    for (Eigen::Index k = 0; k < rest.cols(); ++k)
      rest.col(k) << -9.0 + 0.11 * static_cast<double>(k), -8.0, 2.0 + 0.2 * static_cast<double>(k);
    spec->X = A * rest;
    told.field = spec;
    states.resize(scene->capture.examples.size());
    set("pull", A), set("bend", B);
  }
  MeasuredSpec& field() {
    return scene->capture.examples[static_cast<size_t>(scene->example_index("bend"))].measured[0];
  }
  void set(const std::string& name, const Eigen::Matrix3d& F) {
    auto state = std::make_shared<Equilibrium>();
    state->q = Matrix3Xd(F * scene->body->mesh.X).reshaped();
    states[static_cast<size_t>(scene->example_index(name))].equilibrium = state;
  }
  VectorXd predict() {
    const int e = scene->example_index("bend");
    const Eigen::MatrixXd none;
    return predicted(field(), {*scene, model, e, *states[static_cast<size_t>(e)].equilibrium, none,
                               nullptr, &states})
        .value;
  }
  std::shared_ptr<Scene> scene;
  ModelForm form;
  Model model;
  Eigen::Matrix3d A, B;
  Matrix3Xd rest;
  std::vector<ExampleEvaluation> states;
};

TEST(StartedField, DisplacementsLeadFromTheStateThatItStartsFrom) {
  TwoStates two({.from_pull = true});
  const VectorXd u = two.predict();
  for (Eigen::Index k = 0; k < two.rest.cols(); ++k)
    EXPECT_NEAR((u.segment<3>(3 * k) - (two.B - two.A) * two.rest.col(k)).norm(), 0.0, 1e-9) << k;
  EXPECT_GT(u.norm(), 10.0);
}

/// F = B A^-1 of the plane that the front has become, along axes laid into it.
TEST(StartedField, StrainsAreThoseBetweenTheStates) {
  for (const char* measure : {"green", "hencky", "biot", "engineering", "small"})
    for (const char* gauge : {"", ", gauge: 3"}) {
      TwoStates two({.keys = gauge, .from_pull = true, .strain = measure});
      const VectorXd e = two.predict();
      const Vector3d normal = (two.A.inverse().transpose() * -Vector3d::UnitY()).normalized();
      const Tangents T = *tangents_along(normal, two.field().field->strain->axes);
      const Tangents went = two.B * two.A.inverse() * T;
      const Vector3d expected = strain_by(two.field().field->strain->measure, went, T).e;
      EXPECT_GT(expected.norm(), 0.1);
      for (Eigen::Index k = 0; k < two.rest.cols(); ++k)
        EXPECT_NEAR((e.segment<3>(3 * k) - expected).norm(), 0.0, *gauge ? 5e-4 : 1e-9)
            << measure << gauge << " at " << k << ": a foot may lie just round the rim";
    }
}

Evaluation evaluated(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                     bool derivatives) {
  EvaluationOptions options;
  options.derivatives = derivatives;
  return workspace.evaluate(form, p, options).value();
}

/// Both equilibria move with the modulus and the weight, and so do the points below the places.
void expect_derivative(const FieldBlock& block, double within) {
  const auto scene = block.scene();
  ModelForm form = base_form(scene);
  form.ingredients.push_back(find_effect("gravity")->candidate(form.realise(form.initial()), ""));
  VectorXd p = form.initial();
  p[0] = 0.055;
  p.tail<3>() = Vector3d(3000.0, -2000.0, -9000.0);
  Workspace workspace(scene);
  const int bend = scene->example_index("bend");
  const Evaluation here = evaluated(workspace, form, p, true),
                   whole = evaluated(workspace, form, p, false);
  const auto parameters = form.parameters();
  for (size_t k = 0; k < 2; ++k) {
    const MeasuredEvaluation& one = here.find(bend)->measured[k];
    const VectorXd& r = whole.find(bend)->measured[k].r;
    EXPECT_NEAR(one.r.squaredNorm(), r.squaredNorm(), 1e-9 * r.squaredNorm());
    Eigen::MatrixXd J(r.size(), p.size());
    for (int i = 0; i < p.size(); ++i) {
      const double step = 1e-3 * (parameters[i].positive ? p[i] : parameters[i].typical);
      const VectorXd by = step * VectorXd::Unit(p.size(), i);
      J.col(i) = (evaluated(workspace, form, p + by, false).find(bend)->measured[k].r -
                  evaluated(workspace, form, p - by, false).find(bend)->measured[k].r) /
                 (2.0 * step);
    }
    const Eigen::MatrixXd JtJ = J.transpose() * J, condensed = one.J.transpose() * one.J;
    for (int i = 0; i < p.size(); ++i) {
      const double length = std::sqrt(JtJ(i, i));
      EXPECT_GT(length, 0.0);
      EXPECT_NEAR(one.J.col(i).dot(one.r), J.col(i).dot(r), within * length * r.norm());
      for (int j = 0; j < p.size(); ++j)
        EXPECT_NEAR(condensed(i, j), JtJ(i, j), within * length * std::sqrt(JtJ(j, j)))
            << block.strain << block.keys << " " << k << ": " << i << " " << j;
    }
  }
}

TEST(StartedField, DerivativesAreThoseOfFiniteDifferences) {
  expect_derivative({.sigma = 0.05, .from_pull = true}, 2e-3);
}

TEST(StartedField, DerivativesOfStrainsAreThoseOfFiniteDifferences) {
  expect_derivative({.sigma = 1e-3, .from_pull = true, .strain = "green"}, 5e-3);
  expect_derivative({.sigma = 1e-3, .from_pull = true, .strain = "small"}, 5e-3);
  expect_derivative({.sigma = 1e-3, .keys = ", gauge: 6", .from_pull = true, .strain = "hencky"},
                    1e-2);
}

Fitted fitted_to(std::shared_ptr<const Scene> scene, bool weight = false) {
  Workspace workspace(scene);
  ModelForm form = base_form(scene);
  if (weight)
    form.ingredients.push_back(find_effect("gravity")->candidate(form.realise(form.initial()), ""));
  auto result = fit(workspace, form, form.initial());
  if (!result) throw std::runtime_error(result.error().reason);
  return *std::move(result);
}

/// The truth, out of fields of which some start from a load case; a plain reading of these files
/// would be far from noise.
TEST(StartedField, AFitFindsTheTruth) {
  for (const char* strain : {"", "green"}) {
    const FieldBlock block{.gravity = {4000, 0, -9000},
                           .sigma = *strain ? 2e-4 : 5e-3,
                           .keys = *strain ? ", correlation: 0, gauge: 6" : ", correlation: 0",
                           .from_pull = true,
                           .strain = strain};
    const auto scene = block.scene();
    const Fitted fitted = fitted_to(scene, true);
    EXPECT_NEAR(fitted.p[0], 0.05, 5e-4) << strain;
    EXPECT_NEAR(fitted.p[3], -9000.0, 300.0) << strain;
    EXPECT_NEAR(fitted.evaluation.chi(false), 1.0, 0.1) << strain;
    EXPECT_EQ(measure_floor(*scene, fitted.evaluation).source, "rest fields");
  }
}

/// Of the load case that others start from, nothing need be measured; and it may be held out.
TEST(StartedField, WhereItStartsNothingNeedBeMeasured) {
  const FieldBlock block{.sigma = 5e-3, .from_pull = true};
  const std::string entries =
      "    measured:\n    - {field: pull_front.csv, sigma: 0.005}\n    - {field: pull_flank.csv, "
      "sigma: 0.005}\n";
  const auto bare = ChangedBlock{block, "capture.yaml", entries, ""}.scene();
  const auto held =
      ChangedBlock{block, "capture.yaml", "  pull:\n", "  pull:\n    use: validate\n"}.scene();
  for (const auto& scene : {bare, held}) {
    const Fitted fitted = fitted_to(scene);
    EXPECT_NEAR(fitted.p[0], 0.05, 5e-4);
    EXPECT_EQ(fitted.evaluation.find(scene->example_index("pull")) == nullptr, scene == bare);
  }
  const Fitted fitted = fitted_to(bare);
  const Model model = fitted.form.realise(fitted.p);
  const TetMesh mesh = mesh_below(model, fitted.evaluation, bend_field(*bare));
  const FieldPoints points = field_points(mesh, *bend_field(*bare).field);
  EXPECT_LT(points.gap.maxCoeff(), 0.1) << "the points lie on the body as `pull` deforms it";
  EXPECT_GT(field_points(bare->body->mesh, *bend_field(*bare).field).gap.maxCoeff(), 0.5);
}

TEST(StartedField, TheOrderOfExamplesDoesNotMatter) {
  const auto scene = FieldBlock{.sigma = 0.02, .from_pull = true}.scene();
  auto turned = std::make_shared<Scene>(*scene);
  std::reverse(turned->capture.examples.begin(), turned->capture.examples.end());
  const auto sums = [](const std::shared_ptr<const Scene>& of) {
    Workspace workspace(of);
    const ModelForm form = base_form(of);
    return normal_equations(evaluated(workspace, form, form.initial(), true));
  };
  const auto here = sums(scene), there = sums(turned);
  EXPECT_NEAR(here.JtJ(0, 0), there.JtJ(0, 0), 1e-9 * here.JtJ(0, 0));
  EXPECT_NEAR(here.Jtr[0], there.Jtr[0], 1e-9 * std::abs(here.Jtr[0]));
  EXPECT_GT(std::abs(here.Jtr[0]), 0.0);
}

std::string refusal(const FieldBlock& block, const std::string& from, const std::string& to) {
  return ChangedBlock{block, "capture.yaml", from, to}.refusal();
}

TEST(StartedField, WhatItCannotStartFromIsToldWithFileAndLine) {
  using testing::HasSubstr;
  const FieldBlock block{.sigma = 1e-3, .from_pull = true};
  EXPECT_EQ(refusal(block, "from: pull", "from: pul"),
            "capture.yaml:30:7: the field bend_front.csv of example `bend` starts from `pul`, and "
            "there is no such example\n  did you mean `pull`?");
  EXPECT_THAT(refusal(block, "from: pull", "from: bend"),
              HasSubstr("bend_front.csv of example `bend` starts from its own example"));
  EXPECT_THAT(
      refusal(block, "pull_front.csv, sigma: 0.001", "pull_front.csv, sigma: 0.001, from: bend"),
      HasSubstr("fields start from one another in a circle: `bend` from `pull` from `bend`"));
  EXPECT_THAT(refusal(block, "  pull:\n", "  pull:\n    use: test\n"),
              HasSubstr("starts from `pull`, which is held out for the test"));
  EXPECT_THAT(refusal(block, "  pull:\n    supports: [{region: base, fix: [x, y, z]}]",
                      "  pull:\n    use: validate\n    supports: [{region: base, rigid: fit}]"),
              HasSubstr("starts from `pull`, which is held out, and how its grip moves is fitted"));
  EXPECT_EQ(refusal(block, "    use: validate", "    use: test"), "");
  EXPECT_THAT(refusal(block, "from: pull", "from: [1, 2]"), HasSubstr("capture.yaml:30:"));
}

}  // namespace
}  // namespace hookeye::test
