"""What `on_step` is told, and a bar for it."""

from __future__ import annotations

import logging
from typing import Any, Callable, NamedTuple, Optional


class Progress(NamedTuple):
    """What `on_step` is told. work: "fit" (of its iterations), "diagnose", "report", or "step" once
    one is written; stage: "1/8 size", "motion", or the step's name; chi: 0 where it is not known."""

    work: str
    stage: str
    done: int
    of: int
    chi: float


OnStep = Callable[[Progress], Any]


def listener(on_step: Optional[OnStep]) -> Any:
    if on_step is None:
        return None
    if not callable(on_step):
        raise TypeError("on_step: a function of one Progress is expected")
    return lambda *told: on_step(Progress(*told))


class ProgressBar:
    """`he.fit(capture, on_step=he.ProgressBar())`: tqdm's bar (in a notebook, too) where tqdm is
    installed, else a log line for every stage."""

    def __init__(self) -> None:
        self._stage = ("", "")
        self._bar: Any = None
        try:
            from tqdm.auto import tqdm

            self._tqdm: Any = tqdm
        except ImportError:
            self._tqdm = None

    def __call__(self, now: Any) -> None:
        title = f"{now.work} {now.stage}".strip()
        if (now.work, now.stage) != self._stage:
            self._stage = (now.work, now.stage)
            self.close()
            if self._tqdm is None:
                logging.getLogger("hookeye").info("%s", title)
            elif now.work != "step":
                self._bar = self._tqdm(total=now.of or None, desc=title, leave=False)
        if self._bar is not None:
            self._bar.total = now.of or None
            self._bar.n = now.done
            if now.chi > 0:
                self._bar.set_postfix(residual=f"{now.chi:.3f}", refresh=False)
            self._bar.refresh()

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None
