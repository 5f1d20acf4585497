"""What the program knows: its effects, and the numbers that it decides by."""

from __future__ import annotations

from typing import Any

from . import _hookeye
from .tables import table


def effects() -> Any:
    """The catalogue: name, group, title, manual of each."""
    return table(_hookeye.effects(), ["name", "group", "title", "manual"], "name")


def options() -> Any:
    """Every number that a fit or a search decides by: what `Capture(options=...)` may set."""
    columns = ["name", "standard", "low", "high", "unit", "what", "source"]
    return table(_hookeye.options(), columns, "name")
