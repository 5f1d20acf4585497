"""Captures: from their folder, or from a dict with arrays in place of files."""

from __future__ import annotations

import os
import pathlib
from typing import Any, Dict, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _hookeye
from ._from_dict import write_capture
from ._named import Attributes, Named
from .errors import InputError
from .measured_field import MeasuredField, fields_of

PathLike = Union[str, "os.PathLike[str]"]
Shot = Tuple[str, str]

_hookeye.Camera.__getattr__ = Attributes.__getattr__


class Photo(Attributes):
    """A photo as it is compared: `values` (linear), `sigma` (noise), `valid` (pixels that count)."""

    def __init__(self, told: Dict[str, Any]) -> None:
        self.values: np.ndarray = told["values"]
        self.sigma: np.ndarray = told["sigma"]
        self.valid: np.ndarray = told["valid"]
        self.file: str = told["file"]


class Mesh(Attributes):
    """The body: `points` (n, 3), `elements` (m, 4 or 10), `boundary` (b, 3 or 6), `regions`."""

    def __init__(self, told: Dict[str, Any]) -> None:
        self.points: np.ndarray = told["points"]
        self.elements: np.ndarray = told["elements"]
        self.boundary: np.ndarray = told["boundary"]
        #: By name: nodes, area, centroid, normal.
        self.regions: Dict[str, Dict[str, Any]] = Named("region", told["regions"])


class Capture(Attributes):
    """A capture, checked. `path`: its folder or its yaml.

    options: numbers to decide by (hookeye.options()), as `--set` of the command line.
    """

    def __init__(self, path: PathLike, *, options: Optional[Mapping[str, float]] = None) -> None:
        #: Numbers to decide by that are not the standard ones.
        self.options: Dict[str, float] = dict(options or {})
        self._own = _hookeye.Capture(path, self.options)
        self._folder: Any = None  # of from_dict: lives as long as the capture

    @classmethod
    def from_dict(cls, told: Mapping[str, Any], photos: Optional[Mapping[Shot, Any]] = None, *,
                  masks: Optional[Mapping[Shot, Any]] = None, folder: Optional[PathLike] = None,
                  options: Optional[Mapping[str, float]] = None) -> "Capture":
        """The content of a capture.yaml, with arrays in place of files.

        `photos`: by (example, camera): height x width (x 3). float and uint16 are linear (1 or
        65535: full scale), uint8 follows the capture's `encoding` (sRGB, if not told). `masks`: the
        same way, true where pixels count. `body.volume`: (points, elements); `body.surface`:
        (points, triangles). In `measured`, `field`: {"points": (n, 3), "displacement": (n, 3)} or
        an array (n, 6); a row that is NaN is a point without a measurement.

        Files that the dict names are looked for in `folder`, or in the current directory. What is
        written goes into `folder`; where none is told, into one that goes with the capture, and
        the files that are named are taken there.
        """
        top, base, kept = write_capture(told, photos or {}, masks or {}, folder)
        try:
            out = cls(top, options=options)
        except InputError as error:
            if "no such file" not in error.right:
                raise
            looked = f"; it was looked for in {base}"
            raise InputError(str(error) + looked, error.file, error.line, error.column, error.wrong,
                             error.right + looked) from None
        out._folder = kept
        return out

    @property
    def file(self) -> pathlib.Path:
        return pathlib.Path(self._own.file)

    @property
    def title(self) -> str:
        return self._own.title

    @property
    def units(self) -> Dict[str, str]:
        """Names only: numbers are never converted."""
        return {"length": self._own.length, "force": self._own.force, "stress": self._own.stress}

    @property
    def cameras(self) -> Dict[str, _hookeye.Camera]:
        return Named("camera", {camera.name: camera for camera in self._own.cameras()})

    @property
    def examples(self) -> Dict[str, Dict[str, Any]]:
        """By name: use ("fit", "validate", "test") and the cameras of its photos."""
        return Named("load case", {one["name"]: one for one in self._own.examples()})

    @property
    def materials(self) -> List[Dict[str, Any]]:
        return self._own.materials()

    @property
    def photos(self) -> Dict[Shot, Photo]:
        """By (example, camera); without examples of `use: test`, which nothing may see."""
        return Named("photo of (load case, camera)",
                     {shot: Photo(told) for shot, told in self._own.photos().items()})

    @property
    def fields(self) -> Dict[Shot, MeasuredField]:
        """Measured fields by (example, file as the capture names it); without `use: test`."""
        return fields_of(self._own.fields())

    @property
    def mesh(self) -> Mesh:
        return Mesh(self._own.mesh())

    def model(self) -> "Model":
        """The base model at its starting values."""
        from .model import Model

        return Model(self)

    def __repr__(self) -> str:
        return f"<hookeye.Capture {self.file}: {', '.join(self.examples)}>"

    def _repr_html_(self) -> str:
        from .tables import Table

        rows = [{"load case": name, "use": one["use"], "photos": ", ".join(one["photos"])}
                for name, one in self.examples.items()]
        return f"<b>{self.title or self.file}</b>" + Table(
            rows, ["load case", "use", "photos"])._repr_html_()
