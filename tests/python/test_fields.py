"""Measured fields as arrays: told by a dict, given back with what a model says of them."""

import os
import pickle

import numpy as np
import pytest
from conftest import hookeye
from test_capture import BLOCK, TETS, told

import hookeye as he

RNG = np.random.default_rng(3)
#: Of the front of the box, y = 0.
POINTS = np.array([[x, 0.0, z] for z in np.linspace(1, 19, 10) for x in np.linspace(1, 9, 9)])
MOVED = 0.02 * POINTS[:, 2:] * [0.1, -0.1, 1.0] + 0.002 * RNG.standard_normal(POINTS.shape)


def entry(**changes):
    return {"field": {"points": POINTS, "displacement": MOVED}, "sigma": 0.002, **changes}


def with_fields(*measured, **changes):
    capture = told(**changes)
    for key in ("cameras", "light", "photos"):
        del capture[key]
    capture["body"] = {"volume": (BLOCK, TETS)}
    capture["examples"]["pull"]["measured"] = list(measured)
    return capture


@pytest.fixture(scope="module")
def lost():
    """Displacements where two points were lost."""
    moved = MOVED.copy()
    moved[[4, 70]] = np.nan
    return moved


def test_arrays_come_back_as_they_were_told(lost):
    capture = he.Capture.from_dict(with_fields(entry(field=(POINTS, lost))))
    (key, field), = capture.fields.items()
    assert key == ("pull", "fields/pull-0.csv") == (field.example, field.file)
    valid = np.ones(90, bool)
    valid[[4, 70]] = False
    assert field.valid.dtype == bool and np.array_equal(field.valid, valid)
    assert np.array_equal(field.points[valid], POINTS[valid])
    assert np.array_equal(field.measured, lost, equal_nan=True)
    assert (field.sigma[valid] == 0.002).all() and field.sigma.shape == (90, 3)
    assert field.predicted is None and field.residual is None
    assert (field.unit, field.components, field.holds, field.start) == ("mm", ("x", "y", "z"), "displacements", "")
    assert np.array_equal(field.axes, np.eye(3)) and not field.held_out
    assert (field.alike[valid] >= 1).all() and field.alike[valid].max() > 1


def test_a_model_and_a_run_give_what_is_left(tmp_path, lost):
    held_out = with_fields(entry(field=np.ma.masked_invalid(np.hstack([POINTS, lost]))))
    held_out["examples"]["push"] = {**held_out["examples"]["pull"], "use": "validate"}
    capture = he.Capture.from_dict(held_out, folder=tmp_path / "capture")
    model = capture.model()
    for jac in (False, True):
        seen = model.evaluate(jac=jac).fields["pull", "fields/pull-0.csv"]
        assert np.array_equal(np.isnan(seen.residual).all(axis=1), ~seen.valid)
        np.testing.assert_allclose(seen.residual, (seen.predicted - lost) / 0.002)
        # It is that of the sum of squares: each point counts as its share of those alike.
        of_sum = np.nansum(seen.residual ** 2 / seen.alike[:, None])
        assert model.evaluate(jac=False).r2 == pytest.approx(of_sum, rel=1e-9)
    # The displacement at the points is that of the nodes there.
    state = model.simulate("pull")
    corner = np.argmin(np.linalg.norm(BLOCK - [10, 0, 20], axis=1))
    near = np.argmin(np.linalg.norm(POINTS - [9, 0, 19], axis=1))
    assert np.linalg.norm(seen.predicted[near] - state.u[corner]) < 0.2 * np.linalg.norm(state.u[corner])

    run = he.fit(capture, out=tmp_path / "run")
    fields = run.fields()
    assert set(fields) == {("pull", "fields/pull-0.csv"), ("push", "fields/push-0.csv")}
    assert [one.held_out for one in fields.values()] == [False, True]
    one = fields["pull", "fields/pull-0.csv"]
    metrics = next(m for m in run.steps[0].metrics["fields"] if m["example"] == "pull")
    counted = one.residual[one.valid] ** 2 / one.alike[one.valid, None]
    assert np.sqrt(counted.sum() / metrics["numbers"]) == pytest.approx(metrics["chi"], rel=1e-6)
    assert "88 points" in repr(one) and "RMS" in repr(one)
    assert hookeye("compare", "run", cwd=tmp_path)


def test_frames_files_and_strains(tmp_path):
    # A file with its own frame and rows without numbers, from where the dict is told.
    lines = ["X [mm],Y [mm],U [mm],V [mm]"]
    lines += [f"{x - 5},{z},{0.01 * z},{0.02 * z}" for x, _, z in POINTS]
    lines.insert(3, "1,1,nan,nan")
    lines.insert(4, "")
    (tmp_path / "front.csv").write_text("\n".join(lines))
    frame = {"origin": [5, 0, 0], "x": [1, 0, 0], "y": [0, 0, 1]}
    strain = np.column_stack([0.02 + 0 * POINTS[:, 0], -0.005 * np.ones(90)])
    strains = {"field": {"points": POINTS, "strain": strain}, "strain": "green", "gauge": 2.0,
               "sigma": [1e-3, 2e-3], "axes": [[0, 0, 1], [1, 0, 0]]}
    capture = he.Capture.from_dict(
        with_fields({"field": "front.csv", "sigma": 0.01, "frame": frame}, strains,
                    {"field": "front.csv", "sigma": 0.01, "frame": frame}), folder=tmp_path)
    assert list(capture.fields) == [("pull", "front.csv"), ("pull", "fields/pull-1.csv"),
                                    ("pull", "front.csv#2")]
    field = capture.fields["pull", "front.csv"]
    assert len(field) == 91 and field.valid.sum() == 90 and not field.valid[2]
    np.testing.assert_allclose(field.points[field.valid], POINTS, atol=1e-12)
    in_capture = field.measured @ field.axes[:, :2].T
    np.testing.assert_allclose(in_capture[field.valid], POINTS[:, 2:] * [0.01, 0, 0.02], atol=1e-12)
    field = capture.fields["pull", "fields/pull-1.csv"]
    assert (field.holds, field.measure, field.components, field.unit) == ("strains", "green", ("exx", "eyy"), "")
    assert np.array_equal(field.measured, strain) and (field.sigma == [1e-3, 2e-3]).all()
    assert np.array_equal(field.axes, [[0, 1], [0, 0], [1, 0]])


def test_no_unit_is_asked_for_where_the_capture_tells_it(tmp_path):
    he.Capture.from_dict(with_fields(entry()), folder=tmp_path)
    (one,) = hookeye("check", "--quick", ".", cwd=tmp_path)["fields"]
    assert one["points"] == 90
    assert (tmp_path / "fields/pull-0.csv").read_text().startswith("X [mm],Y,Z,U,V,W\n")


def changed(array, row, value):
    out = array.copy()
    out[row] = value
    return out


@pytest.mark.parametrize("told_as, error, says", [
    (entry(field={"points": POINTS[:, :2], "displacement": MOVED}), he.InputError, r"measured\[0\].field.points: the array is 90 x 2\n  points are \(n, 3\)"),
    (entry(field={"points": POINTS, "displacement": MOVED[:80]}), he.InputError, "displacement: 80 rows, and 90 points"),
    (entry(field={"points": POINTS, "displacement": MOVED.T}), he.InputError, "the array is 3 x 90"),
    (entry(field=MOVED), he.InputError, r"the array is 90 x 3\n  \(n, 6\)"),
    (entry(field={"points": POINTS}), he.InputError, "points is not enough"),
    (entry(field={"points": POINTS, "displacements": MOVED}), he.InputError, "has no 'displacements'\n  did you mean 'displacement'"),
    (entry(field={"points": POINTS, "displacement": MOVED.astype(complex)}), TypeError, "displacement: real numbers are expected, not dtype complex128"),
    (entry(field={"points": POINTS, "displacement": [["a"] * 3] * 90}), TypeError, "not dtype <U1"),
    (entry(field={"points": changed(POINTS, 7, np.nan), "displacement": MOVED}), he.InputError, "points: row 7 is NaN"),
    (entry(field={"points": POINTS, "displacement": changed(MOVED, 5, np.inf)}), he.InputError, "displacement: row 5 is infinite"),
    (entry(field={"points": POINTS, "displacement": 0 * MOVED + np.nan}), he.InputError, r"no row has numbers \(90 rows, all with NaN\)"),
    (entry(field={"points": changed(POINTS, 7, POINTS[2]), "displacement": MOVED}), he.InputError, "rows 2 and 7 are the same point"),
    (entry(field={"points": POINTS, "displacement": MOVED, "sigma": 0.1}), he.InputError, "`sigma` is told twice"),
    ({"field": (POINTS, MOVED)}, he.InputError, "lacks `sigma`"),
    (entry(sigma=[1.0, 2.0]), he.InputError, "sigma: the array is 2\n"),
    (entry(sigma=np.full((90, 3), 0.1)), he.InputError, "90 x 3, one a point\n.*root mean square is 0.1, 0.1, 0.1"),
    (entry(sigma=-1.0), he.InputError, "-1.0 is not a standard deviation"),
    (entry(sigma="small"), TypeError, "sigma: real numbers"),
    (entry(strain="green"), he.InputError, "strains take both"),
    (entry(field=(POINTS + [0, 50, 0], MOVED)), he.InputError, "off the body's surface"),
])
def test_arrays_that_are_none_are_refused(told_as, error, says):
    with pytest.raises(error, match=says):
        he.Capture.from_dict(with_fields(told_as)).model()


def test_files_are_looked_for_where_the_dict_is_told(tmp_path, monkeypatch):
    lines = ["X [mm],Y,Z,U,V,W"] + [",".join(map(repr, row)) for row in np.hstack([POINTS, MOVED]).tolist()]
    (tmp_path / "data").mkdir()
    (tmp_path / "data/pull.csv").write_text("\n".join(lines))
    named = {"field": "data/pull.csv", "sigma": 0.002}
    monkeypatch.chdir(tmp_path)
    capture = he.Capture.from_dict(with_fields(named))
    assert ("pull", "data/pull.csv") in capture.fields and capture.file.parent != tmp_path
    assert os.listdir(tmp_path) == ["data"]
    # Out of the folder, and by its whole name.
    monkeypatch.chdir(tmp_path / "data")
    for name in ("pull.csv", "../data/pull.csv", tmp_path / "data/pull.csv"):
        field, = he.Capture.from_dict(with_fields({**named, "field": name})).fields.values()
        assert np.array_equal(field.measured, MOVED)
    field, = he.Capture.from_dict(with_fields(named), folder=tmp_path).fields.values()
    assert np.array_equal(field.measured, MOVED)
    with pytest.raises(he.InputError) as caught:
        he.Capture.from_dict(with_fields({**named, "field": "pul.csv"}))
    said = str(caught.value)
    assert "measured.0.field: there is no file 'pul.csv' in " + str(tmp_path / "data") in said
    assert "did you mean 'pull.csv'" in said and "folder=" in said and "hookeye-" not in said
    with pytest.raises(he.InputError, match=f"no file 'rest.obj' in {tmp_path / 'there'}"):
        he.Capture.from_dict(with_fields(entry(), body={"surface": "rest.obj"}) | {"body": {"surface": "rest.obj"}},
                             folder=tmp_path / "there")
    # What a file of its own names is found, and missed, in the same place.
    (tmp_path / "data/cameras.yaml").write_text("cameras:\n  front: {calibration: lens.yml}\n")
    lens = """%YAML:1.0
---
image_width: 64
image_height: 48
K: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 60., 0., 31.5, 0., 60., 23.5, 0., 0., 1. ]
"""
    other = with_fields(named | {"field": "pull.csv"}) | {"cameras": {"from": "cameras.yaml"}}
    with pytest.raises(he.InputError, match=f"no such file.*looked for in {tmp_path / 'data'}"):
        he.Capture.from_dict(other)
    (tmp_path / "data/lens.yml").write_text(lens + "R: [1., 0., 0., 0., 0., -1., 0., 1., 0.]\nT: [0., 0., 9.]\n")
    try:
        assert he.Capture.from_dict(other).cameras["front"].K[0, 0] == 60
    except he.InputError as error:  # the file is found, whatever is said of its pose
        assert "no such file" not in str(error) and "lens.yml" in str(error)


def test_an_unknown_name_says_which_there_are(capture, fitted):
    cases = [(lambda: capture.cameras["cam1"], "no camera 'cam1'", "'cam0'"),
             (lambda: capture.photos["pull", "cam1"], r"no photo of \(load case, camera\) \('pull', 'cam1'\)", "'cam0'"),
             (lambda: capture.photos["pull"], "no photo", "'cam0'"),
             (lambda: capture.examples["pul"], "no load case 'pul'", "did you mean"),
             (lambda: capture.fields["pull", "u.csv"], "no field", "there is none"),
             (lambda: capture.mesh.regions["grp"], "no region 'grp'", "grip"),
             (lambda: fitted.residuals()["pull", "cam1"], "no photo", "'cam0'"),
             (lambda: fitted.model()["mw"], "no parameter 'mw'", "mu"),
             (lambda: he.Table([], ["a"])["b"], "no column 'b'", "a")]
    for ask, wrong, right in cases:
        with pytest.raises(KeyError, match=wrong) as caught:
            ask()
        assert isinstance(caught.value, he.InputError) and right in caught.value.right
        assert str(caught.value) == f"{caught.value.wrong}\n  {caught.value.right}"
        assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
    assert capture.cameras.get("cam1") is None and "cam1" not in capture.cameras
    for ask, says in ((lambda: capture.camera, "Capture has no 'camera': did you mean 'cameras'"),
                      (lambda: capture.photos["pull", "cam0"].image, "Photo has no 'image': .*values"),
                      (lambda: capture.cameras["cam0"].k, "Camera has no 'k': .*K"),
                      (lambda: fitted.residual, "Run has no 'residual': did you mean 'residuals'"),
                      (lambda: fitted.model().evaluate(jac=False).JTJ, "jac=True")):
        with pytest.raises(AttributeError, match=says):
            ask()
