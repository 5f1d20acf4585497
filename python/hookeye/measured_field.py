"""Measured fields as arrays: what an image correlation gave, and what a model says of it."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Tuple

import numpy as np

from ._named import Attributes, Named


class MeasuredField(Attributes):
    """A field of displacements or strains that was measured, a row for each of its file (or of the
    arrays of Capture.from_dict). Rows that were dropped are NaN, and `valid` is False there.

    - `points` (n, 3): places on the body as it was given (of one with `start`: as that load case
      deforms it), in the capture's frame and unit of length.
    - `measured` (n, c): along `components`. Of displacements these are x, y, z of the field's own
      frame, in the capture's unit of length: `measured @ axes[:, :c].T` is in the capture's frame.
      Of strains exx, eyy and exy, fractions, along `axes` laid into the surface.
    - `sigma` (n, c): the told standard deviation of each.
    - `predicted` (n, c): by the model, and `residual` (n, c): predicted less measured, over `sigma`.
      Of Capture.fields they are None.
    - `alike` (n,): how many points err as this one does: it counts for 1 / alike.
    """

    def __init__(self, told: Dict[str, Any]) -> None:
        lines = np.concatenate([told["lines"], told["dropped_lines"]]).astype(int)
        rows = np.empty(len(lines), int)
        rows[np.argsort(lines, kind="stable")] = np.arange(len(lines))
        kept = rows[:len(told["lines"])]

        def spread(values: np.ndarray) -> np.ndarray:
            out = np.full((len(lines), *values.shape[1:]), np.nan)
            out[kept] = values
            return out

        self.example: str = told["example"]
        #: As the capture names it.
        self.file: str = told["file"]
        self.held_out: bool = told["held_out"]
        #: "displacements" or "strains"; of strains their `measure` ("green", ...), else "".
        self.holds: str = told["holds"]
        self.measure: str = told["measure"]
        #: The load case that it starts from; "": the body as it was given.
        self.start: str = told["from"]
        #: Of `measured`: the capture's unit of length, or "" (fractions).
        self.unit: str = told["unit"]
        self.components: Tuple[str, ...] = tuple(told["components"])
        #: Columns: directions in the capture's frame; (3, 3), of strains (3, 2).
        self.axes: np.ndarray = told["axes"]
        self.valid: np.ndarray = np.zeros(len(lines), bool)
        self.valid[kept] = True
        self.points: np.ndarray = spread(told["points"])
        self.measured: np.ndarray = spread(told["measured"])
        self.sigma: np.ndarray = spread(np.broadcast_to(told["sigma"], told["measured"].shape))
        self.alike: np.ndarray = spread(told["alike"])
        self.predicted: Optional[np.ndarray] = None
        self.residual: Optional[np.ndarray] = None
        if "predicted" in told:
            self.predicted = spread(told["predicted"])
            self.residual = (self.predicted - self.measured) / self.sigma

    def __len__(self) -> int:
        return len(self.points)

    def __repr__(self) -> str:
        left = ""
        if self.residual is not None:
            left = f", residual {np.sqrt(np.nanmean(self.residual ** 2)):.4g} of sigma (RMS)"
        return (f"<hookeye.MeasuredField {self.file} of {self.example}: {int(self.valid.sum())} points, "
                f"{self.holds} along {' '.join(self.components)}{left}>")


def fields_of(told: List[Dict[str, Any]]) -> Dict[Tuple[str, str], MeasuredField]:
    """By (example, file); a file that an example names again is "FILE#2"."""
    out: Dict[Tuple[str, str], MeasuredField] = Named("field of (load case, file)")
    for one in told:
        name, count = one["file"], 1
        while (one["example"], name) in out:
            count += 1
            name = f"{one['file']}#{count}"
        out[one["example"], name] = MeasuredField(one)
    return out
