// Krylov solves with K_ff, preconditioned with the Cholesky factor of a tangent near it.
#pragma once

#include "simulation/sparse_factor.h"

namespace hookeye {

/// Solves K_ff x = b by conjugate gradients preconditioned with the factor; K symmetric. Returns
/// the number of iterations, or -1 where `max_iterations` did not reach |r| <= tolerance |b| in the
/// norm of K^-1 or K is indefinite.
int conjugate_gradients(const SparseMatrix& K, const TangentFactor& factor, const VectorXd& b,
                        double tolerance, int max_iterations, VectorXd& x);

/// Solves (H + W) X = B, nf x m: H symmetric positive definite and factored, W = -W^T. The
/// generalised conjugate gradients of Concus, Golub (1976) and Widlund (1978): short recurrences
/// that converge however large W is. Returns the number of iterations, a solve with all columns
/// each, or -1 where `max_iterations` did not reach |r| <= tolerance |B| in the norm of H^-1 in
/// every column.
int skew_gradients(const SparseMatrix& W, const TangentFactor& H, const MatrixXd& B,
                   double tolerance, int max_iterations, MatrixXd& X);

/// Solves K_ff x = b, K unsymmetric or indefinite, by GMRES preconditioned with the factor M from
/// the left: |M^-1 (b - K_ff x)| <= tolerance |M^-1 b|, residuals as motions. Returns the number of
/// iterations, or -1 where `max_iterations` did not reach that; x is the best then.
int gmres(const SparseMatrix& K, const TangentFactor& factor, const VectorXd& b, double tolerance,
          int max_iterations, VectorXd& x);

}  // namespace hookeye
