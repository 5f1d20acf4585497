"""A load case solved."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

from . import _hookeye
from ._named import Attributes


class Equilibrium(Attributes):
    """The body under one load case, in the units of the capture.

    `u` (n, 3) at the nodes; `F` (m, points, 3, 3) where the energy is evaluated; `stress` (Cauchy)
    and `strain` (Green), (m, 3, 3), `von_mises`, `volume_ratio`, `energy_density` (m) in the middle
    of the elements.
    """

    def __init__(self, own: _hookeye.Equilibrium) -> None:
        self._own = own

    @property
    def example(self) -> str:
        return self._own.example

    @property
    def points(self) -> np.ndarray:
        """Nodes at rest."""
        return self._own.points

    @property
    def elements(self) -> np.ndarray:
        return self._own.elements

    @property
    def u(self) -> np.ndarray:
        return self._own.u

    @property
    def F(self) -> np.ndarray:
        return self._own.F

    @property
    def stress(self) -> np.ndarray:
        return self._own.stress

    @property
    def strain(self) -> np.ndarray:
        return self._own.strain

    @property
    def von_mises(self) -> np.ndarray:
        return self._own.von_mises

    @property
    def volume_ratio(self) -> np.ndarray:
        return self._own.volume_ratio

    @property
    def energy_density(self) -> np.ndarray:
        return self._own.energy_density

    @property
    def stable(self) -> bool:
        """False: the body would buckle."""
        return self._own.stable

    @property
    def iterations(self) -> int:
        return self._own.iterations

    def reaction(self, region: str) -> np.ndarray:
        """Force that the support exerts on the body through a region."""
        return self._own.reaction(region)

    def moment(self, region: str, about: Optional[Any] = None) -> np.ndarray:
        """Moment of the same, about a point (default: the region's centroid)."""
        return self._own.moment(region, about)

    def to_meshio(self) -> Any:
        """A meshio.Mesh at rest with the fields on it. Needs meshio."""
        meshio = _needed("meshio")
        quadratic = self.elements.shape[1] == 10
        return meshio.Mesh(
            self.points, [("tetra10" if quadratic else "tetra", self.elements)],
            point_data={"displacement": self.u},
            cell_data={"cauchy_stress": [self.stress.reshape(-1, 9)],
                       "von_mises": [self.von_mises], "volume_ratio": [self.volume_ratio]})

    def to_pyvista(self) -> Any:
        """A pyvista.UnstructuredGrid at rest with the fields on it. Needs pyvista."""
        pyvista = _needed("pyvista")
        corners = self.elements.shape[1]
        cells = np.hstack([np.full((len(self.elements), 1), corners), self.elements]).ravel()
        kind = 24 if corners == 10 else 10  # VTK_QUADRATIC_TETRA, VTK_TETRA
        grid = pyvista.UnstructuredGrid(cells, np.full(len(self.elements), kind), self.points)
        grid.point_data["displacement"] = self.u
        grid.cell_data["von_mises"] = self.von_mises
        grid.cell_data["cauchy_stress"] = self.stress.reshape(-1, 9)
        return grid

    def to_xarray(self) -> Any:
        """An xarray.Dataset of the fields. Needs xarray."""
        xarray = _needed("xarray")
        axes = ["x", "y", "z"]
        return xarray.Dataset(
            {"u": (("node", "axis"), self.u), "stress": (("element", "axis", "axis2"), self.stress),
             "von_mises": (("element",), self.von_mises)},
            coords={"axis": axes, "axis2": axes,
                    "points": (("node", "axis"), self.points)})

    def __repr__(self) -> str:
        largest = float(np.linalg.norm(self.u, axis=1).max())
        return f"<hookeye.Equilibrium {self.example}: {len(self.points)} nodes, max |u| {largest:.4g}>"


def _needed(name: str) -> Any:
    import importlib

    try:
        return importlib.import_module(name)
    except ImportError:
        raise ImportError(f"this needs {name}, which is not installed") from None


__all__ = ["Equilibrium"]
