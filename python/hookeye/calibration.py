"""Cameras from photos of a board: what `hookeye calibrate` does."""

from __future__ import annotations

import logging
import os
import pathlib
from html import escape
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _hookeye, tables
from ._named import Attributes, Named
from .progress import OnStep, listener
from .tables import Table, table

PathLike = Union[str, "os.PathLike[str]"]
Photos = Union[PathLike, Sequence[PathLike]]
_log = logging.getLogger("hookeye")


class Calibration(Attributes):
    """Cameras, how well they are known, and what each photo had to do with it."""

    def __init__(self, own: Any) -> None:
        self._own = own
        #: As calibration.json has it (docs/calibrate.md).
        self.told: Dict[str, Any] = own.told()
        self.cameras: Dict[str, _hookeye.Camera] = Named(
            "camera", {c.name: c for c in own.cameras()})
        #: Root mean square of what is left of the used corners [px].
        self.rms_px: Dict[str, float] = {c["name"]: c["rms_px"] for c in self.told["cameras"]}
        self.board: Dict[str, Any] = self.told["board"]
        self.world: str = self.told["world"]
        self.unit: str = self.told["unit"]
        self.said: List[str] = own.said()
        #: What makes the cameras doubtful.
        self.warnings: List[str] = self.told["warnings"]

    @property
    def parameters(self) -> Any:
        """Every number of every camera with its standard error. `rotation_x`, `shift_x` and their like are
        a small turn [rad] and shift in the camera's axes, about the pose that was found."""
        rows = [{"camera": camera["name"], **one}
                for camera in self.told["cameras"] for one in camera["parameters"]]
        return table(rows, ["camera", "name", "value", "standard_error", "unit"])

    @property
    def photos(self) -> Any:
        """By photo: camera, instant, corners found and used, what is left of these [px], why not."""
        columns = ["file", "camera", "instant", "corners", "used", "rms_px", "why"]
        rows = [{key: one[key] for key in columns} for one in self.told["photos"]]
        return table(rows, columns)

    def corners(self, file: PathLike) -> Dict[str, np.ndarray]:
        """Of one photo (its path, or its name): `id`, `seen` (n, 2), `residual` (n, 2: the camera's
        picture of the corner less where it is seen) [px], and whether it was `used`."""
        wanted = os.fspath(file)
        for one in self.told["photos"]:
            if wanted in (one["file"], os.path.basename(one["file"])):
                rows = np.array(one.get("corners_seen", []), dtype=float).reshape(-1, 6)
                return {"id": rows[:, 0].astype(int), "seen": rows[:, 1:3].copy(),
                        "residual": rows[:, 3:5].copy(), "used": rows[:, 5] != 0}
        raise KeyError(wanted)

    @property
    def covariance(self) -> Any:
        """Of all numbers of all cameras ("left.fx"), the boards' poses allowed for; zeros where a
        number is given by the choice of the world."""
        matrix, names = self._own.covariance(), self.told["covariance"]["parameters"]
        pandas = tables.pandas_if_there()
        return matrix if pandas is None else pandas.DataFrame(matrix, index=names, columns=names)

    @property
    def yaml(self) -> str:
        """The text that a capture takes by `cameras: {from: cameras.yaml}`."""
        return self._own.yaml()

    @property
    def corner_maps(self) -> Dict[str, str]:
        """A picture (SVG) of all corners by camera, with what is left of each as an arrow."""
        return dict(zip(self.cameras, self._own.corner_maps()))

    def save(self, folder: PathLike) -> pathlib.Path:
        """Writes FOLDER/cameras.yaml, calibration.json and corners_NAME.svg, as the command does. A
        cameras.yaml that was written by hand is refused."""
        return pathlib.Path(self._own.save(folder))

    def _rows(self) -> List[Dict[str, Any]]:
        return [{"camera": name, "rms px": self.rms_px[name], "fx": c.K[0, 0], "fy": c.K[1, 1],
                 "cx": c.K[0, 2], "cy": c.K[1, 2]} for name, c in self.cameras.items()]

    def __repr__(self) -> str:
        rows = self._rows()
        return "\n".join([f"<hookeye.Calibration: {self.told['corners']} corners, "
                          f"{self.told['dropped']} dropped; the world is {self.world} [{self.unit}]>",
                          repr(Table(rows, list(rows[0])))])

    def _repr_html_(self) -> str:
        rows = self._rows()
        doubts = "".join(f"<li>{escape(one)}</li>" for one in self.warnings)
        return (Table(rows, list(rows[0]))._repr_html_() + (f"<ul>{doubts}</ul>" if doubts else "")
                + "".join(self.corner_maps.values()))


def _counts(given: Any, what: str) -> str:
    if given is None or isinstance(given, str):
        return given or ""
    if isinstance(given, Sequence) and len(given) == 2 and all(isinstance(n, int) for n in given):
        return f"{given[0]}x{given[1]}"
    raise TypeError(f"{what}: \"7x5\" or (7, 5) is expected, not {given!r}")


def _sources(given: Any) -> List[str]:
    if isinstance(given, (str, os.PathLike)):
        return [os.fspath(given)]
    return [os.fspath(one) for one in given]


def calibrate(photos: Union[Photos, Mapping[str, Photos]], board: str = "charuco", *,
              squares: Union[str, Tuple[int, int], None] = None, square: float = 0.0,
              marker: float = 0.0, dictionary: str = "",
              dots: Union[str, Tuple[int, int], None] = None, spacing: float = 0.0,
              diameter: float = 0.0, lens: int = 5, frame: PathLike = "", unit: str = "mm",
              on_step: Optional[OnStep] = None, cancel: Any = None) -> Calibration:
    """Cameras from photos of a board, all at once.

    photos: of one camera: a folder, a pattern, files; of several: {"left": ..., "right": ...}. Photos
    of one instant have the same last number in their names.
    board: "charuco 7x5 20 15": kind, squares, side of a square and of a marker; or the kind alone, and
    the rest by the arguments that the options of the command have. A ChArUco board's dictionary is
    found in the photos unless it is told.
    lens: 0, 4, 5 or 8 numbers; frame: a photo whose board is the world; unit: of the lengths.
    """
    named = photos if isinstance(photos, Mapping) else {"camera": photos}
    listed = [(str(name), _sources(given)) for name, given in named.items()]
    told = {"squares": _counts(squares, "squares"), "dots": _counts(dots, "dots"),
            "dictionary": dictionary, "square": square, "marker": marker, "spacing": spacing,
            "diameter": diameter}
    out = Calibration(_hookeye.calibrate(listed, board, told, lens, os.fspath(frame), unit,
                                         listener(on_step), cancel))
    for doubt in out.warnings:
        _log.warning("%s", doubt)
    return out
