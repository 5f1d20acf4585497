"""Draws from the posterior by a sampler of one's own, and compares its intervals with Laplace's.

Model.evaluate() is all that a sampler needs: r2 is the sum of squares over noise, and JTJ the curvature
that Laplace's approximation stands on. Here Metropolis steps in the logarithm of positive parameters,
with Laplace's covariance. The third interval is the run's own: it counts that neighbouring residuals
go together, which neither of the others does, and is wider.

python3 own_sampler.py CAPTURE [DRAWS]
"""

import sys

import numpy as np

import hookeye as he

run = he.fit(he.Capture(sys.argv[1]))
model = run.model()
draws = int(sys.argv[2]) if len(sys.argv) > 2 else 2000
positive = np.array([model[name].positive for name in model.names])
low, high = model.bounds


def to_p(x):
    return np.where(positive, np.exp(x), x)


def log_posterior(x):
    """Flat in x, within the bounds."""
    p = to_p(x)
    if ((p < low) | (p > high)).any():
        return -np.inf
    model.p = p
    try:
        return -0.5 * model.evaluate(jac=False).r2
    except he.NumericalError:  # no equilibrium there
        return -np.inf


looked = model.evaluate()
x = np.where(positive, np.log(model.p), model.p)
slope = np.where(positive, model.p, 1.0)  # dp / dx
laplace = np.linalg.inv(looked.JTJ * np.outer(slope, slope))
step = np.linalg.cholesky(laplace) * 2.4 / np.sqrt(len(x))  # Gelman, Roberts and Gilks 1996

random = np.random.default_rng(1)
here, mode = log_posterior(x), x
chain, accepted = [], 0
for _ in range(draws):
    there = x + step @ random.standard_normal(len(x))
    now = log_posterior(there)
    if np.log(random.random()) < now - here:
        x, here, accepted = there, now, accepted + 1
    chain.append(x)
chain = to_p(np.array(chain[draws // 10:]))

print(f"accepted: {100 * accepted / draws:.0f} %")
for i, name in enumerate(model.names):
    half = 1.96 * np.sqrt(laplace[i, i])
    ends = {"Laplace": to_p(mode + half * np.outer([-1, 1], np.eye(len(mode))[i]))[:, i],
            "sampled": np.quantile(chain[:, i], [0.025, 0.975]),
            "the run": run.model()[name].interval}
    for what, (least, most) in ends.items():
        print(f"{name} {what}: {least:.6g} to {most:.6g} {model[name].unit}")
