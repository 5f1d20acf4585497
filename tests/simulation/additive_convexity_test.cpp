// Convexity of additive models: the test, its gradient, the projection; and bad input.
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>

#include "simulation/additive.h"
#include "simulation/blocks.h"
#include "support/derivative.h"

namespace hookeye {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

VectorXd one(double v) { return VectorXd::Constant(1, v); }

/// Two tied components with a grid, and a third on its own.
AdditiveModel tied() {
  AdditiveModel model;
  add_addend(model, "E11", {-0.2, 0.1, 0.4}, {}, Vector3d(1.0, 1.5, 2.0));
  add_addend(model, "E22", {0.0, 0.3}, {}, Eigen::Vector2d(1.0, 0.8));
  VectorXd grid(4);
  grid << 0.2, 0.3, 0.1, 0.4;
  add_addend(model, "E11_E22", {-0.1, 0.2}, {0.0, 0.3}, grid);
  add_addend(model, "I1bar", {0.0, 0.5}, {}, Eigen::Vector2d(0.3, 0.2));
  add_addend(model, "J", {0.0}, {}, one(2.0));
  return model;
}

/// The values are the numbers themselves.
std::vector<ConvexPart> alone(const AdditiveModel& model) {
  return {{model, MatrixXd::Identity(model.size(), model.size())}};
}

TEST(Convexity, EigenvalueOfStVkIsKnown) {
  // Over E11, E22, E33: 2 mu, 2 mu, 3 lambda + 2 mu; over each shear 4 mu.
  const ConvexityTest found = smallest_eigenvalue(additive_stvk(0.3, 0.05));
  EXPECT_NEAR(found.smallest, 0.1, 1e-15);
  EXPECT_NEAR(smallest_eigenvalue(additive_stvk(-0.04, 0.05)).smallest, 0.1 - 0.12, 1e-15);
}

TEST(Convexity, TheTestedHessianIsThatOfTheEnergy) {
  // At a control point where the bilinear cells make it jump, the two sides differ, and each is the
  // limit of second differences of psi on its side.
  AdditiveModel model = tied();
  model.addends[2].stiffness << 0.2, 0.3, -1.9, 1.4;  // steep: one side of a cell is not convex
  const ConvexityTest least = smallest_eigenvalue(model);
  ASSERT_LT(least.smallest, 0.0);
  double lowest = 1e9;  // by brute force over strains, from finite differences of the law's energy
  const auto psi = [&](double a, double b) {
    AdditiveModel only = model;
    only.addends.resize(3);
    const Vector3d stretch(std::sqrt(1 + 2 * a), std::sqrt(1 + 2 * b), 1);
    return additive(only)->psi(stretch.asDiagonal());
  };
  const double h = 1e-4;
  for (double a = -0.2; a <= 0.4001; a += 0.02)
    for (double b = 0.0; b <= 0.3001; b += 0.02)
      for (double s : {-2 * h, 2 * h})
        for (double t : {-2 * h, 2 * h}) {
          const double x = a + s, y = b + t;
          Eigen::Matrix2d H;
          H(0, 0) = (psi(x + h, y) - 2 * psi(x, y) + psi(x - h, y)) / (h * h);
          H(1, 1) = (psi(x, y + h) - 2 * psi(x, y) + psi(x, y - h)) / (h * h);
          H(0, 1) = H(1, 0) =
              (psi(x + h, y + h) - psi(x + h, y - h) - psi(x - h, y + h) + psi(x - h, y - h)) /
              (4 * h * h);
          lowest =
              std::min(lowest, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(H).eigenvalues()[0]);
        }
  EXPECT_NEAR(least.smallest, lowest, 0.01 * std::abs(lowest));
}

TEST(Convexity, GradientIsTheDerivativeOfTheEigenvalue) {
  AdditiveModel model = tied();
  model.addends[2].stiffness << 0.2, 0.3, -1.9, 1.4;  // steep: the pair has the smallest
  const VectorXd p = model.values();
  const ConvexityTest least = smallest_eigenvalue(model);
  int moving = 0;
  for (int k = 0; k < p.size(); ++k) {
    const auto f = [&](double h) {
      AdditiveModel other = model;
      VectorXd v = p;
      v[k] += h;
      other.set_values(v);
      return one(smallest_eigenvalue(other).smallest);
    };
    if (least.gradient[k] == 0.0) {  // another place's value
      for (double h : {-1e-4, 1e-4}) EXPECT_NEAR(f(h)[0], least.smallest, 1e-12) << k;
      continue;
    }
    ++moving;
    test::expect_derivative(f, one(least.gradient[k]), 1e-4, 1e-6, std::to_string(k));
  }
  EXPECT_GE(moving, 4) << "E11, E22 and the coupling at least";
}

TEST(Convexity, ProjectionEndsConvexAndMovesNoConvexModel) {
  const AdditiveModel model = tied();
  const int n = model.size();
  const MatrixXd I = MatrixXd::Identity(n, n);
  const ConvexProjection stays = project_convex(alone(model), model.values(), I);
  EXPECT_TRUE(stays.converged);
  EXPECT_EQ(stays.x, model.values());
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const VectorXd target = model.values() + 1.5 * test::noise(n, seed);
    AdditiveModel out = model;
    out.set_values(target);
    if (smallest_eigenvalue(out).smallest >= 0) continue;
    const ConvexProjection p = project_convex(alone(model), target, I);
    ASSERT_TRUE(p.converged) << seed;
    EXPECT_GT(p.cuts, 0);
    out.set_values(p.x);
    EXPECT_GE(smallest_eigenvalue(out).smallest, 0.0) << seed;
    // The nearest one: no convex model on the way to the start is nearer (the set is convex, so
    // the angle at the projection is obtuse for every member).
    EXPECT_LE((target - p.x).dot(model.values() - p.x), 1e-6 * target.squaredNorm()) << seed;
  }
}

TEST(Convexity, ProjectionOfOneTiedPairIsKnown) {
  // H = (a c; c b): nearest positive semidefinite matrix in the Frobenius norm clips eigenvalues.
  AdditiveModel model;
  add_addend(model, "E11", {0.0}, {}, one(1));
  add_addend(model, "E22", {0.0}, {}, one(1));
  add_addend(model, "E11_E22", {0.0}, {0.0}, one(0));
  const Vector3d target(1.0, 0.2, 0.9);
  const ConvexProjection p = project_convex(alone(model), target, Vector3d(1, 1, 2).asDiagonal());
  ASSERT_TRUE(p.converged);
  Eigen::Matrix2d H;
  H << 1.0, 0.9, 0.9, 0.2;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(H);
  const Eigen::Matrix2d clipped = eigen.eigenvectors() *
                                  eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
                                  eigen.eigenvectors().transpose();
  EXPECT_NEAR(p.x[0], clipped(0, 0), 1e-5);
  EXPECT_NEAR(p.x[1], clipped(1, 1), 1e-5);
  EXPECT_NEAR(p.x[2], clipped(0, 1), 1e-5);
}

TEST(Convexity, PartsAreProjectedTogetherWhereTheyShareNumbers) {
  // x = (a, b): one part has the moduli a and b - a, the other 2 a. Nearest to (1, 0) with a <= b.
  AdditiveModel pair, other;
  add_addend(pair, "E11", {0.0}, {}, one(1));
  add_addend(pair, "E22", {0.0}, {}, one(1));
  add_addend(other, "J", {0.0}, {}, one(1));
  MatrixXd by_pair(2, 2), by_other(1, 2);
  by_pair << 1, 0, -1, 1;
  by_other << 2, 0;
  const std::vector<ConvexPart> parts = {{pair, by_pair}, {other, by_other}};
  const MatrixXd I = MatrixXd::Identity(2, 2);
  const ConvexProjection p = project_convex(parts, Eigen::Vector2d(1.0, 0.0), I);
  ASSERT_TRUE(p.converged);
  EXPECT_NEAR(p.x[0], 0.5, 1e-4);  // a strain is resisted by 1e-5 of the stiffest at least
  EXPECT_NEAR(p.x[1], 0.5, 1e-4);
  const ConvexProjection q = project_convex(parts, Eigen::Vector2d(-1.0, 2.0), I);
  ASSERT_TRUE(q.converged);
  EXPECT_NEAR(q.x[0], 0.0, 1e-4);
  EXPECT_NEAR(q.x[1], 2.0, 1e-4);
}

TEST(Convexity, ASumIsTheEnergyOfBoth) {
  AdditiveModel a = tied(), b;
  add_addend(b, "I1bar", {0.0, 0.2}, {}, Eigen::Vector2d(0.0, 0.1));
  add_addend(b, "fibre1", {0.0}, {}, one(0.3));
  b.components.back().direction = Vector3d(0.6, 0.8, 0.0);
  a.frame = b.frame = Eigen::AngleAxisd(0.3, Vector3d::UnitZ()).matrix();
  const auto sum = sum_of(a, b);
  ASSERT_TRUE(sum);
  EXPECT_EQ(sum->components.size(), a.components.size() + 1);
  EXPECT_EQ(sum->values().size(), a.size() + b.size());
  Matrix3d F;
  F << 1.1, 0.1, 0.0, -0.05, 0.95, 0.1, 0.02, 0.0, 1.05;
  EXPECT_NEAR(additive(*sum)->psi(F), additive(a)->psi(F) + additive(b)->psi(F), 1e-14);
  // What one takes away the other gives: convex together.
  AdditiveModel softer;
  softer.frame = a.frame;
  add_addend(softer, "I1bar", {0.0}, {}, one(-0.1));
  EXPECT_NEAR(smallest_eigenvalue(softer).smallest, -0.1, 1e-15);
  AdditiveModel stiffer;
  stiffer.frame = a.frame;
  add_addend(stiffer, "I1bar", {0.0, 0.2}, {}, Eigen::Vector2d(0.3, 0.5));
  EXPECT_NEAR(smallest_eigenvalue(*sum_of(stiffer, softer)).smallest, 0.2, 1e-15);
  b.frame.setIdentity();
  EXPECT_FALSE(sum_of(a, b));
  b.frame = a.frame;
  for (int i = 1; i <= 9; ++i) {
    const std::string name = "fibre" + std::to_string(i);
    for (AdditiveModel* model : {&a, &b}) {
      if (model == &b && i == 1) continue;
      add_addend(*model, name, {0.0}, {}, one(0.1));
      model->components.back().direction = Vector3d(i, model == &a ? 1 : -1, 1).normalized();
    }
  }
  EXPECT_FALSE(sum_of(a, b)) << "18 fibres do not fit into a model";
}

TEST(Convexity, ProjectionKeepsBounds) {
  const AdditiveModel model = tied();
  const int n = model.size();
  const VectorXd target = VectorXd::Constant(n, -1.0);
  const VectorXd low = VectorXd::Constant(n, 0.1);
  const ConvexProjection p = project_convex(alone(model), target, MatrixXd::Identity(n, n), low);
  ASSERT_TRUE(p.converged);
  EXPECT_GE(p.x.minCoeff(), 0.1);
}

MaterialSpec spec(std::map<std::string, std::vector<double>> values) {
  MaterialSpec s;
  s.law = "additive";
  s.place = {"capture.yaml", 9, 14};
  int column = 20;
  for (auto& [name, numbers] : values)
    s.parameters[name] = {numbers, {"capture.yaml", 9, column++}};
  return s;
}
using Values = std::map<std::string, std::vector<double>>;
Values with(Values more) {
  Values all = {
      {"I1bar.at", {0}}, {"I1bar.stiffness", {0.05}}, {"J.at", {0}}, {"J.stiffness", {0.5}}};
  for (auto& [name, numbers] : more) all[name] = numbers;
  return all;
}
void expect_fault(const Values& values, const std::string& wrong, const std::string& key) {
  const MaterialSpec s = spec(values);
  try {
    make_law(s);
    ADD_FAILURE() << "accepted: " << wrong;
  } catch (const InputError& e) {
    EXPECT_THAT(e.wrong(), testing::HasSubstr(wrong));
    EXPECT_FALSE(e.right().empty());
    EXPECT_EQ(e.place().column, key.empty() ? 14 : s.parameters.at(key).place.column) << wrong;
  }
}

TEST(AdditiveInput, ReadsWhatACaptureSays) {
  const auto law = make_law(spec(with({{"frame", {0, 1, 0, 0, 0, 1, 1, 0, 0}},
                                       {"E11.at", {-0.1, 0, 0.3}},
                                       {"E11.stiffness", {0.1, 0.2, 0.5}},
                                       {"E11.wall", {0.4, 0.1, 3}},
                                       {"E11_E22.at", {0, 0.2}},
                                       {"E11_E22.at_2", {0, 0.1}},
                                       {"E11_E22.stiffness", {0, 0, 0, 0}},
                                       {"fibre1.at", {0}},
                                       {"fibre1.direction", {0, 0, 2}},
                                       {"fibre1.stiffness", {0.3}},
                                       {"barrier.modulus", {0.1}},
                                       {"barrier.below", {0.3}}})));
  const AdditiveModel* model = additive_model(*law);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->frame.col(0), Vector3d::UnitY());
  EXPECT_EQ(model->size(), 3 + 4 + 1 + 1 + 1);
  ASSERT_TRUE(model->find("E11.wall"));
  EXPECT_TRUE(model->find("E11.wall")->fixed);
  const auto p = law->parameters(Units{"mm", "N"});
  EXPECT_EQ(p[0].name, "E11.1");
  EXPECT_EQ(p[0].unit, "MPa");
  EXPECT_EQ(p[0].long_name, "tangent modulus at E11 = -0.1");
  EXPECT_EQ(p[4].long_name, "coupling modulus at E11 = 0, E22 = 0.1");
  const auto tube = make_law(spec(with({{"frame.axis", {0, 0, 3}}, {"frame.center", {1, 0, 0}}})));
  ASSERT_TRUE(additive_model(*tube)->cylinder);
  EXPECT_EQ(additive_model(*tube)->cylinder->axis, Vector3d::UnitZ());
}

TEST(AdditiveInput, NamesTheFaultAndItsPlace) {
  expect_fault(with({{"E11.at", {0, 0.2, 0.1}}, {"E11.stiffness", {1, 1, 1}}}),
               "out of order: 0.1 after 0.2", "E11.at");
  expect_fault(with({{"E11.at", {0, 0.2, 0.2}}, {"E11.stiffness", {1, 1, 1}}}),
               "0.2 of `E11.at` "
               "stands twice",
               "E11.at");
  expect_fault(with({{"E11.at", {0, NAN}}, {"E11.stiffness", {1, 1}}}), "nan", "E11.at");
  expect_fault(with({{"E11.at", {-0.6, 0}}, {"E11.stiffness", {1, 1}}}), "-0.6", "E11.at");
  expect_fault(with({{"I1bar.at", {-0.1, 0}}, {"I1bar.stiffness", {1, 1}}}), "-0.1", "I1bar.at");
  expect_fault(with({{"E11.at", {0, 0.1}}, {"E11.stiffness", {1}}}), "1 values", "E11.stiffness");
  expect_fault(with({{"E11.at", {0}}}), "lacks `E11.stiffness`", "");
  expect_fault(with({{"E11.at", {0}}, {"E11.stiffness", {-0.1}}}),
               "not convex at E11 = 0: smallest eigenvalue -0.1", "E11.stiffness");
  expect_fault(with({{"E11_E22.at", {0}}, {"E11_E22.at_2", {0}}, {"E11_E22.stiffness", {1}}}),
               "not convex at E11 = 0, E22 = 0: smallest eigenvalue -1", "E11_E22.stiffness");
  expect_fault(with({{"frame", {1, 0, 0, 0.1, 1, 0, 0, 0, 1}}}), "not orthonormal", "frame");
  expect_fault(with({{"frame", {1, 0, 0}}}), "3 numbers", "frame");
  expect_fault(with({{"frame", {1, 0, 0, 0, 1, 0, 0, 0, -1}}}), "left-handed", "frame");
  expect_fault(
      with({{"E11_E22.at", {0}}, {"E11_E22.at_2", {0, 0.3}}, {"E11_E22.stiffness", {0, 0}}}),
      "1 control points along E11 and 2 along E22", "E11_E22.at");
  expect_fault(
      with({{"E11_fibre1.at", {0}}, {"E11_fibre1.at_2", {0}}, {"E11_fibre1.stiffness", {0}}}),
      "needs the direction of fibre1", "E11_fibre1.at");
  expect_fault(with({{"E11.wall", {-0.4, 0.2, 5}}}), "-0.6", "E11.wall");
  expect_fault(with({{"E14.at", {0}}, {"E14.stiffness", {1}}}), "no addend `E14`", "E14.at");
  expect_fault(with({{"E11.points", {0}}, {"E11.at", {0}}, {"E11.stiffness", {1}}}),
               "no `E11.points`", "E11.points");
  expect_fault(with({{"E11_E11.at", {0}}, {"E11_E11.at_2", {0}}, {"E11_E11.stiffness", {1}}}),
               "to itself", "");
  expect_fault(with({{"E11_I1bar.at", {0}}, {"E11_I1bar.at_2", {0}}, {"E11_I1bar.stiffness", {0}}}),
               "stands alone", "");
  expect_fault({{"E11.at", {0}}, {"E11.stiffness", {1}}}, "nothing resists the strain", "");
  expect_fault({}, "no addends", "");
  expect_fault(with({{"barrier.modulus", {-1}}, {"barrier.below", {0.3}}}), "-1",
               "barrier.modulus");
  expect_fault(with({{"barrier.modulus", {1}}, {"barrier.below", {1.2}}}), "1.2", "barrier.below");
  expect_fault(with({{"E11.wall", {0.2, 0, 1}}}), "not a wall", "E11.wall");
  expect_fault(with({{"fibre1.at", {0}}, {"fibre1.stiffness", {1}}}), "lacks `fibre1.direction`",
               "");
  expect_fault(with({{"frame.axis", {0, 0, 0}}, {"frame.center", {0, 0, 0}}}), "no length",
               "frame.axis");
}

}  // namespace
}  // namespace hookeye
