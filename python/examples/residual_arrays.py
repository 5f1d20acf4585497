"""Residuals as arrays: where they are more than noise, and whether neighbours go together.

python3 residual_arrays.py CAPTURE [FILE.npz]
"""

import sys

import numpy as np

import hookeye as he

run = he.fit(he.Capture(sys.argv[1]))
residuals = run.residuals()  # model less photo over noise by (example, camera); NaN: not compared


def correlation(r, shift):
    """Of pixels that lie `shift` pixels apart in a row."""
    a, b = r[:, :-shift].ravel(), r[:, shift:].ravel()
    both = np.isfinite(a) & np.isfinite(b)
    return float(np.corrcoef(a[both], b[both])[0, 1])


def blocks(r, side=16):
    """Root mean square in squares of `side` pixels: noise alone leaves 1 everywhere."""
    rows, columns = (n // side for n in r.shape)
    tiles = r[:rows * side, :columns * side].reshape(rows, side, columns, side)
    counted = np.isfinite(tiles).sum(axis=(1, 3))
    squares = np.nansum(tiles**2, axis=(1, 3))
    return np.sqrt(squares / np.where(counted > side, counted, np.nan))


for (example, camera), r in residuals.items():
    seen = r[np.isfinite(r)]
    worst = np.unravel_index(np.nanargmax(blocks(r)), blocks(r).shape)
    print(f"{example}, {camera}: chi {np.sqrt(np.mean(seen**2)):.3f}, {seen.size} pixels, "
          f"{100 * np.mean(np.abs(seen) > 3):.2f} % beyond 3, "
          f"neighbours {correlation(r, 1):+.2f}, largest in block {worst[0]}, {worst[1]}: "
          f"{np.nanmax(blocks(r)):.2f}")

np.savez_compressed(sys.argv[2] if len(sys.argv) > 2 else "residuals.npz",
                    **{f"{example}_{camera}": r for (example, camera), r in residuals.items()})
