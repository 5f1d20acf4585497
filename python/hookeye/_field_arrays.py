"""Measured fields that are told as arrays: checked, and written as a table that a capture names."""

from __future__ import annotations

import os
import pathlib
from typing import Any, List, Mapping, Tuple

import numpy as np

from ._named import one_of
from .errors import InputError

_KEYS = ("points", "displacement", "strain", "sigma")
#: Lengths that a table's head may tell.
_LENGTHS = ("m", "cm", "mm", "um")


def _bad(wrong: str, right: str) -> InputError:
    return InputError(f"{wrong}\n  {right}", wrong=wrong, right=right)


def write_field(entry: Any, where: str, top: pathlib.Path, name: str, length: str) -> Any:
    """An entry of `measured`: where its field is told as arrays, the same with the file's name."""
    if not isinstance(entry, Mapping) or isinstance(entry.get("field", ""), (str, os.PathLike)):
        return entry
    given = _parts(entry["field"], f"{where}.field")
    strains = "strain" in given
    if strains != ("strain" in entry):
        raise _bad(f"{where}: strains take both, the measure and the numbers",
                   '{"field": {"points": ..., "strain": ...}, "strain": "green", ...}')
    columns, table = _table(given, f"{where}.field")
    heads = ["X", "Y", "Z", *columns]
    if length in _LENGTHS and "unit" not in entry and "scale" not in entry:
        heads[0] += f" [{length}]"
    values = columns if not strains else [c for c in columns if c.startswith("e")]
    out = dict(entry, field=name, sigma=_sigma(entry, given, where, len(table), len(values)))
    file = top / name
    if file.exists():
        raise _bad(f"{file}: there is a file of this name", "another folder")
    file.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(file, table, fmt="%.17g", delimiter=",", header=",".join(heads), comments="")
    return out


def _parts(field: Any, where: str) -> Mapping[str, Any]:
    """By name: points, displacement, strain, sigma."""
    if isinstance(field, Mapping):
        for key in field:
            if key not in _KEYS:
                raise _bad(f"{where} has no {key!r}", one_of(key, _KEYS))
        if "points" not in field or not ("displacement" in field or "strain" in field):
            raise _bad(f"{where}: {', '.join(map(str, field)) or 'nothing'} is not enough",
                       "`points` (n, 3) and `displacement` (n, 3), or `strain`")
        return field
    if isinstance(field, tuple) and len(field) == 2:
        return {"points": field[0], "displacement": field[1]}
    both = _numbers(field, where, (6,), "(n, 6): x, y, z, u, v, w of each point; or a dict of arrays")
    return {"points": both[:, :3], "displacement": both[:, 3:]}


def _numbers(given: Any, where: str, widths: Tuple[int, ...], right: str) -> np.ndarray:
    array = np.asanyarray(given)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{where}: real numbers are expected, not dtype {array.dtype}")
    if array.ndim != 2 or array.shape[1] not in widths:
        shape = " x ".join(map(str, array.shape)) or "one number"
        raise _bad(f"{where}: the array is {shape}", right)
    if isinstance(array, np.ma.MaskedArray):
        array = array.astype(float).filled(np.nan)
    out = np.asarray(array, float)
    infinite = np.isinf(out).any(axis=1)
    if infinite.any():
        raise _bad(f"{where}: row {int(infinite.argmax())} is infinite",
                   "numbers, or NaN where a point was not measured")
    return out


def _table(given: Mapping[str, Any], where: str) -> Tuple[List[str], np.ndarray]:
    points = _numbers(given["points"], f"{where}.points", (3,), "points are (n, 3), a row each")
    columns: List[str] = []
    parts = [points]
    for key, names in (("displacement", ("U", "V", "W")), ("strain", ("exx", "eyy", "exy"))):
        if key not in given:
            continue
        part = _numbers(given[key], f"{where}.{key}", (2, 3), f"(n, 3) or (n, 2), a row a point: {', '.join(names)}")
        if len(part) != len(points):
            raise _bad(f"{where}.{key}: {len(part)} rows, and {len(points)} points", "a row a point")
        columns += names[:part.shape[1]]
        parts.append(part)
    read = parts[-1]  # strains, where there are some
    measured = np.isfinite(read).all(axis=1)
    unknown = measured & ~np.isfinite(points).all(axis=1)
    if unknown.any():
        raise _bad(f"{where}.points: row {int(unknown.argmax())} is NaN, and what is measured there is not",
                   "places of all points; NaN where a point was not measured belongs to what is measured")
    if not measured.any():
        raise _bad(f"{where}: no row has numbers ({len(points)} rows, all with NaN)",
                   "at least one point that was measured")
    _refuse_twice(points[measured], np.flatnonzero(measured), f"{where}.points")
    return columns, np.column_stack(parts)


def _refuse_twice(points: np.ndarray, rows: np.ndarray, where: str) -> None:
    order = np.lexsort(points.T)
    same = (points[order[1:]] == points[order[:-1]]).all(axis=1)
    if same.any():
        at = int(same.argmax())
        first, second = sorted((int(rows[order[at]]), int(rows[order[at + 1]])))
        raise _bad(f"{where}: rows {first} and {second} are the same point",
                   "one row a point; an entry of `measured` for each load case and each camera pair")


def _sigma(entry: Mapping[str, Any], given: Mapping[str, Any], where: str, rows: int, components: int) -> Any:
    if "sigma" in entry and "sigma" in given:
        raise _bad(f"{where}: `sigma` is told twice", "beside `field`, or in it")
    if "sigma" not in entry and "sigma" not in given:
        raise _bad(f"{where} lacks `sigma`", "the standard deviation of what is measured, a number or one a component")
    sigma = np.asarray(entry.get("sigma", given.get("sigma")))
    if sigma.dtype.kind not in "fiu":
        raise TypeError(f"{where}.sigma: real numbers are expected, not dtype {sigma.dtype}")
    if sigma.ndim > 0 and sigma.shape in ((rows,), (rows, 1), (rows, components)) and rows != components:
        mean = np.sqrt(np.nanmean(np.square(sigma, dtype=float), axis=0)).ravel()
        raise _bad(f"{where}.sigma: the array is {' x '.join(map(str, sigma.shape))}, one a point",
                   "one number, or one a component; of these the root mean square is "
                   + ", ".join(f"{x:.3g}" for x in mean))
    if sigma.shape not in ((), (components,)):
        raise _bad(f"{where}.sigma: the array is {' x '.join(map(str, sigma.shape))}",
                   f"one number, or {components}: one a component")
    if not (np.isfinite(sigma).all() and (sigma > 0).all()):
        raise _bad(f"{where}.sigma: {sigma.tolist()} is not a standard deviation", "numbers above zero")
    return sigma.tolist()
