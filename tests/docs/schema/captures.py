"""Small captures and recipes with every key, and the files that they name."""
import struct
import zlib

UNITS = {"length": "mm", "force": "N"}
ROTATION = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
SIZE = (40, 32)

CALIBRATION = """%YAML:1.0
---
image_width: 40
image_height: 32
camera_matrix: !!opencv-matrix {rows: 3, cols: 3, dt: d, data: [20., 0., 19., 0., 21., 15., 0., 0., 1.]}
R: !!opencv-matrix {rows: 3, cols: 3, dt: d, data: [1., 0., 0., 0., 0., -1., 0., 1., 0.]}
T: !!opencv-matrix {rows: 3, cols: 1, dt: d, data: [1., 2., 300.]}
"""
KNOWN = "unit: mm\nframe: camera\nnumbers: {front: [fx, shift_z]}\ncovariance: [[0.01, 0.005], [0.005, 0.04]]\n"
CUBE = "".join(f"v {x} {y} {z}\n" for z in (0, 40) for y in (0, 20) for x in (0, 20)) + "".join(
    f"vt {i % 4 / 3:.3f} {i // 4 / 3:.3f}\n" for i in range(8)) + "".join(
    f"f {a}/{a} {b}/{b} {c}/{c}\n" for a, b, c in (
        (1, 3, 4), (1, 4, 2), (5, 6, 8), (5, 8, 7), (1, 2, 6), (1, 6, 5),
        (3, 7, 8), (3, 8, 4), (1, 5, 7), (1, 7, 3), (2, 4, 8), (2, 8, 6)))


def png(width, height, channels=1):
    rows = (b"\0" + b"\x80" * (width * channels)) * height
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    head = struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def write_files(folder):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "rest.obj").write_text(CUBE)
    (folder / "grip.txt").write_text("2 3\n")
    (folder / "left.yml").write_text(CALIBRATION)
    (folder / "known.yaml").write_text(KNOWN)
    (folder / "photo.png").write_bytes(png(*SIZE, 3))
    (folder / "u.csv").write_text("A,B,C,D,E,F\n1,0,5,0,0,0.1\n2,0,5,0,0,0.1\n1,0,6,0,0,0.1\n")


def full_capture():
    """Every key of format 1. `qqqqqqqq` of schema_test.py is put into each of its maps."""
    pose = {"rotation": ROTATION, "translation": [0, 40, 300]}
    photo = {"file": "photo.png", "kind": "image", "encoding": 2.2, "noise": 0.004, "channels": "rgb",
             "mask": "photo.png", "background": "ignore"}
    return {
        "hookeye": 1,
        "title": "every key",
        "units": UNITS,
        "body": {"surface": "rest.obj", "mesh": {"edge": 5, "order": 2}, "density": 1.07e-9,
                 "texture": {"image": "photo.png", "encoding": "srgb"}, "shading": "flat",
                 "placement": {"rotation": ROTATION, "translation": [0, 0, 5], "fit": True}},
        "model": {"material": {"soft": {"law": "neo-hookean", "mu": 0.05, "kappa": 0.5,
                                        "blend": {"along": [0, 0, 1], "at": [0, 40], "weight": [1, 0.5]}}},
                  "fit": ["soft.mu"], "gravity": [0, 0, -9810]},
        "cameras": {
            "front": {"size": list(SIZE), "projection": "perspective", "pose": pose,
                      "intrinsics": {"fx": 30, "fy": 31, "cx": 19.5, "cy": 15.5, "skew": 0, "distortion": [0.01, 0, 0, 0]}},
            "left": {"calibration": "left.yml", "vignetting": 1.2, "chromatic_shift": {"red": 1.0003, "blue": 0.9998}},
            "top": {"size": list(SIZE), "projection": "orthographic", "pose": pose,
                    "intrinsics": {"scale": 2, "cx": 19.5, "cy": 15.5}}},
        "camera_covariance": {"from": "known.yaml", "scale": 1},
        "light": {"ambient": 0.4, "sun": {"toward": [-0.3, -0.5, 0.8], "strength": 0.6}},
        "photos": {"kind": "image", "encoding": "srgb", "noise": {"full_well": 20000, "read": 0.0011},
                   "channels": "luminance", "background": {"photo": "photo.png"}},
        "regions": {"base": {"box": [[-50, -50, -0.1], [50, 50, 0.1]]}, "grip": {"faces": "grip.txt"},
                    "ball": {"sphere": {"center": [0, 0, 40], "radius": 5}},
                    "side": {"halfspace": {"point": [10, 0, 0], "normal": [2, 0, 0]}}, "inner": {"group": "cavity"}},
        "examples": {
            "rest": {"photos": {"front": "photo.png", "left": photo}},
            "pull": {
                "use": "validate",
                "supports": [
                    {"region": "base", "fix": ["x", "y", "z"]},
                    {"region": "grip", "move": {"x": 0, "z": 0.5}},
                    {"region": "ball", "rigid": {"rotate": {"axis": [0, 0, 1], "degrees": 20, "center": [0, 0, 40]},
                                                 "move": [0, 0, 5]}},
                    {"region": "side", "rigid": "fit"}],
                "loads": [{"region": "grip", "force": [0, 0, 2.5]}, {"region": "inner", "pressure": 0.002}],
                "photos": {"front": "photo.png"},
                "measured": [
                    {"force_on": "grip", "value": [0, 0, 2.5], "sigma": 0.02},
                    {"moment_on": "grip", "about": [0, 0, 40], "value": [0, 0, 35], "sigma": [2, 2, 2]},
                    {"position_of": [10, 0, 40], "value": [10.2, 0, 42.1],
                     "covariance": [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.4]]},
                    {"travel_of": "grip", "along": [0, 0, 1], "value": 2.5, "sigma": 0.1},
                    {"sensor": "opening", "value": [34.2, 1], "sigma": 0.05},
                    {"rotation_of": "grip", "axis": [0, 0, 1], "value": 20, "sigma": 0.5},
                    {"strain_of": [[20, 10, 10], [20, 10, 30]], "value": 0.01, "sigma": 2e-5},
                    {"field": "u.csv", "sigma": 0.01, "correlation": 2, "scale": 1, "tolerance": 100, "from": "rest",
                     "frame": {"origin": [0, 0, 0], "x": [1, 0, 0], "y": [0, 1, 0]},
                     "columns": {"X": "A", "Y": "B", "Z": "C", "U": "D", "V": "E", "W": "F"}},
                    {"field": "u.csv", "strain": "hencky", "sigma": [0.01, 0.01, 0.02], "gauge": 1.5,
                     "axes": [[0, 1, 0], [0, 0, 1]], "strain_unit": "percent", "unit": "mm", "tolerance": 100,
                     "columns": {"X": "A", "Y": "B", "Z": "C", "EXX": "D", "EYY": "E", "GXY": "F"}}]}},
    }


def plain_capture():
    """The same without pictures and calibrations, which cost a program of their own at each start."""
    out = full_capture()
    out["body"]["texture"] = {"uniform": "fit"}
    del out["photos"]["background"], out["cameras"]["left"]
    for example in out["examples"].values():
        example.pop("photos", None)
    return out


def full_recipes():
    """A drawn shape, and a surface of one's own: together every key."""
    cameras = {"count": 1, "size": [60, 80], "distance": 6, "focal": 300, "projection": ["perspective"], "distortion": [],
               "vignetting": 1,
               "azimuth": 0, "spread": 70, "elevation": 10}
    texture = {"texel": 1, "speckle": 4, "cover": 0.5, "soft": 0.35, "dark": 0.2, "bright": 0.8}
    example = {"use": "fit", "region": "grip", "move": [0, 0, 0.02], "rotate": 5, "axis": [0, 0, 1]}
    common = {
        "hookeye_recipe": 1, "title": "every key", "seed": 1, "units": UNITS,
        "material": {"law": "neo-hookean", "true": {"mu": 0.05, "kappa_over_mu": 12}, "told": {"mu": 0.04}, "fit": ["mu"]},
        "gravity": [0, 0, -9810],
        "light": {"ambient": 0.3, "toward": [1, 0, 0], "strength": 0.6},
        "hidden": [{"effect": "gravity", "variant": "x", "values": {"gravity.x": 1500}, "rms_px": 1, "times": 1}],
        "noise": {"full_well": 20000, "read": 0.001, "bits": 8, "force": 0.003, "moment": 0.003},
        "photos": {"kind": "silhouette", "threshold": 0.5},
        "truth": {"edge_factor": 1, "order": 1, "rays_per_axis": 2, "visibility_rays": 16},
    }
    drawn = {**common, "cameras": {**cameras, "look_at": 0.5},
             "examples": {"rest": {}, "turn": example, "pull": {"force": [0, 0, 0.1]}},
             "body": {"shape": "block", "size": [20, 20, 40], "taper": 1, "bumps": 0, "facet": 15, "density": 1.07e-9,
                      "mesh": {"edge": 12, "order": 1}, "texture": texture}}
    own = {**common, "cameras": {**cameras, "look_at": [0, 0, 20]}, "examples": {"rest": {}, "turn": example},
           "body": {"surface": "rest.obj", "density": 1.07e-9, "mesh": {"edge": 12},
                    "texture": {"texel": 1, "speckle": 4, "image": "photo.png", "encoding": "srgb"}},
           "regions": full_capture()["regions"]}
    return drawn, own
