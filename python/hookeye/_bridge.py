"""What C++ asks of an effect in Python: every answer checked, derivatives that a class does not give."""

from __future__ import annotations

import inspect
import math
import re
import zlib
from types import CodeType, FunctionType
from typing import Any, Dict, List, Mapping, Sequence, Tuple

import numpy as np

from .effect import Effect, Setup
from .errors import EffectError, InputError

#: Step into the imaginary: its square is nothing beside 1, so that the derivative is exact.
_IMAGINARY = 1e-30
#: Real step beside an imaginary one, for second derivatives: error some 1e-10 of them.
_REAL = 1e-5

_GROUPS = ("material", "loads", "supports", "history", "measurement", "numerical")
_FIELDS = ("unit", "null", "typical", "low", "high", "words")
#: What methods take besides the parameters.
_TAKEN = ("self", "F", "I1", "I2", "J", "X", "x", "N", "example", "camera", "order", "setup")
#: Numbers of photo(), in the order of the photo's columns: name, how many, whether where photos
#: show a point changes with it.
_PHOTO = (("rotate", 3, True), ("move", 3, True), ("zoom", 1, True), ("log_gain", 1, False),
          ("ambient", 1, False), ("sun", 3, False), ("specular", 1, False), ("blur", 1, False),
          ("background", 1, False))
_KINDS = ("energy", "energy_of_invariants", "body_force", "traction", "photo")


def _complex(F: np.ndarray) -> np.ndarray:
    """A copy (n, 3, 3) whose entries lie together, so that each is one quick array."""
    return np.ascontiguousarray(F.transpose(1, 2, 0)).astype(complex).transpose(2, 0, 1)


def bad(wrong: str, right: str) -> InputError:
    return InputError(f"{wrong}\n  {right}", wrong=wrong, right=right)


def name_of(effect: Any, what: str = "an effect") -> str:
    own = effect.name or re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", type(effect).__name__).lower()
    if not isinstance(own, str) or not re.fullmatch(r"[a-z][a-z0-9_]*", own):
        raise bad(f"{what} cannot have the name {own!r}",
                   "small letters, digits and _, as in `skin_spring`")
    return own


_PLAIN = (str, int, float, tuple, dict, list)


def code_of(effect: Any, base: type = Effect) -> str:
    """Tells one definition from another: what the methods do, and the plain values that they, the class
    and the object hold; not where they are written, nor their docstrings."""

    def text(code: CodeType, doc: Any = None) -> str:
        inner = [text(c) if isinstance(c, CodeType) else repr(c) for c in code.co_consts
                 if doc is None or c != doc]
        return repr((code.co_code, inner, code.co_names, code.co_varnames))

    def of_function(function: FunctionType) -> str:
        held = inspect.getclosurevars(function).nonlocals.values()
        return text(function.__code__, function.__doc__) + repr(
            [function.__defaults__] + [one for one in held if isinstance(one, _PLAIN)])

    parts = []
    for cls in type(effect).__mro__:
        if cls in (base, object):
            continue
        for key, value in sorted(vars(cls).items()):
            if inspect.isfunction(value):
                parts.append(key + of_function(value))
            elif not key.startswith("__") and isinstance(value, _PLAIN):
                parts.append(f"{key} = {value!r}")
    parts += [f"{key} = {value!r}" for key, value in sorted(vars(effect).items())
              if isinstance(value, _PLAIN)]
    return f"{zlib.crc32(repr(parts).encode()):08x}"


def _has(effect: Effect, method: str) -> bool:
    return callable(getattr(effect, method, None))


#: What parameters(setup) named last, by name and code: an effect that is registered again is asked
#: for sentences about what was fitted before.
_told_names: Dict[Tuple[str, str], List[str]] = {}


class Bridge:
    """What C++ asks. Every answer is checked: its shape, its type, that it is finite."""

    def __init__(self, effect: Effect) -> None:
        self.own = effect
        self.name = name_of(effect)
        self.title = effect.title or self.name.replace("_", " ")
        self.manual = " ".join((type(effect).__doc__ or "").split()) or self.title
        self.code = code_of(effect)
        there = [kind for kind in _KINDS if _has(effect, kind)]
        if not there:
            raise bad(f"the effect '{self.name}' does nothing",
                       f"a method of {', '.join(_KINDS)}")
        for one, other in (("energy", "energy_of_invariants"), ("body_force", "traction")):
            if one in there and other in there:
                raise bad(f"the effect '{self.name}' has {one}() and {other}()", "one of them")
        if not callable(effect.parameters):
            self._check_parameters(effect.parameters)
        energetic = there[0].startswith("energy")
        self.group = effect.group or ("material" if energetic else
                                      "measurement" if there[0] == "photo" else "loads")
        if self.group not in _GROUPS:
            raise bad(f"the effect '{self.name}' has the group {self.group!r}",
                       f"one of {', '.join(_GROUPS)}")
        self.force_method = next((k for k in there if k in ("body_force", "traction")), "")
        self.kinds = {"energy": energetic,
                      "of_invariants": "energy_of_invariants" in there,
                      "body_force": "body_force" in there, "traction": "traction" in there,
                      "follows": False, "photo": "photo" in there}
        #: Names of the parameters, in order.
        self.names: List[str] = (_told_names.get((self.name, self.code), [])
                                 if callable(effect.parameters) else list(effect.parameters))
        self.places: List[str] = []  # of X, x, N: what a force takes
        if self.force_method:
            taken = list(inspect.signature(getattr(effect, self.force_method)).parameters)
            self.places = [one for one in taken if one in ("X", "x", "N")]
            if self.places not in (["X"], ["X", "x"], ["X", "N"], ["X", "x", "N"]):
                raise bad(f"the effect '{self.name}': {self.force_method}() takes {taken}",
                           "X, then x if the force follows the body, then the parameters")
            self.kinds["follows"] = "x" in self.places

    # -- what it declares

    def setup(self, told: Dict[str, Any]) -> Dict[str, Any]:
        setup = Setup(told)
        parameters = self.own.parameters
        if callable(parameters):
            parameters = self._ask("parameters", setup)
            self._check_parameters(parameters)
            self.names = _told_names[self.name, self.code] = list(parameters)
        declared = []
        for name, one in parameters.items():
            null, typical = float(one.get("null", 0.0)), float(one["typical"])
            declared.append({"name": name, "unit": one.get("unit", ""), "null": null,
                             "words": one.get("words", name), "typical": typical,
                             "low": float(one.get("low", -math.inf)),
                             "high": float(one.get("high", math.inf))})
        why_not = self._ask("applies", setup)
        if why_not is None:
            why_not = ""
        if not isinstance(why_not, str):
            raise self._wrong("applies", f"{why_not!r} was returned", "\"\", or why not")
        cameras = False
        if self.kinds["photo"] and not why_not and setup.examples and setup.cameras:
            at = np.array([one["null"] + one["typical"] if one["null"] + one["typical"] <= one["high"]
                           else one["null"] - one["typical"] for one in declared])
            shots = [(example, camera, i) for i, example in enumerate(setup.examples)
                     for camera in setup.cameras]
            cameras = bool(self.photos(shots, at)[:, :7].any())
        weights = None
        if self.kinds["energy"] and _has(self.own, "where") and not why_not:
            centres = setup.points[setup.elements[:, :4]].mean(axis=1)
            weights = self._checked("where", self._ask("where", centres, setup), (len(centres),))
            weights = weights.astype(float)
        return {"parameters": declared, "why_not": why_not, "region": self.own.region or "",
                "cameras": cameras, "weights": weights}

    def _check_parameters(self, parameters: Any) -> None:
        if not isinstance(parameters, Mapping) or not parameters:
            raise bad(f"the effect '{self.name}' has no parameters",
                       'parameters = {"k": {"unit": "MPa", "typical": 0.01}}')
        for name, one in parameters.items():
            what = f"the effect '{self.name}', parameter '{name}'"
            if not isinstance(name, str) or not name.isidentifier() or name in _TAKEN:
                raise bad(f"{what} has no name of its own",
                           f"letters, digits and _, and none of {', '.join(_TAKEN)}")
            if not isinstance(one, Mapping):
                raise bad(f"{what}: {one!r}", '{"unit": "MPa", "typical": 0.01}')
            for key in one:
                if key not in _FIELDS:
                    raise bad(f"{what} has `{key}`", f"one of {', '.join(_FIELDS)}")
            null, typical = one.get("null", 0.0), one.get("typical")
            for key in ("null", "typical", "low", "high"):
                if key in one and (isinstance(one[key], bool)
                                   or not isinstance(one[key], (int, float, np.number))
                                   or math.isnan(one[key])):
                    raise bad(f"{what}: {key} is {one[key]!r}", "a number")
            if typical is None or not 0 < typical < math.inf:
                raise bad(f"{what} has no size that matters", "typical: a number above zero")
            if not one.get("low", -math.inf) <= null <= one.get("high", math.inf):
                raise bad(f"{what}: null = {null} is not between low and high", "other bounds")

    def sentence(self, values: np.ndarray) -> str:
        if not _has(self.own, "sentence"):
            return ""
        said = self._ask("sentence", **self._named(values))
        if not isinstance(said, str):
            raise self._wrong("sentence", f"{said!r} was returned", "a sentence")
        return said

    # -- energies

    def psi(self, F: np.ndarray, values: np.ndarray) -> np.ndarray:
        return self._numbers("energy", (len(F),), F, values=values, infinite=True)

    def P(self, F: np.ndarray, values: np.ndarray) -> np.ndarray:
        """(n, 9), column by column."""
        if _has(self.own, "stress"):
            P = self._numbers("stress", F.shape, F, values=values)
            return np.ascontiguousarray(np.swapaxes(P, 1, 2)).reshape(-1, 9)
        out = np.empty((len(F), 9))
        moved = _complex(F)
        for k in range(9):
            a, b = k % 3, k // 3
            moved[:, a, b] += 1j * _IMAGINARY
            out[:, k] = self._slope("energy", (len(F),), moved, values)
            moved[:, a, b] = F[:, a, b]
        return out

    def dP_dF(self, F: np.ndarray, values: np.ndarray) -> np.ndarray:
        """(n, 9, 9), F and P column by column."""
        n = len(F)
        if _has(self.own, "stiffness"):
            D = self._numbers("stiffness", (n, 3, 3, 3, 3), F, values=values)
            return np.ascontiguousarray(D.transpose(0, 4, 3, 2, 1)).reshape(n, 9, 9)
        out = np.empty((n, 9, 9))
        moved = _complex(F)
        if _has(self.own, "stress"):
            for k in range(9):
                a, b = k % 3, k // 3
                moved[:, a, b] += 1j * _IMAGINARY
                dP = self._slope("stress", F.shape, moved, values)
                out[:, k] = np.swapaxes(dP, 1, 2).reshape(n, 9)
                moved[:, a, b] = F[:, a, b]
            return out
        for k in range(9):
            for i in range(k + 1):
                pair = []
                for side in (_REAL, -_REAL):
                    moved[:, k % 3, k // 3] += side
                    moved[:, i % 3, i // 3] += 1j * _IMAGINARY
                    pair.append(self._slope("energy", (n,), moved, values))
                    moved[:, k % 3, k // 3] = F[:, k % 3, k // 3]
                    moved[:, i % 3, i // 3] = F[:, i % 3, i // 3]
                out[:, k, i] = out[:, i, k] = (pair[0] - pair[1]) / (2 * _REAL)
        return out

    def of_invariants(self, I: np.ndarray, values: np.ndarray, order: int) -> np.ndarray:
        """(1, 4 or 10, n): W; by I1bar, I2bar, J; by 11, 22, JJ, 12, 1J, 2J."""
        method, shape = "energy_of_invariants", I.shape[1:]
        rows = [self._numbers(method, shape, *I, values=values, infinite=order == 0)]
        moved = I.astype(complex)

        def slope(i: int) -> np.ndarray:
            moved[i] += 1j * _IMAGINARY
            out = self._slope(method, shape, moved, values, spread=True)
            moved[i] = moved[i].real
            return out

        if order >= 1:
            rows += [slope(i) for i in range(3)]
        if order >= 2:
            for i, k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
                pair = []
                for side in (_REAL, -_REAL):
                    moved[k] = I[k] + side
                    pair.append(slope(i))
                    moved[k] = I[k]
                rows.append((pair[0] - pair[1]) / (2 * _REAL))
        return np.stack(rows)

    # -- forces

    def force(self, X: np.ndarray, x: Any, N: Any, values: np.ndarray) -> np.ndarray:
        return self._numbers(self.force_method, X.shape, *self._at(X, x, N), values=values)

    def force_dx(self, X: np.ndarray, x: np.ndarray, N: Any, values: np.ndarray) -> np.ndarray:
        """(n, 3, 3): force by place."""
        out = np.empty((len(X), 3, 3))
        for j in range(3):
            moved = x.astype(complex)
            moved[:, j] += 1j * _IMAGINARY
            told = self._ask(self.force_method, *self._at(X, moved, N), **self._named(values))
            told = self._checked(self.force_method, told, X.shape)
            out[:, :, j] = told.imag / _IMAGINARY if np.iscomplexobj(told) else 0.0
        return out

    def _at(self, X: np.ndarray, x: Any, N: Any) -> List[Any]:
        if "N" in self.places and N is None:
            raise self._wrong(self.force_method, "a body has no normal N", "X and x")
        return [{"X": X, "x": x, "N": N}[place] for place in self.places]

    def share(self, example: str, order: int) -> float:
        told = self._ask("share", example, order)
        return float(self._checked("share", told, ()))

    # -- photos

    def photos(self, shots: Sequence[Tuple[str, str, int]], values: np.ndarray) -> np.ndarray:
        out = np.zeros((len(shots), sum(size for _, size, _ in _PHOTO)))
        for row, (example, camera, order) in zip(out, shots):
            told = self._ask("photo", example, camera, order, **self._named(values))
            if told is None:
                continue
            if not isinstance(told, Mapping):
                raise self._wrong("photo", f"{type(told).__name__} was returned", "a dict")
            left, at = dict(told), 0
            for key, size, _ in _PHOTO:
                if key in left:
                    row[at:at + size] = self._checked(
                        "photo", left.pop(key), () if size == 1 else (size,), key)
                at += size
            if left:
                raise self._wrong("photo", f"it changes {', '.join(map(repr, left))}",
                                  f"of {', '.join(key for key, _, _ in _PHOTO)}")
        return out

    # -- calls and their checks

    def _named(self, values: np.ndarray) -> Dict[str, float]:
        return dict(zip(self.names, values.tolist()))

    def _wrong(self, method: str, wrong: str, right: str) -> EffectError:
        return EffectError(f"effect '{self.name}', {method}(): {wrong}\n  {right}", self.name, method)

    def _ask(self, method: str, *given: Any, **named: Any) -> Any:
        try:
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                return getattr(self.own, method)(*given, **named)
        except EffectError:
            raise
        except Exception as error:
            raise EffectError(
                f"effect '{self.name}', {method}(): {type(error).__name__}: {error}", self.name,
                method) from error

    def _checked(self, method: str, told: Any, shape: Tuple[int, ...], what: str = "",
                 infinite: bool = False) -> np.ndarray:
        said = f"{what}: " if what else ""
        array = np.asarray(told)
        if array.dtype.kind not in "fiucb":
            raise self._wrong(method, f"{said}{type(told).__name__} of dtype {array.dtype} was "
                              "returned", f"real numbers of the shape {shape}")
        if array.shape != shape:
            raise self._wrong(method, f"{said}an array of the shape {array.shape} was returned",
                              f"the shape {shape}: a value for each that was asked")
        good = ~np.isnan(array) & (array != -np.inf) if infinite else np.isfinite(array)
        if not good.all():
            at = np.argwhere(~good)[0]
            raise self._wrong(method, f"{said}{array[tuple(at)]} was returned at {tuple(at.tolist())}",
                              "finite numbers")
        return array

    def _numbers(self, method: str, shape: Tuple[int, ...], *given: Any, values: np.ndarray,
                 infinite: bool = False) -> np.ndarray:
        told = self._checked(method, self._ask(method, *given, **self._named(values)), shape,
                             infinite=infinite)
        if np.iscomplexobj(told):
            raise self._wrong(method, "complex numbers were returned for real ones", "real numbers")
        return np.ascontiguousarray(told, dtype=float)

    def _slope(self, method: str, shape: Tuple[int, ...], moved: np.ndarray, values: np.ndarray,
               spread: bool = False) -> np.ndarray:
        """By the imaginary step that is in `moved`."""
        given = tuple(moved) if spread else (moved,)
        told = self._checked(method, self._ask(method, *given, **self._named(values)), shape)
        if not np.iscomplexobj(told):
            raise self._wrong(method, "real numbers were returned for a complex argument, so that "
                              "no derivative comes out",
                              "no abs(), real or float(); or give stress() and stiffness()")
        return told.imag / _IMAGINARY
