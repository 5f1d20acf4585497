"""Fits a capture, prints the moduli with their intervals, and draws residuals and displacement.

python3 fit_and_plot.py CAPTURE [PICTURE.png]
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import hookeye as he

capture = he.Capture(sys.argv[1])
run = he.fit(capture, on_step=lambda now: print(f"{now.stage} {now.done}/{now.of}: {now.chi:.3f}"))
print(run.parameters)
print(run)  # what `hookeye fit` says

draws = run.samples(1000)  # of the Laplace approximation
print("mu:", float(draws["mu"].mean()), "+-", float(draws["mu"].std()))

residuals = run.residuals()
figure = plt.figure(figsize=(4 * len(residuals) + 5, 4))
for i, ((example, camera), r) in enumerate(residuals.items()):
    axes = figure.add_subplot(1, len(residuals) + 1, i + 1)
    shown = axes.imshow(r, cmap="RdBu_r", vmin=-8, vmax=8)
    axes.set_title(f"{example}, {camera}")
figure.colorbar(shown, label="residual over noise")
run.field("displacement").plot(figure.add_subplot(1, len(residuals) + 1, len(residuals) + 1,
                                                  projection="3d"))
figure.savefig(sys.argv[2] if len(sys.argv) > 2 else "fit.png", dpi=100)
