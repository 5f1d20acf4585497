"""Effects written in Python: the same numbers as those built in, and what goes wrong is said."""

import threading

import numpy as np
import pytest

import hookeye as he


class Yeoh(he.Effect):
    """The built-in strain stiffening, written anew. Easily taken for it."""

    title = "stiffening in Python"

    def parameters(self, setup):
        mu = setup.shear_modulus
        return {name: {"unit": setup.stress, "typical": 0.5 * mu, "low": -mu, "words": "modulus"}
                for name in ("c2", "c3")}

    def energy_of_invariants(self, I1, I2, J, c2, c3):
        return c2 * (I1 - 3) ** 2 + c3 * (I1 - 3) ** 3


class YeohOfF(he.Effect):
    """The same of the deformation gradient."""

    parameters = Yeoh.parameters

    def energy(self, F, c2, c3):
        i = he.determinant(F) ** (-2 / 3) * np.einsum("...ij,...ij->...", F, F) - 3
        return (c2 + c3 * i) * i * i


class YeohByStress(YeohOfF):
    """The same, which knows its stress."""

    def stress(self, F, c2, c3):
        J = he.determinant(F)[..., None, None]
        I1 = J ** (-2 / 3) * (F * F).sum((-1, -2))[..., None, None]
        dI1 = 2 * J ** (-2 / 3) * F - 2 / 3 * I1 * he.cofactor(F) / J
        return (2 * c2 * (I1 - 3) + 3 * c3 * (I1 - 3) ** 2) * dI1


class Weight(he.Effect):
    """The body's own weight, as a force on its volume. Easily taken for swelling."""

    parameters = {"g" + axis: {"unit": "N/mm^3", "typical": 1e-5, "words": f"weight along {axis}"}
                  for axis in "xyz"}

    def body_force(self, X, gx, gy, gz):
        return np.broadcast_to([gx, gy, gz], X.shape)


class Spring(he.Effect):
    """The surface stands in a bed of springs. Easily taken for a stiffer material."""

    title = "a bed of springs"
    parameters = {"k": {"unit": "MPa/mm", "typical": 1e-4, "low": 0, "words": "stiffness"}}

    def traction(self, X, x, k):
        return k * (X - x)

    def sentence(self, k):
        return f"springs of {k:.3g} all around"


@pytest.fixture(autouse=True)
def nothing_stays():
    yield
    from hookeye import _hookeye
    from hookeye._registered import known

    for name in list(known):
        _hookeye.unregister_effect(name)
    known.clear()


@pytest.mark.parametrize("effect, tolerance", [(Yeoh, 1e-9), (YeohOfF, 1e-8), (YeohByStress, 1e-9)])
def test_an_energy_is_the_built_in_law(capture, effect, tolerance):
    built_in, own = capture.model(), capture.model()
    built_in.add("strain_stiffening")
    own.add(effect)
    for name, value in (("c2", 0.01), ("c3", 0.004)):
        built_in["strain_stiffening." + name].value = value
        own[f"{own.ingredients[-1]}.{name}"].value = value
    expected, found = built_in.simulate("pull"), own.simulate("pull")
    assert np.abs(found.u - capture.model().simulate("pull").u).max() > 0.1
    assert np.abs(found.u - expected.u).max() < tolerance * np.abs(expected.u).max()
    assert np.allclose(found.stress, expected.stress, rtol=1e-6, atol=1e-9)
    assert np.allclose(found.energy_density, expected.energy_density, rtol=1e-6)
    one, other = built_in.evaluate(), own.evaluate()
    assert np.isclose(one.r2, other.r2, rtol=1e-6)
    assert np.allclose(one.JTJ, other.JTJ, rtol=1e-4, atol=1e-6 * np.abs(one.JTJ).max())


@pytest.mark.parametrize("effect", [Yeoh, YeohOfF, YeohByStress, Weight, Spring])
def test_the_contract_holds(capture, effect):
    checks = he.check_effect(effect, capture)
    assert all(checks["passed"]) and len(checks["check"]) >= 5
    assert effect.__name__.lower() not in list(he.effects()["name"]), "it does not stay"


class Wrong(he.Effect):
    """Takes what it does from its subclasses."""

    parameters = {"k": {"unit": "MPa", "typical": 0.01}}

    def energy(self, F, k):
        return k * (he.invariants(F)[0] - 3) ** 2


class KnowsDirections(Wrong):
    def energy(self, F, k):
        return k * (F[..., 0, 0] - 1) ** 2


class OtherStress(Wrong):
    def stress(self, F, k):
        return 2 * k * (F - he.cofactor(F) / he.determinant(F)[..., None, None])


class ThereAtNull(Wrong):
    def energy(self, F, k):
        return (k + 0.01) * (he.invariants(F)[0] - 3) ** 2


class NoSlope(Wrong):
    def energy(self, F, k):
        return k**2 * (he.invariants(F)[0] - 3) ** 2


class Dice(Wrong):
    def energy(self, F, k):
        return k * (he.invariants(F)[0] - 3) ** 2 * (1 + 0.01 * np.random.default_rng().random())


@pytest.mark.parametrize("effect, says", [
    (KnowsDirections, "body is turned"), (OtherStress, "not the derivative of the energy"),
    (NoSlope, "nothing to first order"), (ThereAtNull, "the null is no null"), (Dice, "answers differently")])
def test_what_breaks_the_contract_is_said(capture, effect, says):
    with pytest.raises(he.EffectError, match=says) as caught:
        he.check_effect(effect, capture)
    assert caught.value.effect in str(caught.value)


class Raises(Wrong):
    def energy(self, F, k):
        raise ZeroDivisionError("no such skin")


class Short(Wrong):
    def energy(self, F, k):
        return np.zeros(3)


class NotANumber(Wrong):
    def energy(self, F, k):
        return np.full(len(F), np.nan)


class Text(Wrong):
    def energy(self, F, k):
        return ["stiff"] * len(F)


class Absolute(Wrong):
    def energy(self, F, k):
        return k * np.abs(he.determinant(F) - 1)


@pytest.mark.parametrize("effect, says", [
    (Raises, "ZeroDivisionError: no such skin"), (Short, r"the shape \(3,\)"),
    (NotANumber, "nan.* was returned"), (Text, "dtype <U5"), (Absolute, "real numbers were returned for a complex")])
def test_a_fault_in_a_method_ends_the_call_and_writes_nothing(capture, tmp_path, effect, says):
    model = capture.model()
    model.add(effect)
    name = model.ingredients[-1]
    model[name + ".k"].value = 0.001
    for call in (lambda: model.simulate("pull"), model.evaluate,
                 lambda: he.fit(capture, model, out=tmp_path / "run")):
        with pytest.raises(he.EffectError, match=says) as caught:
            call()
        assert caught.value.effect == name and caught.value.method == "energy"
        assert f"effect '{name}', energy()" in str(caught.value)
    assert isinstance(caught.value.__cause__, ZeroDivisionError) == (effect is Raises)
    assert not (tmp_path / "run").exists()
    assert np.isfinite(capture.model().simulate("pull").u).all(), "the next call goes on"


@pytest.mark.parametrize("declared, says", [
    ({}, "no parameters"), ({"k": {"unit": "MPa"}}, "size that matters"),
    ({"k": {"typical": 1, "lwo": 0}}, "`lwo`"), ({"k": {"typical": 1, "low": 1}}, "between low and high"),
    ({"k": {"typical": "large"}}, "typical is 'large'"),
    ({"F": {"typical": 1}}, "no name of its own")])
def test_parameters_that_are_none_are_refused(declared, says):
    with pytest.raises(he.InputError, match=says):
        he.register(type("Odd", (Wrong,), {"parameters": declared}))


def test_classes_that_are_no_effects_are_refused(capture):
    with pytest.raises(he.InputError, match="does nothing"):
        he.register(type("Idle", (he.Effect,), {"parameters": Wrong.parameters}))
    with pytest.raises(he.InputError, match="already"):
        he.register(type("Mine", (Wrong,), {"name": "gravity"}))
    with pytest.raises(he.InputError, match="small letters"):
        he.register(type("Mine", (Wrong,), {"name": "My Effect"}))
    with pytest.raises(TypeError, match="hookeye.Effect"):
        he.register(dict)
    with pytest.raises(he.InputError, match="there is no region 'nowhere'"):
        capture.model().add(type("Away", (Spring,), {"region": "nowhere"}))
    with pytest.raises(he.InputError, match="has a brother"):
        capture.model().add(type("Shy", (Spring,), {"applies": lambda self, setup: "it has a brother"}))


def test_a_definition_is_known_by_what_it_does():
    from hookeye._bridge import Bridge

    def made(factor, words, power=2):
        class Skin(Wrong):
            __doc__ = words

            def energy(self, F, k, p=power):
                """What it is."""
                return factor * k * (he.invariants(F)[0] - 3) ** p

        return Bridge(Skin()).code

    assert made(1.0, "a") == made(1.0, "b")
    assert len({made(1.0, "a"), made(1.5, "a"), made(1.0, "a", 3)}) == 3


def test_one_registered_again_tells_of_what_was_fitted_before(capture):
    from hookeye._bridge import Bridge

    class Told(Yeoh):
        """Its sentence has its parameters."""

        def sentence(self, c2, c3):
            return f"{c2} then {c3}"

    capture.model().add(Told)
    assert Bridge(Told()).sentence(np.array([1.0, 2.0])) == "1.0 then 2.0"


def test_a_photo_s_light_changes(capture):
    class Lamp(he.Effect):
        """One load case was photographed brighter. Easily taken for exposure."""

        parameters = {"gain": {"typical": 0.05, "words": "logarithm of the gain"}}

        def photo(self, example, camera, order, gain):
            return {"log_gain": gain} if example == "pull" else None

    assert all(he.check_effect(Lamp, capture)["passed"])
    model = capture.model()
    before = {name: np.asarray(model.render(name, "cam0")) for name in ("pull", "side")}
    model.add(Lamp)
    model["lamp.gain"].value = np.log(1.1)
    mask = model.render("pull", "cam0").mask
    inner = mask & (before["pull"] > 0.05)
    ratio = np.asarray(model.render("pull", "cam0"))[inner] / before["pull"][inner]
    assert np.median(ratio) == pytest.approx(1.1, abs=1e-3)
    assert np.array_equal(model.render("side", "cam0"), before["side"])


def test_an_effect_is_named_added_and_reported_as_the_built_in_one(capture, tmp_path):
    run = he.fit(capture, out=tmp_path / "run")
    table = {row["effect"]: row for row in run.diagnose(effects=[Weight, Spring]).told["effects"]}
    own, built_in = table["weight"], table["gravity"]
    assert own["evidence"] == pytest.approx(built_in["evidence"], abs=2.0)
    assert own["explains"] == pytest.approx(built_in["explains"], abs=0.01)
    assert "spring" in table and set(run.why("weight")["candidate"]) == {"weight"}
    step = run.add(Weight)
    other_run = he.fit(capture, out=tmp_path / "other")
    other = other_run.add("gravity")
    assert step.added == "weight" and step.chi == pytest.approx(other.chi, abs=1e-3)
    values = dict(zip(run.parameters["name"], run.parameters["value"]))
    assert values["weight.gz"] == pytest.approx(-9650 * 1.07e-9, rel=0.05)
    run.report(tmp_path / "r.html")
    assert "weight" in (tmp_path / "r.html").read_text()
    again = he.Run(tmp_path / "run")
    assert again.model()["weight.gz"].value == values["weight.gz"]

    he.unregister("weight")
    with pytest.raises(he.InputError, match="no effect `weight` here") as caught:
        he.Run(tmp_path / "run").model()
    assert "hookeye.register(" in caught.value.right and "before the run is opened" in caught.value.right
    # What was decided of it is told all the same, and asking for it says what to do first.
    assert set(he.Run(tmp_path / "run").why("weight")["candidate"]) == {"weight"}
    with pytest.raises(he.InputError, match="no effect 'weight'") as caught:
        other_run.add("weight")
    assert "hookeye.register(" in caught.value.right

    class Heavier(Weight):
        """Another with the same name."""

        name = "weight"

        def body_force(self, X, gx, gy, gz):
            return 2 * super().body_force(X, gx, gy, gz)

    he.register(Heavier)
    with pytest.raises(he.InputError, match="other code"):
        he.Run(tmp_path / "run").model()


def test_a_search_finds_it(capture, tmp_path):
    run = he.discover(capture, out=tmp_path / "run", effects=[Weight],
                      without=[name for name in he.effects()["name"] if name not in ("weight", "swelling")])
    assert [step.added for step in run.steps][1:2] == ["weight"]


def test_a_fault_in_a_search_leaves_the_steps_that_are_finished(capture, tmp_path):
    class Late(Weight):
        """Fails once it is fitted."""

        def body_force(self, X, gx, gy, gz):
            if abs(gz) > 2e-6:
                raise RuntimeError("too heavy")
            return super().body_force(X, gx, gy, gz)

    run = he.fit(capture, out=tmp_path / "run")
    with pytest.raises(he.EffectError, match="too heavy"):
        run.add(Late)
    assert [step.name for step in he.Run(tmp_path / "run").steps] == ["base"]
    # Nothing of it is left: in the program, or half-moved in the run that is open.
    assert "late" not in list(he.effects()["name"])
    with pytest.raises(he.EffectError, match="too heavy"):
        run.diagnose(effects=[Late])
    assert "late" not in list(he.effects()["name"])
    assert run.diagnose().verdict


def test_several_threads_work_with_one_effect(capture):
    """A worker that waits for the interpreter is not waited for by who holds it."""
    he.register(YeohByStress)
    found, threads = [], []

    def work():
        model = capture.model()
        model.add("yeoh_by_stress")
        model["yeoh_by_stress.c2"].value = 0.01
        found.append(model.evaluate().r2)

    for _ in range(3):
        threads.append(threading.Thread(target=work, daemon=True))
        threads[-1].start()
    for thread in threads:
        thread.join(timeout=120)
        assert not thread.is_alive()
    assert len(found) == 3 and found[0] == pytest.approx(found[1]) == pytest.approx(found[2])


def test_cancel_is_seen_while_python_works(capture, tmp_path):
    event = threading.Event()

    class Slow(Wrong):
        """Sets the event itself, in the middle of a fit."""

        def energy(self, F, k):
            event.set()
            return super().energy(F, k)

    model = capture.model()
    model.add(Slow)
    model["slow.k"].value = 0.001
    with pytest.raises(he.Cancelled):
        he.fit(capture, model, out=tmp_path / "run", cancel=event)
    assert not (tmp_path / "run").exists()


def test_a_method_that_asks_the_model_at_work_is_refused(capture):
    class Curious(Wrong):
        def energy(self, F, k):
            model.evaluate()
            return super().energy(F, k)

    model = capture.model()
    model.add(Curious)
    model["curious.k"].value = 0.001
    with pytest.raises(he.EffectError, match="at work"):
        model.evaluate()
