"""What answers to names: an unknown one is an error that says which there are."""

from __future__ import annotations

import difflib
from typing import Any, Dict, Iterable, TypeVar

from .errors import UnknownName

Value = TypeVar("Value")


def one_of(name: Any, known: Iterable[Any]) -> str:
    """"did you mean 'front'? One of front, side"."""
    words = [str(one) for one in known]
    if not words:
        return "there is none"
    near = difflib.get_close_matches(str(name), words, 1)
    return (f"did you mean {near[0]!r}? " if near else "") + f"one of {', '.join(words)}"


class Named(Dict[Any, Value]):
    """A dict whose unknown key is an UnknownName (a KeyError, and an InputError). `what` a key names."""

    def __init__(self, what: str, content: Any = ()) -> None:
        super().__init__(content)
        self._what = what

    def __missing__(self, key: Any) -> Value:
        wrong = f"there is no {self._what} {key!r}"
        right = one_of(key, [repr(one) for one in self])
        raise UnknownName(f"{wrong}\n  {right}", wrong=wrong, right=right)

    def __reduce__(self) -> Any:
        return (Named, (self._what, dict(self)))


class Attributes:
    """An attribute that there is not: the error says which there are."""

    def __getattr__(self, name: str) -> Any:
        own = type(self)
        if name.startswith("_"):
            raise AttributeError(f"{own.__name__} has no '{name}'")
        if hasattr(own, name):  # a property's own AttributeError
            return object.__getattribute__(self, name)
        known = sorted({one for one in (*dir(own), *getattr(self, "__dict__", ())) if not one.startswith("_")})
        raise AttributeError(f"{own.__name__} has no '{name}': {one_of(name, known)}")
