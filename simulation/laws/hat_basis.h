// Piecewise linear functions of one variable and their integrals from 0: what the addends of the
// additive law are made of.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/additive.h"

namespace hookeye::laws {

using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostControlPoints, 1>;

/// Hat functions h_i over increasing control points: 1 at the own point, 0 at the others, linear
/// between, constant beyond the first and the last. Their integrals from 0,
///   h1_i(x) = int_0^x h_i,  h2_i(x) = int_0^x h1_i,
/// are C1 and C2, and h1_i(0) = h2_i(0) = h2_i'(0) = 0. A sum of values_i h2_i is a cubic C2 spline
/// with the second derivative values_i at the control points; every such spline that is flat and
/// zero at 0 is one.
class HatBasis {
 public:
  explicit HatBasis(const std::vector<double>& at);
  int size() const { return static_cast<int>(rows_); }

  /// Where x lies: breaks are the control points and 0; the expansion starts at the neighbour of x
  /// on the side of 0, so that nothing cancels near 0.
  struct Spot {
    int break_index, cell;
    double d;  ///< x minus the break
  };
  Spot find(double x) const;
  /// The same, but for the limit from below where x is a control point.
  Spot find_below(double x) const;

  /// A sum of basis functions, contracted once: per break or cell.
  struct Sum {
    Eigen::VectorXd m, c, s, v;  ///< function, its slope in the cell, first and second integral
  };
  Sum contract(const Eigen::VectorXd& values) const;
  static double value(const Sum& f, const Spot& x) {
    return f.m[x.break_index] + f.c[x.cell] * x.d;
  }
  static double first_integral(const Sum& f, const Spot& x) {
    return f.s[x.break_index] + x.d * (f.m[x.break_index] + 0.5 * x.d * f.c[x.cell]);
  }
  static double second_integral(const Sum& f, const Spot& x) {
    return f.v[x.break_index] +
           x.d * (f.s[x.break_index] + x.d * (0.5 * f.m[x.break_index] + x.d / 6.0 * f.c[x.cell]));
  }

  /// All basis functions at once: h_i, dh_i/dx, h1_i, h2_i.
  SmallVector hats(const Spot& x) const { return M_.col(x.break_index) + x.d * C_.col(x.cell); }
  SmallVector slopes(const Spot& x) const { return C_.col(x.cell); }
  SmallVector first_integrals(const Spot& x) const {
    return S_.col(x.break_index) + x.d * M_.col(x.break_index) + 0.5 * x.d * x.d * C_.col(x.cell);
  }
  SmallVector second_integrals(const Spot& x) const {
    return V_.col(x.break_index) + x.d * S_.col(x.break_index) +
           0.5 * x.d * x.d * M_.col(x.break_index) + x.d * x.d * x.d / 6.0 * C_.col(x.cell);
  }

 private:
  Eigen::Index rows_;
  std::vector<double> breaks_;  ///< control points and 0, increasing
  int zero_ = 0;                ///< index of 0 among them
  /// Rows: basis functions. M, S, V: at the breaks (h, h1, h2). C: slope in the cell; cell c lies
  /// below break c, the last one above all.
  Eigen::MatrixXd M_, C_, S_, V_;
};

}  // namespace hookeye::laws
