"""Draws from the posterior by a sampler of one's own, and compares its intervals with Laplace's.

Model.evaluate() is all that a sampler needs: r2 is the sum of squares over noise. Residuals of
neighbouring pixels go together, so that photos hold fewer numbers than pixels. How many times fewer, the
run's covariance tells against that of JTJ, which counts every pixel: r2 is divided by it. What then
differs are tails and bends, which Laplace's approximation has not.

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
    """Of what is sampled: logarithms of positive parameters."""
    return np.where(positive, np.exp(x), x)


looked = model.evaluate()
mode = np.where(positive, np.log(model.p), model.p)
slope = np.where(positive, model.p, 1.0)  # dp / dx
laplace = np.asarray(run.covariance) / np.outer(slope, slope)
every_pixel = np.linalg.inv(looked.JTJ * np.outer(slope, slope))
together = np.trace(np.linalg.solve(every_pixel, laplace)) / len(mode)


def log_posterior(x):
    """Flat in x, within the bounds."""
    p = to_p(x)
    if ((p < low) | (p > high)).any():
        return -np.inf
    model.p = p
    try:
        return -0.5 * model.evaluate(jac=False).r2 / together
    except he.NumericalError:  # no equilibrium there
        return -np.inf


step = np.linalg.cholesky(laplace) * 2.4 / np.sqrt(len(mode))  # Gelman, Roberts and Gilks 1996
random = np.random.default_rng(1)
x, here = mode, log_posterior(mode)
chain, accepted = [], 0
for _ in range(draws):
    there = x + step @ random.standard_normal(len(x))
    now = log_posterior(there)
    if np.log(random.random()) < now - here:
        x, here, accepted = there, now, accepted + 1
    chain.append(x)
chain = to_p(np.array(chain[draws // 10:]))

print(f"accepted: {100 * accepted / draws:.0f} %; a pixel counts as 1/{together:.0f}")
for i, name in enumerate(model.names):
    side = 1.96 * np.outer([-1, 1], np.eye(len(mode))[i])
    ends = {"every pixel": to_p(mode + side * np.sqrt(every_pixel[i, i]))[:, i],
            "Laplace": to_p(mode + side * np.sqrt(laplace[i, i]))[:, i],
            "sampled": np.quantile(chain[:, i], [0.025, 0.975])}
    for what, (least, most) in ends.items():
        print(f"{name} {what}: {least:.6g} to {most:.6g} {model[name].unit}")
