#include <limits>
#include <vector>

#include "python/effect_term.h"
#include "simulation/laws/invariants.h"

namespace hookeye {

namespace py = pybind11;

namespace {

/// Deformation gradients that a law may be asked for: those that turn the body inside out, which a
/// line search may try, have energy without end and are asked as the identity.
class SoundGradients {
 public:
  explicit SoundGradients(const Matrix9Xd& given) : F(given) {
    for (Eigen::Index k = 0; k < F.cols(); ++k) {
      const Matrix3d here = F.col(k).reshaped(3, 3);
      if (here.determinant() > 0) continue;
      inverted.push_back(k);
      F.col(k) = Matrix3d::Identity().reshaped();
    }
  }
  Matrix9Xd F;
  std::vector<Eigen::Index> inverted;
};

/// n x 3 x 3.
DoubleArray gradients_array(const Matrix9Xd& F) {
  DoubleArray out({F.cols(), Eigen::Index{3}, Eigen::Index{3}});
  for (Eigen::Index k = 0; k < F.cols(); ++k)
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(out.mutable_data() + 9 * k) =
        F.col(k).reshaped(3, 3);
  return out;
}

void set_infinite(const SoundGradients& sound, Eigen::RowVectorXd& psi) {
  for (const Eigen::Index k : sound.inverted) psi[k] = std::numeric_limits<double>::infinity();
}

class OfGradient final : public BatchTerm {
 public:
  OfGradient(std::shared_ptr<const Bridge> bridge, Eigen::VectorXd values)
      : bridge_(std::move(bridge)), values_(std::move(values)) {}
  std::string name() const override { return "python"; }

  Eigen::RowVectorXd psi_of(const Matrix9Xd& F) const override {
    const SoundGradients sound(F);
    Eigen::RowVectorXd psi = answer("psi", sound.F, 1);
    set_infinite(sound, psi);
    return psi;
  }
  Matrix9Xd P_of(const Matrix9Xd& F) const override { return answer("P", SoundGradients(F).F, 9); }
  Eigen::MatrixXd dP_dF_of(const Matrix9Xd& F) const override {
    return answer("dP_dF", SoundGradients(F).F, 81);
  }

 private:
  /// `rows` numbers a point, those of a point together.
  Eigen::MatrixXd answer(const char* method, const Matrix9Xd& F, Eigen::Index rows) const {
    return bridge_->ask([&](py::handle effect) -> Eigen::MatrixXd {
      const py::object told = effect.attr(method)(gradients_array(F), array_of(values_));
      return Bridge::rows_of(told, F.cols(), rows).transpose();
    });
  }
  std::shared_ptr<const Bridge> bridge_;
  Eigen::VectorXd values_;
};

/// Rows of what an energy of I1bar, I2bar and J answers.
enum Row { kW, kW1, kW2, kWJ, kW11, kW22, kWJJ, kW12, kW1J, kW2J };

class OfInvariants final : public BatchTerm {
 public:
  OfInvariants(std::shared_ptr<const Bridge> bridge, Eigen::VectorXd values)
      : bridge_(std::move(bridge)), values_(std::move(values)) {}
  std::string name() const override { return "python"; }

  Eigen::RowVectorXd psi_of(const Matrix9Xd& F) const override {
    const SoundGradients sound(F);
    Eigen::RowVectorXd psi = answer(sound.F, 0).row(kW);
    set_infinite(sound, psi);
    return psi;
  }

  Matrix9Xd P_of(const Matrix9Xd& given) const override {
    const Matrix9Xd F = SoundGradients(given).F;
    const Bridge::Rows W = answer(F, 1);
    Matrix9Xd out(9, F.cols());
    for (Eigen::Index k = 0; k < F.cols(); ++k) {
      const laws::Deformation d(F.col(k).reshaped(3, 3));
      Matrix3d P = W(kW1, k) * laws::i1bar(d).gradient(d) + W(kWJ, k) * d.cof;
      if (W(kW2, k) != 0) P += W(kW2, k) * laws::i2bar(d).gradient(d);
      out.col(k) = P.reshaped();
    }
    return out;
  }

  Eigen::MatrixXd dP_dF_of(const Matrix9Xd& given) const override {
    const Matrix9Xd F = SoundGradients(given).F;
    const Bridge::Rows W = answer(F, 2);
    Eigen::MatrixXd out(81, F.cols());
    for (Eigen::Index k = 0; k < F.cols(); ++k)
      out.col(k) = tangent(F.col(k).reshaped(3, 3), W.col(k)).reshaped();
    return out;
  }

 private:
  static Matrix9d tangent(const Matrix3d& F, const Eigen::Matrix<double, 10, 1>& W) {
    const laws::Deformation d(F);
    const laws::Vector9d c = laws::vec(d.cof);
    const laws::Isochoric a = laws::i1bar(d);
    Matrix9d D = (W[kWJJ] * c) * c.transpose();
    double d2J = W[kWJ] + a.add_hessian(d, W[kW1], W[kW11], D);
    laws::add_d2I1(W[kW1] * a.scale, D);
    const auto add_mixed = [&D](double w, const laws::Vector9d& one, const laws::Vector9d& other) {
      if (w == 0) return;
      D.noalias() += (w * one) * other.transpose();
      D.noalias() += (w * other) * one.transpose();
    };
    if (W[kW1J] != 0) add_mixed(W[kW1J], laws::vec(a.gradient(d)), c);
    if (W[kW2] != 0 || W[kW22] != 0 || W[kW12] != 0 || W[kW2J] != 0) {
      const laws::Isochoric b = laws::i2bar(d);
      d2J += b.add_hessian(d, W[kW2], W[kW22], D);
      laws::add_d2I2(W[kW2] * b.scale, F, D);
      add_mixed(W[kW12], laws::vec(a.gradient(d)), laws::vec(b.gradient(d)));
      add_mixed(W[kW2J], laws::vec(b.gradient(d)), c);
    }
    laws::add_d2J(d2J, F, D);
    return D;
  }

  /// 1, 4 or 10 rows: the energy with its derivatives up to `order`.
  Bridge::Rows answer(const Matrix9Xd& F, int order) const {
    Bridge::Rows invariants(3, F.cols());
    for (Eigen::Index k = 0; k < F.cols(); ++k) {
      const laws::Deformation d(F.col(k).reshaped(3, 3));
      invariants.col(k) << laws::i1bar(d).value(), laws::i2bar(d).value(), d.J;
    }
    constexpr Eigen::Index kRows[] = {1, 4, 10};
    return bridge_->ask([&](py::handle effect) {
      const DoubleArray told({Eigen::Index{3}, F.cols()}, invariants.data());
      return Bridge::rows_of(effect.attr("of_invariants")(told, array_of(values_), order),
                             kRows[order], F.cols());
    });
  }
  std::shared_ptr<const Bridge> bridge_;
  Eigen::VectorXd values_;
};

}  // namespace

std::shared_ptr<const EnergyTerm> python_energy(std::shared_ptr<const Bridge> bridge, EnergyOf of,
                                                Eigen::VectorXd values) {
  if (of == EnergyOf::invariants)
    return std::make_shared<OfInvariants>(std::move(bridge), std::move(values));
  return std::make_shared<OfGradient>(std::move(bridge), std::move(values));
}

}  // namespace hookeye
