import shutil
import threading
import time

import numpy as np
import pytest
from conftest import hookeye

import hookeye as he


def test_equilibria_are_those_of_the_command(folder, capture):
    told = hookeye("simulate", "capture", "-o", "simulated", cwd=folder)
    model = capture.model()
    for example in told["examples"]:
        state = model.simulate(example["name"])
        assert np.linalg.norm(state.u, axis=1).max() == example["max_displacement"]
        for support in example["supports"]:
            assert list(state.reaction(support["region"])) == support["force"]
            assert list(state.moment(support["region"], support["about"])) == support["moment"]
        assert state.stable


def test_an_example_that_no_fit_may_see_is_simulated_all_the_same(folder, capture, tmp_path):
    shutil.copytree(folder / "capture", tmp_path, dirs_exist_ok=True)
    text = (tmp_path / "capture.yaml").read_text()
    assert text.count("use: validate") == 1
    (tmp_path / "capture.yaml").write_text(text.replace("use: validate", "use: test"))
    hidden = he.Capture(tmp_path)
    assert hidden.examples["poke"]["use"] == "test" and ("poke", "cam0") not in hidden.photos
    model = hidden.model()
    assert np.array_equal(model.simulate("poke").u, capture.model().simulate("poke").u)
    assert model.render("poke", "cam0").mask.any()


def test_stress_follows_from_the_deformation(capture):
    state = capture.model().simulate("pull")
    material = capture.materials[0]["parameters"]
    assert state.F.shape[0] == len(state.elements) and state.F.shape[2:] == (3, 3)
    F = state.F.mean(axis=1)  # linear in the element: the middle of its points is its own
    J = np.linalg.det(F)
    assert np.allclose(J, state.volume_ratio, rtol=1e-12)
    strain = (np.swapaxes(F, 1, 2) @ F - np.eye(3)) / 2
    assert np.allclose(strain, state.strain, atol=1e-12)
    assert np.array_equal(state.stress, np.swapaxes(state.stress, 1, 2))
    deviator = state.stress - np.trace(state.stress, axis1=1, axis2=2)[:, None, None] * np.eye(3) / 3
    assert np.allclose(np.sqrt(1.5 * (deviator**2).sum((1, 2))), state.von_mises, rtol=1e-9)
    # Neo-Hookean: the deviator goes with that of F F^T.
    b = F @ np.swapaxes(F, 1, 2)
    b -= np.trace(b, axis1=1, axis2=2)[:, None, None] * np.eye(3) / 3
    assert np.allclose(deviator, material["mu"] * b / J[:, None, None] ** (5 / 3), rtol=1e-6,
                       atol=1e-12)


def test_a_rendered_picture_is_the_one_that_is_compared(capture):
    model = capture.model()
    looked = model.evaluate(jac=False)
    r = looked.r["pull", "cam0"]
    picture = model.render("pull", "cam0")
    assert picture.dtype == np.float32 and picture.shape == r.shape == picture.mask.shape
    counted = np.isfinite(r) & picture.mask
    assert counted.sum() > 500
    shown = np.asarray(picture)[counted]
    assert np.allclose(shown, looked.pictures["pull", "cam0"][counted], atol=2e-5)
    photo = capture.photos["pull", "cam0"]
    assert np.allclose(r[counted], ((shown - photo.values[counted]) / photo.sigma[counted]),
                       atol=0.02)
    assert (picture.coverage[picture.mask] > 0.999).all() and not picture.mask.all()


def test_a_picture_shows_itself(capture, tmp_path):
    picture = capture.model().render("pull", "cam0")
    matplotlib = pytest.importorskip("matplotlib.image")
    (tmp_path / "a.png").write_bytes(picture._repr_png_())
    shown = matplotlib.imread(tmp_path / "a.png")
    linear = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    assert np.allclose(linear, np.clip(picture, 0, 1), atol=0.01)


def test_the_gradient_is_that_of_finite_differences(capture):
    model = capture.model()
    looked = model.evaluate()
    assert looked.names == model.names == ["mu", "kappa"]
    gradient = []
    for name in model.names:
        value, step = model[name].value, 1e-2 * model[name].value
        sums = []
        for side in (-1, 1):
            model[name].value = value + side * step
            sums.append(model.evaluate(jac=False).r2)
        model[name].value = value
        gradient.append((sums[1] - sums[0]) / (4 * step))  # of r2 / 2
    # Rays that hit another facet or texel make the sum rough: a wide step, and some tolerance.
    assert np.allclose(gradient, looked.JTr, rtol=0.04)
    r2 = sum(float(np.nansum(r.astype(float) ** 2)) for r in looked.r.values())
    r2 += sum(float((one["r"] ** 2).sum()) for one in looked.measured)
    assert np.isclose(r2, looked.r2, rtol=1e-5)


def test_the_condensed_residual_has_the_same_sums(capture):
    looked = capture.model().evaluate()
    assert np.allclose(looked.R.T @ looked.R, looked.JTJ, rtol=1e-9)
    assert np.allclose(looked.R.T @ looked.z, looked.JTr, rtol=1e-9)
    assert np.isclose(looked.z @ looked.z + looked.rho**2, looked.r2, rtol=1e-12)
    assert (np.linalg.eigvalsh(looked.JTJ) > 0).all()
    with pytest.raises(AttributeError, match="jac=True"):
        capture.model().evaluate(jac=False).JTJ


def test_a_fixed_number_is_no_column_and_keeps_its_value(capture):
    model = capture.model()
    whole = model.evaluate()
    model.fix("kappa")
    assert model.names == ["mu"] and model["kappa"].fixed
    part = model.evaluate()
    assert part.JTJ.shape == (1, 1)
    assert np.isclose(part.JTr[0], whole.JTr[0], rtol=1e-9)
    assert np.isclose(part.r2, whole.r2, rtol=1e-9)
    before = model.simulate("pull").u
    model["kappa"].value *= 3
    assert not np.allclose(before, model.simulate("pull").u, rtol=1e-3)
    model.free("kappa")
    assert model.names == ["mu", "kappa"]


def test_an_effect_at_its_null_changes_nothing_and_then_something(capture):
    model = capture.model()
    rest = model.simulate("rest").u
    model.add("gravity")
    assert "gravity" in model.ingredients and "gravity.z" in model
    assert np.array_equal(model.simulate("rest").u, rest)
    model["gravity.z"].value = -9650
    state = model.simulate("rest")
    corners = state.points[state.elements[:, :4]]
    volume = np.abs(np.linalg.det(np.diff(corners, axis=1))).sum() / 6
    weight = 1.07e-9 * 9650 * volume
    assert np.isclose(state.reaction("base")[2], weight, rtol=0.02)
    with pytest.raises(he.InputError, match="already"):
        model.add("gravity")
    model.remove("gravity")
    assert "gravity.z" not in model
    with pytest.raises(he.InputError, match="gravity"):
        model.add("gravty")


@pytest.mark.parametrize("values, error, says", [
    ([0.05], he.InputError, "2 numbers: mu, kappa"),
    ([[0.05, 0.6]], he.InputError, "the shape"),
    ([0.05, float("nan")], he.InputError, "kappa = nan"),
    ([0.05, -1.0], he.InputError, "kappa = -1"),
    (["a", "b"], TypeError, "real numbers"),
    ([0.05, 1j], TypeError, "complex"),
])
def test_values_that_are_none_are_refused(capture, values, error, says):
    model = capture.model()
    before = model.p
    with pytest.raises(error, match=says):
        model.p = values
    assert np.array_equal(model.p, before)


def test_unknown_names_are_told_with_the_nearest(capture):
    model = capture.model()
    with pytest.raises(KeyError, match="mu"):
        model["mw"]
    with pytest.raises(he.InputError, match="did you mean 'pull'"):
        model.simulate("pul")
    with pytest.raises(he.InputError, match="camera"):
        model.render("pull", "cam7")
    with pytest.raises(he.InputError, match="region"):
        model.simulate("pull").reaction("nowhere")
    with pytest.raises(he.InputError, match="about"):
        model.simulate("pull").moment("base", [0, float("nan"), 0])


def test_a_load_that_no_body_bears_is_a_numerical_error(tmp_path):
    from test_capture import told

    bent = told()
    bent["examples"]["pull"]["loads"][0]["force"] = [0, 0, -1e6]
    with pytest.raises(he.NumericalError) as caught:
        he.Capture.from_dict(bent).model().simulate("pull")
    assert caught.value.example == "pull" and caught.value.load_fraction < 1


def test_other_threads_run_meanwhile(capture):
    model = capture.model()
    count, running = 0, True

    def counting():
        nonlocal count
        while running:
            count += 1
            time.sleep(0)

    thread = threading.Thread(target=counting)
    model.evaluate()
    thread.start()
    before, begin = count, time.perf_counter()
    while time.perf_counter() - begin < 0.5:
        model.evaluate()
    during = count - before
    running = False
    thread.join()
    # With the lock held it would come to a handful.
    assert during > 1000
