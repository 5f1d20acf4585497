"""How many cores the work may use."""

from . import _hookeye


def set_threads(count: int) -> None:
    """Uses so many cores from now on; 0: all."""
    _hookeye.set_threads(count)
