"""The model of a capture: parameters, equilibria, pictures, normal equations."""

from __future__ import annotations

import struct
import zlib
from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy as np

from . import _hookeye
from ._named import Attributes, Named, one_of
from ._registered import registered
from .capture import Capture
from .effect import EffectLike
from .equilibrium import Equilibrium
from .errors import InputError, UnknownName
from .measured_field import MeasuredField, fields_of
from .tables import table

Shot = Tuple[str, str]


class Parameter(Attributes):
    """One number of a model; `value` may be set. `low`, `high`: bounds, not an interval."""

    def __init__(self, model: "Model", name: str) -> None:
        self._model = model
        self.name = name
        self._told()  # or there is none of that name

    def _told(self) -> Dict[str, Any]:
        for one in self._model._own.parameters():
            if one["name"] == self.name:
                return one
        wrong = f"the model has no parameter '{self.name}'"
        right = one_of(self.name, [one["name"] for one in self._model._own.parameters()])
        raise UnknownName(f"{wrong}\n  {right}", wrong=wrong, right=right)

    @property
    def value(self) -> float:
        return self._told()["value"]

    @value.setter
    def value(self, value: float) -> None:
        self._model._own.set(self.name, float(value))

    @property
    def interval(self) -> Optional[Tuple[float, float]]:
        """95 %, of the fit that the model comes from; None: of no fit, or changed since."""
        known = self._model._intervals.get(self.name)
        return known[1] if known and known[0] == self.value else None

    @property
    def fixed(self) -> bool:
        return self._told()["fixed"]

    @property
    def unit(self) -> str:
        return self._told()["unit"]

    @property
    def words(self) -> str:
        return self._told()["words"]

    @property
    def low(self) -> float:
        return self._told()["low"]

    @property
    def high(self) -> float:
        return self._told()["high"]

    @property
    def positive(self) -> bool:
        """Fitted as its logarithm."""
        return self._told()["positive"]

    @property
    def typical(self) -> float:
        """A change of this size matters."""
        return self._told()["typical"]

    def __float__(self) -> float:
        return self.value

    def __repr__(self) -> str:
        fixed = ", fixed" if self.fixed else ""
        return f"<hookeye.Parameter {self.name} = {self.value:.6g} {self.unit}{fixed}>"


class Picture(np.ndarray):
    """A rendered picture, linear, float32. `coverage`: the body's share of each pixel; `mask`: true
    where the body covers it whole."""

    coverage: np.ndarray

    @classmethod
    def _made(cls, values: np.ndarray, coverage: np.ndarray) -> "Picture":
        out = values.view(cls)
        out.coverage = coverage
        return out

    def __array_finalize__(self, source: Any) -> None:
        self.coverage = getattr(source, "coverage", None)

    @property
    def mask(self) -> np.ndarray:
        return self.coverage > 1.0 - 1e-6

    def _repr_png_(self) -> Optional[bytes]:
        """Notebooks show the picture (in sRGB)."""
        values = np.asarray(self)
        if values.ndim not in (2, 3) or (values.ndim == 3 and values.shape[2] != 3):
            return None
        linear = np.clip(np.nan_to_num(values), 0.0, 1.0)
        stored = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
        rows = np.round(255 * stored).astype(np.uint8).reshape(len(values), -1)
        lines = b"".join(b"\0" + row.tobytes() for row in rows)
        head = struct.pack(">IIBBBBB", values.shape[1], values.shape[0], 8,
                           0 if values.ndim == 2 else 2, 0, 0, 0)
        return b"\x89PNG\r\n\x1a\n" + b"".join(
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
            for kind, data in ((b"IHDR", head), (b"IDAT", zlib.compress(lines)), (b"IEND", b"")))


class Evaluation(Attributes):
    """One look at the model: what is left, and the normal equations of what is fitted.

    `r` by (example, camera): model less photo over noise, NaN where a pixel does not count.
    `r2`: sum of squares of the fitted photos and measurements; `chi`: root mean square over photos.
    With `jac`: `JTJ`, `JTr` by `names` (free parameters, in order), so that the gradient of r2 / 2
    is JTr; and `R`, `z`, `rho`: R^T R = JTJ, R^T z = JTr, |z|^2 + rho^2 = r2, which a least-squares
    solver takes as a residual vector and its Jacobian.
    """

    def __init__(self, told: Dict[str, Any]) -> None:
        self.names: List[str] = told["names"]
        self.r: Dict[Shot, np.ndarray] = Named("photo of (load case, camera)", told["r"])
        self.pictures: Dict[Shot, np.ndarray] = Named("photo of (load case, camera)", told["pictures"])
        #: Measured fields with their residuals, by (example, file).
        self.fields: Dict[Shot, MeasuredField] = fields_of(told["fields"])
        self.measured: List[Dict[str, Any]] = told["measured"]
        self.r2: float = told["r2"]
        self.chi: float = told["chi"]
        self.chi_held_out: float = told["chi_held_out"]
        self._sums = told

    def _sum(self, name: str) -> Any:
        if name not in self._sums:
            raise AttributeError(f"{name} is known only of evaluate(jac=True)")
        return self._sums[name]

    @property
    def JTJ(self) -> np.ndarray:
        return self._sum("JTJ")

    @property
    def JTr(self) -> np.ndarray:
        return self._sum("JTr")

    @property
    def R(self) -> np.ndarray:
        return self._sum("R")

    @property
    def z(self) -> np.ndarray:
        return self._sum("z")

    @property
    def rho(self) -> float:
        return self._sum("rho")

    def __repr__(self) -> str:
        return f"<hookeye.Evaluation: chi {self.chi:.4g} over {len(self.r)} photos>"


class Model(Attributes):
    """Parameters by name: `model["mu"].value = 0.05`. Made by Capture.model() or Run.model()."""

    def __init__(self, capture: Capture, _own: Optional[_hookeye.Model] = None) -> None:
        self.capture = capture
        self._own = _own if _own is not None else _hookeye.Model(capture._own)
        #: name -> (value of the fit, interval)
        self._intervals: Dict[str, Tuple[float, Tuple[float, float]]] = {}

    def __getitem__(self, name: str) -> Parameter:
        return Parameter(self, name)

    def __iter__(self) -> Iterator[str]:
        return iter([one["name"] for one in self._own.parameters()])

    def __len__(self) -> int:
        return len(self._own.parameters())

    def __contains__(self, name: object) -> bool:
        return name in list(self)

    @property
    def names(self) -> List[str]:
        """Free parameters, in the order of `p` and of Evaluation.JTJ."""
        return [one["name"] for one in self._own.parameters() if not one["fixed"]]

    @property
    def p(self) -> np.ndarray:
        """Values of the free parameters; may be set."""
        return np.array([one["value"] for one in self._own.parameters() if not one["fixed"]])

    @p.setter
    def p(self, values: Any) -> None:
        names = self.names
        values = np.asarray(values)
        if values.dtype.kind not in "fiu":
            raise TypeError(f"p: real numbers are expected, not dtype {values.dtype}")
        if values.shape != (len(names),):
            wrong = f"p: the array has the shape {values.shape}"
            right = f"{len(names)} numbers: {', '.join(names)}"
            raise InputError(f"{wrong}\n  {right}", wrong=wrong, right=right)
        before = self.p
        try:
            for name, value in zip(names, values):
                self._own.set(name, float(value))
        except Exception:
            for name, value in zip(names, before):
                self._own.set(name, float(value))
            raise

    @property
    def bounds(self) -> Tuple[np.ndarray, np.ndarray]:
        """Of the free parameters."""
        free = [one for one in self._own.parameters() if not one["fixed"]]
        return np.array([one["low"] for one in free]), np.array([one["high"] for one in free])

    @property
    def parameters(self) -> Any:
        """All of them, as a table."""
        columns = ["name", "value", "unit", "words", "low", "high", "fixed"]
        rows = [{key: one[key] for key in columns} for one in self._own.parameters()]
        return table(rows, columns, "name")

    @property
    def ingredients(self) -> List[str]:
        """What the model is made of: "material", "light", added effects."""
        return self._own.ingredients()

    def fix(self, *names: str) -> None:
        """Holds numbers of the capture's own model at their values: no fit moves them."""
        for name in names:
            self._own.fix(name)

    def free(self, *names: str) -> None:
        for name in names:
            self._own.free(name)

    def variants(self, effect: EffectLike) -> List[str]:
        """The ways in which an effect can be present in this capture."""
        return self._own.variants(registered(effect))

    def add(self, effect: EffectLike, variant: str = "") -> None:
        """Adds an effect at its null values, which change nothing yet. A class derived from
        hookeye.Effect is registered with it."""
        self._own.add(registered(effect), variant)

    def remove(self, effect: EffectLike) -> None:
        self._own.remove(registered(effect))

    def to_yaml(self) -> str:
        """The model.yaml that `hookeye fit -m` takes."""
        return self._own.text()

    def simulate(self, example: str, *, cancel: Any = None) -> Equilibrium:
        """The equilibrium of one load case."""
        return Equilibrium(self._own.simulate(example, cancel))

    def render(self, example: str, camera: str, *, cancel: Any = None) -> Picture:
        """What a camera would see of a load case."""
        return Picture._made(*self._own.render(example, camera, cancel))

    def evaluate(self, jac: bool = True, *, held_out: bool = False,
                 cancel: Any = None) -> Evaluation:
        """The model against all fitted photos (and those that are held out)."""
        return Evaluation(self._own.evaluate(bool(jac), bool(held_out), cancel))

    def __repr__(self) -> str:
        return f"<hookeye.Model {', '.join(self.ingredients)}: {', '.join(self)}>"

    def _repr_html_(self) -> str:
        return self.parameters._repr_html_()
