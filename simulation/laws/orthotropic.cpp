// orthotropic, anisotropic: addends for other laws, not materials by themselves
//
// W = 1/2 e.C e, e = (E11, E22, E33, 2 E23, 2 E13, 2 E12) the Green strain in Voigt's order: the
// general energy that is quadratic in E, told by its stiffnesses C = sum_k x_k B_k. Like stvk, for
// large rotations and moderate strains. Orthotropic: nine of them in a frame of three axes. With
// the frame's first axis along fibres, c11, c12 = c13 and g12 = g13 are transverse isotropy's.
#include <fmt/format.h>

#include "simulation/laws/invariants.h"

namespace hookeye {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
constexpr int kI[] = {0, 1, 2, 1, 0, 0}, kJ[] = {0, 1, 2, 2, 2, 1};  ///< Voigt's order

Matrix3d tensor_of_stress(const Vector6d& s) {
  Matrix3d S;
  for (int k = 0; k < 6; ++k) S(kI[k], kJ[k]) = S(kJ[k], kI[k]) = s[k];
  return S;
}

Vector6d voigt_strain(const Matrix3d& E) {
  Vector6d e;
  for (int k = 0; k < 6; ++k) e[k] = (k < 3 ? 1.0 : 2.0) * E(kI[k], kJ[k]);
  return e;
}

class QuadraticInStrain final : public EnergyTerm {
 public:
  struct Basis {
    std::string law;
    std::vector<std::string> names;
    std::vector<Stiffness6> B;
  };
  QuadraticInStrain(std::shared_ptr<const Basis> basis, const Eigen::VectorXd& x)
      : basis_(std::move(basis)), x_(x), C_(Stiffness6::Zero()) {
    for (int k = 0; k < x.size(); ++k) C_ += x[k] * basis_->B[k];
  }
  std::string name() const override { return basis_->law; }
  std::vector<Parameter> parameters(const Units& units) const override {
    std::vector<Parameter> all;
    for (int k = 0; k < x_.size(); ++k)
      all.push_back(laws::coefficient(basis_->names[k], "stiffness", units.stress(), x_[k], 1.0));
    return all;
  }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& x) const override {
    return std::make_shared<QuadraticInStrain>(basis_, x);
  }
  double psi(const Matrix3d& F) const override {
    const Vector6d e = strain(F);
    return 0.5 * e.dot(C_ * e);
  }
  Matrix3d P(const Matrix3d& F) const override { return F * tensor_of_stress(C_ * strain(F)); }
  Matrix9d dP_dF(const Matrix3d& F) const override {
    // dP = dF S + F dS, dS = C de, de = G dF
    Eigen::Matrix<double, 6, 9> G = Eigen::Matrix<double, 6, 9>::Zero();
    for (int k = 0; k < 6; ++k) {
      G.block<1, 3>(k, 3 * kJ[k]) = F.col(kI[k]).transpose();
      G.block<1, 3>(k, 3 * kI[k]) = F.col(kJ[k]).transpose();
    }
    const Matrix3d S = tensor_of_stress(C_ * strain(F));
    Matrix9d D = G.transpose() * C_ * G;
    for (int b = 0; b < 3; ++b)
      for (int a = 0; a < 3; ++a) D.block<3, 3>(3 * a, 3 * b).diagonal().array() += S(a, b);
    return D;
  }
  Matrix3d dP_dtheta(const Matrix3d& F, int k) const override {
    return F * tensor_of_stress(basis_->B[k] * strain(F));
  }

 private:
  static Vector6d strain(const Matrix3d& F) {
    return voigt_strain(0.5 * (F.transpose() * F - Matrix3d::Identity()));
  }
  std::shared_ptr<const Basis> basis_;
  Eigen::VectorXd x_;
  Stiffness6 C_;
};

}  // namespace

Stiffness6 stiffness_in_frame(const Stiffness6& C, const Matrix3d& A) {
  // e in rest axes of a strain told in the frame: E = A E' A^T
  Stiffness6 T;
  for (int k = 0; k < 6; ++k) {
    Matrix3d own = Matrix3d::Zero();
    own(kI[k], kJ[k]) += 0.5, own(kJ[k], kI[k]) += 0.5;
    T.col(k) = voigt_strain(A * own * A.transpose());
  }
  return T.transpose() * C * T;
}

Stiffness6 voigt_stiffness(const OrthotropicValues& v) {
  Stiffness6 C = Stiffness6::Zero();
  C.topLeftCorner<3, 3>() = v.c;
  for (int k = 3; k < 6; ++k) C(k, k) = v.g(kI[k], kJ[k]);
  return stiffness_in_frame(C, v.frame.transpose());
}

OrthotropicValues orthotropic_values(const Eigen::VectorXd& x, const Matrix3d& frame) {
  OrthotropicValues v;
  v.c << x[0], x[3], x[4], x[3], x[1], x[5], x[4], x[5], x[2];
  v.g << 0, x[6], x[7], x[6], 0, x[8], x[7], x[8], 0;
  v.frame = frame;
  return v;
}

std::shared_ptr<const EnergyTerm> orthotropic(const OrthotropicValues& v) {
  auto basis = std::make_shared<QuadraticInStrain::Basis>();
  basis->law = "orthotropic";
  basis->names = {"c11", "c22", "c33", "c12", "c13", "c23", "g12", "g13", "g23"};
  for (int k = 0; k < 9; ++k)
    basis->B.push_back(voigt_stiffness(orthotropic_values(Eigen::VectorXd::Unit(9, k), v.frame)));
  Eigen::VectorXd x(9);
  x << v.c.diagonal(), v.c(0, 1), v.c(0, 2), v.c(1, 2), v.g(0, 1), v.g(0, 2), v.g(1, 2);
  return std::make_shared<QuadraticInStrain>(std::move(basis), x);
}

std::shared_ptr<const EnergyTerm> anisotropic(const Stiffness6& C) {
  static const auto basis = [] {
    auto made = std::make_shared<QuadraticInStrain::Basis>();
    made->law = "anisotropic";
    for (int i = 0; i < 6; ++i)
      for (int j = i; j < 6; ++j) {
        made->names.push_back(fmt::format("C{}{}", i + 1, j + 1));
        made->B.push_back(Stiffness6::Zero());
        made->B.back()(i, j) = made->B.back()(j, i) = 1.0;
      }
    return made;
  }();
  Eigen::VectorXd x(21);
  int k = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j) x[k++] = C(i, j);
  return std::make_shared<QuadraticInStrain>(basis, x);
}

}  // namespace hookeye
