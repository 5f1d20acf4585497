"""What energies are functions of, for real and for complex arrays."""

from __future__ import annotations

from typing import Tuple

import numpy as np


def cofactor(F: np.ndarray) -> np.ndarray:
    """d det F / dF of (..., 3, 3), real or complex: det F times the inverse's transpose. Much quicker
    than numpy.linalg.inv, which asks LAPACK for every matrix."""
    f = [[F[..., i, j] for j in range(3)] for i in range(3)]
    out = np.empty_like(F)
    for i in range(3):
        for j in range(3):
            a, b, c, d = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
            out[..., i, j] = f[a][c] * f[b][d] - f[a][d] * f[b][c]
    return out


def determinant(F: np.ndarray) -> np.ndarray:
    """det of (..., 3, 3), real or complex."""
    f = [[F[..., i, j] for j in range(3)] for i in range(3)]
    return (f[0][0] * (f[1][1] * f[2][2] - f[1][2] * f[2][1])
            + f[0][1] * (f[1][2] * f[2][0] - f[1][0] * f[2][2])
            + f[0][2] * (f[1][0] * f[2][1] - f[1][1] * f[2][0]))


def invariants(F: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """I1bar, I2bar and J of deformation gradients (..., 3, 3), real or complex."""
    cof = cofactor(F)
    J = sum(F[..., 0, j] * cof[..., 0, j] for j in range(3))
    scale = J ** (-2 / 3)
    I1, I2 = (np.einsum("...ij,...ij->...", M, M) for M in (F, cof))
    return scale * I1, scale * scale * I2, J
