"""Runs: fit, diagnose, discover, and any run folder opened."""

from __future__ import annotations

import json
import logging
import os
import pathlib
import tempfile
from html import escape
from typing import (Any, ContextManager, Dict, Iterable, List, Optional, Sequence, Tuple, Union)

import numpy as np

from . import _hookeye, tables
from ._registered import registered, registered_for
from ._named import Attributes, Named
from .capture import Capture
from .effect import EffectLike
from .errors import InputError
from .measured_field import MeasuredField, fields_of
from .fields import Field
from .model import Model, Shot
from .progress import OnStep, listener
from .tables import Table, table

PathLike = Union[str, "os.PathLike[str]"]
_log = logging.getLogger("hookeye")


class Step(Attributes):
    """A finished step of a run: its figures (run.json) and its folder."""

    def __init__(self, told: Dict[str, Any], folder: str) -> None:
        self.told = told
        self.folder = pathlib.Path(folder)
        self.name: str = told["name"]
        self.added: Optional[str] = told["added"]
        self.effects: List[str] = told["effects"]
        self.chi: float = told["chi_fit"]
        self.chi_held_out: Optional[float] = told["chi_validate"]
        self.converged: bool = told.get("converged", True)

    @property
    def parameters(self) -> Any:
        return _parameters(self.told)

    @property
    def metrics(self) -> Dict[str, Any]:
        """metrics.json: misfit by photo, camera, example and region; the material's card."""
        return json.loads((self.folder / "metrics.json").read_text(encoding="utf-8"))

    def __repr__(self) -> str:
        return f"<hookeye.Step {self.name}: chi {self.chi:.4g}>"


def _parameters(step: Dict[str, Any]) -> Any:
    rows = [{"name": one["name"], "value": one["value"], "low": one.get("low"),
             "high": one.get("high"), "unit": one["unit"], "words": one["long_name"]}
            for one in step["parameters"]]
    return table(rows, ["name", "value", "low", "high", "unit", "words"], "name")


class Diagnosis(Attributes):
    """Which effect is missing in a step's model, without refitting."""

    def __init__(self, told: Dict[str, Any]) -> None:
        self.told = told  #: as `hookeye diagnose --json` prints it

    @property
    def table(self) -> Any:
        """Effects by falling evidence; those that could not be tested last."""
        columns = ["effect", "evidence", "explains", "explains_held_out", "p_value", "weight",
                   "named", "why"]
        rows = [{**{c: one.get(c) for c in columns}, "why": one.get("why", one.get("why_not"))}
                for one in self.told["effects"]]
        return table(rows, columns, "effect")

    @property
    def ties(self) -> List[str]:
        """The leading effect and all that cannot be told from it; empty: none may be named."""
        return self.told["leaders"]

    @property
    def gate(self) -> float:
        """95 % critical value of the evidence over the whole catalogue."""
        return self.told["gate"]

    @property
    def floor(self) -> float:
        return self.told["floor"]["chi"]

    @property
    def verdict(self) -> str:
        return self.told["conclusion"]

    def __repr__(self) -> str:
        return f"<hookeye.Diagnosis: {self.verdict}>"

    def _repr_html_(self) -> str:
        return f"<p>{escape(self.verdict)}</p>" + self.table._repr_html_()


class Report(Dict[str, Any]):
    """What was written: `report` (the file), `bytes`, `reduction`, `faults`, `answer`."""

    def _repr_html_(self) -> str:
        page = pathlib.Path(self["report"]).read_text(encoding="utf-8")
        return f'<iframe srcdoc="{escape(page)}" width="100%" height="800"></iframe>'


class Run(Attributes):
    """A run folder; any opens, whoever made it. Reads the folder anew at every question."""

    def __init__(self, folder: PathLike, _own: Any = None, _capture: Optional[Capture] = None,
                 _kept: Any = None) -> None:
        self._own = _own if _own is not None else _hookeye.Run(folder)
        self._capture = _capture
        self._kept = _kept  # a temporary folder, which goes with the run

    @property
    def folder(self) -> pathlib.Path:
        return pathlib.Path(self._own.folder)

    @property
    def timeline(self) -> Dict[str, Any]:
        """run.json."""
        return self._own.timeline()["timeline"]

    @property
    def capture(self) -> Capture:
        if self._capture is None:
            told = self._own.timeline()
            self._capture = Capture(told["capture"], options=told["timeline"].get("options"))
        return self._capture

    @property
    def steps(self) -> List[Step]:
        told = self._own.timeline()
        return [Step(step, folder) for step, folder in zip(told["timeline"]["steps"], told["steps"])]

    def _newest(self) -> Step:
        steps = self.steps
        if not steps:
            wrong = "the run has no finished step"
            raise InputError(f"{self.folder}: {wrong}", str(self.folder), 0, 0, wrong,
                             "fit or discover into it first")
        return steps[-1]

    @property
    def parameters(self) -> Any:
        """Of the newest step: value, 95 % interval, unit."""
        return self._newest().parameters

    @property
    def converged(self) -> bool:
        return self._newest().converged

    @property
    def answer(self) -> Dict[str, Any]:
        """{material, headline, sentence, misfit}, as the page and the terminal begin."""
        self._newest()
        return self._own.timeline()["answer"]

    @property
    def verdict(self) -> Optional[str]:
        """"explained", "unexplained" ... of a search; None: there was none since the newest step."""
        return self.timeline.get("verdict")

    @property
    def decisions(self) -> Any:
        """The decision log: what was asked of whom, the number, its limit, and the rule's line."""
        columns = ["step", "asked", "candidate", "accepted", "value", "limit", "option", "why",
                   "where", "cpu_s"]
        return table(self._own.decisions(), columns)

    def why(self, effect: EffectLike) -> Any:
        """All that was decided of one effect; printed it is whole."""
        decisions = self._own.decisions()
        of = lambda name: [one for one in decisions if name in one["candidate"].split()]
        # The log tells of an effect in Python, too, whose class is not registered now.
        name = effect if isinstance(effect, str) and of(effect) else registered(effect)
        mine = of(name)
        columns = ["step", "asked", "candidate", "accepted", "value", "limit", "option", "why",
                   "where", "cpu_s"]
        return table(mine, columns)

    def model(self, *, cancel: Any = None) -> Model:
        """The newest step's model, with its intervals."""
        out = Model(self.capture, self._own.model(cancel))
        for one in self._newest().told["parameters"]:
            if one.get("low") is not None and one.get("high") is not None:
                out._intervals[one["name"]] = (one["value"], (one["low"], one["high"]))
        return out

    @property
    def covariance(self) -> Any:
        """Of the newest step's free parameters, as far as the data fix them."""
        told = self._own.covariance(None)
        return _square(told["covariance"], told["names"])

    def samples(self, n: int, seed: int = 0) -> Any:
        """`n` draws from the Laplace approximation of the newest step.

        Normal about the fit with `covariance`, in the logarithm where a parameter is positive, cut
        at its bounds. No posterior was sampled: tails and bends are not there.
        """
        if n < 1:
            raise InputError(f"samples: {n}", wrong=f"samples: {n}", right="a number from 1")
        told = self._own.covariance(None)
        values, positive = told["values"], np.array(told["positive"], dtype=bool)
        scale = np.where(positive, values, 1.0)
        in_x = told["covariance"] / np.outer(scale, scale)
        x = np.random.default_rng(seed).multivariate_normal(np.zeros(len(values)), in_x, size=n,
                                                             method="eigh")
        drawn = np.where(positive, values * np.exp(x), values + x)
        drawn = np.clip(drawn, told["low"], told["high"])
        rows = [dict(zip(told["names"], line)) for line in drawn.tolist()]
        out = table(rows, told["names"])
        if hasattr(out, "attrs"):
            out.attrs["kind"] = "Laplace approximation"
        return out

    def diagnose(self, *, effects: Iterable[EffectLike] = (), on_step: Optional[OnStep] = None,
                 cancel: Any = None) -> Diagnosis:
        """Tests every effect against what the newest step leaves, and writes it down. `effects`:
        classes derived from hookeye.Effect, which are registered before; one that fails is taken
        out again."""
        with _register_all(effects):
            return Diagnosis(self._own.diagnose(listener(on_step), cancel))

    def add(self, effect: EffectLike, *, take_back: bool = False, on_step: Optional[OnStep] = None,
            cancel: Any = None) -> Step:
        """Refits with an effect (or without it again): the next step, diagnosed. A class that fails
        is taken out again, if it was not registered before."""
        with registered_for([effect]) as (name,):
            command = f"hookeye.Run.add({name!r}{', take_back=True' if take_back else ''})"
            self._own.add(name, take_back, command, listener(on_step), cancel)
        return self._newest()

    def report(self, out: PathLike, *, on_step: Optional[OnStep] = None,
               cancel: Any = None) -> "Report":
        """Writes the run as one page that can be mailed; a notebook shows it."""
        told = self._own.report(out, listener(on_step), cancel)
        for fault in told["faults"]:
            _log.warning("%s", fault)
        return Report(told)

    def residuals(self, *, cancel: Any = None) -> Dict[Shot, np.ndarray]:
        """Of the newest step by (example, camera): model less photo over noise, NaN: not counted."""
        return Named("photo of (load case, camera)",
                     {shot: photo for shot, (photo, _) in self._pictures(cancel).items()})

    def pictures(self, *, cancel: Any = None) -> Dict[Shot, np.ndarray]:
        """What the newest step's model shows, linear."""
        return Named("photo of (load case, camera)",
                     {shot: picture for shot, (_, picture) in self._pictures(cancel).items()})

    def fields(self, *, cancel: Any = None) -> Dict[Shot, MeasuredField]:
        """Measured fields with what the newest step's model predicts of them and the residuals, by
        (example, file as the capture names it); those that are held out, too."""
        return fields_of(self._own.fields(cancel))

    def _pictures(self, cancel: Any) -> Dict[Shot, Tuple[np.ndarray, np.ndarray]]:
        planes: Dict[Shot, List[Tuple[np.ndarray, np.ndarray]]] = {}
        for example, camera, _, _, residual, picture in self._own.residuals(cancel):
            planes.setdefault((example, camera), []).append((residual, picture))
        return {shot: all_[0] if len(all_) == 1 else
                (np.stack([r for r, _ in all_], -1), np.stack([p for _, p in all_], -1))
                for shot, all_ in planes.items()}

    def field(self, name: str = "displacement", example: str = "", *, cancel: Any = None) -> Field:
        """"displacement" or "von_mises" of the newest step in an example (default: where it is
        largest)."""
        return Field.of_run(self._own.states(cancel), name, example, self.capture.units)

    def __repr__(self) -> str:
        told = self._own.timeline()
        return told["text"] or f"<hookeye.Run {self.folder}: no finished step>"

    def _repr_html_(self) -> str:
        steps = self.steps
        if not steps:
            return f"<p>{escape(str(self.folder))}: no finished step</p>"
        rows = [{"step": s.name, "residual": s.chi, "held out": s.chi_held_out} for s in steps]
        own = [{k: one.get(k) for k in ("name", "value", "low", "high", "unit")}
               for one in steps[-1].told["parameters"]]
        answer = self.answer
        return (f"<p><b>{escape(answer['headline'])}</b> {escape(answer['sentence'])}</p>"
                + Table(rows, ["step", "residual", "held out"])._repr_html_()
                + Table(own, ["name", "value", "low", "high", "unit"])._repr_html_())


def _square(matrix: np.ndarray, names: Sequence[str]) -> Any:
    pandas = tables.pandas_if_there()
    if pandas is None:
        return matrix
    return pandas.DataFrame(matrix, index=list(names), columns=list(names))


def _out(out: Optional[PathLike]) -> Tuple[PathLike, Any]:
    if out is not None:
        return out, None
    kept = tempfile.TemporaryDirectory(prefix="hookeye-run-")
    return os.path.join(kept.name, "run"), kept


def _register_all(effects: Iterable[EffectLike]) -> ContextManager[List[str]]:
    if isinstance(effects, (str, type)):
        raise TypeError("effects: a list of classes is expected")
    return registered_for(effects)


def _expect_capture(capture: Any) -> None:
    if not isinstance(capture, Capture):
        raise TypeError(f"capture: a hookeye.Capture is expected, not {type(capture).__name__}")


def fit(capture: Capture, model: Optional[Model] = None, out: Optional[PathLike] = None, *,
        iterations: Optional[int] = None, additive: bool = False,
        on_step: Optional[OnStep] = None, cancel: Any = None) -> Run:
    """Fits the model (default: the capture's own) to the photos: step 0 of a run in `out`, which is
    new. Without `out` the folder goes when the Run does. Stopped or failed it leaves nothing."""
    _expect_capture(capture)
    if model is not None and not isinstance(model, Model):
        raise TypeError(f"model: a hookeye.Model is expected, not {type(model).__name__}")
    folder, kept = _out(out)
    command = f"hookeye.fit({str(capture.file)!r})"
    own = _hookeye.fit(capture._own, None if model is None else model._own, folder, iterations,
                       additive, command, listener(on_step), cancel)
    return Run(folder, own, capture, kept)


def discover(capture: Capture, out: Optional[PathLike] = None, *, without: Iterable[str] = (),
             effects: Iterable[EffectLike] = (), on_step: Optional[OnStep] = None,
             cancel: Any = None) -> Run:
    """Fits, diagnoses, adds, until what is left is noise; takes up the run in `out`, if there is
    one. Stopped it leaves the steps that are finished. `effects`: classes derived from
    hookeye.Effect, which are registered before."""
    _expect_capture(capture)
    folder, kept = _out(out)
    command = f"hookeye.discover({str(capture.file)!r})"
    with _register_all(effects):
        own = _hookeye.discover(capture._own, folder, list(without), command, listener(on_step),
                                cancel)
    return Run(folder, own, capture, kept)
