// Fields of strains: measures against formulas, predictions against finite differences, gauges and
// axes, and captures that are wrong.
#include <gmock/gmock.h>

#include <fstream>

#include "estimation/effects/catalogue.h"
#include "estimation/evaluation/field_evaluation.h"
#include "estimation/field_block.h"
#include "estimation/model/strain_measure.h"

namespace hookeye::test {
namespace {

constexpr StrainMeasure kAll[] = {StrainMeasure::green, StrainMeasure::hencky, StrainMeasure::biot,
                                  StrainMeasure::engineering, StrainMeasure::small};

TEST(StrainMeasures, AStretchHasTheFormulasStrainsHoweverItIsTurned) {
  const Tangents T = Tangents::Identity();
  const double x = 1.2, y = 0.9;
  Tangents U = T;
  U(0, 0) = x, U(1, 1) = y;
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.8, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const auto of = [&](StrainMeasure measure) { return strain_by(measure, R * U, T).e; };
  EXPECT_LT((of(StrainMeasure::green) - Vector3d(0.5 * (x * x - 1), 0.5 * (y * y - 1), 0)).norm(),
            1e-12);
  EXPECT_LT((of(StrainMeasure::hencky) - Vector3d(std::log(x), std::log(y), 0)).norm(), 1e-12);
  for (const auto measure : {StrainMeasure::biot, StrainMeasure::engineering})
    EXPECT_LT((of(measure) - Vector3d(x - 1, y - 1, 0)).norm(), 1e-12);
  EXPECT_LT((strain_by(StrainMeasure::small, U, T).e - Vector3d(x - 1, y - 1, 0)).norm(), 1e-12);
  EXPECT_GT((of(StrainMeasure::small) - Vector3d(x - 1, y - 1, 0)).norm(), 0.1) << "it sees turns";
  Tangents shear = T;
  shear(0, 1) = 0.3;
  EXPECT_NEAR(strain_by(StrainMeasure::engineering, shear, T).e[2], 0.5 * std::atan(0.3), 1e-12);
  EXPECT_NEAR(strain_by(StrainMeasure::small, shear, T).e[2], 0.15, 1e-12);
}

TEST(StrainMeasures, DerivativesAreThoseOfFiniteDifferences) {
  Tangents T, even, skew;
  T << 0.6, -0.8, 0.8, 0.6, 0.0, 0.0;
  even = 1.1 * T;  // two equal stretches
  skew << 0.7, -0.7, 0.9, 0.65, 0.1, -0.2;
  for (const StrainMeasure measure : kAll)
    for (const Tangents& A : {even, skew}) {
      const StrainOfTangents here = strain_by(measure, A, T);
      for (int i = 0; i < 6; ++i) {
        constexpr double kStep = 1e-6;
        Tangents up = A, down = A;
        up.data()[i] += kStep, down.data()[i] -= kStep;
        const Vector3d d =
            (strain_by(measure, up, T).e - strain_by(measure, down, T).e) / (2.0 * kStep);
        EXPECT_LT((here.d_A.col(i) - d).norm(), 1e-8) << name_of(measure) << " " << i;
      }
      EXPECT_GT(here.d_A.norm(), 0.5);
    }
}

const MeasuredSpec& first_field(const Scene& scene) {
  return scene.capture.examples.front().measured.front();
}

FieldBlock strains(const std::string& measure, const std::string& keys = "") {
  return {.mu = 0.06, .sigma = 1e-3, .keys = keys, .strain = measure};
}

/// Whole predictions of a body in equilibrium, its weight among the parameters, by Jacobian and by
/// central differences.
void expect_derivative(const FieldBlock& block) {
  const auto scene = block.scene();
  ModelForm form = base_form(scene);
  form.ingredients.push_back(find_effect("gravity")->candidate(form.realise(form.initial()), ""));
  VectorXd p = form.initial();
  p.tail<3>() = Vector3d(3000.0, -2000.0, -9000.0);
  Workspace workspace(scene);
  const auto at = [&](const VectorXd& there, bool derivatives) {
    EvaluationOptions options;
    options.derivatives = derivatives;
    return workspace.evaluate(form, there, options).value();
  };
  const Evaluation here = at(p, true), whole = at(p, false);
  const auto parameters = form.parameters();
  for (int i = 0; i < p.size(); ++i) {
    const double step = 1e-3 * (parameters[i].positive ? p[i] : parameters[i].typical);
    const Evaluation up = at(p + step * VectorXd::Unit(p.size(), i), false),
                     down = at(p - step * VectorXd::Unit(p.size(), i), false);
    for (size_t e = 0; e < here.examples.size(); ++e)
      for (size_t k = 0; k < here.examples[e].measured.size(); ++k) {
        const MeasuredEvaluation& one = here.examples[e].measured[k];
        const VectorXd& r = whole.examples[e].measured[k].r;
        const VectorXd d =
            (up.examples[e].measured[k].r - down.examples[e].measured[k].r) / (2.0 * step);
        EXPECT_GT(d.norm(), 0.0);
        EXPECT_NEAR(one.J.col(i).norm(), d.norm(), 2e-3 * d.norm()) << block.strain << " " << i;
        EXPECT_NEAR(one.J.col(i).dot(one.r), d.dot(r), 2e-3 * d.norm() * r.norm());
      }
  }
}

TEST(StrainField, DerivativesAreThoseOfFiniteDifferences) {
  expect_derivative(strains("green", ", gauge: 6"));
  expect_derivative(strains("hencky"));
}

/// One state, told: an even deformation of the whole body.
struct Even {
  explicit Even(const FieldBlock& block) : scene(block.scene()), form(base_form(scene)) {
    F << 1.1, 0.05, 0.0, -0.02, 0.97, 0.1, 0.03, 0.0, 1.2;
    state.q = Matrix3Xd(F * scene->body->mesh.X).reshaped();
  }
  VectorXd strain(const Model& model) const {
    const Eigen::MatrixXd none;
    return predicted(first_field(*scene), {*scene, model, 0, state, none}).value;
  }
  std::shared_ptr<const Scene> scene;
  ModelForm form;
  Eigen::Matrix3d F;
  Equilibrium state;
};

TEST(StrainField, AnEvenDeformationIsTheSamePointwiseAndOverAGauge) {
  for (const char* gauge : {"", ", gauge: 5"}) {
    const Even even(strains("green", gauge));
    const Eigen::Matrix3d E = 0.5 * (even.F.transpose() * even.F - Eigen::Matrix3d::Identity());
    const VectorXd e = even.strain(even.form.realise(even.form.initial()));
    ASSERT_EQ(e.size(), 3 * 152);
    for (Eigen::Index k = 0; k < 152; ++k) {  // the front: x across, z up
      EXPECT_NEAR(e[3 * k], E(0, 0), 1e-10);
      EXPECT_NEAR(e[3 * k + 1], E(2, 2), 1e-10);
      EXPECT_NEAR(e[3 * k + 2], E(0, 2), 1e-10);
    }
  }
}

/// The told axes stay where they are; a body that is placed otherwise turns below them.
TEST(StrainField, APlacementTurnsTheSurfaceBelowTheAxes) {
  const Even even(strains("biot"));
  Model model = even.form.realise(even.form.initial());
  const VectorXd before = even.strain(model);
  model.placement = Eigen::AngleAxisd(EIGEN_PI / 2, Vector3d::UnitY());
  const VectorXd after = even.strain(model);
  for (Eigen::Index k = 0; k < 152; ++k) {
    EXPECT_NEAR(after[3 * k], before[3 * k + 1], 1e-10);
    EXPECT_NEAR(after[3 * k + 1], before[3 * k], 1e-10);
    EXPECT_NEAR(after[3 * k + 2], -before[3 * k + 2], 1e-10);
  }
}

TEST(StrainField, ATurningPlacementHasItsDerivative) {
  for (const StrainMeasure measure : kAll) {
    const Even even(strains(name_of(measure)));
    const FieldSpec& field = *first_field(*even.scene).field;
    const TetMesh& mesh = even.scene->body->mesh;
    const FieldPoints points = field_points(mesh, field);
    const Vector3d w(0.1, -0.7, 0.2);
    const auto turned = [&](double by) {
      return Eigen::AngleAxisd(by, w.normalized()).toRotationMatrix();
    };
    Eigen::Matrix3d W;
    W << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
    const Eigen::Matrix3d d = W / w.norm() * turned(0.2);
    const auto at = [&](double by) {
      return PointStrainer(mesh, field, *points.strain, turned(by))
          .at(40, even.state.q, nullptr, {})
          .e;
    };
    const Eigen::MatrixXd S = Eigen::MatrixXd::Zero(even.state.q.size(), 1);
    const PointStrain here =
        PointStrainer(mesh, field, *points.strain, turned(0.2)).at(40, even.state.q, &S, {{0, d}});
    const Vector3d difference = (at(0.2 + 1e-5) - at(0.2 - 1e-5)) / 2e-5;
    EXPECT_GT(difference.norm(), 0.01);
    EXPECT_LT((here.J.col(0) - difference).norm(), 1e-7) << name_of(measure);
  }
}

/// Near a rim the gauge holds what there is of the surface.
TEST(StrainField, AGaugeIsTheMeanOfItsDisc) {
  const auto fine = strains("small").scene(), wide = strains("small", ", gauge: 8").scene();
  Equilibrium state;  // strains that grow with height, to second order
  const Matrix3Xd& X = fine->body->mesh.X;
  Matrix3Xd x = X;
  x.row(2).array() += 0.001 * X.row(2).array().square();
  state.q = x.reshaped();
  const Eigen::MatrixXd none;
  const auto at = [&](const Scene& scene) {
    const ModelForm form = base_form(fine);
    const Model model = form.realise(form.initial());
    return predicted(first_field(scene), {scene, model, 0, state, none}).value;
  };
  const VectorXd a = at(*fine), b = at(*wide);
  const Matrix3Xd& points = first_field(*fine).field->X;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double z = points(2, k);
    EXPECT_NEAR(a[3 * k + 1], 0.002 * z, 1e-6);
    if (z > 4.0 && z < 36.0) {
      EXPECT_NEAR(b[3 * k + 1], 0.002 * z, 1e-6) << "a straight slope";
    }
  }
  EXPECT_GT(b[3 * 0 + 1], 1.2 * a[3 * 0 + 1])
      << "2 mm above the rim the disc has its lower part cut";
}

TEST(StrainField, SigmasMayBeOneAComponent) {
  FieldBlock block = strains("green");
  const TemporaryFolder folder;
  block.write(folder.path());
  std::ostringstream text;
  text << std::ifstream(folder.path() / "capture.yaml").rdbuf();
  std::string yaml = text.str();
  for (size_t at; (at = yaml.find("sigma: 0.001")) != std::string::npos;)
    yaml.replace(at, 12, "sigma: [0.001, 0.002, 0.003]");
  std::ofstream(folder.path() / "capture.yaml") << yaml;
  const auto scene = load_scene(read_capture(folder.path()));
  const MeasuredSpec& field = first_field(*scene);
  const double alike = std::sqrt(field.field->alike[0]);
  for (int i = 0; i < 3; ++i) EXPECT_DOUBLE_EQ(field.sigma[i], 0.001 * (i + 1) * alike);
}

std::string refusal(const std::string& file, const std::string& from, const std::string& to) {
  return ChangedBlock{{.sigma = 1e-9, .strain = "green"}, file, from, to}.refusal();
}

TEST(StrainField, WhatIsWrongIsToldWithFileAndLine) {
  using testing::AllOf;
  using testing::HasSubstr;
  const auto capture = [](const std::string& from, const std::string& to) {
    return refusal("capture.yaml", from, to);
  };
  EXPECT_THAT(capture("strain: green", "strain: grene"),
              AllOf(HasSubstr("capture.yaml:"), HasSubstr("`grene` is no measure of strain that "
                                                          "is known\n  one of green, hencky, biot, "
                                                          "engineering, small")));
  EXPECT_THAT(capture("strain: green", "strain: Euler-Almansi"),
              HasSubstr("almansi strains are not read: their axes are those of the deformed body"));
  EXPECT_THAT(capture("axes: [[1, 0, 0], [0, 0, 1]]", "axes: [[1, 0, 0], [0, 1, 0]]"),
              AllOf(HasSubstr("rest_front.csv:2: the axes of the strains do not lie in the body's "
                              "surface, whose normal at this point is (0, -1, 0)"),
                    HasSubstr("tell along what exx and eyy are")));
  EXPECT_THAT(capture("axes: [[1, 0, 0], [0, 0, 1]]", "axes: [[1, 0, 0], [1, 0, 1]]"),
              HasSubstr("the axes of the strains are not at right angles"));
  EXPECT_THAT(capture("axes: [[1, 0, 0], [0, 0, 1]]", "axes: [[1, 0, 0]]"),
              HasSubstr("1 axes of the strains"));
  EXPECT_THAT(capture("sigma: 1e-09, strain: green", "sigma: [1, 2], strain: green"),
              HasSubstr("2 sigmas, but 3 components (exx, eyy, exy)"));
  EXPECT_THAT(capture("strain: green", "strain: green, gauge: -1"), HasSubstr("capture.yaml:"));
  EXPECT_THAT(capture("strain: green", "strain: green, strain_unit: bar"),
              HasSubstr("one of fraction, percent, millistrain, microstrain"));
  EXPECT_THAT(capture("strain: green", "gauge: 3"),
              HasSubstr("`gauge` is of a field of strains\n  add `strain: green`"));
  EXPECT_THAT(refusal("rest_front.csv", "exx,", "exx [%] - Hencky,"),
              HasSubstr("rest_front.csv:1: column `eyy` is in `1`, others in `%`"));
  EXPECT_THAT(refusal("rest_front.csv", "exx,eyy,exy", "e_x,eyy,exy"),
              HasSubstr("rest_front.csv:1: there is `eyy`, but no strain along x"));
  EXPECT_THAT(refusal("rest_front.csv", "exx,eyy,exy", "exx - Hencky,eyy,exy"),
              HasSubstr("the head of rest_front.csv says that its strains are hencky, the capture "
                        "green\n  `strain: hencky`"));
  EXPECT_THAT(
      refusal("rest_front.csv", "\n-9,-8,4,", "\n-9,-15,4,"),
      HasSubstr("rest_front.csv:3: the point (-9, -15, 4) lies 7 mm off the body's surface"));
}

}  // namespace
}  // namespace hookeye::test
