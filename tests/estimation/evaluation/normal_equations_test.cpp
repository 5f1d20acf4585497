// Residuals condensed to as many as there are parameters, and what an interval says of what the
// data leave open.
#include "estimation/evaluation/normal_equations.h"

#include <gmock/gmock.h>

#include <Eigen/QR>
#include <random>

#include "support/derivative.h"

namespace hookeye {
namespace {

Parameter stiffness(const std::string& name) {
  Parameter one;
  one.name = name, one.unit = "MPa", one.value = 1.0, one.low = 0.0;
  one.high = std::numeric_limits<double>::infinity(), one.typical = 1.0, one.positive = true;
  return one;
}

Parameter level(const std::string& name) {
  Parameter one;
  one.name = name, one.value = 0.0, one.low = -1.0, one.high = 10.0, one.typical = 0.1;
  one.positive = false;
  return one;
}

/// One photo with these derivatives of its residuals.
Evaluation seen(const Eigen::MatrixXd& J) {
  PhotoEvaluation photo;
  photo.sums.JtJ = J.transpose() * J;
  photo.sums.Jtr = VectorXd::Zero(J.cols());
  ExampleEvaluation example;
  example.photos.push_back(photo);
  Evaluation out;
  out.examples.push_back(example);
  out.columns = static_cast<int>(J.cols());
  return out;
}

/// A value at its bound is written and read again: rounding must not put it outside.
TEST(Scaling, KeepsTheBoundsThatRoundingWouldLeave) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(1e-6, 3000.0);
  int left = 0;
  for (int i = 0; i < 200; ++i) {
    Parameter one = stiffness("k");
    one.low = any(random), one.high = 2.0 * one.low;
    const Scaling scaling{{one, level("z")}};
    for (const double bound : {one.low, one.high}) {
      const double naive = std::exp(std::log(bound));
      left += naive < one.low || naive > one.high;
      const VectorXd p = scaling.to_p(scaling.to_x(Eigen::Vector2d(bound, 10.0)));
      EXPECT_GE(p[0], one.low);
      EXPECT_LE(p[0], one.high);
      EXPECT_LE(p[1], 10.0);
    }
  }
  EXPECT_GT(left, 0) << "rounding left no bound, the test would prove nothing";
}

/// Photos under prescribed motions know ratios of stiffness alone: each modulus may be anything,
/// although its ratio to the other is known to a thousandth.
/// What a fit moves and what the model has: their slopes, for a logarithm and for a level.
TEST(Scaling, HasItsDerivative) {
  const Scaling scaling{{stiffness("k"), level("z")}};
  const VectorXd p = Eigen::Vector2d(0.37, 2.3), x = scaling.to_x(p);
  for (int i = 0; i < 2; ++i)
    test::expect_derivative([&](double h) { return scaling.to_p(x + h * VectorXd::Unit(2, i)); },
                            scaling.dp_dx(p)[i] * VectorXd::Unit(2, i), 1e-3, 1e-9,
                            scaling.parameters[i].name);
}

/// Photos and measured values of the fitted examples, or of the others, with the weight of these,
/// and nothing else.
TEST(NormalEquations, SumPhotosAndMeasuredValues) {
  std::mt19937 random(3);
  std::normal_distribution<double> any;
  const auto noise = [&](Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd(
        Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return any(random); }));
  };
  Evaluation evaluation;
  evaluation.columns = 3;
  evaluation.measured_weight = 7.0;
  Eigen::MatrixXd J[2];
  VectorXd r[2];
  for (const bool held_out : {false, true, false}) {
    ExampleEvaluation example;
    example.held_out = held_out;
    Eigen::MatrixXd& all = J[held_out];
    VectorXd& residuals = r[held_out];
    for (int k = 0; k < 4; ++k) {
      Eigen::MatrixXd own = noise(3, 3);
      VectorXd at = noise(3, 1);
      if (k < 2) {
        PhotoEvaluation photo;
        photo.sums = {own.transpose() * own, own.transpose() * at, at.squaredNorm(), 3};
        example.photos.push_back(photo);
      } else {
        MeasuredEvaluation measured;
        measured.predicted.setZero();
        measured.J = own, measured.r = at;
        example.measured.push_back(measured);
        own *= std::sqrt(evaluation.measured_weight), at *= std::sqrt(evaluation.measured_weight);
      }
      const Eigen::Index before = residuals.size();
      all.conservativeResize(before + 3, 3), residuals.conservativeResize(before + 3);
      all.bottomRows(3) = own, residuals.tail(3) = at;
    }
    evaluation.examples.push_back(example);
  }
  for (const bool held_out : {false, true}) {
    const NormalEquations sums = normal_equations(evaluation, held_out);
    EXPECT_LE((sums.JtJ - J[held_out].transpose() * J[held_out]).norm(), 1e-13 * sums.JtJ.norm());
    EXPECT_LE((sums.Jtr - J[held_out].transpose() * r[held_out]).norm(), 1e-13 * sums.Jtr.norm());
    EXPECT_NEAR(sums.r2, r[held_out].squaredNorm(), 1e-13 * sums.r2);
  }
}

/// A weight moves the estimate, and the interval is that estimate's: w too large or too small for
/// the noise widens it (Gauss-Markov; White's sandwich).
TEST(ParameterCovariance, KnowsTheWeightOfMeasuredValues) {
  const Eigen::MatrixXd J = Eigen::VectorXd::Constant(1, 30.0);
  Evaluation evaluation = seen(J);
  MeasuredEvaluation measured;
  measured.predicted.setZero(), measured.r.setZero();
  measured.J = Eigen::Vector3d(10.0, 0.0, 0.0);
  evaluation.examples[0].measured.push_back(measured);
  const VectorXd p = VectorXd::Constant(1, 0.2);
  for (const double w : {0.2, 1.0, 9.0}) {
    evaluation.measured_weight = w;
    const double variance = parameter_covariance(evaluation, {level("z")}, p).determined(0, 0);
    const double expected = (900.0 + w * w * 100.0) / std::pow(900.0 + w * 100.0, 2);
    EXPECT_NEAR(variance, expected, 1e-12) << w;
    EXPECT_GE(variance, (1.0 - 1e-12) / 1000.0);
  }
}

TEST(ParameterCovariance, ARatioAloneLeavesBothModuliOpen) {
  const VectorXd p = Eigen::Vector3d(0.02, 0.3, 0.2);
  const std::vector<Parameter> all{stiffness("mu"), stiffness("kappa"), level("background.cam0")};
  Eigen::MatrixXd J(2, 3);
  J << 1000.0 / p[0], -1000.0 / p[1], 50.0,  //
      0.0, 0.0, 1e5;
  const ParameterCovariance known = parameter_covariance(seen(J), all, p);
  EXPECT_THAT(known.directions,
              testing::ElementsAre("stiffness scale not determined; only ratios (mu, kappa)"));
  EXPECT_THAT(known.open, testing::ElementsAre(true, true, false));
  // The ratio, in logarithms, and the level have what the photo says of them.
  const Eigen::Vector3d ratio(1.0 / p[0], -1.0 / p[1], 0.0);
  EXPECT_NEAR(std::sqrt(ratio.dot(known.determined * ratio)), 1e-3, 1e-5);
  EXPECT_NEAR(std::sqrt(known.all()(2, 2)), 1e-5, 1e-7);
  EXPECT_GT(std::sqrt(known.all()(0, 0)), 10.0 * p[0]);
}

TEST(ParameterCovariance, OneModulusThatNothingMoves) {
  const VectorXd p = Eigen::Vector2d(0.02, 0.2);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(1, 2);
  J(0, 1) = 1e4;
  const auto known = parameter_covariance(seen(J), {stiffness("mu"), level("background.cam0")}, p);
  EXPECT_THAT(known.open, testing::ElementsAre(true, false));
  EXPECT_THAT(known.directions,
              testing::ElementsAre("stiffness scale not determined; only ratios (mu)"));
}

/// Two moduli that nothing moves have no known ratio either, and a length is no stiffness.
TEST(ParameterCovariance, NoRatioIsToldWhereNoneIsKnown) {
  const auto none =
      parameter_covariance(seen(Eigen::MatrixXd::Zero(1, 2)), {stiffness("mu"), stiffness("kappa")},
                           Eigen::Vector2d(0.02, 0.3));
  EXPECT_THAT(none.directions,
              testing::UnorderedElementsAre("not determined by this capture: mu",
                                            "not determined by this capture: kappa"));
  Parameter reach = stiffness("stiffness_field.radius");
  reach.unit = "mm";
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(1, 2);
  J(0, 0) = 1e4;
  const auto length =
      parameter_covariance(seen(J), {stiffness("mu"), reach}, Eigen::Vector2d(0.02, 5.0));
  EXPECT_THAT(length.directions,
              testing::ElementsAre("not determined by this capture: stiffness_field.radius"));
}

/// Four depths of which the photos know two combinations: two directions are open, and both are the
/// same four names.
TEST(ParameterCovariance, WhatIsOpenIsSaidOnce) {
  Eigen::MatrixXd J(2, 4);
  J << 1e4, 1.3e4, 0.7e4, 0.9e4,  //
      0.8e4, -0.9e4, 1.2e4, -1.1e4;
  const auto known = parameter_covariance(seen(J), {level("a"), level("b"), level("c"), level("d")},
                                          VectorXd::Constant(4, 0.1));
  EXPECT_THAT(known.directions, testing::SizeIs(1));
  EXPECT_THAT(known.open, testing::ElementsAre(true, true, true, true));
}

TEST(ParameterCovariance, WhatAForceFixesIsNotOpen) {
  const VectorXd p = Eigen::Vector2d(0.02, 0.3);
  Eigen::MatrixXd J(2, 2);
  J << 1000.0 / p[0], -1000.0 / p[1], 30.0 / p[0], 0.0;
  const auto known = parameter_covariance(seen(J), {stiffness("mu"), stiffness("kappa")}, p);
  EXPECT_TRUE(known.directions.empty());
  EXPECT_THAT(known.open, testing::ElementsAre(false, false));
  EXPECT_NEAR(std::sqrt(known.determined(0, 0)) / p[0], 1.0 / 30.0, 1e-3);
}

/// Ten photos whose errors move together within a photo, five times as far as their white noise
/// would: the scatter from photo to photo tells, and widens the interval as far.
TEST(ParameterCovariance, ScatterFromPhotoToPhotoWidensIt) {
  std::mt19937 engine(7);
  std::normal_distribution<double> normal;
  const auto interval = [&](double common) {
    Evaluation seen;
    seen.columns = 1;
    ExampleEvaluation example;
    double sum = 0.0;
    for (int k = 0; k < 10; ++k) {
      PhotoEvaluation photo;
      photo.photo = k;
      photo.sums.JtJ = Eigen::MatrixXd::Constant(1, 1, 1e4);
      photo.sums.Jtr = VectorXd::Constant(1, 100.0 * common * normal(engine));
      sum += photo.sums.Jtr[0] / 10.0;
      example.photos.push_back(photo);
    }
    for (auto& photo : example.photos) photo.sums.Jtr.array() -= sum;  // at the optimum
    seen.examples.push_back(example);
    const VectorXd p = VectorXd::Constant(1, 0.2);
    return std::sqrt(parameter_covariance(seen, {level("a")}, p).determined(0, 0));
  };
  const double white = 1.0 / std::sqrt(10.0 * 1e4);
  double least = 1e9, most = 0.0, mean = 0.0;
  for (int i = 0; i < 50; ++i) {
    const double wide = interval(5.0) / white;
    least = std::min(least, wide), most = std::max(most, wide), mean += wide / 50.0;
    EXPECT_GE(interval(0.1), white);
  }
  EXPECT_NEAR(mean, 5.0 * 2.262 / 1.960, 0.8);  // Student's quantile for nine degrees
  EXPECT_GT(least, 2.0);
  EXPECT_LT(most, 12.0);
}

/// By the table of Student's quantiles: two photos that count alike leave one degree of freedom.
TEST(ParameterCovariance, FewPhotosWidenItByStudentsQuantile) {
  const std::vector<std::pair<int, double>> table{{2, 12.706}, {3, 4.303}, {4, 3.182}, {10, 2.262}};
  for (const auto& [count, student] : table) {
    ExampleEvaluation example;
    double scatter = 0.0;
    for (int k = 0; k < count; ++k) {
      PhotoEvaluation photo;
      photo.photo = k;
      photo.sums.JtJ = Eigen::MatrixXd::Constant(1, 1, 1e4);
      photo.sums.Jtr = VectorXd::Constant(1, 500.0 * (k - 0.5 * (count - 1)));  // at the optimum
      scatter += photo.sums.Jtr.squaredNorm() / 1e4 / (count - 1);
      example.photos.push_back(photo);
    }
    Evaluation seen;
    seen.columns = 1;
    seen.examples.push_back(example);
    const VectorXd p = VectorXd::Constant(1, 0.2);
    const double deviation =
        std::sqrt(parameter_covariance(seen, {level("a")}, p).determined(0, 0));
    EXPECT_NEAR(1.959964 * deviation / std::sqrt(scatter / (count * 1e4)), student, 1e-3) << count;
  }
}

/// A camera that was knocked before the last photo has taken on what moves together there: it is as
/// far off as the others scatter. A sensor's zero knows nothing of photos.
TEST(ParameterCovariance, WhatOnePhotoKnowsTakesTheScatterOfTheOthers) {
  std::mt19937 engine(7);
  std::normal_distribution<double> normal;
  constexpr double kCommon = 5.0;
  constexpr int kRepeats = 200;
  int missed = 0;
  double wide = 0.0;  // of b, in white standard errors
  for (int i = 0; i < kRepeats; ++i) {
    Evaluation seen;
    seen.columns = 3;
    ExampleEvaluation example;
    for (int k = 0; k < 10; ++k) {
      PhotoEvaluation photo;
      photo.photo = k;
      photo.sums.JtJ = Eigen::Vector3d(1e4, k == 9 ? 1e4 : 0.0, 0.0).asDiagonal();
      photo.sums.Jtr = Eigen::Vector3d(100.0 * kCommon * normal(engine), 0.0, 0.0);
      example.photos.push_back(photo);
    }
    double mean = 0.0;
    for (const auto& photo : example.photos) mean += photo.sums.Jtr[0] / 10.0;
    for (auto& photo : example.photos) photo.sums.Jtr[0] -= mean;  // at the optimum
    MeasuredEvaluation zero;
    zero.predicted = zero.r = Eigen::Vector3d::Zero();
    zero.J = Eigen::Matrix3d::Zero();
    zero.J(0, 2) = 100.0;
    example.measured.push_back(zero);
    seen.examples.push_back(example);
    const auto known =
        parameter_covariance(seen, {level("a"), level("b"), level("c")}, VectorXd::Zero(3));
    const double off =
        kCommon * normal(engine) / 100.0;  // of b, as the errors of that photo have it
    missed += std::abs(off) > 1.96 * std::sqrt(known.determined(1, 1));
    wide += 100.0 * std::sqrt(known.determined(1, 1)) / kRepeats;
    EXPECT_NEAR(std::sqrt(known.determined(2, 2)), 0.01, 1e-6);
  }
  EXPECT_NEAR(wide, kCommon * 2.262 / 1.960, 0.8);
  EXPECT_LT(missed, 0.05 * kRepeats + 3.0 * std::sqrt(0.05 * kRepeats));
}

/// All residuals of some pixels.
struct Residuals {
  Eigen::MatrixXd J = Eigen::MatrixXd::Random(60, 4);
  VectorXd r = VectorXd::Random(60);
  NormalEquations sums() const { return {J.transpose() * J, J.transpose() * r, r.squaredNorm()}; }
};

TEST(Condense, IsTheFactorizationOfAllResiduals) {
  const Residuals all;
  const Eigen::Vector4d scale(2.0, 0.1, 30.0, 1.0);
  const CondensedResidual few = condense(all.sums(), scale);
  Eigen::MatrixXd Jr(60, 5);
  Jr << all.J * scale.asDiagonal(), all.r;
  const Eigen::MatrixXd qr =
      Jr.householderQr().matrixQR().topRows(5).triangularView<Eigen::Upper>();
  EXPECT_NEAR(few.z.norm(), qr.col(4).head(4).norm(), 1e-9);
  EXPECT_NEAR(std::abs(few.rho), std::abs(qr(4, 4)), 1e-9);
  for (int i = 0; i < 5; ++i) {
    const VectorXd dx = VectorXd::Random(4);
    const double all_r2 = (all.J * scale.asDiagonal() * dx + all.r).squaredNorm();
    EXPECT_NEAR((few.R * dx + few.z).squaredNorm() + few.rho * few.rho, all_r2, 1e-9 * all_r2);
  }
}

/// Two parameters that do the same: their sum is fitted, their difference stays where it is.
TEST(Condense, SingularDirectionsCostNothingAndStayPut) {
  Residuals all;
  all.J.col(3) = all.J.col(1);
  const CondensedResidual few = condense(all.sums(), VectorXd::Ones(4));
  ASSERT_TRUE(few.R.allFinite());
  const Eigen::Vector4d difference(0.0, 1.0, 0.0, -1.0);
  EXPECT_LT((few.R * difference).norm(), 1e-6);
  const VectorXd dx = -few.R.completeOrthogonalDecomposition().solve(few.z);
  EXPECT_NEAR(dx.dot(difference), 0.0, 1e-6);
  EXPECT_NEAR((all.J.transpose() * (all.J * dx + all.r)).norm(), 0.0, 1e-6);
}

/// Least squares within bounds against all choices of who stays.
TEST(WithinBounds, MovesWhomTheBoundedStepMoves) {
  constexpr int n = 5;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int repeat = 0; repeat < 200; ++repeat) {
    // Nearly one direction: the unbounded step says little of the bounded one.
    Eigen::MatrixXd J(8, n);
    const VectorXd common = VectorXd::NullaryExpr(8, [&] { return normal(random); });
    for (int i = 0; i < n; ++i)
      J.col(i) = common + 0.3 * VectorXd::NullaryExpr(8, [&] { return normal(random); });
    const VectorXd r = VectorXd::NullaryExpr(8, [&] { return normal(random); });
    NormalEquations sums{J.transpose() * J, J.transpose() * r, r.squaredNorm()};
    Scaling scaling;
    VectorXd p = VectorXd::Zero(n);
    for (int i = 0; i < n; ++i)
      scaling.parameters.push_back({"p" + std::to_string(i), "", "", 0.0, i % 2 ? -1e9 : 0.0,
                                    i == 1 ? 0.0 : 1e9, 1.0 + i, false});
    double least = std::numeric_limits<double>::infinity();
    VectorXd best;
    for (int mask = 0; mask < 1 << n; ++mask) {  // who moves
      Eigen::MatrixXd some = J;
      for (int i = 0; i < n; ++i)
        if (!(mask >> i & 1)) some.col(i).setZero();
      const VectorXd step = -some.completeOrthogonalDecomposition().solve(r);
      bool within = true;
      for (int i = 0; i < n; ++i)
        within &= step[i] >= scaling.parameters[i].low - 1e-12 &&
                  step[i] <= scaling.parameters[i].high + 1e-12;
      if (within && (J * step + r).squaredNorm() < least)
        least = (J * step + r).squaredNorm(), best = step;
    }
    const VectorXd scale = scaling.dp_dx(p);
    const CondensedResidual condensed = condense(within_bounds(sums, scaling, p), scale);
    const VectorXd step = -scale.cwiseProduct(
        VectorXd(condensed.R.completeOrthogonalDecomposition().solve(condensed.z)));
    EXPECT_LT((step - best).norm(), 1e-6 * (1.0 + best.norm())) << repeat;
    EXPECT_NEAR(condensed.rho * condensed.rho, least, 1e-9 * (1.0 + least)) << repeat;
  }
}

}  // namespace
}  // namespace hookeye
