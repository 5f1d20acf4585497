// Laws against curves known in closed form: uniaxial, equibiaxial, simple shear and volume.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>

#include "simulation/energy_term.h"

namespace hookeye {
namespace {

using Eigen::Vector3d;
using std::exp;
using std::pow;
using Law = std::shared_ptr<const EnergyTerm>;

constexpr double kKappa = 0.6;

/// Fibres at 25 degrees from axis 1, dispersed.
constexpr double kMu = 0.05, kK1 = 0.08, kK2 = 0.7, kSpread = 0.1, kToe = 0.01;
const double kCos = std::cos(25 * EIGEN_PI / 180), kSin = std::sin(25 * EIGEN_PI / 180);
Law fibres() {
  HolzapfelValues v;
  v.mu = kMu, v.k1 = kK1, v.k2 = kK2, v.kappa = kKappa, v.dispersion = kSpread, v.toe = kToe;
  v.angles = {25};
  return holzapfel(v);
}
/// dW/dE of the fibres beyond their toe.
double pull(double E) { return E <= 0 ? 0.0 : kK1 * E * exp(kK2 * (E * E - kToe * kToe / 6)); }

/// Fung's law in axes 1, 2, 3 without shear: P_ii = l_i S_ii.
constexpr double kC = 0.05;
Law skin() {
  Eigen::Matrix<double, 9, 1> b;
  b << 1.2, 0.8, 0.9, 0.3, 0.2, 0.25, 0.5, 0.4, 0.6;
  return fung(kC, b, kKappa);
}
/// Second Piola-Kirchhoff stresses along the axes for diagonal E.
Vector3d skin_stress(const Vector3d& E) {
  Matrix3d B;
  B << 1.2, 0.3, 0.25, 0.3, 0.8, 0.2, 0.25, 0.2, 0.9;
  return kC * exp(E.dot(B * E)) * (B * E);
}

struct Curve {
  Law law;
  std::function<double(double)> stress;
};
const std::vector<double> kStretches = {0.5, 0.7, 0.9, 1.05, 1.3, 1.7, 2.2};

double cauchy_difference(const Law& law, const Matrix3d& F) {
  const Matrix3d sigma = law->P(F) * F.transpose();
  return sigma(0, 0) - sigma(2, 2);
}

/// At constant volume s1 - s3 = 2 rubber(l) (dW/dI1 + second(l) dW/dI2) (Treloar).
using OfStretch = std::function<double(double)>;
std::vector<Curve> laws_of_invariants(const OfStretch& rubber, const OfStretch& I1,
                                      const OfStretch& second) {
  return {{neo_hookean(0.05, kKappa), [=](double l) { return 0.05 * rubber(l); }},
          {mooney_rivlin(0.02, 0.013, kKappa),
           [=](double l) { return 2 * rubber(l) * (0.02 + 0.013 * second(l)); }},
          {yeoh(0.03, -0.002, 0.0007, kKappa), [=](double l) {
             const double x = I1(l) - 3;
             return 2 * rubber(l) * (0.03 - 2 * 0.002 * x + 3 * 0.0007 * x * x);
           }}};
}

TEST(LawCurves, UniaxialAtConstantVolume) {
  // F = diag(l, l^-1/2, l^-1/2).
  const auto rubber = [](double l) { return l * l - 1 / l; };
  const auto I1 = [](double l) { return l * l + 2 / l; };
  std::vector<Curve> all = laws_of_invariants(rubber, I1, [](double l) { return 1 / l; });
  const std::vector<Curve> others = {
      {ogden({0.03, -0.01}, {1.3, -2.7}, kKappa),
       [](double l) {
         return 0.03 * (pow(l, 1.3) - pow(l, -0.65)) - 0.01 * (pow(l, -2.7) - pow(l, 1.35));
       }},
      {skin(),
       [](double l) {
         const Vector3d S = skin_stress(0.5 * Vector3d(l * l - 1, 1 / l - 1, 1 / l - 1));
         return l * l * S[0] - S[2] / l;
       }},
      {fibres(), [&](double l) {
         const double I4 = l * l * kCos * kCos + kSin * kSin / l;
         const double w = pull(kSpread * (I1(l) - 3) + (1 - 3 * kSpread) * (I4 - 1));
         return (kMu + 2 * kSpread * w) * rubber(l) +
                2 * (1 - 3 * kSpread) * w * l * l * kCos * kCos;
       }}};
  all.insert(all.end(), others.begin(), others.end());
  for (const Curve& curve : all)
    for (double l : kStretches) {
      const Matrix3d F = Vector3d(l, 1 / std::sqrt(l), 1 / std::sqrt(l)).asDiagonal();
      const double expected = curve.stress(l);
      EXPECT_NEAR(cauchy_difference(curve.law, F), expected, 1e-13 * std::max(1.0, expected))
          << curve.law->name() << " " << l;
    }
}

TEST(LawCurves, EquibiaxialAtConstantVolume) {
  // F = diag(l, l, l^-2).
  const auto rubber = [](double l) { return l * l - pow(l, -4); };
  const auto I1 = [](double l) { return 2 * l * l + pow(l, -4); };
  std::vector<Curve> all = laws_of_invariants(rubber, I1, [](double l) { return l * l; });
  const std::vector<Curve> others = {
      {ogden({0.03, -0.01}, {1.3, -2.7}, kKappa),
       [](double l) {
         return 0.03 * (pow(l, 1.3) - pow(l, -2.6)) - 0.01 * (pow(l, -2.7) - pow(l, 5.4));
       }},
      {skin(),
       [](double l) {
         const Vector3d S = skin_stress(0.5 * Vector3d(l * l - 1, l * l - 1, pow(l, -4) - 1));
         return l * l * S[0] - pow(l, -4) * S[2];
       }},
      // All directions of the plane are stretched by l.
      {fibres(), [&](double l) {
         const double w = pull(kSpread * (I1(l) - 3) + (1 - 3 * kSpread) * (l * l - 1));
         return (kMu + 2 * kSpread * w) * rubber(l) +
                2 * (1 - 3 * kSpread) * w * l * l * kCos * kCos;
       }}};
  all.insert(all.end(), others.begin(), others.end());
  for (const Curve& curve : all)
    for (double l : {0.8, 0.9, 1.05, 1.3, 1.6}) {
      const Matrix3d F = Vector3d(l, l, 1 / (l * l)).asDiagonal();
      const double expected = curve.stress(l);
      EXPECT_NEAR(cauchy_difference(curve.law, F), expected, 1e-13 * std::max(1.0, expected))
          << curve.law->name() << " " << l;
    }
}

TEST(LawCurves, SimpleShear) {
  // J = 1, I1bar = I2bar = 3 + g^2: P_12 is the derivative of psi by the amount of shear g.
  const double b22 = 0.8, g12 = 0.5;  // of the nine coefficients, those that act here
  const std::vector<Curve> all = {
      {neo_hookean(0.05, kKappa), [](double g) { return 0.05 * g; }},
      {mooney_rivlin(0.02, 0.013, kKappa), [](double g) { return 2 * 0.033 * g; }},
      {yeoh(0.03, -0.002, 0.0007, kKappa),
       [](double g) { return 2 * g * (0.03 - 2 * 0.002 * g * g + 3 * 0.0007 * pow(g, 4)); }},
      {ogden({0.03}, {1.3}, kKappa),
       [](double g) {
         // Principal stretches l, 1, 1/l with g = l - 1/l.
         const double l = 0.5 * (g + std::sqrt(g * g + 4));
         return 0.03 * (pow(l, 1.3) - pow(l, -1.3)) / l / (1 + 1 / (l * l));
       }},
      {skin(),
       [=](double g) {
         // E12 = g/2, E22 = g^2/2, else 0.
         const double Q = b22 * pow(g, 4) / 4 + 2 * g12 * g * g / 4;
         return kC / 2 * exp(Q) * (b22 * g * g * g + g12 * g);
       }},
      {fibres(), [](double g) {
         const double along = kCos + g * kSin, I4 = along * along + kSin * kSin;
         const double w = pull(kSpread * g * g + (1 - 3 * kSpread) * (I4 - 1));
         return kMu * g + w * (2 * kSpread * g + 2 * (1 - 3 * kSpread) * along * kSin);
       }}};
  for (const Curve& curve : all)
    for (double g : {-0.6, -0.2, 0.1, 0.4, 0.9}) {
      Matrix3d F = Matrix3d::Identity();
      F(0, 1) = g;
      EXPECT_NEAR(curve.law->P(F)(0, 1), curve.stress(g), 1e-14) << curve.law->name() << " " << g;
    }
}

TEST(LawCurves, Volume) {
  // F = l 1: the isochoric part is silent; P = kappa (J - 1) l^2.
  for (const Law& law :
       {neo_hookean(0.05, kKappa), mooney_rivlin(0.02, 0.013, kKappa),
        yeoh(0.03, -0.002, 0.0007, kKappa), ogden({0.03, -0.01}, {1.3, -2.7}, kKappa), fibres()})
    for (double l : {0.7, 0.95, 1.02, 1.3}) {
      const Matrix3d expected = kKappa * (l * l * l - 1) * l * l * Matrix3d::Identity();
      EXPECT_LE((law->P(l * Matrix3d::Identity()) - expected).norm(), 1e-14)
          << law->name() << " " << l;
    }
  for (double l : {0.7, 0.95, 1.02, 1.3}) {
    const Vector3d S = skin_stress(Vector3d::Constant(0.5 * (l * l - 1)));
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(skin()->P(l * Matrix3d::Identity())(i, i),
                  l * S[i] + kKappa * (l * l * l - 1) * l * l, 1e-14);
  }
}

TEST(Holzapfel, FibresCarryTensionOnly) {
  // Shortened along all their directions they leave the matrix alone.
  HolzapfelValues v;
  v.mu = kMu, v.k1 = kK1, v.k2 = kK2, v.kappa = kKappa;
  v.angles = {20, -20};
  const Law law = holzapfel(v), matrix = neo_hookean(kMu, kKappa);
  const Matrix3d shorter = Vector3d(0.8, 1.0, 1.25).asDiagonal();
  EXPECT_EQ(law->P(shorter), matrix->P(shorter));
  const Matrix3d longer = Vector3d(1.25, 1.0, 0.8).asDiagonal();
  EXPECT_GT(law->P(longer)(0, 0), matrix->P(longer)(0, 0) + kK1 / 4);
  // Dispersed along all directions alike they make no direction special.
  v.dispersion = 1.0 / 3;
  v.angles = {20};
  const Law alike = holzapfel(v);
  const Matrix3d turn = Eigen::AngleAxisd(1.1, Vector3d(1, -2, 0.5).normalized()).matrix();
  EXPECT_NEAR(alike->psi(longer), alike->psi(longer * turn), 1e-15);
}

TEST(Holzapfel, StiffnessIsContinuousWhereFibresTakeUpLoad) {
  HolzapfelValues v;
  v.mu = kMu, v.k1 = 10.0, v.k2 = 5.0, v.kappa = kKappa, v.toe = 0.02;
  v.directions = {Vector3d::UnitX()};
  const Law law = holzapfel(v);
  const auto stiffness = [&](double E) {  // E = l^2 - 1 at J = 1
    const double l = std::sqrt(1 + E);
    return law->dP_dF(Vector3d(l, 1 / std::sqrt(l), 1 / std::sqrt(l)).asDiagonal());
  };
  for (double E : {0.0, 0.02}) {
    const double jump = (stiffness(E + 1e-9) - stiffness(E - 1e-9)).norm();
    EXPECT_LE(jump, 1e-6 * stiffness(0.02).norm()) << E;
  }
  EXPECT_GT(stiffness(0.02)(0, 0), 20 * stiffness(0.0)(0, 0));
}

}  // namespace
}  // namespace hookeye
