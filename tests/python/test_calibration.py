"""Cameras from photos of a board: the command's, and a Python that goes on working meanwhile."""

import json
import re
import threading

import numpy as np
import pytest
from conftest import hookeye

import hookeye as he

SIDE, COLUMNS, ROWS = 18.0, 8, 7


def rotation(x, y, z):
    (cx, sx), (cy, sy), (cz, sz) = ((np.cos(a), np.sin(a)) for a in (x, y, z))
    return (np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
            @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
            @ np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]]))


def photo(K, R, t, size):
    """A chessboard, nine rays a pixel. R, t: board to camera."""
    width, height = size
    grey = np.zeros((height, width))
    for dx in (-1 / 3, 0, 1 / 3):
        for dy in (-1 / 3, 0, 1 / 3):
            u, v = np.meshgrid(np.arange(width) + dx, np.arange(height) + dy)
            rays = np.stack([(u - K[0, 2]) / K[0, 0], (v - K[1, 2]) / K[1, 1], np.ones_like(u)], -1)
            on_board, origin = rays @ R, -R.T @ t
            X = origin + on_board * (-origin[2] / on_board[..., 2])[..., None]
            column, row = np.floor(X[..., 0] / SIDE), np.floor(X[..., 1] / SIDE)
            inside = (column >= 0) & (column < COLUMNS) & (row >= 0) & (row < ROWS)
            rim = ((column >= -1) & (column <= COLUMNS) & (row >= -1) & (row <= ROWS))
            grey += np.where(inside, np.where((column + row) % 2 == 0, 0.05, 0.9),
                             np.where(rim, 0.9, 0.4)) / 9
    noise = np.random.default_rng(int(1e3 * abs(t).sum())).normal(0, 0.004, grey.shape)
    return np.clip(grey + noise, 0, 1)


def write_pgm(file, grey):
    bytes_ = np.rint(255 * grey ** (1 / 2.2)).astype(np.uint8)
    file.write_bytes(b"P5\n%d %d\n255\n" % (grey.shape[1], grey.shape[0]) + bytes_.tobytes())


#: Camera matrix, and how each camera stands: x_in_camera = R x + t.
K = np.array([[520.0, 0, 158.0], [0, 522.0, 123.0], [0, 0, 1]])
STANDS = {"left": (np.eye(3), np.zeros(3)),
          "right": (rotation(0.02, 0.16, 0.03), np.array([-50.0, 2.0, 6.0]))}


@pytest.fixture(scope="module")
def photos(tmp_path_factory):
    folder = tmp_path_factory.mktemp("board")
    middle = np.array([SIDE * COLUMNS / 2, SIDE * ROWS / 2, 0])
    tilts = [(0.5, 0.1), (-0.5, 0), (0.1, 0.5), (0, -0.5), (0.4, 0.4), (-0.4, 0.4), (0.35, -0.4),
             (-0.35, -0.35), (0.1, 0.05)]
    for i, (a, b) in enumerate(tilts):
        R = rotation(a, b, 0.1 * (i - 4))
        centre = np.array([18 * ((i % 3) - 1), 12 * ((i // 3) - 1), 400.0 + 15 * (i % 2)])
        for name, (Rc, tc) in STANDS.items():
            to = Rc @ (centre - R @ middle) + tc
            write_pgm(folder / f"{name}_{i + 1:02}.pgm", photo(K, Rc @ R, to, (320, 240)))
    return folder


def patterns(photos):
    return {name: photos / f"{name}_*.pgm" for name in STANDS}


BOARD = f"chessboard {COLUMNS}x{ROWS} {SIDE:g}"


@pytest.fixture(scope="module")
def found(photos):
    told = []
    out = he.calibrate(patterns(photos), BOARD, lens=0, on_step=told.append)
    assert [one.done for one in told] == list(range(1, 19)) and told[0].work == "calibrate"
    return out


def test_cameras_come_back_within_their_errors(found):
    rows = found.parameters
    error = {(c, n): e for c, n, e in zip(rows["camera"], rows["name"], rows["standard_error"])}
    for name, camera in found.cameras.items():
        for key, value, true in (("fx", camera.K[0, 0], K[0, 0]), ("fy", camera.K[1, 1], K[1, 1]),
                                 ("cx", camera.K[0, 2], K[0, 2]), ("cy", camera.K[1, 2], K[1, 2])):
            assert abs(value - true) < 5 * error[name, key] < 5
        assert found.rms_px[name] < 0.1
    R, t = STANDS["right"]
    np.testing.assert_allclose(found.cameras["right"].R, R, atol=2e-3)
    np.testing.assert_allclose(found.cameras["right"].t, t, atol=0.3)
    assert found.unit == "mm" and found.board["columns"] == COLUMNS
    covariance = np.asarray(found.covariance)
    assert covariance.shape == (len(rows), len(rows))
    np.testing.assert_allclose(np.sqrt(np.diag(covariance)), np.asarray(rows["standard_error"], float))
    corners = found.corners("left_03.pgm")
    assert len(corners["id"]) == len(corners["used"]) == 42 and corners["seen"].shape == (42, 2)
    table = found.photos
    assert len(table) == 18 and list(table["used"])[0] == found.corners("left_01.pgm")["used"].sum()
    assert "left" in repr(found) and "<svg" in found._repr_html_()


NUMBER = re.compile(r"-?[0-9]+(?:\.[0-9]+)?(?:e[-+]?[0-9]+)?")


def expect_alike(ours, theirs, name):
    """But for the order in which threads add."""
    assert NUMBER.sub("#", ours) == NUMBER.sub("#", theirs), name
    for a, b in zip(NUMBER.findall(ours), NUMBER.findall(theirs)):
        assert float(a) == pytest.approx(float(b), rel=1e-6, abs=1e-7), name


def test_what_is_saved_is_what_the_command_writes(found, photos, tmp_path):
    document = hookeye("calibrate", *[f"--camera={n}={p}" for n, p in patterns(photos).items()],
                       "--board", "chessboard", "--squares", f"{COLUMNS}x{ROWS}", "--square", SIDE,
                       "--lens", 0, "-o", "by_command", cwd=tmp_path)
    assert found.save(tmp_path / "by_python") == tmp_path / "by_python/cameras.yaml"
    for one in sorted((tmp_path / "by_command").iterdir()):
        expect_alike(one.read_text(), (tmp_path / "by_python" / one.name).read_text(), one.name)
    assert len(document["corner_maps"]) == 2 and json.loads(
        (tmp_path / "by_python/calibration.json").read_text()) == found.told
    assert found.yaml == (tmp_path / "by_python/cameras.yaml").read_text()
    (tmp_path / "by_python/cameras.yaml").write_text("cameras: {}\n")
    with pytest.raises(he.InputError, match="another file of this name"):
        found.save(tmp_path / "by_python")


def test_one_camera_and_keywords(photos, found):
    one = he.calibrate(sorted(photos.glob("left_*.pgm")), "chessboard", squares=(COLUMNS, ROWS),
                       square=SIDE, lens=0, frame="left_02.pgm")
    assert list(one.cameras) == ["camera"] and "left_02.pgm" in one.world
    assert abs(one.cameras["camera"].K[0, 0] - found.cameras["left"].K[0, 0]) < 2


@pytest.mark.parametrize("board, told, says", [
    ("chessboard", {}, "needs squares"),
    ("chess 8x7 18", {}, "no kind of board"),
    ("charuco 8x7 18 20", {}, "do not fit into squares"),
    (BOARD, {"square": 3.0}, "square is told twice"),
    (BOARD, {"lens": 3}, "lens 3"),
    (BOARD, {"unit": "inch"}, "no 'inch'"),
    (BOARD, {"square": float("nan")}, "no length|told twice"),
    ("chessboard 11x10 18", {}, "no chessboard of 11x10"),
])
def test_what_is_wrong_is_told_in_the_words_of_python(photos, board, told, says):
    with pytest.raises(he.InputError, match=says) as raised:
        he.calibrate(photos / "left_0*.pgm", board, **told)
    assert "--" not in str(raised.value) and "hookeye calibrate" not in str(raised.value)


def test_photos_that_are_not_there_have_their_place(tmp_path):
    with pytest.raises(he.InputError) as raised:
        he.calibrate(tmp_path / "none_*.png", BOARD)
    assert raised.value.file.endswith("none_*.png")
    with pytest.raises(he.InputError, match="no photos"):
        he.calibrate({}, BOARD)
    with pytest.raises(he.InputError, match="cannot have the name"):
        he.calibrate({"a b": "x"}, BOARD)


def test_a_dictionary_that_is_not_told_and_not_there(photos):
    with pytest.raises(he.InputError, match="no dictionary of markers"):
        he.calibrate(photos / "left_01.pgm", "charuco 7x5 20 15")


def test_other_threads_go_on_and_cancel_ends_it(photos):
    stop, ticks = threading.Event(), []

    def count():
        while not stop.wait(0.001):
            ticks.append(1)

    beside = threading.Thread(target=count)
    beside.start()
    cancel = threading.Event()
    with pytest.raises(he.Cancelled):
        he.calibrate(patterns(photos), BOARD, cancel=cancel, on_step=lambda now: cancel.set())
    stop.set()
    beside.join()
    assert ticks
    with pytest.raises(ZeroDivisionError):
        he.calibrate(patterns(photos), BOARD, on_step=lambda now: 1 / 0)
