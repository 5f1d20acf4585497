// The addends of an additive model, ready to evaluate: Psi(e) with first and second derivatives by
// the strain components.
#pragma once

#include <array>
#include <optional>

#include "simulation/additive.h"
#include "simulation/laws/hat_basis.h"

namespace hookeye::laws {

constexpr int kMostComponents = 18;  ///< nine and nine fibres: all there are
using Strains = std::array<double, kMostComponents>;

/// Energy over the strain components.
struct StrainEnergy {
  double psi = 0.0;
  Strains d1{};
  std::array<Strains, kMostComponents> d2{};  ///< symmetric
};

/// On which side of its control points a strain lies: only the derivative of hats depends on it.
enum class Side { above, below };

class CompiledAddend {
 public:
  CompiledAddend(const Addend& addend, int offset);

  int first() const { return first_; }
  int second() const { return second_; }
  int offset() const { return offset_; }  ///< of its control values; -1: fixed
  int size() const { return a_.size() * (b_ ? b_->size() : 1); }

  double psi(const Strains& e) const;
  /// Adds psi, d1, d2.
  void add(const Strains& e, StrainEnergy& out) const;
  /// d(d1)/dvalue of every control value: rows; columns first and second component.
  void d1_basis(const Strains& e, Eigen::MatrixX2d& out) const;
  /// d2 on one side of cell edges: by aa, bb, ab; and the same by every control value (rows).
  Eigen::Vector3d hessian(const Strains& e, Side a, Side b) const;
  Eigen::MatrixX3d hessian_basis(const Strains& e, Side a, Side b) const;
  /// One component: energy, first, second derivative by every control value.
  Eigen::MatrixX3d curve_basis(double e) const;

 private:
  int first_, second_, offset_;
  bool even_;
  HatBasis a_;
  std::optional<HatBasis> b_;
  Eigen::VectorXd values_;
  HatBasis::Sum sum_;                               ///< one component
  Eigen::Map<const Eigen::MatrixXd> grid() const {  ///< m(j, i), two components
    return {values_.data(), b_->size(), a_.size()};
  }
};

/// All addends of a model; offsets skip the fixed ones.
std::vector<CompiledAddend> compile(const AdditiveModel& model);

}  // namespace hookeye::laws
