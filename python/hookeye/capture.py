"""Captures: from their folder, or from a dict with arrays in place of files."""

from __future__ import annotations

import json
import math
import os
import pathlib
import tempfile
from typing import Any, Dict, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _hookeye
from .errors import InputError

PathLike = Union[str, "os.PathLike[str]"]
Shot = Tuple[str, str]


def _bad(wrong: str, right: str) -> InputError:
    return InputError(f"{wrong}\n  {right}", wrong=wrong, right=right)


class Photo:
    """A photo as it is compared: `values` (linear), `sigma` (noise), `valid` (pixels that count)."""

    def __init__(self, told: Dict[str, Any]) -> None:
        self.values: np.ndarray = told["values"]
        self.sigma: np.ndarray = told["sigma"]
        self.valid: np.ndarray = told["valid"]
        self.file: str = told["file"]


class Mesh:
    """The body: `points` (n, 3), `elements` (m, 4 or 10), `boundary` (b, 3 or 6), `regions`."""

    def __init__(self, told: Dict[str, Any]) -> None:
        self.points: np.ndarray = told["points"]
        self.elements: np.ndarray = told["elements"]
        self.boundary: np.ndarray = told["boundary"]
        #: By name: nodes, area, centroid, normal.
        self.regions: Dict[str, Dict[str, Any]] = told["regions"]


class Capture:
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
        (points, triangles). The files are written into `folder`, else into one that goes with the
        capture.
        """
        kept = None
        if folder is None:
            kept = tempfile.TemporaryDirectory(prefix="hookeye-")
            folder = kept.name
        top = pathlib.Path(folder)
        top.mkdir(parents=True, exist_ok=True)
        if (top / "capture.yaml").exists():
            raise _bad(f"{top}: there is a capture already", "another folder")
        document = _plain(dict(told), "capture", top)
        _put_photos(document, photos or {}, masks or {}, top)
        text = json.dumps(document, indent=1, ensure_ascii=False)
        (top / "capture.yaml").write_text(text, encoding="utf-8")
        out = cls(top, options=options)
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
        return {camera.name: camera for camera in self._own.cameras()}

    @property
    def examples(self) -> Dict[str, Dict[str, Any]]:
        """By name: use ("fit", "validate", "test") and the cameras of its photos."""
        return {one["name"]: one for one in self._own.examples()}

    @property
    def materials(self) -> List[Dict[str, Any]]:
        return self._own.materials()

    @property
    def photos(self) -> Dict[Shot, Photo]:
        """By (example, camera); without examples of `use: test`, which nothing may see."""
        return {shot: Photo(told) for shot, told in self._own.photos().items()}

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


def _plain(value: Any, where: str, folder: pathlib.Path) -> Any:
    """What JSON can say of it; arrays of the body become files."""
    if isinstance(value, Mapping):
        out = {}
        for key, inner in value.items():
            if not isinstance(key, str):
                raise TypeError(f"{where}: keys are names, not {key!r}")
            at = f"{where}.{key}"
            if where == "capture.body" and key in ("volume", "surface") and not isinstance(
                    inner, (str, os.PathLike)):
                out[key] = _write_body(key, inner, folder)
            else:
                out[key] = _plain(inner, at, folder)
        return out
    if isinstance(value, np.ndarray):
        if value.dtype.kind not in "fiub":
            raise TypeError(f"{where}: real numbers are expected, not dtype {value.dtype}")
        return _plain(value.tolist(), where, folder)
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, (list, tuple)):
        return [_plain(inner, f"{where}[{i}]", folder) for i, inner in enumerate(value)]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, float) and not math.isfinite(value):
        raise _bad(f"{where}: {value} is not finite", "a number")
    if value is None or isinstance(value, (str, bool, int, float)):
        return value
    raise TypeError(f"{where}: {type(value).__name__} has no place in a capture")


def _write_body(key: str, given: Any, folder: pathlib.Path) -> str:
    if not isinstance(given, (tuple, list)) or len(given) != 2:
        right = "elements" if key == "volume" else "triangles"
        raise TypeError(f"capture.body.{key}: a file, or (points, {right})")
    points, cells = given
    if key == "volume":
        _hookeye.write_volume(folder / "volume.vtu", points, cells)
        return "volume.vtu"
    _hookeye.write_surface(folder / "surface.obj", points, cells)
    return "surface.obj"


def _expect_full_scale(array: Any, what: str) -> None:
    """Numbers of a camera that were made floats: no exposure is twice full scale."""
    values = np.asarray(array)
    if values.dtype.kind == "f" and values.size and np.nanmax(values) > 2.0:
        most = float(np.nanmax(values))
        by = 255 if most <= 255 else 65535
        raise _bad(f"{what}: floats up to {most:.4g}, where 1 is full scale",
                   f"divide them by {by}, or give the camera's uint8 or uint16")


def _put_photos(document: Dict[str, Any], photos: Mapping[Shot, Any], masks: Mapping[Shot, Any],
                folder: pathlib.Path) -> None:
    if photos or masks:
        (folder / "photos").mkdir(exist_ok=True)
    examples = document.get("examples") or {}
    for given, kind in ((photos, "photo"), (masks, "mask")):
        for shot, array in given.items():
            if not isinstance(shot, tuple) or len(shot) != 2:
                raise TypeError(f"{kind}s: keys are (example, camera), not {shot!r}")
            name, camera = shot
            if name not in examples:
                raise _bad(f"{kind}s: there is no example '{name}'",
                           f"one of {', '.join(examples)}")
            if examples[name] is None:
                examples[name] = {}
            all_photos = examples[name].setdefault("photos", {})
            told = all_photos.setdefault(camera, {})
            if isinstance(told, str):
                told = all_photos[camera] = {"file": told}
            what = f"{kind}s[{name!r}, {camera!r}]"
            stem = folder / "photos" / f"{name}_{camera}"
            if kind == "photo":
                _expect_full_scale(array, what)
                told["file"] = "photos/" + _hookeye.write_photo(stem, array, what)
                if told["file"].endswith(".exr"):
                    told["encoding"] = "linear"
            else:
                mask = np.asarray(array)
                if mask.ndim != 2:
                    raise _bad(f"{what}: the array has {mask.ndim} axes", "height x width")
                counts = np.where(mask.astype(bool), 255, 0).astype(np.uint8)
                told["mask"] = "photos/" + _hookeye.write_photo(
                    folder / "photos" / f"{name}_{camera}_mask", counts, what)
