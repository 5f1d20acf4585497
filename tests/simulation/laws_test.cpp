// Every law against finite differences, against automatic differentiation of an independently
// written energy, and against closed forms.
#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>

#include "simulation/blocks.h"
#include "simulation/energy_term.h"
#include "support/derivative.h"

namespace hookeye {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

using Law = std::shared_ptr<const EnergyTerm>;
template <class T>
using M3 = Eigen::Matrix<T, 3, 3>;

/// A dual number over complex ones: its derivatives' imaginary parts, after a step of i h, are the
/// second derivatives, without a difference (complex step).
using Step = ceres::Jet<std::complex<double>, 9>;
Step operator+(const Step& a, double b) { return a + Step(b); }
Step operator-(const Step& a, double b) { return a - Step(b); }
Step operator*(const Step& a, double b) { return a * Step(b); }
Step operator*(double a, const Step& b) { return Step(a) * b; }
Step operator/(const Step& a, double b) { return a * Step(1.0 / b); }
bool operator>(const Step& a, const Step& b) { return a.a.real() > b.a.real(); }
bool operator<(const Step& a, const Step& b) { return b > a; }

template <class T>
T determinant(const M3<T>& F) {
  return F.row(0).dot(F.row(1).cross(F.row(2)));
}
template <class T>
T volumetric(T J, double kappa) {
  return kappa / 2 * (J - 1.0) * (J - 1.0);
}

// Energies written from the manual, templated for automatic differentiation.
struct NeoEnergy {
  template <class T>
  static T psi(const M3<T>& F, const VectorXd& p) {
    using std::pow;
    const T J = determinant<T>(F);
    return p[0] / 2 * (pow(J, -2.0 / 3) * (F.transpose() * F).trace() - 3.0) + volumetric(J, p[1]);
  }
};
struct TiedEnergy {
  template <class T>
  static T psi(const M3<T>& F, const VectorXd& p) {
    return NeoEnergy::psi<T>(F, Eigen::Vector2d(p[0], 12 * p[0]));
  }
};
struct StVkEnergy {
  template <class T>
  static T psi(const M3<T>& F, const VectorXd& p) {
    const M3<T> E = (F.transpose() * F - M3<T>::Identity()) * T(0.5);
    return p[0] / 2 * E.trace() * E.trace() + p[1] * (E * E).trace();
  }
};
struct MooneyEnergy {
  template <class T>
  static T psi(const M3<T>& F, const VectorXd& p) {
    using std::pow;
    const T J = determinant<T>(F);
    const M3<T> C = F.transpose() * F;
    const T I2 = (C.trace() * C.trace() - (C * C).trace()) / 2.0;
    return p[0] * (pow(J, -2.0 / 3) * C.trace() - 3.0) + p[1] * (pow(J, -4.0 / 3) * I2 - 3.0) +
           volumetric(J, p[2]);
  }
};
struct YeohEnergy {
  template <class T>
  static T psi(const M3<T>& F, const VectorXd& p) {
    using std::pow;
    const T J = determinant<T>(F);
    const T i = pow(J, -2.0 / 3) * (F.transpose() * F).trace() - 3.0;
    return p[0] * i + p[1] * i * i + p[2] * i * i * i + volumetric(J, p[3]);
  }
};
/// Principal stretches by the roots of the characteristic polynomial: where all three differ.
struct OgdenEnergy {
  template <class T>
  static T psi(const M3<T>& F, const VectorXd& p) {
    using std::acos;
    using std::cos;
    using std::pow;
    using std::sqrt;
    const M3<T> C = F.transpose() * F;
    const T mean = C.trace() / 3.0;
    M3<T> off = C;
    for (int i = 0; i < 3; ++i) off(i, i) -= mean;
    const T size = sqrt((off * off).trace() / 6.0);
    const T angle = acos(determinant<T>(off) / (size * size * size) / 2.0) / 3.0;
    const double third = 2.0 / 3.0 * static_cast<double>(EIGEN_PI);
    const T J = determinant<T>(F);
    T W = volumetric(J, p[p.size() - 1]);
    const Eigen::Index terms = (p.size() - 1) / 2;  // mu of all, then alpha of all
    for (Eigen::Index k = 0; k < terms; ++k)
      for (int i = 0; i < 3; ++i) {
        const T squared = mean + size * cos(angle + i * third) * 2.0;
        W += p[k] / p[terms + k] * (pow(squared * pow(J, -2.0 / 3), 0.5 * p[terms + k]) - 1.0);
      }
    return W;
  }
};
struct FibreEnergy {
  template <class T>
  static T psi(const M3<T>& F, const VectorXd& p) {
    using std::pow;
    const T J = determinant<T>(F);
    const Vector3d a = p.segment<3>(1).normalized();
    const Eigen::Matrix<T, 3, 1> Fa = F * a.cast<T>();
    const T i = pow(J, -2.0 / 3) * Fa.squaredNorm() - 1.0;
    return p[0] / 2 * i * i;
  }
};

struct FungEnergy {
  template <class T>
  static T psi(const M3<T>& F, const VectorXd& p) {
    using std::exp;
    const M3<T> E = (F.transpose() * F - M3<T>::Identity()) * T(0.5);
    const VectorXd b = p.segment<9>(1);
    const T Q = b[0] * E(0, 0) * E(0, 0) + b[1] * E(1, 1) * E(1, 1) + b[2] * E(2, 2) * E(2, 2) +
                2 * b[3] * E(0, 0) * E(1, 1) + 2 * b[4] * E(1, 1) * E(2, 2) +
                2 * b[5] * E(0, 0) * E(2, 2) + 2 * b[6] * E(0, 1) * E(0, 1) +
                2 * b[7] * E(1, 2) * E(1, 2) + 2 * b[8] * E(0, 2) * E(0, 2);
    return p[0] / 2 * (exp(Q) - 1.0) + volumetric(determinant<T>(F), p[10]);
  }
};
Law some_fung() {
  Eigen::Matrix<double, 9, 1> b;
  b << 1.2, 0.8, 0.9, 0.3, 0.2, 0.25, 0.5, 0.4, 0.6;
  return fung(0.05, b, 0.6);
}

/// As in the manual of holzapfel.cpp: angles in degrees in the plane 1-2 of the rest axes.
struct HolzapfelEnergy {
  static constexpr double toe = 0.05;
  template <class T>
  static T psi(const M3<T>& F, const VectorXd& p) {
    using std::exp;
    using std::pow;
    const T J = determinant<T>(F), scale = pow(J, -2.0 / 3);
    const T i1 = scale * (F.transpose() * F).trace() - 3.0;
    T W = p[0] / 2 * i1 + volumetric(J, p[4]);
    for (int k = 5; k < p.size(); ++k) {
      const double angle = p[k] * EIGEN_PI / 180;
      const Eigen::Matrix<T, 3, 1> Fa = F * Vector3d(std::cos(angle), std::sin(angle), 0).cast<T>();
      const T E = p[3] * i1 + (1 - 3 * p[3]) * (scale * Fa.squaredNorm() - 1.0), t = E / toe;
      T u(0.0);
      if (E > T(toe)) u = E * E - toe * toe / 6;
      if (E > T(0.0) && E < T(toe)) u = toe * toe * (4.0 / 3 * t * t * t - t * t * t * t / 2.0);
      W += p[1] / (2 * p[2]) * (exp(p[2] * u) - 1.0);
    }
    return W;
  }
};
Law some_holzapfel() {
  HolzapfelValues v;
  v.mu = 0.05, v.k1 = 0.08, v.k2 = 0.7, v.kappa = 0.6, v.dispersion = 0.1;
  v.toe = HolzapfelEnergy::toe;
  v.angles = {35, -50};
  return holzapfel(v);
}

VectorXd values_of(const Law& law) {
  const auto parameters = law->parameters(Units{"mm", "N"});
  VectorXd v(static_cast<Eigen::Index>(parameters.size()));
  for (size_t i = 0; i < parameters.size(); ++i)
    v[static_cast<Eigen::Index>(i)] = parameters[i].value;
  return v;
}

std::vector<std::pair<std::string, Law>> all_laws() {
  return {{"neo-hookean", neo_hookean(0.05, 0.6)},
          {"neo-hookean tied", neo_hookean_tied(0.05, 12)},
          {"neo-hookean stiff", neo_hookean(0.05, 5.0)},
          {"stvk", stvk(0.3, 0.05)},
          {"mooney-rivlin", mooney_rivlin(0.02, 0.013, 0.6)},
          {"yeoh", yeoh(0.03, -0.002, 0.0007, 0.6)},
          {"ogden", ogden({0.03, -0.01}, {1.3, -2.7}, 0.6)},
          {"ogden three", ogden({0.03, 0.001, -0.01}, {1.3, 5.0, -2.0}, 0.6)},
          {"fung", some_fung()},
          {"holzapfel", some_holzapfel()},
          {"fibre", fibre(0.08, Vector3d(1, 2, -0.5))}};
}

std::vector<std::pair<std::string, Matrix3d>> deformations() {
  std::vector<std::pair<std::string, Matrix3d>> all;
  const Matrix3d turn = Eigen::AngleAxisd(1.1, Vector3d(1, -2, 0.5).normalized()).matrix();
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Matrix3d F = Matrix3d::Identity() + 0.35 * test::noise(9, seed).reshaped(3, 3);
    if (F.determinant() < 0.1) F = Matrix3d::Identity() + 0.2 * (F - Matrix3d::Identity());
    all.emplace_back("random " + std::to_string(seed), turn * F);
  }
  // Near and at equal stretches, where spectral formulas break.
  all.emplace_back("two equal", turn * Vector3d(1.2, 1.2, 0.8).asDiagonal() * turn.transpose());
  all.emplace_back("nearly equal", Matrix3d(Vector3d(1.2, 1.2 + 1e-9, 0.8).asDiagonal()) * turn);
  all.emplace_back("all equal", 1.1 * turn);
  all.emplace_back("strong compression", turn * Vector3d(0.4, 1.3, 1.5).asDiagonal());
  return all;
}

TEST(Laws, StressIsDerivativeOfEnergy) {
  for (const auto& [name, law] : all_laws())
    for (const auto& [what, F] : deformations()) {
      if (what == "all equal" && name == "fibre") continue;  // no stress: I4bar = 1
      const Matrix3d direction = test::noise(9, 77).reshaped(3, 3);
      const auto f = [&, &law = law, &F = F](double h) {
        return VectorXd::Constant(1, law->psi(F + h * direction));
      };
      const double analytic = law->P(F).cwiseProduct(direction).sum();
      test::expect_derivative(f, VectorXd::Constant(1, analytic), 1e-3, 1e-6, name + ", " + what);
    }
}

TEST(Laws, StiffnessIsDerivativeOfStressAndSymmetric) {
  for (const auto& [name, law] : all_laws())
    for (const auto& [what, F] : deformations()) {
      const Matrix9d D = law->dP_dF(F);
      EXPECT_LE((D - D.transpose()).norm(), 1e-13 * D.norm()) << name << ", " << what;
      // There the fibres begin to pull: continuous (law_curves_test.cpp), but differences are not
      // of fourth order.
      if (what == "all equal" && name == "holzapfel") continue;
      for (int k = 0; k < 9; ++k) {
        Matrix3d direction = Matrix3d::Zero();
        direction(k % 3, k / 3) = 1;
        const auto f = [&, &law = law, &F = F](double h) {
          return VectorXd(law->P(F + h * direction).reshaped());
        };
        test::expect_derivative(f, D.col(k), 1e-4, 1e-7, name + ", " + what);
      }
    }
}

TEST(Laws, ParameterDerivative) {
  for (const auto& [name, law] : all_laws())
    for (const auto& [what, F] : deformations()) {
      if (what == "all equal" && name != "stvk" && name != "fung")
        continue;                         // isochoric stress vanishes there
      if (name == "holzapfel") continue;  // its own test, where all fibres are stretched
      const VectorXd p = values_of(law);
      for (int k = 0; k < p.size(); ++k) {
        const bool no_shear = what == "all equal" || what == "strong compression";
        if (name == "fung" && no_shear && k >= 7 && k <= 9) continue;
        const auto f = [&, &law = law, &F = F](double h) {
          VectorXd v = p;
          v[k] += h;
          return VectorXd(law->with(v)->P(F).reshaped());
        };
        test::expect_derivative(f, law->dP_dtheta(F, k).reshaped(), 1e-3 * std::abs(p[k]), 1e-6,
                                name + ", " + what + ", parameter " + std::to_string(k));
      }
    }
}

TEST(Laws, ParameterDerivativeOfStretchedFibres) {
  const Law law = some_holzapfel();
  const VectorXd p = values_of(law);
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Matrix3d F = Matrix3d(Vector3d(1.4, 1.35, 0.75).asDiagonal()) +
                       0.1 * test::noise(9, seed).reshaped(3, 3);
    for (int k = 0; k < p.size(); ++k) {
      const auto f = [&](double h) {
        VectorXd v = p;
        v[k] += h;
        return VectorXd(law->with(v)->P(F).reshaped());
      };
      test::expect_derivative(f, law->dP_dtheta(F, k).reshaped(), 1e-3 * std::abs(p[k]), 1e-6,
                              "parameter " + std::to_string(k));
    }
  }
}

/// psi, P and dP/dF by automatic differentiation of the energies above. `digits` is what the energy
/// itself, told another way, has.
template <class Energy>
void compare_with_jets(const Law& law, double digits = 1e-13, bool equal_stretches = true) {
  using Jet = ceres::Jet<double, 9>;
  const VectorXd p = values_of(law);
  for (const auto& [what, F] : deformations()) {
    if (!equal_stretches && what.find("equal") != std::string::npos) continue;
    M3<Jet> x;
    for (int k = 0; k < 9; ++k) x(k % 3, k / 3) = Jet(F(k % 3, k / 3), k);
    const Jet y = Energy::template psi<Jet>(x, p);
    const Matrix9d D = law->dP_dF(F);
    const double scale = D.norm();
    EXPECT_NEAR(law->psi(F), y.a, digits * scale) << law->name() << ", " << what;
    EXPECT_LE((law->P(F).reshaped() - y.v).norm(), digits * scale) << law->name() << ", " << what;
    for (int m = 0; m < 9; ++m) {
      constexpr double h = 1e-30;
      M3<Step> z;
      for (int k = 0; k < 9; ++k) z(k % 3, k / 3) = Step({F(k % 3, k / 3), k == m ? h : 0.0}, k);
      const Eigen::VectorXcd by_F = Energy::template psi<Step>(z, p).v;
      EXPECT_LE((D.col(m) - by_F.imag() / h).norm(), 10.0 * digits * scale)
          << law->name() << ", " << what << ", column " << m;
    }
  }
}

TEST(Laws, AgreeWithAutomaticDifferentiation) {
  compare_with_jets<NeoEnergy>(neo_hookean(0.05, 0.6));
  compare_with_jets<TiedEnergy>(neo_hookean_tied(0.05, 12));
  compare_with_jets<StVkEnergy>(stvk(0.3, 0.05));
  compare_with_jets<MooneyEnergy>(mooney_rivlin(0.02, 0.013, 0.6));
  compare_with_jets<YeohEnergy>(yeoh(0.03, -0.002, 0.0007, 0.6));
  compare_with_jets<OgdenEnergy>(ogden({0.03, -0.01}, {1.3, -2.7}, 0.6), 1e-11, false);
  compare_with_jets<OgdenEnergy>(ogden({0.03, 0.001, -0.01}, {1.3, 5.0, -2.0}, 0.6), 1e-11, false);
  compare_with_jets<FungEnergy>(some_fung());
  compare_with_jets<HolzapfelEnergy>(some_holzapfel());
  compare_with_jets<FibreEnergy>(fibre(0.08, Vector3d(1, 2, -0.5)));
}

TEST(Laws, OgdenWithOneTermOfTwoIsNeoHooke) {
  // mu/2 (I1bar - 3) = mu/alpha (sum lbar^alpha - 3) at alpha = 2.
  const Law a = ogden({0.05}, {2.0}, 0.6), b = neo_hookean(0.05, 0.6);
  // and alpha = -2 with c01 of Mooney-Rivlin: I2bar = sum lbar^-2.
  const Law c = ogden({0.04, -0.026}, {2.0, -2.0}, 0.6), d = mooney_rivlin(0.02, 0.013, 0.6);
  for (const auto& [what, F] : deformations()) {
    EXPECT_NEAR(a->psi(F), b->psi(F), 1e-13) << what;
    EXPECT_LE((a->P(F) - b->P(F)).norm(), 1e-13) << what;
    EXPECT_LE((a->dP_dF(F) - b->dP_dF(F)).norm(), 1e-12 * b->dP_dF(F).norm()) << what;
    EXPECT_LE((c->P(F) - d->P(F)).norm(), 1e-13) << what;
    EXPECT_LE((c->dP_dF(F) - d->dP_dF(F)).norm(), 1e-12 * d->dP_dF(F).norm()) << what;
  }
}

TEST(Laws, RestIsStressFreeAndSmallStrainModuliAreRight) {
  const Matrix3d I = Matrix3d::Identity();
  struct Expected {
    Law law;
    double mu, kappa;
  };
  const std::vector<Expected> all = {{neo_hookean(0.05, 0.6), 0.05, 0.6},
                                     {stvk(0.3, 0.05), 0.05, 0.3 + 0.1 / 3},
                                     {mooney_rivlin(0.02, 0.013, 0.6), 0.066, 0.6},
                                     {yeoh(0.03, -0.002, 0.0007, 0.6), 0.06, 0.6},
                                     {ogden({0.03, -0.01}, {1.3, -2.7}, 0.6), 0.033, 0.6},
                                     {some_holzapfel(), 0.05, 0.6}};
  for (const auto& [law, mu, kappa] : all) {
    EXPECT_LE(law->P(I).norm(), 1e-15) << law->name();
    const Matrix9d D = law->dP_dF(I);
    EXPECT_NEAR(D(1, 1) + D(1, 3), 2 * mu, 1e-12) << law->name();  // E_21 + E_12
    EXPECT_NEAR(D(0, 0) + 2 * D(0, 4), 3 * kappa, 1e-12) << law->name();
  }
}

TEST(Laws, RotationOfTheBodyRotatesStress) {
  const Matrix3d Q = Eigen::AngleAxisd(0.9, Vector3d(3, 1, 2).normalized()).matrix();
  for (const auto& [name, law] : all_laws())
    for (const auto& [what, F] : deformations())
      EXPECT_LE((law->P(Q * F) - Q * law->P(F)).norm(), 1e-12 * law->P(F).norm() + 1e-14)
          << name << ", " << what;
}

TEST(Laws, InvertedIsNotAdmissible) {
  const Matrix3d F = Vector3d(-0.1, 1, 1).asDiagonal();
  for (const auto& [name, law] : all_laws())
    if (name != "stvk") {
      EXPECT_TRUE(std::isinf(law->psi(F))) << name;
    }
}

}  // namespace
}  // namespace hookeye
