// orthotropic: an addend for other laws, not a material by itself
//
// W = 1/2 sum_ij c_ij E_ii E_jj + 2 sum_{i<j} g_ij E_ij^2, E the Green strain in a frame of three
// axes: the general orthotropic energy that is quadratic in E, told by its stiffnesses. With the
// frame's first axis along fibres, c11, c12 = c13 and g12 = g13 are transverse isotropy's. Like
// stvk, for large rotations and moderate strains.
#include "simulation/laws/invariants.h"

namespace hookeye {
namespace {

class Orthotropic final : public EnergyTerm {
 public:
  explicit Orthotropic(const OrthotropicValues& values) : v_(values) {}
  std::string name() const override { return "orthotropic"; }
  std::vector<Parameter> parameters(const Units& units) const override {
    std::vector<Parameter> all;
    for (int k = 0; k < 9; ++k)
      all.push_back(laws::coefficient(kNames[k], "stiffness", units.stress(), stiffness(k), 1.0));
    return all;
  }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& x) const override {
    return orthotropic(orthotropic_values(x, v_.frame));
  }
  double psi(const Matrix3d& F) const override {
    const Matrix3d E = green(F * v_.frame);
    return 0.5 * (E.cwiseProduct(second_piola(E))).sum();
  }
  Matrix3d P(const Matrix3d& F) const override {
    const Matrix3d G = F * v_.frame;
    return G * second_piola(green(G)) * v_.frame.transpose();
  }
  Matrix9d dP_dF(const Matrix3d& F) const override {
    // dP_a = sum_b S_ab dF_b + F_a-terms: C_aabb = c_ab, C_abab = g_ab; f_a the columns of F.
    const Matrix3d G = F * v_.frame, S = second_piola(green(G));
    Matrix9d D;
    for (int b = 0; b < 3; ++b)
      for (int a = 0; a < 3; ++a) {
        Matrix3d block = v_.c(a, b) * G.col(a) * G.col(b).transpose();
        for (int i = 0; i < 3; ++i)
          if (a == b && i != a) block += v_.g(a, i) * G.col(i) * G.col(i).transpose();
        if (a != b) block += v_.g(a, b) * G.col(b) * G.col(a).transpose();
        block.diagonal().array() += S(a, b);
        D.block<3, 3>(3 * a, 3 * b) = block;
      }
    return stiffness_from_frame(D, v_.frame);
  }
  Matrix3d dP_dtheta(const Matrix3d& F, int k) const override {
    return Orthotropic(orthotropic_values(Eigen::VectorXd::Unit(9, k), v_.frame)).P(F);
  }

 private:
  static constexpr const char* kNames[] = {"c11", "c22", "c33", "c12", "c13",
                                           "c23", "g12", "g13", "g23"};
  double stiffness(int k) const {
    const int i = k < 3 ? k : k % 3 == 2 ? 1 : 0, j = k < 3 ? k : k % 3 == 0 ? 1 : 2;
    return k < 6 ? v_.c(i, j) : v_.g(i, j);
  }
  static Matrix3d green(const Matrix3d& F) {
    return 0.5 * (F.transpose() * F - Matrix3d::Identity());
  }
  Matrix3d second_piola(const Matrix3d& E) const {
    Matrix3d S = 2.0 * v_.g.cwiseProduct(E);
    S.diagonal() = v_.c * E.diagonal();
    return S;
  }
  OrthotropicValues v_;
};

}  // namespace

OrthotropicValues orthotropic_values(const Eigen::VectorXd& x, const Matrix3d& frame) {
  OrthotropicValues v;
  v.c << x[0], x[3], x[4], x[3], x[1], x[5], x[4], x[5], x[2];
  v.g << 0, x[6], x[7], x[6], 0, x[8], x[7], x[8], 0;
  v.frame = frame;
  return v;
}

std::shared_ptr<const EnergyTerm> orthotropic(const OrthotropicValues& values) {
  return std::make_shared<Orthotropic>(values);
}

}  // namespace hookeye
