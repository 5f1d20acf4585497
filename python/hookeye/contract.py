"""What every effect keeps: the contract of the catalogue, asked of an effect in Python."""

from __future__ import annotations

from typing import Any, Dict, List

import numpy as np

from . import _hookeye
from ._bridge import Bridge
from ._registered import (is_sensor, known, known_sensors, made, made_sensor, register_sensor,
                          registered)
from ._sensor_bridge import SensorBridge
from .capture import Capture
from .effect import EffectLike
from .errors import EffectError, InputError, SensorError
from .model import Model
from .tables import table


class _Contract:
    """One effect on one capture, at its null and at values that matter."""

    def __init__(self, bridge: Bridge, capture: Capture) -> None:
        self.bridge = bridge
        self.rows: List[Dict[str, Any]] = []
        self.without, self.with_ = Model(capture), Model(capture)
        self.with_.add(bridge.name)
        self.own = [one for one in self.with_._own.parameters()
                    if one["name"].startswith(bridge.name + ".")]
        self.null = np.array([one["value"] for one in self.own])
        self.typical = np.array([one["typical"] for one in self.own])
        high = np.array([one["high"] for one in self.own])
        #: Values that matter, within their bounds.
        self.some = np.where(self.null + self.typical <= high, self.null + self.typical,
                             self.null - self.typical)
        mesh = capture.mesh
        self.size = float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
        s = (mesh.points - mesh.points.mean(axis=0)) / self.size
        self.x = mesh.points + self.size * _bent(s)
        self.along = _wave(s)

    def at(self, values: Any = None, x: Any = None) -> Dict[str, np.ndarray]:
        """`values` None: the model without the effect."""
        model = self.without
        if values is not None:
            model = self.with_
            for one, value in zip(self.own, values):
                model[one["name"]].value = float(value)
        return model._own.probe(self.x if x is None else x, self.along)

    def own_part(self, x: Any = None) -> Dict[str, np.ndarray]:
        """What the effect adds at values that matter."""
        whole, rest = self.at(self.some, x), self.at(None, x)
        return {key: whole[key] - rest[key] for key in rest}

    def asked(self, check: str, value: float, limit: float, method: str, wrong: str) -> None:
        passed = bool(value <= limit)
        self.rows.append({"check": check, "passed": passed, "value": float(value), "limit": limit})
        if not passed:
            raise EffectError(f"effect '{self.bridge.name}': {wrong} ({value:.3g}, at most {limit:g})",
                              self.bridge.name, method)

    # -- the checks

    def words(self) -> None:
        said = self.bridge.sentence(self.some)
        self.asked("its sentence has numbers", float("nan" in said.lower()), 0.0, "sentence",
                   f"the sentence says {said!r}")

    def null_changes_nothing(self) -> None:
        before, after = self.at(), self.at(self.null)
        worst = max(float(np.abs(after[key] - before[key]).max()) for key in before)
        self.asked("null changes nothing", worst, 0.0, "parameters",
                   "at its null values the model is not the same")

    def begins_at_its_null(self) -> None:
        rest = self.at(self.null)
        near, far = (self.at(self.null + share * (self.some - self.null)) for share in (1e-4, 1.0))
        for key in ("forces", "numbers"):
            whole = float(np.linalg.norm(far[key] - rest[key]))
            jump = float(np.linalg.norm(near[key] - rest[key]))
            self.asked(f"{key} begin at the null", jump / max(whole, 1e-300), 0.01, "parameters",
                       "it jumps where it leaves its null: the null is no null")

    def does_something(self) -> None:
        part = self.own_part()
        moved = max(float(np.abs(part[key]).max()) for key in ("forces", "numbers"))
        self.asked("values that matter change something", float(moved == 0.0), 0.0, "parameters",
                   "at values that matter the model is the same as without it")

    def is_deterministic(self) -> None:
        one, other = self.at(self.some), self.at(self.some)
        worst = max(float(np.abs(one[key] - other[key]).max()) for key in one)
        self.asked("the same twice", worst, 0.0, "", "asked twice it answers differently")

    def forces_are_those_of_the_energy(self) -> None:
        h = 1e-5 * self.size
        up, down = (self.own_part(self.x + side * h * self.along) for side in (1, -1))
        slope = (up["energy"] - down["energy"]) / (2 * h)
        here = (self.own_part()["forces"] * self.along.ravel()).sum(axis=1)
        scale = max(float(np.abs(here).max()), 1e-300)
        self.asked("stress is the energy's derivative", float(np.abs(slope - here).max()) / scale,
                   1e-5, "stress", "the stress is not the derivative of the energy")

    def tangent_is_that_of_the_forces(self) -> None:
        h = 1e-5 * self.size
        up, down = (self.own_part(self.x + side * h * self.along) for side in (1, -1))
        slope, here = (up["forces"] - down["forces"]) / (2 * h), self.own_part()["tangent"]
        # A force that does not depend on place has no tangent: then noise is held against forces.
        scale = max(float(np.linalg.norm(here)), 1e-5 * float(np.linalg.norm(up["forces"])) / h,
                    1e-300)
        self.asked("stiffness is the force's derivative", float(np.linalg.norm(slope - here)) / scale,
                   1e-5, "stiffness" if self.bridge.kinds["energy"] else self.bridge.force_method,
                   "the stiffness is not the derivative of the force (methods are called with complex "
                   "arrays, too: no abs(), real, float or arrays of real numbers to write into)")

    def turns_with_the_body(self) -> None:
        turn = _rotation(np.array([0.3, -0.8, 0.5]), 1.1)
        before, after = self.own_part(), self.own_part(self.x @ turn.T)
        scale = max(float(np.abs(before["energy"]).max()), 1e-300)
        self.asked("a turned body has the same energy",
                   float(np.abs(after["energy"] - before["energy"]).max()) / scale, 1e-9, "energy",
                   "the energy changes where the body is turned as a whole")

    def has_slopes(self) -> None:
        """Central differences by each parameter settle as their step is halved."""
        for k, one in enumerate(self.own):
            d = [self._difference(k, 0.02 * self.typical[k] / 2**i) for i in range(3)]
            noise = 1e-9 * np.linalg.norm(d[2]) + 1e-12 * self._scale() / self.typical[k]
            self.asked(f"{one['name']} has a slope at its null", float(np.linalg.norm(d[2]) <= noise),
                       0.0, "parameters", f"{one['name']} changes nothing to first order at its null")
            coarse, fine = np.linalg.norm(d[0] - d[1]), np.linalg.norm(d[1] - d[2])
            self.asked(f"{one['name']} is smooth", float(fine), max(0.35 * float(coarse), float(noise)),
                       "parameters", f"no derivative by {one['name']} comes out at its null")

    def _scale(self) -> float:
        before = self.at()
        return float(np.linalg.norm(np.append(before["forces"].ravel(), before["numbers"])))

    def _difference(self, k: int, h: float) -> np.ndarray:
        def moved(step: float) -> np.ndarray:
            values = self.null.copy()
            values[k] += step
            told = self.at(values)
            return np.append(told["forces"].ravel(), told["numbers"])

        if self.null[k] - h < self.own[k]["low"]:
            return (-1.5 * moved(0) + 2 * moved(h) - 0.5 * moved(2 * h)) / h
        if self.null[k] + h > self.own[k]["high"]:
            return (1.5 * moved(0) - 2 * moved(-h) + 0.5 * moved(-2 * h)) / h
        return (moved(h) - moved(-h)) / (2 * h)

    def run(self) -> None:
        self.words()
        self.null_changes_nothing()
        self.does_something()
        self.begins_at_its_null()
        self.is_deterministic()
        self.has_slopes()
        if self.bridge.kinds["energy"]:
            self.turns_with_the_body()
            self.forces_are_those_of_the_energy()
        if self.bridge.kinds["energy"] or self.bridge.kinds["follows"]:
            self.tangent_is_that_of_the_forces()


def _bent(s: np.ndarray) -> np.ndarray:
    """Stretched, bent and twisted by some per cent: nothing is turned inside out."""
    return np.column_stack([0.08 * s[:, 2]**2 + 0.03 * s[:, 0], 0.04 * s[:, 1] - 0.1 * s[:, 0] * s[:, 2],
                            0.12 * s[:, 2] + 0.1 * s[:, 0] * s[:, 1]])


def _wave(s: np.ndarray) -> np.ndarray:
    wave = 2 * np.pi * s
    return np.column_stack([np.sin(wave[:, 1] + 1), np.sin(wave[:, 2]), np.cos(wave[:, 0])])


def _rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    n = axis / np.linalg.norm(axis)
    cross = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def check_effect(effect: EffectLike, capture: Capture) -> Any:
    """Asks an effect in Python what the program relies on, on the body of a capture.

    At its null it changes nothing; its derivatives are those of finite differences; an energy does
    not know how the body is turned; it answers the same twice. Returns a table of the checks, or
    raises EffectError for the first that fails.
    """
    if isinstance(effect, str):
        raise TypeError("effect: a class derived from hookeye.Effect is expected")
    if not isinstance(capture, Capture):
        raise TypeError(f"capture: a hookeye.Capture is expected, not {type(capture).__name__}")
    bridge = Bridge(made(effect))
    there = bridge.name in known
    registered(effect)
    try:
        contract = _Contract(bridge, capture)
        contract.bridge.names = [one["name"].split(".", 1)[1] for one in contract.own]
        contract.run()
    finally:
        if not there:
            known.pop(bridge.name, None)
            _hookeye.unregister_effect(bridge.name)
    return table(contract.rows, ["check", "passed", "value", "limit"])


class _SensorContract:
    """One sensor on the body of a capture, bent."""

    def __init__(self, bridge: SensorBridge, capture: Capture) -> None:
        self.bridge = bridge
        self.rows: List[Dict[str, Any]] = []
        mesh = capture.mesh
        for region in bridge.regions:
            if region not in mesh.regions:
                wrong = f"the sensor '{bridge.name}' looks at the unknown region '{region}'"
                right = f"the capture has {', '.join(mesh.regions)}"
                raise InputError(f"{wrong}\n  {right}", wrong=wrong, right=right)
        nodes = [mesh.regions[region]["nodes"] for region in bridge.regions]
        rest = mesh.points[np.concatenate(nodes)] if nodes else bridge.points
        self.counts = [len(one) for one in nodes] or [len(rest)]
        size = float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
        s = (rest - mesh.points.mean(axis=0)) / size
        self.u = size * _bent(s)
        self.x = rest + self.u
        #: The points move; and the whole body is placed elsewhere, with and without a turn.
        turned = np.cross([0.3, -0.8, 0.5], self.x), np.cross([0.3, -0.8, 0.5], self.u)
        wave = size * _wave(s)
        self.ways = [(wave, wave), (np.tile([0.2, 0.5, -0.7], (len(s), 1)) * size, 0 * wave), turned]
        self.example = next(iter(capture.examples), "")

    def asked(self, check: str, value: float, limit: float, method: str, wrong: str) -> None:
        passed = bool(value <= limit)
        self.rows.append({"check": check, "passed": passed, "value": float(value), "limit": limit})
        if not passed:
            raise SensorError(f"sensor '{self.bridge.name}': {wrong} ({value:.3g}, at most {limit:g})",
                              self.bridge.name, method)

    def run(self) -> None:
        at = (self.counts, self.example)
        none = np.empty((0, *self.x.shape))
        value, _ = self.bridge.answer(self.x, self.u, none, none, *at)
        again, _ = self.bridge.answer(self.x, self.u, none, none, *at)
        self.asked("the same twice", float(value.shape != again.shape or (value != again).any()), 0.0,
                   "predict", "asked twice it answers differently")
        given = np.stack([self.bridge.along(self.x, self.u, dx, du, *at, len(value))
                          for dx, du in self.ways])
        self.asked("it sees motion", float(not given.any()), 0.0, "predict",
                   "whatever moves, its numbers stay as they are")
        method = "derivative" if hasattr(self.bridge.own, "derivative") else "predict"
        scale = float(np.abs(given).max())
        for (dx, du), own in zip(self.ways, given):
            coarse, fine = (self.bridge.difference(self.x, self.u, dx, du, *at, share)
                            for share in (4e-4, 2e-4))
            # Of second order: Richardson's value, and how far it may be off.
            slope, error = fine + (fine - coarse) / 3, np.abs(fine - coarse).max()
            self.asked("its derivative is that of finite differences",
                       float(np.abs(own - slope).max()) / scale, float(1e-6 + error / scale), method,
                       "the derivative is not that of predict(): abs(), a branch or a wrong formula")


def check_sensor(sensor: Any, capture: Capture) -> Any:
    """Asks a sensor in Python what the program relies on, on the body of a capture, bent and moved.

    It answers the same twice, it sees motion, and its derivative (by its class, by complex steps or by
    differences) is that of finite differences. Returns a table of the checks, or raises SensorError for
    the first that fails. It need not be registered.
    """
    if not is_sensor(sensor):
        raise TypeError(f"sensor: a class derived from hookeye.Sensor is expected, not {sensor!r}")
    if not isinstance(capture, Capture):
        raise TypeError(f"capture: a hookeye.Capture is expected, not {type(capture).__name__}")
    bridge = SensorBridge(made_sensor(sensor))
    there = bridge.name in known_sensors
    if not there:  # the capture may name it
        register_sensor(bridge.own)
    try:
        contract = _SensorContract(bridge, capture)
        contract.run()
    finally:
        if not there:
            known_sensors.pop(bridge.name, None)
            _hookeye.unregister_sensor(bridge.name)
    return table(contract.rows, ["check", "passed", "value", "limit"])
