"""Sensors written in Python: the same numbers as those built in, and what goes wrong is said."""

import subprocess

import numpy as np
import pytest
import yaml
from conftest import PROGRAM

import hookeye as he

ALONG = np.array([1.0, 2.0, 2.0]) / 3


class Jaw(he.Sensor):
    """travel_of, written anew."""

    unit = "mm"
    region = "grip"

    def predict(self, x, u):
        return (u @ ALONG).mean()


class JawByDifferences(Jaw):
    name = "jaw"
    differences = True


class JawByItself(Jaw):
    name = "jaw"

    def derivative(self, x, u, dx, du):
        return (du @ ALONG).mean()


class Tip(he.Sensor):
    """position_of, written anew."""

    points = [[0.0, 0.0, 34.0]]

    def predict(self, x, u):
        return x[0]


class Stretch(he.Sensor):
    """How far two regions are apart: no such sensor is built in."""

    regions = ("base", "grip")

    def predict(self, x, u, example):
        assert example
        d = x["grip"].mean(axis=0) - x["base"].mean(axis=0)
        return np.array([np.sqrt((d * d).sum()), (d * d).sum()])


@pytest.fixture(autouse=True)
def nothing_stays():
    yield
    from hookeye._registered import known_sensors

    for name in list(known_sensors):
        he.unregister(name)


@pytest.fixture
def measured(capture, folder, tmp_path):
    """Captures of the same photos: `with_them([...])` has these measurements in its load case `pull`."""
    def with_them(measured):
        told = yaml.safe_load(capture.file.read_text())
        told["examples"]["pull"]["measured"] = measured
        made = tmp_path / f"capture{len(list(tmp_path.iterdir()))}"
        import shutil

        shutil.copytree(folder / "capture", made)
        (made / "capture.yaml").write_text(yaml.safe_dump(told, sort_keys=False))
        return made

    return with_them


def told_of(capture, like):
    """What the model itself predicts, moved: something for a fit to do."""
    model = he.Capture(capture).model()
    return {one["kind"]: one["predicted"] for one in model.evaluate().measured if one["example"] == like}


BUILT_IN = {"travel_of": "grip", "along": ALONG.tolist(), "value": 2.4, "sigma": 0.01}
OWN = {"sensor": "jaw", "value": 2.4, "sigma": 0.01}


def test_a_jaw_in_python_fits_as_the_one_built_in(measured, tmp_path):
    runs = [he.fit(he.Capture(measured([BUILT_IN])), out=tmp_path / "built_in")]
    for i, jaw in enumerate((Jaw, JawByItself, JawByDifferences)):
        assert he.register(jaw) == "jaw"
        runs.append(he.fit(he.Capture(measured([OWN])), out=tmp_path / f"own{i}"))
    values = [list(run.parameters["value"]) for run in runs]
    for own, tolerance in zip(values[1:], (1e-6, 1e-6, 1e-6)):
        np.testing.assert_allclose(own, values[0], rtol=tolerance)
    # The measurement does something: without it the fit is another.
    without = he.fit(he.Capture(measured([])), out=tmp_path / "without")
    assert abs(list(without.parameters["value"])[0] / values[0][0] - 1) > 1e-4
    told = runs[1].steps[0].metrics["measured"][0]
    assert told["kind"] == "sensor" and told["region"] == "jaw" and told["unit"] == "mm"


def test_positions_turn_and_move_with_the_placement(measured):
    he.register(Tip)
    capture = he.Capture(measured([
        {"position_of": [0.0, 0.0, 34.0], "value": [0, 0, 35], "sigma": 0.1},
        {"sensor": "tip", "value": [0, 0, 35], "sigma": 0.1}]))
    model = capture.model()
    model.add("placement")
    for one in model.parameters:
        if one.startswith("placement."):
            model[one].value = 0.01
    told = model.evaluate(jac=True)
    built_in, own = told.measured
    np.testing.assert_allclose(own["predicted"], built_in["predicted"], rtol=1e-12)
    assert np.abs(told.JTr).max() > 0


def test_several_regions_and_numbers(measured):
    he.register(Stretch)
    capture = he.Capture(measured([{"sensor": "stretch", "value": [30, 900], "sigma": [0.1, 6]}]))
    one = capture.model().evaluate().measured[0]
    assert one["kind"] == "sensor" and one["region"] == "stretch" and one["predicted"][1] == pytest.approx(one["predicted"][0] ** 2)


@pytest.mark.parametrize("sensor", [Jaw, JawByDifferences, JawByItself, Tip, Stretch])
def test_the_contract_holds(capture, sensor):
    table = he.check_sensor(sensor, capture)
    assert all(table["passed"]) and "it sees motion" in list(table["check"])


def test_the_contract_can_be_asked_of_a_capture_that_names_it(measured):
    capture = he.Capture(measured([OWN]))
    assert all(he.check_sensor(Jaw, capture)["passed"])
    with pytest.raises(he.InputError, match="no sensor"):
        he.unregister(Jaw)


class Wrong(Jaw):
    def derivative(self, x, u, dx, du):
        return 1.1 * (du @ ALONG).mean()


class PartlyReal(Jaw):
    def predict(self, x, u):
        return (u @ ALONG).mean() + abs(x[0, 0])


class Deaf(Jaw):
    def predict(self, x, u):
        return 0 * x[0, 0] + 1


class Random(Jaw):
    def predict(self, x, u):
        return u[0, 0] + np.random.default_rng().normal()


class Elsewhere(Jaw):
    region = "handle"


@pytest.mark.parametrize("sensor, says", [
    (Wrong, "derivative"), (PartlyReal, "derivative"), (Deaf, "whatever moves"),
    (Random, "asked twice")])
def test_what_breaks_the_contract_is_named(capture, sensor, says):
    with pytest.raises(he.SensorError, match=says) as raised:
        he.check_sensor(sensor, capture)
    assert raised.value.sensor == raised.value.sensor.lower()


def broken(method):
    return type("Jaw", (he.Sensor,), {"region": "grip", "predict": method})


@pytest.mark.parametrize("method, says", [
    (lambda self, x, u: float("nan"), "finite numbers"),
    (lambda self, x, u: u, "shape"),
    (lambda self, x, u: "far", "dtype"),
    (lambda self, x, u: 1 / 0, "ZeroDivisionError"),
    (lambda self, x, u: float(abs(u).sum()), "no derivative comes out"),
])
def test_what_goes_wrong_inside_comes_out(measured, tmp_path, method, says):
    he.register(broken(method))
    capture = he.Capture(measured([OWN]))
    with pytest.raises(he.SensorError, match=says) as raised:
        he.fit(capture, out=tmp_path / "run")
    assert raised.value.sensor == "jaw" and raised.value.method == "predict"
    assert (raised.value.__cause__ is not None) == (says == "ZeroDivisionError")
    assert not (tmp_path / "run/steps").exists() or not list((tmp_path / "run/steps").iterdir())


def test_a_sensor_that_is_not_there_has_its_place(measured):
    capture = measured([OWN])
    with pytest.raises(he.InputError, match="there is no sensor `jaw`") as raised:
        he.Capture(capture).model()
    assert raised.value.file.endswith("capture.yaml") and raised.value.line > 0
    done = subprocess.run([PROGRAM, "check", capture], capture_output=True, text=True)
    assert done.returncode == 2 and "written in Python" in done.stderr and "capture.yaml:" in done.stderr


def test_a_sensor_that_does_not_fit_the_capture(measured):
    he.register(type("Jaw", (Elsewhere,), {}))
    with pytest.raises(he.InputError, match="unknown region `handle`"):
        he.Capture(measured([OWN])).model()
    he.register(Jaw)
    with pytest.raises(he.InputError, match="`value` has 2 numbers, and the sensor `jaw` predicts 1") as raised:
        he.Capture(measured([{**OWN, "value": [1, 2]}])).model().evaluate()
    assert raised.value.line > 0


@pytest.mark.parametrize("told, says", [
    ({"predict": he.Sensor.predict}, "no predict"),
    ({"region": ""}, "looks at nothing"),
    ({"points": [[0, 0, 1]]}, "one of region, regions and points"),
    ({"region": "", "points": [[0, float("nan"), 1]]}, "points"),
    ({"region": "", "regions": (1, 2)}, "regions are names"),
    ({"unit": 3}, "unit"),
    ({"name": "Jaw 2"}, "cannot have the name"),
])
def test_a_class_that_is_none_is_refused(told, says):
    with pytest.raises(he.InputError, match=says):
        he.register(type("Jaw", (Jaw,), told))
    with pytest.raises(he.InputError, match="no sensor"):
        he.unregister(Jaw)
