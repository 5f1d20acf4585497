import pickle
import shutil

import numpy as np
import pytest

import hookeye as he

BLOCK = np.array([[x, y, z] for z in (0, 20) for y in (0, 10) for x in (0, 10)], float)
# Six tetrahedra of a box about its diagonal from corner 0 to corner 7.
TETS = np.array([[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7],
                 [0, 5, 1, 7]])


def told(**changes):
    capture = {
        "hookeye": 1, "title": "box", "units": {"length": "mm", "force": "N"},
        "body": {"volume": (BLOCK, TETS), "texture": {"uniform": 0.5}},
        "model": {"material": {"law": "neo-hookean", "mu": 0.05, "kappa": 0.5}, "fit": ["mu"]},
        "cameras": {"front": {
            "size": [64, 48], "intrinsics": {"fx": 60, "fy": 60, "cx": 31.5, "cy": 23.5},
            "pose": {"rotation": np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]),
                     "translation": [-5, 10, 40]}}},
        "light": {"ambient": 1.0}, "photos": {"noise": {"full_well": 20000, "read": 0.001}},
        "regions": {"base": {"halfspace": {"point": [0, 0, 0.01], "normal": [0, 0, -1]}},
                    "top": {"halfspace": {"point": [0, 0, 19.99], "normal": [0, 0, 1]}}},
        "examples": {"pull": {"supports": [{"region": "base", "fix": ["x", "y", "z"]}],
                              "loads": [{"region": "top", "force": [0, 0, 0.5]}]}}}
    capture.update(changes)
    return capture


def test_a_camera_projects_as_its_numbers_say(capture):
    camera = next(iter(capture.cameras.values()))
    xyz = np.random.default_rng(1).uniform(-10, 10, (50, 3))
    in_camera = xyz @ camera.R.T + camera.t
    homogeneous = in_camera @ camera.K.T
    assert not camera.D.any()
    expected = homogeneous[:, :2] / homogeneous[:, 2:]
    assert np.allclose(camera.project(xyz), expected, atol=1e-9)
    assert np.array_equal(camera.project(xyz[0]), camera.project(xyz)[0])
    # The order of the memory and the type of the numbers change nothing.
    assert np.array_equal(camera.project(np.asfortranarray(xyz)), camera.project(xyz))
    assert np.array_equal(camera.project(xyz[::2]), camera.project(xyz)[::2])
    with pytest.raises(ValueError):
        camera.K[0, 0] = 1.0


@pytest.mark.parametrize("xyz, error, says", [
    (np.zeros((3, 4)), he.InputError, "xyz: the array is 3 x 4"),
    (np.zeros((2, 2, 3)), he.InputError, "2 x 2 x 3"),
    (np.array([[0, 0, 1], [0, np.nan, 1]]), he.InputError, "row 1 is not finite"),
    (np.zeros((2, 3), complex), TypeError, "complex128"),
    (np.array([["a", "b", "c"]]), TypeError, "real numbers"),
    ("points", TypeError, "xyz"),
])
def test_points_that_are_none_are_refused(capture, xyz, error, says):
    camera = next(iter(capture.cameras.values()))
    with pytest.raises(error, match=says):
        camera.project(xyz)


def test_photos_and_mesh_are_arrays(capture):
    photos = capture.photos
    assert ("pull", "cam0") in photos
    photo = photos["pull", "cam0"]
    assert photo.values.shape == photo.sigma.shape == photo.valid.shape == (190, 150)
    assert photo.values.dtype == np.float32 and photo.valid.dtype == bool
    assert (photo.sigma > 0).all()
    mesh = capture.mesh
    assert mesh.points.shape[1] == 3 and mesh.elements.max() == len(mesh.points) - 1
    volume = np.linalg.det(np.diff(mesh.points[mesh.elements[:, :4]], axis=1)) / 6
    assert (volume > 0).all() and np.isclose(volume.sum(), 20 * 16 * 34, rtol=0.1)


def test_bad_input_has_its_place(folder, tmp_path):
    text = (folder / "capture/capture.yaml").read_text()
    shutil.copytree(folder / "capture", tmp_path, dirs_exist_ok=True)
    (tmp_path / "capture.yaml").write_text(text.replace("neo-hookean", "neo-hokean"))
    with pytest.raises(he.InputError) as caught:
        he.Capture(tmp_path).model()
    error = caught.value
    line = next(i for i, line in enumerate(text.splitlines(), 1) if "neo-hookean" in line)
    assert error.file == str(tmp_path / "capture.yaml") and error.line == line
    assert error.column > 0 and "neo-hookean" in error.right
    assert str(error).startswith(f"{error.file}:{line}:{error.column}: ")
    assert isinstance(error, ValueError)
    again = pickle.loads(pickle.dumps(error))
    assert (again.line, again.right, str(again)) == (error.line, error.right, str(error))


def test_a_missing_capture_and_unknown_options(tmp_path, folder):
    with pytest.raises(he.InputError) as caught:
        he.Capture(tmp_path / "nothing")
    assert "nothing" in caught.value.file
    with pytest.raises(he.InputError, match="fit.hubber"):
        he.Capture(folder / "capture", options={"fit.hubber": 3.0})


def test_a_dict_with_arrays_is_a_capture():
    photo = np.full((48, 64), 0.25, np.float32)
    capture = he.Capture.from_dict(told(), {("pull", "front"): photo},
                                   masks={("pull", "front"): np.arange(64) > 9 + 0 * photo})
    assert np.array_equal(capture.mesh.points, BLOCK)
    shot = capture.photos["pull", "front"]
    assert np.array_equal(shot.values, photo)
    assert not shot.valid[:, :10].any() and shot.valid[:, 10:].all()
    state = capture.model().simulate("pull")
    assert np.allclose(state.reaction("base"), [0, 0, -0.5], atol=1e-9)
    file = capture.file
    assert file.exists()
    del capture, state, shot
    assert not file.exists()


def test_bytes_are_srgb_and_words_are_linear():
    stored = np.full((48, 64), 188, np.uint8)
    capture = he.Capture.from_dict(told(), {("pull", "front"): stored})
    s = 188 / 255
    linear = ((s + 0.055) / 1.055) ** 2.4
    assert np.allclose(capture.photos["pull", "front"].values, linear, atol=1e-5)
    words = np.full((48, 64), 40000, np.uint16)
    capture = he.Capture.from_dict(told(), {("pull", "front"): words})
    assert np.allclose(capture.photos["pull", "front"].values, 40000 / 65535, atol=1e-7)


@pytest.mark.parametrize("photo, error, says", [
    (np.zeros((48, 64, 2)), he.InputError, "48 x 64 x 2"),
    (np.zeros(48), he.InputError, "the array is 48"),
    (np.full((48, 64), np.nan), he.InputError, r"pixel \(0, 0\) is not finite"),
    (np.zeros((48, 64), np.int64), TypeError, "int64"),
    (np.full((48, 64), 174.0), he.InputError, "up to 174, where 1 is full scale\n  divide them by 255"),
    (np.zeros((20, 64), np.float32), he.InputError, "64 x 20"),
])
def test_photos_that_are_none_are_refused(photo, error, says):
    with pytest.raises(error, match=says):
        he.Capture.from_dict(told(), {("pull", "front"): photo})


@pytest.mark.parametrize("body, error, says", [
    ((BLOCK[:, :2], TETS), he.InputError, "points: the array is 8 x 2"),
    ((BLOCK, TETS[:, :3]), he.InputError, "elements: the array is 6 x 3"),
    ((BLOCK, TETS + 1), he.InputError, "has the index 8"),
    ((BLOCK, TETS.astype(float)), TypeError, "whole numbers"),
    ((BLOCK, TETS[:, [1, 0, 2, 3]]), he.InputError, ""),  # inverted
    (BLOCK, TypeError, "elements"),
])
def test_bodies_that_are_none_are_refused(body, error, says):
    with pytest.raises(error, match=says):
        he.Capture.from_dict(told(body={"volume": body, "texture": {"uniform": 0.5}})).mesh


def test_a_dict_that_is_none_is_refused(tmp_path):
    with pytest.raises(he.InputError, match=r"capture.light.ambient: nan"):
        he.Capture.from_dict(told(light={"ambient": float("nan")}))
    with pytest.raises(TypeError, match=r"capture.title: object"):
        he.Capture.from_dict(told(title=object()))
    with pytest.raises(he.InputError, match="no example 'push'"):
        he.Capture.from_dict(told(), {("push", "front"): np.zeros((48, 64))})
    he.Capture.from_dict(told(), folder=tmp_path)
    with pytest.raises(he.InputError, match="a capture already"):
        he.Capture.from_dict(told(), folder=tmp_path)


def test_importers_read_what_others_calibrated(tmp_path):
    source = tmp_path / "lens.yml"
    source.write_text("""%YAML:1.0
---
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 800., 0., 320., 0., 810., 240., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -0.1, 0.02, 0., 0., 0. ]
""")
    found = he.importers.opencv(source)
    camera = next(iter(found.cameras.values()))
    assert (camera.K == [[800, 0, 320], [0, 810, 240], [0, 0, 1]]).all()
    assert (camera.D[:2] == [-0.1, 0.02]).all()
    file = found.save(tmp_path / "out")
    assert "810" in file.read_text()
    with pytest.raises(he.InputError, match="a file of this name"):
        found.save(tmp_path / "out")
    assert set(he.importers.kinds) >= {"colmap", "dice", "opencv"}
    assert he.importers.colmap.__name__ == "colmap"
    with pytest.raises(he.InputError):
        he.importers.colmap(tmp_path / "nothing")
    with pytest.raises(he.InputError, match="scale"):
        he.importers.opencv(source, scale=float("nan"))


def test_the_catalogue_and_the_options_are_tables():
    assert "gravity" in list(he.effects()["name"])
    assert "fit.huber" in list(he.options()["name"])
