"""Effects that were put beside those built in."""

from __future__ import annotations

from typing import Any, Dict, Tuple

from . import _hookeye
from ._bridge import Bridge, bad, name_of
from .effect import Effect, EffectLike
from .errors import EffectError


def register(effect: EffectLike) -> str:
    """Puts an effect beside those built in, until the program ends; one registered before under the
    same name goes. Returns the name."""
    return registered(effect)


def unregister(effect: EffectLike) -> None:
    """Takes an effect out again. Models and runs that have it are not opened any more."""
    name = effect if isinstance(effect, str) else name_of(made(effect))
    known.pop(name, None)
    if not _hookeye.unregister_effect(name):
        raise bad(f"no effect '{name}' is registered", "hookeye.effects() lists all")


def registered(effect: EffectLike) -> str:
    """The name, for C++; a class is registered, unless the very same is."""
    if isinstance(effect, str):
        return effect
    bridge = Bridge(made(effect))
    if known.get(bridge.name) != (bridge.own.__class__, bridge.code) or isinstance(effect, Effect):
        _hookeye.register_effect(bridge)
        known[bridge.name] = (bridge.own.__class__, bridge.code)
    return bridge.name


known: Dict[str, Tuple[type, str]] = {}


def made(effect: Any) -> Effect:
    if isinstance(effect, Effect):
        return effect
    if isinstance(effect, type) and issubclass(effect, Effect):
        try:
            return effect()
        except Exception as error:
            raise EffectError(f"effect {effect.__name__}: cannot be made without arguments: {error}",
                              effect.__name__, "__init__") from error
    raise TypeError(f"effect: a class derived from hookeye.Effect is expected, not {effect!r}")
