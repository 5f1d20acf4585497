"""Drives the model by SciPy's least_squares in place of Hookeye's own fit.

Evaluation.z and rho are a residual vector of the right length and slope, R is its Jacobian: any
least-squares solver or sampler can use them. Here in the logarithm of the modulus.

python3 own_optimiser.py CAPTURE
"""

import sys

import numpy as np
from scipy.optimize import least_squares

import hookeye as he

model = he.Capture(sys.argv[1]).model()
positive = np.array([model[name].positive for name in model.names])
known = {}


def evaluated(x):
    """Both functions below are asked at the same places: one look serves them."""
    if tuple(x) not in known:
        model.p = np.where(positive, np.exp(x), x)
        known.clear()
        known[tuple(x)] = model.evaluate(jac=True)
    return known[tuple(x)]


def residual(x):
    return np.append(evaluated(x).z, evaluated(x).rho)


def jacobian(x):
    slope = np.where(positive, np.exp(x), 1.0)  # dp / dx
    return np.vstack([evaluated(x).R * slope, np.zeros(len(x))])


start = np.where(positive, np.log(model.p), model.p)
found = least_squares(residual, start, jac=jacobian, x_scale=0.1, xtol=1e-8, ftol=1e-10)
evaluated(found.x)
for name in model.names:
    print(name, model[name].value, model[name].unit)
print("chi", model.evaluate(jac=False).chi, "after", found.nfev, "evaluations")
