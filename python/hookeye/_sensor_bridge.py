"""What C++ asks of a sensor in Python: every answer checked, derivatives that a class does not give."""

from __future__ import annotations

import inspect
from typing import Any, Dict, List, Sequence, Tuple

import numpy as np

from ._bridge import _IMAGINARY, bad, code_of, name_of
from .errors import SensorError
from .sensor import Sensor

#: Central differences: a step of this share of the extent of the points. Their error is of its square.
_SHARE = 1e-5


class SensorBridge:
    def __init__(self, sensor: Sensor) -> None:
        self.own = sensor
        self.name = name_of(sensor, "a sensor")
        self.unit = sensor.unit
        if not isinstance(self.unit, str):
            raise bad(f"the sensor '{self.name}' has the unit {self.unit!r}", 'a text, as "mm"')
        if type(sensor).predict is Sensor.predict:
            raise bad(f"the sensor '{self.name}' has no predict()", "def predict(self, x, u): ...")
        self.code = code_of(sensor, Sensor)
        self._places(sensor)
        self.takes_example = "example" in inspect.signature(sensor.predict).parameters

    def _places(self, sensor: Sensor) -> None:
        told = [key for key in ("region", "regions", "points") if len(getattr(sensor, key))]
        if len(told) != 1:
            raise bad(f"the sensor '{self.name}' looks at {' and '.join(told) or 'nothing'}",
                      "one of region, regions and points")
        self.by_name = told == ["regions"]
        self.regions: List[str] = list(sensor.regions) if self.by_name else (
            [sensor.region] if sensor.region else [])
        if any(not isinstance(one, str) for one in self.regions):
            raise bad(f"the sensor '{self.name}': regions are names", 'as ("grip", "base")')
        self.points = np.empty((0, 3))
        if not self.regions:
            points = np.asarray(sensor.points)
            if points.dtype.kind not in "fiu" or points.ndim != 2 or points.shape[1] != 3 \
                    or not np.isfinite(points).all():
                raise bad(f"the sensor '{self.name}': its points are no array (n, 3) of numbers",
                          "points = [[0, 0, 40]]")
            self.points = points.astype(float)

    # -- what C++ asks

    def answer(self, x: np.ndarray, u: np.ndarray, dx: np.ndarray, du: np.ndarray,
               counts: Sequence[int], example: str) -> Tuple[np.ndarray, Any]:
        """Numbers (k,), and their derivatives (k, m) along dx, du (m, n, 3)."""
        value = self._predict(x, u, counts, example)
        if np.iscomplexobj(value):
            raise self._wrong("predict", "complex numbers were returned for real ones", "real numbers")
        if not len(dx):
            return value, None
        J = np.empty((len(value), len(dx)))
        for j, (ex, eu) in enumerate(zip(dx, du)):
            J[:, j] = self.along(x, u, ex, eu, counts, example, len(value))
        return value, J

    def along(self, x: np.ndarray, u: np.ndarray, dx: np.ndarray, du: np.ndarray,
              counts: Sequence[int], example: str, size: int) -> np.ndarray:
        if not dx.any() and not du.any():
            return np.zeros(size)
        if hasattr(self.own, "derivative"):
            given = [self._split(a, counts) for a in (x, u, dx, du)]
            return self._checked("derivative", self._ask("derivative", example, *given), size)
        if self.own.differences:
            return self.difference(x, u, dx, du, counts, example, _SHARE)
        told = self._predict(x + 1j * _IMAGINARY * dx, u + 1j * _IMAGINARY * du, counts, example)
        if not np.iscomplexobj(told):
            raise self._wrong("predict", "real numbers were returned for a complex argument, so that no "
                              "derivative comes out", "no abs(), real or float(); or differences = True, "
                              "or give derivative()")
        return told.imag / _IMAGINARY

    def difference(self, x: np.ndarray, u: np.ndarray, dx: np.ndarray, du: np.ndarray,
                   counts: Sequence[int], example: str, share: float) -> np.ndarray:
        rest = x - u
        size = max(float(np.linalg.norm(np.ptp(x, axis=0))), float(np.abs(rest).max()), 1e-300)
        h = share * size / max(float(np.abs(dx).max()), float(np.abs(du).max()))
        up, down = (self._predict(x + side * h * dx, u + side * h * du, counts, example)
                    for side in (1, -1))
        return (up - down) / (2 * h)

    # -- calls and their checks

    def _split(self, points: np.ndarray, counts: Sequence[int]) -> Any:
        if not self.by_name:
            return points
        ends = np.cumsum(counts)
        return {name: points[end - count:end]
                for name, count, end in zip(self.regions, counts, ends)}

    def _predict(self, x: np.ndarray, u: np.ndarray, counts: Sequence[int], example: str) -> np.ndarray:
        told = self._ask("predict", example, self._split(x, counts), self._split(u, counts))
        return self._checked("predict", told)

    def _ask(self, method: str, example: str, *given: Any) -> Any:
        named: Dict[str, str] = {"example": example} if self.takes_example else {}
        try:
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                return getattr(self.own, method)(*given, **named)
        except Exception as error:
            raise SensorError(f"sensor '{self.name}', {method}(): {type(error).__name__}: {error}",
                              self.name, method) from error

    def _checked(self, method: str, told: Any, size: int = 0) -> np.ndarray:
        array = np.asarray(told)
        if array.dtype.kind not in "fiuc":
            raise self._wrong(method, f"{type(told).__name__} of dtype {array.dtype} was returned",
                              "a number, or an array of some")
        if array.ndim > 1 or array.size == 0 or (size and array.size != size):
            raise self._wrong(method, f"an array of the shape {array.shape} was returned",
                              f"{size or 'some'} numbers in a row")
        if not np.isfinite(array).all():
            raise self._wrong(method, f"{array.tolist()} was returned", "finite numbers")
        return np.atleast_1d(array if array.dtype.kind == "c" else array.astype(float))

    def _wrong(self, method: str, wrong: str, right: str) -> SensorError:
        return SensorError(f"sensor '{self.name}', {method}(): {wrong}\n  {right}", self.name, method)
