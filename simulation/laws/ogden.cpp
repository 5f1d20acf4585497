// ogden {mu: [...], alpha: [...], kappa}
//
// W = sum_i mu_i/alpha_i (sum_j lbar_j^alpha_i - 3) + kappa/2 (J - 1)^2 in the isochoric principal
// stretches lbar_j = J^(-1/3) l_j. The most flexible of the classical rubber laws: pairs of a
// modulus and an exponent, tension and compression shaped apart. Small-strain shear modulus
// sum mu_i alpha_i / 2, which must be positive. One term with alpha = 2 is neo-Hooke.
#include <Eigen/SVD>
#include <limits>

#include "simulation/laws/invariants.h"

namespace hookeye {
namespace {

using Eigen::Vector3d;

/// (x^e - y^e)/(x - y), accurate for all x, y > 0, equal ones included.
double power_difference(double x, double y, double e) {
  const double t = (x - y) / y;
  const double ratio = t == 0 ? e : std::expm1(e * std::log1p(t)) / t;
  return std::pow(y, e - 1) * ratio;
}

/// F = U diag(l) V^T with U, V both rotations or both reflections, as det F > 0.
struct Principal {
  explicit Principal(const Matrix3d& F) {
    const Eigen::JacobiSVD<Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    U = svd.matrixU();
    V = svd.matrixV();
    l = svd.singularValues();
    J = l.prod();
  }
  Matrix3d U, V;
  Vector3d l;
  double J;
};

class Ogden final : public EnergyTerm {
 public:
  Ogden(std::vector<double> mu, std::vector<double> alpha, double kappa)
      : mu_(std::move(mu)), alpha_(std::move(alpha)), kappa_(kappa) {}
  std::string name() const override { return "ogden"; }
  std::vector<Parameter> parameters(const Units& units) const override {
    std::vector<Parameter> all;
    double mu = 0, alpha = 0;
    for (double m : mu_) mu = std::max(mu, std::abs(m));
    for (double a : alpha_) alpha = std::max(alpha, std::abs(a));
    for (size_t i = 0; i < mu_.size(); ++i)
      all.push_back(laws::coefficient("mu" + std::to_string(i + 1), "Ogden modulus", units.stress(),
                                      mu_[i], mu));
    for (size_t i = 0; i < mu_.size(); ++i)
      all.push_back(laws::coefficient("alpha" + std::to_string(i + 1), "Ogden exponent", "",
                                      alpha_[i], alpha));
    all.push_back(laws::modulus("kappa", "bulk modulus", units.stress(), kappa_));
    return all;
  }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& v) const override {
    const auto n = mu_.size();
    return ogden({v.data(), v.data() + n}, {v.data() + n, v.data() + 2 * n},
                 v[static_cast<Eigen::Index>(2 * n)]);
  }

  double psi(const Matrix3d& F) const override {
    if (!(F.determinant() > 0)) return std::numeric_limits<double>::infinity();
    const Principal p(F);
    double W = 0.5 * kappa_ * (p.J - 1) * (p.J - 1);
    for (size_t i = 0; i < mu_.size(); ++i)
      W += mu_[i] / alpha_[i] * ((p.l / std::cbrt(p.J)).array().pow(alpha_[i]).sum() - 3);
    return W;
  }

  Matrix3d P(const Matrix3d& F) const override {
    const Principal p(F);
    Vector3d g = kappa_ * (p.J - 1) * p.J * p.l.cwiseInverse();
    for (size_t i = 0; i < mu_.size(); ++i) g += mu_[i] * isochoric_gradient(p, alpha_[i]);
    return p.U * g.asDiagonal() * p.V.transpose();
  }

  /// Ball 1984; Smith, de Goes, Kim, "Analytic eigensystems for isotropic distortion energies",
  /// 2019: in the principal frame the 3 stretches couple by the Hessian of W(l), each pair of
  /// axes has a stretch-like mode (g_i - g_j)/(l_i - l_j) and a rotation-like (g_i + g_j)/(l_i +
  /// l_j). The quotient is taken term by term in closed form, so equal stretches need no limit.
  Matrix9d dP_dF(const Matrix3d& F) const override {
    const Principal p(F);
    Vector3d g = kappa_ * (p.J - 1) * p.J * p.l.cwiseInverse();
    for (size_t i = 0; i < mu_.size(); ++i) g += mu_[i] * isochoric_gradient(p, alpha_[i]);
    const Matrix3d H = stretch_hessian(p);
    Matrix9d local = Matrix9d::Zero();  // by vec(U^T dF V)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) local(4 * i, 4 * j) = H(i, j);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const double stretch = pair_quotient(p, i, j), turn = (g[i] + g[j]) / (p.l[i] + p.l[j]);
      const int ij = i + 3 * j, ji = j + 3 * i;
      local(ij, ij) = local(ji, ji) = 0.5 * (stretch + turn);
      local(ij, ji) = local(ji, ij) = 0.5 * (stretch - turn);
    }
    Matrix9d Q;  // vec(U A V^T) = Q vec(A)
    for (int b = 0; b < 3; ++b)
      for (int a = 0; a < 3; ++a) Q.block<3, 3>(3 * a, 3 * b) = p.V(a, b) * p.U;
    return Q * local * Q.transpose();
  }

  Matrix3d dP_dtheta(const Matrix3d& F, int k) const override {
    const Principal p(F);
    const int n = static_cast<int>(mu_.size());
    Vector3d g;
    if (k < n) {
      g = isochoric_gradient(p, alpha_[k]);
    } else if (k < 2 * n) {
      // d/dalpha of lbar^(alpha-1): times log lbar.
      const double c = std::cbrt(p.J), alpha = alpha_[k - n];
      const Vector3d lbar = p.l / c;
      const Vector3d dpower = lbar.array().pow(alpha) * lbar.array().log();
      g = mu_[k - n] * (dpower.array() - dpower.sum() / 3.0).matrix().cwiseQuotient(p.l);
    } else {
      g = (p.J - 1) * p.J * p.l.cwiseInverse();
    }
    return p.U * g.asDiagonal() * p.V.transpose();
  }

 private:
  /// d/dl_j of (sum lbar^alpha - 3)/alpha = (lbar_j^alpha - mean lbar^alpha) / l_j.
  static Vector3d isochoric_gradient(const Principal& p, double alpha) {
    const Vector3d power = (p.l / std::cbrt(p.J)).array().pow(alpha);
    return (power.array() - power.sum() / 3.0).matrix().cwiseQuotient(p.l);
  }
  Matrix3d stretch_hessian(const Principal& p) const {
    const Vector3d r = p.l.cwiseInverse();
    // Volumetric: dJ = J/l_i; d2J = J/(l_i l_j) off the diagonal.
    Matrix3d H = (kappa_ * (p.J * p.J + (p.J - 1) * p.J)) * r * r.transpose();
    H.diagonal() -= (kappa_ * (p.J - 1) * p.J) * r.cwiseAbs2();
    for (size_t t = 0; t < mu_.size(); ++t) {
      const double alpha = alpha_[t];
      const Vector3d w = (p.l / std::cbrt(p.J)).array().pow(alpha);
      const double mean = w.sum() / 3.0;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          // d/dl_j of (w_i - mean)/l_i with dw_i = alpha w_i (delta_ij - 1/3)/l_j.
          double h = alpha * (w[i] * ((i == j) - 1.0 / 3.0) - (w[j] - mean) / 3.0);
          if (i == j) h -= w[i] - mean;
          H(i, j) += mu_[t] * h * r[i] * r[j];
        }
    }
    return H;
  }
  /// (g_i - g_j)/(l_i - l_j): powers by power_difference, (1/l_i - 1/l_j)/(l_i - l_j) = -1/(l_i
  /// l_j).
  double pair_quotient(const Principal& p, int i, int j) const {
    double inverse = kappa_ * (p.J - 1) * p.J, quotient = 0;
    for (size_t t = 0; t < mu_.size(); ++t) {
      const double alpha = alpha_[t], scale = std::pow(p.J, -alpha / 3.0);
      inverse -= mu_[t] * scale * p.l.array().pow(alpha).sum() / 3.0;
      quotient += mu_[t] * scale * power_difference(p.l[i], p.l[j], alpha - 1);
    }
    return quotient - inverse / (p.l[i] * p.l[j]);
  }

  std::vector<double> mu_, alpha_;
  double kappa_;
};

}  // namespace

std::shared_ptr<const EnergyTerm> ogden(const std::vector<double>& mu,
                                        const std::vector<double>& alpha, double kappa) {
  return std::make_shared<Ogden>(mu, alpha, kappa);
}

}  // namespace hookeye
