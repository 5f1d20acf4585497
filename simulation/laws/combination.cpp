// combination: an addend for other laws, not a material by itself
//
// W = sum_i k_i W_i(F). With k = (s, -s) beside W_2 itself: the share s of W_2 goes over into W_1.
// Not admissible where one of them is not, whatever its coefficient.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "simulation/laws/invariants.h"
#include "simulation/made_of.h"

namespace hookeye {
namespace {

class Combination final : public EnergyTerm {
 public:
  explicit Combination(std::vector<WeightedTerm> terms) : terms_(std::move(terms)) {}
  std::string name() const override { return "combination"; }
  const std::vector<WeightedTerm>& terms() const { return terms_; }
  std::vector<Parameter> parameters(const Units&) const override {
    std::vector<Parameter> all;
    for (size_t i = 0; i < terms_.size(); ++i)
      all.push_back(laws::coefficient(fmt::format("k{}", i + 1), "coefficient", "",
                                      terms_[i].coefficient, 1.0));
    return all;
  }
  std::shared_ptr<const EnergyTerm> with(const Eigen::VectorXd& x) const override {
    auto terms = terms_;
    for (size_t i = 0; i < terms.size(); ++i) terms[i].coefficient = x[static_cast<int>(i)];
    return combination(std::move(terms));
  }
  double psi(const Matrix3d& F) const override {
    double sum = 0.0;
    for (const auto& [k, term] : terms_) {
      const double own = term->psi(F);
      if (!std::isfinite(own)) return std::numeric_limits<double>::infinity();
      sum += k * own;
    }
    return sum;
  }
  Matrix3d P(const Matrix3d& F) const override {
    Matrix3d sum = Matrix3d::Zero();
    for (const auto& [k, term] : terms_) sum += k * term->P(F);
    return sum;
  }
  Matrix9d dP_dF(const Matrix3d& F) const override {
    Matrix9d sum = Matrix9d::Zero();
    for (const auto& [k, term] : terms_) sum += k * term->dP_dF(F);
    return sum;
  }
  Matrix3d dP_dtheta(const Matrix3d& F, int k) const override { return terms_[k].term->P(F); }

 private:
  std::vector<WeightedTerm> terms_;
};

}  // namespace

std::shared_ptr<const EnergyTerm> combination(std::vector<WeightedTerm> terms) {
  return std::make_shared<Combination>(std::move(terms));
}

const std::vector<WeightedTerm>* terms_of(const EnergyTerm& law) {
  const auto* own = dynamic_cast<const Combination*>(&law);
  return own ? &own->terms() : nullptr;
}

}  // namespace hookeye
