// Measured fields: what a model predicts of them, its derivative, and how many numbers they are.
#include "estimation/evaluation/field_evaluation.h"

#include <gmock/gmock.h>

#include <fstream>

#include "estimation/effects/catalogue.h"
#include "estimation/effects_scene.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/field_block.h"

namespace hookeye::test {
namespace {

const MeasuredSpec& first_field(const Scene& scene) {
  return scene.capture.examples.front().measured.front();
}

/// Every predicted number against its central difference, weight and placement included; and what
/// is condensed against the whole.
TEST(FieldEvaluation, DerivativesAreThoseOfFiniteDifferences) {
  const auto scene = FieldBlock{.mu = 0.06, .sigma = 0.05}.scene();
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
  std::vector<Evaluation> up, down;
  VectorXd steps(p.size());
  for (int i = 0; i < p.size(); ++i) {
    steps[i] = 1e-3 * (parameters[i].positive ? p[i] : parameters[i].typical);
    up.push_back(at(p + steps[i] * VectorXd::Unit(p.size(), i), false));
    down.push_back(at(p - steps[i] * VectorXd::Unit(p.size(), i), false));
  }
  for (size_t e = 0; e < here.examples.size(); ++e)
    for (size_t k = 0; k < here.examples[e].measured.size(); ++k) {
      const MeasuredEvaluation& one = here.examples[e].measured[k];
      const VectorXd& r = whole.examples[e].measured[k].r;
      ASSERT_EQ(one.J.rows(), p.size() + 1);
      Eigen::MatrixXd J(r.size(), p.size());
      for (int i = 0; i < p.size(); ++i)
        J.col(i) = (up[i].examples[e].measured[k].r - down[i].examples[e].measured[k].r) /
                   (2.0 * steps[i]);
      const Eigen::MatrixXd JtJ = J.transpose() * J, condensed = one.J.transpose() * one.J;
      const VectorXd Jtr = J.transpose() * r, score = one.J.transpose() * one.r;
      EXPECT_NEAR(one.r.squaredNorm(), r.squaredNorm(), 1e-9 * r.squaredNorm());
      for (int i = 0; i < p.size(); ++i) {
        const double length = std::sqrt(JtJ(i, i));
        EXPECT_GT(length, 0.0);
        EXPECT_NEAR(score[i], Jtr[i], 2e-4 * length * r.norm());
        for (int j = 0; j < p.size(); ++j)
          EXPECT_NEAR(condensed(i, j), JtJ(i, j), 2e-3 * length * std::sqrt(JtJ(j, j)));
      }
    }
}

TEST(FieldEvaluation, APlacementTurnsWhatIsPredicted) {
  const auto scene = FieldBlock{}.scene();
  const ModelForm form = base_form(scene);
  Model model = form.realise(form.initial());
  const Eigen::AngleAxisd turn(0.3, Vector3d(1, 2, 2) / 3.0);
  model.placement = Eigen::Translation3d(1, 2, 3) * turn;
  Equilibrium state;
  const Vector3d move(0.5, -0.3, 2.0);
  state.q = (scene->body->mesh.X.colwise() + move).reshaped();
  const Eigen::MatrixXd none;
  const VectorXd value = predicted(first_field(*scene), {*scene, model, 0, state, none}).value;
  for (Eigen::Index k = 0; k < value.size() / 3; ++k)
    EXPECT_NEAR((value.segment<3>(3 * k) - turn * move).norm(), 0.0, 1e-12);
}

/// Beside photos chi stays theirs; the sums of a fit hold both, whatever sensors weigh.
TEST(FieldEvaluation, BesidePhotosAFieldAddsItsOwnSums) {
  const auto told = FieldBlock{}.scene();
  auto scene = std::make_shared<Scene>(*block_scene());
  const auto at = static_cast<size_t>(scene->example_index("pull"));
  scene->capture.examples[at].measured = {
      told->capture.examples[static_cast<size_t>(told->example_index("pull"))].measured.front()};
  const ModelForm form = base_form(scene), plain = base_form(block_scene());
  Workspace workspace(scene), without(block_scene());
  Evaluation both = workspace.evaluate(form, form.initial(), {}).value();
  const Evaluation photos = without.evaluate(plain, form.initial(), {}).value();
  EXPECT_EQ(both.seen(), Evaluation::Seen::photos);
  EXPECT_EQ(both.chi(false), photos.chi(false));
  EXPECT_EQ(both.measured_chi(false), photos.measured_chi(false));
  EXPECT_GT(both.field_chi(false), 0.0);
  EXPECT_EQ(photos.field_chi(false), 0.0);
  const MeasuredEvaluation& field = both.find(static_cast<int>(at))->measured.front();
  EXPECT_DOUBLE_EQ(field.size(), field.numbers);
  const auto added = [&] {
    return (normal_equations(both).JtJ - normal_equations(photos).JtJ).eval();
  };
  const Eigen::MatrixXd own = field.J.transpose() * field.J;
  EXPECT_NEAR((added() - own).norm(), 0.0, 1e-6 * normal_equations(both).JtJ.norm());
}

/// A file without the third component, in a frame of its own, tells the other two.
TEST(FieldEvaluation, TwoComponentsInAPlaneOfTheirOwn) {
  const FieldBlock block{.gravity = {0, 5000, -9000}, .sigma = 1e-6};
  FieldBlock flat = block;
  flat.in_plane = true;
  const auto whole = block.scene(), plane = flat.scene();
  for (size_t e = 0; e < whole->capture.examples.size(); ++e)
    for (size_t f = 0; f < 2; ++f) {
      const MeasuredSpec &three = whole->capture.examples[e].measured[f],
                         &two = plane->capture.examples[e].measured[f];
      ASSERT_EQ(two.field->components, 2);
      EXPECT_NEAR((two.field->X - three.field->X).cwiseAbs().maxCoeff(), 0.0, 1e-9);
      const Eigen::Index across = f == 0 ? 0 : 1;
      for (Eigen::Index k = 0; k < two.field->X.cols(); ++k) {
        EXPECT_NEAR(two.value[2 * k], three.value[3 * k + across], 1e-4);
        EXPECT_NEAR(two.value[2 * k + 1], three.value[3 * k + 2], 1e-4);
      }
    }
}

/// 152 points of a square grid: each disc holds nine of them but at the rims.
TEST(FieldEvaluation, PointsThatErrAlikeAreFewNumbers) {
  const auto numbers = [](const std::string& keys) {
    return first_field(*FieldBlock{.keys = keys}.scene()).field->numbers();
  };
  EXPECT_DOUBLE_EQ(numbers(", correlation: 0"), 3.0 * 152.0);
  EXPECT_DOUBLE_EQ(numbers(""), numbers(", correlation: 6"));
  EXPECT_GT(numbers(""), 3.0 * 152.0 / 9.0);
  EXPECT_LT(numbers(""), 3.0 * 152.0 / 6.0);
  EXPECT_LT(numbers(", correlation: 500"), 4.0);
}

/// Two cameras see worse along their sight than across it.
TEST(FieldEvaluation, SigmaMayBeOneAComponent) {
  const FieldBlock block{.keys = ", correlation: 0"};
  const ChangedBlock changed{block, "capture.yaml", "sigma: 0.01", "sigma: [0.01, 0.02, 0.04]"};
  const auto one = block.scene(), three = changed.scene();
  const MeasuredSpec &even = first_field(*one), &uneven = first_field(*three);
  VectorXd off(uneven.value.size());
  for (Eigen::Index i = 0; i < off.size(); ++i) off[i] = 0.04;
  const VectorXd by_one = even.whitened(off), by_three = uneven.whitened(off);
  for (Eigen::Index k = 0; k < off.size(); k += 3)
    for (int c = 0; c < 3; ++c) {
      EXPECT_DOUBLE_EQ(by_one[k + c], 4.0);
      EXPECT_DOUBLE_EQ(by_three[k + c], 4.0 / std::pow(2.0, c));
    }
  EXPECT_NEAR(uneven.field->sigma, 0.01 * std::sqrt((1.0 + 4.0 + 16.0) / 3.0), 1e-12);
  EXPECT_EQ(uneven.field->numbers(), even.field->numbers());
}

std::string refusal(const FieldBlock& block, const std::string& file, const std::string& from,
                    const std::string& to) {
  return ChangedBlock{block, file, from, to}.refusal();
}

TEST(FieldEvaluation, WhatIsWrongIsToldWithFileAndLine) {
  const FieldBlock exact{.sigma = 1e-9};
  EXPECT_EQ(
      refusal(exact, "pull_front.csv", "\n-9,-8,4,", "\n-9,-15,4,"),
      "pull_front.csv:3: the point (-9, -15, 4) lies 7 mm off the body's surface, more than "
      "0.95 (1 of 152 points do)\n"
      "  coordinates in the capture's frame (else tell `frame:`, whose z is x cross y) and of "
      "the body as it was given; `tolerance: LENGTH` allows for more");
  const std::string metres =
      refusal(FieldBlock{}, "capture.yaml", "sigma: 0.01}", "sigma: 0.01, unit: m}");
  EXPECT_THAT(metres, testing::HasSubstr("(152 of 152 points do)"));
  EXPECT_THAT(metres, testing::HasSubstr("0.001 times their coordinates lie on it: tell the "
                                         "field's `unit` or `scale`"));
  EXPECT_THAT(refusal(FieldBlock{}, "bend_flank.csv", "X,Y,Z,U,V,W", "X,Y,Z,U,speed,W"),
              testing::StartsWith("bend_flank.csv:1: of X, Y, Z, U, V, W the file lacks V; it has "
                                  "X, Y, Z, U, speed, W\n"));
  const std::string through_frame =
      refusal(FieldBlock{}, "capture.yaml", "sigma: 0.01}",
              "sigma: 0.01, unit: m, frame: {origin: [0, 0, 5000], x: [1, 0, 0], y: [0, 1, 0]}}");
  EXPECT_THAT(through_frame, testing::HasSubstr("the points reach over"));
  EXPECT_THAT(through_frame, testing::HasSubstr("tell the field's `unit` or `scale`"));
  EXPECT_THAT(refusal(FieldBlock{.keys = ", unit: mm"}, "bend_flank.csv", "X,", "X [cm],"),
              testing::AllOf(testing::HasSubstr("capture.yaml:"),
                             testing::HasSubstr("bend_flank.csv tells its columns in cm, the "
                                                "capture in mm\n  remove `unit`, or tell")));
  EXPECT_THAT(refusal(FieldBlock{}, "bend_flank.csv", "X,", "X [px],"),
              testing::HasSubstr("the field of bend_flank.csv is in pixels\n"
                                 "  tell the length of a pixel, `scale: 0.05`"));
  EXPECT_THAT(refusal(FieldBlock{}, "bend_flank.csv", "X,", "X [furlong],"),
              testing::HasSubstr("bend_flank.csv is in the unknown unit `furlong`"));
  EXPECT_THAT(refusal(FieldBlock{}, "capture.yaml", "sigma: 0.01", "sigma: 0"),
              testing::HasSubstr("capture.yaml:"));
  EXPECT_THAT(refusal(FieldBlock{}, "capture.yaml", "sigma: 0.01", "value: 3"),
              testing::HasSubstr("has no key `value`"));
  EXPECT_THAT(refusal(FieldBlock{}, "capture.yaml", "rest_front.csv", "rest_fromt.csv"),
              testing::HasSubstr("rest_fromt.csv"));
}

TEST(FieldEvaluation, RowsWithoutNumbersAreDroppedAndCounted) {
  const TemporaryFolder folder;
  FieldBlock{}.write(folder.path());
  std::ofstream(folder.path() / "rest_front.csv", std::ios::app) << "nan,0,0,0,0,0\n-9,-8,4,,,\n";
  const auto scene = load_scene(read_capture(folder.path()));
  EXPECT_EQ(first_field(*scene).field->X.cols(), 152);
  EXPECT_EQ(first_field(*scene).field->dropped, 2);
}

}  // namespace
}  // namespace hookeye::test
