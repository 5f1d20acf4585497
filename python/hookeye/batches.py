"""One verb over many captures: what `hookeye batch` does, over the same folder."""

from __future__ import annotations

import logging
import os
import pathlib
from typing import Any, Dict, Iterable, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

from . import _hookeye
from ._named import Attributes, one_of
from ._registered import known, known_sensors
from .capture import Capture
from .errors import InputError, UnknownName
from .progress import OnStep, listener
from .run import Run
from .tables import Table, table

PathLike = Union[str, "os.PathLike[str]"]
Given = Union[PathLike, Capture]
_log = logging.getLogger("hookeye")

_COLUMNS = ("label", "state", "verdict", "found", "chi_fit", "chi_validate", "floor", "seconds",
            "exit", "error", "capture", "options")


class Batch(Attributes):
    """The folder of a batch, and a row a capture, in the order of the list."""

    def __init__(self, folder: str, rows: List[Dict[str, Any]]) -> None:
        self.folder = pathlib.Path(folder)
        #: As `hookeye batch --json` prints them: label, state, verdict, found, parameters, ...
        self.rows = rows

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Dict[str, Any]]:
        return iter(self.rows)

    def __getitem__(self, label: str) -> Dict[str, Any]:
        for row in self.rows:
            if row["label"] == label:
                return row
        wrong, right = f"there is no capture {label!r}", one_of(label, [row["label"] for row in self.rows])
        raise UnknownName(f"{wrong}\n  {right}", wrong=wrong, right=right)

    @property
    def table(self) -> Any:
        """A row a capture; of each parameter its value, `_low` and `_high`. index.csv holds all."""
        names = list(dict.fromkeys(one["name"] for row in self.rows for one in row["parameters"]))
        columns = list(_COLUMNS[:4]) + [n + end for n in names for end in ("", "_low", "_high")]
        columns += _COLUMNS[4:]
        return table([_flat(row) for row in self.rows], columns, "label")

    @property
    def failed(self) -> List[Dict[str, Any]]:
        return [row for row in self.rows if row["state"] == "failed"]

    def run(self, label: str) -> Run:
        """The run of a capture, opened."""
        row = self[label]
        if row["state"] != "done":
            wrong = f"{label}: {row['error'] or row['state']}"
            raise InputError(wrong, row["capture"], wrong=wrong, right="a capture that is done")
        return Run(self.folder / row["run"])

    @property
    def page(self) -> pathlib.Path:
        """One page of all captures."""
        return self.folder / "index.html"

    def __repr__(self) -> str:
        done = sum(row["state"] == "done" for row in self.rows)
        return (f"<hookeye.Batch {self.folder}: {len(self.rows)} captures, {done} done, "
                f"{len(self.failed)} failed>")

    def _repr_html_(self) -> str:
        rows = [_flat(row) for row in self.rows]
        return Table(rows, ["label", "state", "verdict", "found", "error"])._repr_html_()


def _flat(row: Dict[str, Any]) -> Dict[str, Any]:
    out = {key: row.get(key) for key in _COLUMNS}
    out["found"], out["options"] = " ".join(row["found"]), " ".join(row["options"])
    for one in row["parameters"]:
        for end, key in (("", "value"), ("_low", "low"), ("_high", "high")):
            out[one["name"] + end] = one[key]
    return out


def _options(given: Mapping[str, Any], what: str) -> List[Tuple[str, List[str]]]:
    """{"without": ["creep"], "set": {"fit.pixels": 0}, "additive": True} as names and values."""
    if not isinstance(given, Mapping):
        raise TypeError(f"{what}: a dict of options is expected, not {type(given).__name__}")
    out: List[Tuple[str, List[str]]] = []
    for name, value in given.items():
        if value is None or value is False:
            continue
        if value is True:
            out.append((name, []))
        elif isinstance(value, Mapping):
            out.append((name, [f"{key}={one}" for key, one in value.items()]))
        elif isinstance(value, (str, os.PathLike)) or not isinstance(value, Iterable):
            out.append((name, [os.fspath(value) if isinstance(value, os.PathLike) else str(value)]))
        else:
            out.append((name, [str(one) for one in value]))
    return out


def _listed(captures: Union[Given, Iterable[Given], Mapping[str, Given]]) -> List[Any]:
    if isinstance(captures, Mapping):
        named: Sequence[Tuple[str, Any]] = [(str(name), one) for name, one in captures.items()]
    elif isinstance(captures, (str, os.PathLike, Capture)):
        named = [("", captures)]
    else:
        named = [("", one) for one in captures]
    out = []
    for name, one in named:
        if isinstance(one, Capture):
            own = _options({"set": one.options} if one.options else {}, "options")
            out.append((os.fspath(one.file), name, own))
        else:
            out.append((os.fspath(one), name, []))
    return out


def batch(captures: Union[Given, Iterable[Given], Mapping[str, Given]], verb: str = "discover",
          out: PathLike = "runs", *, options: Optional[Mapping[str, Any]] = None, jobs: int = 0,
          threads: int = 0, memory: Union[str, float, None] = None, timeout: float = 0.0,
          retry: bool = False, reports: bool = True, program: PathLike = "",
          on_step: Optional[OnStep] = None, cancel: Any = None) -> Batch:
    """A verb over many captures, a process each; the same call goes on where it was stopped.

    captures: folders, patterns, lists and tables (csv) as the command takes them, or hookeye.Capture;
    a dict gives names. verb: discover, fit, check, simulate, render. out: the folder, which
    `hookeye batch` goes on with, too. options: of the verb, as {"without": ["creep"], "set":
    {"fit.pixels": 0}}. jobs, threads: captures at once and cores of each (0: as the machine allows);
    memory: of a process, as "4G"; timeout: seconds of a capture. retry: what has failed. reports: a
    page of every run. program: the program hookeye, where it is not found.

    A capture that fails stops no other: its row says so. Ctrl-C stops all in order.
    """
    for what, number in (("jobs", jobs), ("threads", threads), ("timeout", timeout)):
        if not 0 <= number < float("inf"):
            raise InputError(f"{what}: {number}", wrong=f"{what}: {number}", right="from 1, or 0")
    own = [*known, *known_sensors]
    if own:
        _log.warning("%s", f"written in Python, so that the processes of a batch do not know it: "
                           f"{', '.join(own)}")
    how = {"program": os.fspath(program), "jobs": jobs, "threads": threads, "memory": memory,
           "timeout": float(timeout), "retry": retry, "reports": reports}
    return Batch(*_hookeye.batch(_listed(captures), verb, out, _options(options or {}, "options"),
                                 how, listener(on_step), cancel))
