// The energy of the whole body: a sum of terms, each weighted over the elements, and swelling.
#pragma once

#include <memory>
#include <vector>

#include "meshing/tet_mesh.h"
#include "simulation/energy_term.h"

namespace hookeye {

/// psi(X, F) = sum_parts weight_e * g^3 * term.psi(F / g), g = swelling stretch of the element
/// (F = F_elastic * g I; multiplicative growth, Rodriguez, Hoger, McCulloch 1994).
struct EnergyModel {
  struct Part {
    std::shared_ptr<const EnergyTerm> term;
    VectorXd weight;  ///< one per element, or empty: 1 everywhere
    /// Material axes a1 a2 a3 of every element, column by column (9 x elements); empty: the term's
    /// own. psi(F) = term.psi(F A), A = (a1 a2 a3).
    Eigen::MatrixXd frames = {};

    Matrix3d frame(int e) const { return Matrix3d(frames.col(e).reshaped(3, 3)); }
    double psi(int e, const Matrix3d& F) const {
      return frames.size() ? term->psi(F * frame(e)) : term->psi(F);
    }
    Matrix3d P(int e, const Matrix3d& F) const {
      return frames.size() ? Matrix3d(term->P(F * frame(e)) * frame(e).transpose()) : term->P(F);
    }
    Matrix9d dP_dF(int e, const Matrix3d& F) const {
      return frames.size() ? stiffness_from_frame(term->dP_dF(F * frame(e)), frame(e))
                           : term->dP_dF(F);
    }
    Matrix3d dP_dtheta(int e, const Matrix3d& F, int k) const {
      return frames.size() ? Matrix3d(term->dP_dtheta(F * frame(e), k) * frame(e).transpose())
                           : term->dP_dtheta(F, k);
    }
    Eigen::Matrix<double, 9, Eigen::Dynamic> all_dP_dtheta(int e, const Matrix3d& F) const;
  };
  std::vector<Part> parts;
  VectorXd swelling;  ///< linear stretch g, one per element, or empty: 1 everywhere
};

}  // namespace hookeye
