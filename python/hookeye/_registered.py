"""Effects and sensors that were put beside those built in."""

from __future__ import annotations

import contextlib
from typing import Any, Dict, Iterable, Iterator, List, Tuple, Union

from . import _hookeye
from ._bridge import Bridge, bad, name_of
from ._named import one_of
from ._sensor_bridge import SensorBridge
from .effect import Effect, EffectLike
from .errors import EffectError, SensorError
from .sensor import Sensor


def register(effect: Union[EffectLike, Sensor]) -> str:
    """Puts an effect or a sensor beside those built in, until the program ends; one registered before
    under the same name goes. Returns the name."""
    return register_sensor(effect) if is_sensor(effect) else registered(effect)


def unregister(effect: Union[EffectLike, Sensor]) -> None:
    """Takes an effect or a sensor out again. Captures, models and runs that have it are not opened any
    more."""
    if is_sensor(effect) or (isinstance(effect, str) and effect in known_sensors):
        name = effect if isinstance(effect, str) else SensorBridge(made_sensor(effect)).name
        known_sensors.pop(name, None)
        if not _hookeye.unregister_sensor(name):
            raise bad(f"no sensor '{name}' is registered", "hookeye.register() of its class")
        return
    name = effect if isinstance(effect, str) else name_of(made(effect))
    known.pop(name, None)
    if not _hookeye.unregister_effect(name):
        raise bad(f"no effect '{name}' is registered", "hookeye.effects() lists all")


def registered(effect: EffectLike) -> str:
    """The name, for C++; a class is registered, unless the very same is."""
    if isinstance(effect, str):
        names = [one["name"] for one in _hookeye.effects()]
        if effect not in names:
            raise bad(f"there is no effect '{effect}'",
                      f"{one_of(effect, names)}; one written in Python is registered first: "
                      "hookeye.register(...) of the class of this name")
        return effect
    bridge = Bridge(made(effect))
    if known.get(bridge.name) != (bridge.own.__class__, bridge.code) or isinstance(effect, Effect):
        _hookeye.register_effect(bridge)
        known[bridge.name] = (bridge.own.__class__, bridge.code)
    return bridge.name


@contextlib.contextmanager
def registered_for(effects: Iterable[EffectLike]) -> Iterator[List[str]]:
    """Registers classes, and yields their names. One that fails in the work that follows, and was
    not there before, goes again: else it would fail in all that is asked later."""
    before = dict(known)
    names = [registered(effect) for effect in effects]
    try:
        yield names
    except EffectError as error:
        if error.effect in names and error.effect in known and error.effect not in before:
            known.pop(error.effect)
            _hookeye.unregister_effect(error.effect)
        raise


known: Dict[str, Tuple[type, str]] = {}
#: The same of sensors.
known_sensors: Dict[str, Tuple[type, str]] = {}


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


def is_sensor(given: Any) -> bool:
    return isinstance(given, Sensor) or (isinstance(given, type) and issubclass(given, Sensor))


def made_sensor(sensor: Any) -> Sensor:
    if isinstance(sensor, Sensor):
        return sensor
    try:
        return sensor()
    except Exception as error:
        raise SensorError(f"sensor {sensor.__name__}: cannot be made without arguments: {error}",
                          sensor.__name__, "__init__") from error


def register_sensor(sensor: Any) -> str:
    bridge = SensorBridge(made_sensor(sensor))
    _hookeye.register_sensor(bridge, bridge.code)
    known_sensors[bridge.name] = (bridge.own.__class__, bridge.code)
    return bridge.name
