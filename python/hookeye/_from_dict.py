"""What Capture.from_dict() is told, as a folder: arrays become files, files that are named are taken there."""

from __future__ import annotations

import difflib
import json
import math
import os
import pathlib
import re
import shutil
import tempfile
from typing import Any, Dict, Iterator, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _hookeye
from ._field_arrays import write_field
from .errors import InputError

PathLike = Union[str, "os.PathLike[str]"]
Shot = Tuple[str, str]


def _bad(wrong: str, right: str) -> InputError:
    return InputError(f"{wrong}\n  {right}", wrong=wrong, right=right)


def write_capture(told: Mapping[str, Any], photos: Mapping[Shot, Any], masks: Mapping[Shot, Any],
                  folder: Optional[PathLike]) -> Tuple[pathlib.Path, pathlib.Path, Any]:
    """The capture's folder, that where files were looked for, and what keeps the first (None: it
    stays)."""
    kept = tempfile.TemporaryDirectory(prefix="hookeye-") if folder is None else None
    base = pathlib.Path.cwd() if folder is None else pathlib.Path(folder).absolute()
    top = pathlib.Path(kept.name) if folder is None else pathlib.Path(folder)
    top.mkdir(parents=True, exist_ok=True)
    if (top / "capture.yaml").exists():
        raise _bad(f"{top}: there is a capture already", "another folder")
    document = _plain(_with_fields(dict(told), top), "capture", top)
    files = _Files(base, top)
    for where, holder, key in _named_files(document):
        shot = tuple(where[2:5:2]) if where[1:2] == ["examples"] and where[3:4] == ["photos"] else ()
        instead = masks if key == "mask" else photos if len(where) == 5 or key == "file" else {}
        if shot not in instead:
            holder[key] = files.take(holder[key], ".".join(where))
    _put_photos(document, photos, masks, top)
    text = json.dumps(document, indent=1, ensure_ascii=False)
    (top / "capture.yaml").write_text(text, encoding="utf-8")
    return top, base, kept


#: Where a capture names files: keys from the top, "*" for any name, "#" for any place in a list.
_FILES = ("body.surface", "body.volume", "body.texture.image", "cameras.from", "cameras.*.calibration",
          "camera_covariance", "camera_covariance.from", "regions.*.faces", "photos.mask",
          "photos.background.photo", "examples.from", "examples.*.photos.*", "examples.*.photos.*.file",
          "examples.*.photos.*.mask", "examples.*.photos.*.background.photo",
          "examples.*.measured.#.field")


def _named_files(document: Dict[str, Any]) -> Iterator[Tuple[List[str], Any, Any]]:
    """({"capture", "examples", ...}, what holds it, its key) of each."""
    def below(value: Any, keys: List[str], where: List[str]) -> Iterator[Tuple[List[str], Any, Any]]:
        inner: Any = ()
        if isinstance(value, dict) and keys[0] != "#":
            inner = list(value) if keys[0] == "*" else [keys[0]] if keys[0] in value else []
        elif isinstance(value, list) and keys[0] == "#":
            inner = range(len(value))
        for key in inner:
            if len(keys) > 1:
                yield from below(value[key], keys[1:], [*where, str(key)])
            elif isinstance(value[key], str):
                yield [*where, str(key)], value, key

    for pattern in _FILES:
        yield from below(document, pattern.split("."), ["capture"])


class _Files:
    """Files by the names that the dict has for them, which are of `base`: within `top`."""

    def __init__(self, base: pathlib.Path, top: pathlib.Path) -> None:
        self._base, self._top = base, top.absolute()
        self._apart = base.resolve() != self._top.resolve()

    def take(self, name: str, where: str) -> str:
        """What the capture is to call it."""
        way_out = os.path.isabs(name) or os.pardir in pathlib.Path(name).parts
        if not way_out and (self._top / name).is_file():
            return name  # written there, or lies there
        source = self._base / name
        if not source.is_file():
            raise _bad(f"{where}: there is no file {name!r} in {self._base}", self._near(source))
        inside = os.path.relpath(source, self._base)
        if inside.startswith(os.pardir):
            inside = self._elsewhere(source)
        elif not self._apart:
            return pathlib.Path(inside).as_posix()
        self._link(source, inside)
        if source.suffix in (".yaml", ".yml"):  # it may name further ones
            for further in re.findall(r"[^\s,:{}\[\]'\"]+", source.read_text(encoding="utf-8", errors="replace")):
                if not os.path.isabs(further) and os.pardir not in further and (
                        self._base / further).is_file():
                    self._link(self._base / further, further)
        return pathlib.Path(inside).as_posix()

    def _near(self, source: pathlib.Path) -> str:
        there = [one.name for one in source.parent.iterdir()] if source.parent.is_dir() else []
        near = difflib.get_close_matches(source.name, there, 1)
        return (f"did you mean {near[0]!r}? " if near else "") + (
            "files are looked for in the current directory, or in that of `folder=`")

    def _elsewhere(self, source: pathlib.Path) -> str:
        count = len(list((self._top / "files").iterdir())) if (self._top / "files").is_dir() else 0
        return os.path.join("files", str(count), source.name)

    def _link(self, source: pathlib.Path, inside: str) -> None:
        target = self._top / inside
        if target.exists():
            return
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            os.link(source.resolve(), target)
        except OSError:  # another disk, or not ours
            shutil.copyfile(source, target)


def _with_fields(told: Dict[str, Any], top: pathlib.Path) -> Dict[str, Any]:
    """Arrays of measured fields as files."""
    examples = told.get("examples")
    if not isinstance(examples, Mapping):
        return told
    units = told.get("units")
    length = units.get("length", "") if isinstance(units, Mapping) else ""
    out: Dict[str, Any] = {}
    for k, (name, example) in enumerate(examples.items()):
        measured = example.get("measured") if isinstance(example, Mapping) else None
        if isinstance(measured, (list, tuple)):
            stem = name if re.fullmatch(r"\w[\w .-]*", str(name)) else f"example{k}"
            example = dict(example, measured=[
                write_field(entry, f"capture.examples.{name}.measured[{i}]", top,
                            f"fields/{stem}-{i}.csv", length) for i, entry in enumerate(measured)])
        out[name] = example
    return dict(told, examples=out)


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
    most = float(values[np.isfinite(values)].max(initial=0.0)) if values.dtype.kind == "f" else 0.0
    if most > 2.0:
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
