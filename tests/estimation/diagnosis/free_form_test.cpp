// Forces of no name: do they stand where the hidden ones do?
#include "estimation/diagnosis/free_form.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimation/search/contest.h"
#include "support/temporary_folder.h"
#include "tests/estimation/effects_scene.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

using test::base_fit;
using test::SmallScene;

/// A weight is a body force that is the same everywhere and in all examples.
TEST(FreeForm, FindsAWeightWithoutItsName) {
  const SmallScene small({.hidden = "hidden:\n  - {effect: gravity, values: {gravity.x: 4000, "
                                    "gravity.z: -7000}}\n"});
  Workspace workspace(small.scene);
  const Fitted fitted = base_fit(workspace);
  const auto result = free_form(workspace, fitted, nullptr);
  const auto& fields = *result;
  ASSERT_FALSE(fields.empty());
  const FreeForm& first = fields.front();
  EXPECT_EQ(first.name, "body_force") << first.sentence;
  EXPECT_EQ(first.example, "");
  // One linear step, and shrunk.
  EXPECT_GT(first.explains, 0.8);
  EXPECT_GT(first.explains_held_out, 0.8);
  // Of the free half of the body: what presses on the clamp moves nothing.
  const Matrix3Xd& X = small.scene->body->mesh.X;
  const double middle = 0.5 * (X.row(2).minCoeff() + X.row(2).maxCoeff());
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (Eigen::Index a = 0; a < X.cols(); ++a)
    if (X(2, a) > middle) sum += first.forces.col(a), ++count;
  const double density = small.scene->capture.body.density;
  const Vector3d weight = density * Vector3d(4000, 0, -7000);
  const Vector3d mean = sum / count;
  EXPECT_NEAR(mean.x(), weight.x(), 0.2 * weight.x());
  EXPECT_LT(std::abs(mean.y()), 0.2 * weight.x());
  // Along the axis of the body a force moves little that is seen, and the prior holds it back.
  EXPECT_LT(mean.z(), 0.4 * weight.z());
  EXPECT_GT(mean.z(), 1.1 * weight.z());
}

/// Dead forces are linear in their values: the column is the difference of residuals, in the
/// examples that the field acts in and in no other.
TEST(FreeForm, ColumnsAreTheForcesThatAreApplied) {
  const Model& base = test::base_model();
  const TetMesh& mesh = base.scene->body->mesh;
  Equilibrium state;
  state.q = test::deformed_state(*base.scene);
  int acting = 0;
  for (const auto& field : free_form_ingredients(base))
    for (const int k : {0, 4, static_cast<int>(field->parameters().size()) - 1}) {
      const double h = field->parameters()[k].typical;
      Model shifted = base;
      field->apply(h * VectorXd::Unit(field->parameters().size(), k), shifted);
      const VectorXd null = VectorXd::Zero(field->parameters().size());
      for (int e = 0; e < static_cast<int>(base.examples.size()); ++e) {
        MechanicsDerivative column;
        ASSERT_TRUE(field->mechanics_derivative(null, base, e, state, k, column));
        const auto R = [&](const Model& model) {
          return residual(mesh, EnergyModel{}, model.examples[e].loading, state.q);
        };
        const VectorXd applied = (R(shifted) - R(base)) / h;
        if (column.dR_dt.size() == 0) column.dR_dt = VectorXd::Zero(applied.size());
        EXPECT_LE((column.dR_dt - applied).norm(), 1e-9 * applied.norm() + 1e-12 / h)
            << field->variant() << " " << k << " " << e;
        acting += applied.norm() > 0.0;
      }
    }
  EXPECT_GT(acting, 0);
}

TEST(FreeForm, SaysNothingWhereNothingIsHidden) {
  const SmallScene small({.same_renderer = true});
  Workspace workspace(small.scene);
  const Fitted fitted = base_fit(workspace);
  const auto result = free_form(workspace, fitted, nullptr);
  EXPECT_TRUE(result->empty());
}

TEST(FreeForm, IsWrittenAtTheNodes) {
  const SmallScene small({});
  const int n = small.scene->body->mesh.nodes();
  FreeForm field;
  field.name = "traction", field.example = "pull";
  field.forces = Matrix3Xd::Random(3, n);
  const test::TemporaryFolder folder;
  write_free_form(folder.path() / "a.vtu", *small.scene, {field});
  EXPECT_EQ(read_vtu_array(folder.path() / "a.vtu", "traction in pull"), field.forces);
}

}  // namespace
}  // namespace hookeye
