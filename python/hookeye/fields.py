"""A field on the body, to be drawn."""

from __future__ import annotations

from typing import Any, Dict, Optional

import numpy as np

from ._named import Attributes
from .equilibrium import _needed
from .errors import InputError


class Field(Attributes):
    """`values` on the nodes (displacement, n x 3) or the elements (von_mises) of the body at rest.
    `magnitude`: one number a node or element."""

    def __init__(self, name: str, example: str, unit: str, points: np.ndarray,
                 elements: np.ndarray, boundary: np.ndarray, values: np.ndarray) -> None:
        self.name, self.example, self.unit = name, example, unit
        self.points, self.elements, self.boundary = points, elements, boundary
        self.values = values

    @classmethod
    def of_run(cls, states: Dict[str, Any], name: str, example: str,
               units: Dict[str, str]) -> "Field":
        kinds = {"displacement": units["length"], "von_mises": units["stress"]}
        if name not in kinds:
            raise _bad(f"there is no field '{name}'", f"one of {', '.join(kinds)}")
        of = states[name]
        if not of:
            raise _bad("no example of the run has a state", "fit it first")
        if example and example not in of:
            raise _bad(f"there is no example '{example}'", f"one of {', '.join(of)}")
        chosen = example or max(of, key=lambda e: float(_magnitude(of[e]).max()))
        return cls(name, chosen, kinds[name], states["points"], states["elements"],
                   states["boundary"], of[chosen])

    @property
    def magnitude(self) -> np.ndarray:
        return _magnitude(self.values)

    def plot(self, axes: Optional[Any] = None, cmap: str = "viridis") -> Any:
        """The surface at rest in colours of the magnitude. Needs matplotlib; returns the axes."""
        pyplot = _needed("matplotlib.pyplot")
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        if axes is None:
            axes = pyplot.figure().add_subplot(projection="3d")
        corners = self.boundary[:, :3]
        at_nodes = len(self.magnitude) == len(self.points)
        colours = self.magnitude[corners].mean(axis=1) if at_nodes else self._of_faces()
        surface = Poly3DCollection(self.points[corners], cmap=cmap)
        surface.set_array(colours)
        axes.add_collection3d(surface)
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        middle, half = (low + high) / 2, (high - low).max() / 2
        axes.set_xlim(middle[0] - half, middle[0] + half)
        axes.set_ylim(middle[1] - half, middle[1] + half)
        axes.set_zlim(middle[2] - half, middle[2] + half)
        axes.set_title(f"{self.name} in {self.example}")
        axes.figure.colorbar(surface, ax=axes, label=self.unit)
        return axes

    def _of_faces(self) -> np.ndarray:
        """Of the element that each boundary face belongs to."""
        owner = {}
        for e, nodes in enumerate(self.elements[:, :4]):
            for left_out in range(4):
                owner[frozenset(np.delete(nodes, left_out).tolist())] = e
        faces = [owner[frozenset(face.tolist())] for face in self.boundary[:, :3]]
        return self.magnitude[faces]

    def __repr__(self) -> str:
        return (f"<hookeye.Field {self.name} in {self.example}: up to "
                f"{float(self.magnitude.max()):.4g} {self.unit}>")


def _magnitude(values: np.ndarray) -> np.ndarray:
    return np.linalg.norm(values, axis=1) if values.ndim == 2 else values


def _bad(wrong: str, right: str) -> InputError:
    return InputError(f"{wrong}\n  {right}", wrong=wrong, right=right)
