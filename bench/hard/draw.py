"""Specifications of captures: `drawn(seed)`, and one by hand.

What make.py must still choose to size (forces, strength of what is hidden, focal lengths) stands as an aim.
"""

import itertools

import numpy as np

from body import rotation, unit
from shapes import SHAPES
from stand import area_lamp, look_at, speckle, sun

BRACKET = """
module part() difference() {
  union() {
    translate([0, -7.5, 0]) cube([60, 15, 14]);
    translate([0, -7.5, 0]) cube([14, 15, 52]);
    rotate([90, 0, 0]) translate([0, 0, -3]) linear_extrude(6) polygon([[13.9, 13.9], [26, 13.9], [26, 14], [14, 26], [13.9, 26]]);
  }
  translate([52, 0, -1]) cylinder(r = 3.5, h = 20, $fn = 48);
}
"""


def bracket():
    """An L with a hole and a rib; a stiff ball in the leg between hole and corner."""
    rng = np.random.default_rng(2024)
    turn = [[[1, 0, 0], 30], [[0, 1, 0], 30]]
    matrix = rotation(*turn[1]) @ rotation(*turn[0])
    move = [37.0, -12.0, 81.0]
    middle = (matrix @ [28, 0, 24] + move).round(3).tolist()
    ball = {"centres": [[37, 0.5, 7.0]], "radius": 6.0, "strength": 4.0}

    def example(force, use="fit"):
        world = (matrix @ np.array(force)).round(4).tolist()
        return {"use": use, "held": ["wall"], "moved": {}, "forces": {"end": world}, "photos": ["left", "right"]}
    rest = {"use": "fit", "held": ["wall"], "moved": {}, "forces": {}, "photos": ["left", "right"]}
    examples = {"rest": rest, "lift": example([0, 0, 0.048]), "push": example([0.034, 0, 0]),
                "swing": example([0, 0.021, 0.0]), "oblique": example([-0.016, -0.012, -0.02]),
                "check_down": example([0.008, 0.004, -0.04], "validate"),
                "check_side": example([-0.02, 0.012, 0.01], "validate")}
    light = {"ambient": 0.5, "lamps": [area_lamp([-0.5, -0.7, 0.8], middle, 0.5)]}
    sensor = {"full_well": 8000, "read": 0.002, "encoding": "linear", "bits": 16, "file": "png", "colour": False}
    return {
        "seed": 2024, "title": "silicone bracket", "scad": BRACKET, "turn": turn, "move": move,
        "edge": 3.6, "fine": [[ball["centres"][0], 6.5, 1.9], [[52, 0, 7], 5.0, 2.2]], "surface_edge": 1.2, "smooth": 30,
        "regions": {"wall": [[60, 0, 7], [1, 0, 0]], "end": [[7, 0, 52], [0, 0, 1]]},
        "mu": 0.06, "kappa": 0.72, "hidden": {"ball": ball}, "examples": examples,
        "cameras": {"left": look_at(middle, -120, 20, 420, 2150, (640, 480)),
                    "right": look_at(middle, -60, 20, 420, 2150, (640, 480))},
        "skin": speckle(0.8, rng), "light": light, "samples": 64, "background": 0.05, "props": [], "sensor": sensor,
        "told_edge": 4.0,
        "told_body": {"density": 1.07e-9, "shading": "flat", "texture": {"from": "rest"}},
        "told_model": {"material": {"law": "neo-hookean", "mu": 0.05, "kappa_over_mu": 12}, "fit": ["mu"]},
        "told_light": {},
        "told_photos": {"encoding": "linear", "noise": {"full_well": 8000, "read": 0.002}},
    }


KINDS = ["nothing", "ball", "halves", "gravity", "camera", "direction", "fibre", "orthotropic", "swelling", "soft_clamp"]


def kind_of(seed):
    """Body and hidden thing: each pair once in fifty seeds."""
    pairs = list(itertools.product(SHAPES, KINDS))
    order = np.random.default_rng([(seed - 1) // len(pairs), 3]).permutation(len(pairs))
    return pairs[order[(seed - 1) % len(pairs)]]


def chance(rng, share):
    return bool(rng.random() < share)


def on_sphere(rng):
    return unit(rng.normal(size=3)).round(4).tolist()


def load_cases(rng, shape, views, rest):
    """Directions in the part's frame and aims in mm; make.py finds the forces."""
    count = 3 + chance(rng, 0.5)
    along = np.array(shape["regions"]["end"][1], float)
    names = [f"load{k}" for k in range(1, count + 1)] + ["check"]
    directions = []
    while len(directions) < len(names):  # apart from each other, and half of them not along the axis
        way = unit(rng.normal(size=3) + 0.6 * along * rng.choice([-1, 0, 1]))
        if all(abs(way @ other) < 0.85 for other in directions):
            directions.append(way)
    if shape.get("flat"):  # a sheet does not bear pressing along itself
        directions = [d + 2 * abs(d @ along) * along if d @ along < 0 else d for d in directions]
    blank = {"use": "fit", "held": ["base"], "moved": {}, "forces": {}, "photos": views}
    examples = {"rest": blank} if rest else {}
    for name, way in zip(names, directions):
        aim = round(float(rng.uniform(*shape["aim"])), 2)
        examples[name] = {**blank, "use": "validate" if name == "check" else "fit",
                          "aim": {"region": "end", "direction": way.round(4).tolist(), "mm": aim}}
    return examples


def hidden_values(rng, kind, shape, examples, views, seed):
    loaded = [name for name, told in examples.items() if "aim" in told and told["use"] == "fit"]
    centre, room = (np.array(x, float) for x in shape["inside"])
    place = lambda: (centre + room * rng.uniform(-1, 1, 3)).round(2).tolist()
    centres = [place()]
    if shape.get("flat"):
        centres.append((np.array(centres[0]) + [0, shape["room"] * 2.3, 0]).round(2).tolist())
    values = {"nothing": {}, "ball": {"centres": centres, "radius": shape["room"], "strength": 3.0},
              "halves": {"along": shape["long"], "at": round(float(rng.uniform(0.4, 0.6)), 2), "strength": 0.5},
              "gravity": {"toward": unit(np.array([0, 0, -1]) + 0.15 * rng.normal(size=3)).round(4).tolist()},
              "swelling": {"strength": 0.01}, "soft_clamp": {"strength": 5.0},
              "direction": {"example": str(rng.choice(loaded)), "toward": on_sphere(rng), "strength": 8.0},
              "fibre": {"along": on_sphere(rng), "strength": round(float(rng.uniform(0.6, 1.5)), 2)},
              "orthotropic": {"along": on_sphere(rng), "strength": round(float(rng.uniform(0.4, 1.0)), 2)},
              "camera": {"camera": str(rng.choice(views)), "from": str(rng.choice(loaded[1:])), "axis": on_sphere(rng),
                         "move": on_sphere(rng), "strength": 1.0}}[kind]
    return {kind: {**values, "aim_px": round(float(np.exp(rng.uniform(0, np.log(8)))), 2)}}


def draw_light(rng):
    """Lamps by what is told of them: direction from the body, strength, size."""
    kind = str(rng.choice(["sun", "area", "two areas", "tent"]))
    toward = [float(rng.uniform(-0.8, 0.8)), -0.8, float(rng.uniform(0.5, 1.1))]
    lamps = {"sun": [("sun", toward, 0.45)], "area": [("area", toward, 0.5)],
             "two areas": [("area", toward, 0.3), ("area", [-toward[0] + 0.5, -0.6, 0.4], 0.25)], "tent": []}[kind]
    return {"kind": kind, "ambient": {"sun": 0.4, "area": 0.4, "two areas": 0.35, "tent": 0.75}[kind], "lamps": lamps}


def draw_skin(rng, dot):
    told = speckle(dot, rng, uneven=0.09 if chance(rng, 0.3) else 0.0)
    kind = str(rng.choice(["matte", "matte", "gloss", "subsurface"]))
    if kind == "gloss":
        told.update(specular=round(float(rng.uniform(0.2, 0.5)), 2), roughness=round(float(rng.uniform(0.35, 0.6)), 2))
    if kind == "subsurface":
        told.update(subsurface=0.3, depth=round(float(rng.uniform(0.4, 1.2)), 2))
    return {**told, "kind": kind}


def draw_sensor(rng, green):
    if green:
        return {"full_well": 8000, "read": 0.003, "encoding": "linear", "bits": 8, "file": "png", "colour": True, "key": 0.04}
    sensor = {"full_well": int(rng.choice([5000, 10000, 20000])), "read": 0.002}
    kinds = {"jpeg": {"encoding": "srgb", "bits": 8, "file": "jpeg", "quality": 90, "colour": True},
             "srgb8": {"encoding": "srgb", "bits": 8, "file": "png", "colour": chance(rng, 0.5)},
             "linear8": {"encoding": "linear", "bits": 8, "file": "png", "colour": False},
             "linear16": {"encoding": "linear", "bits": 16, "file": "png", "colour": False}}
    return {**sensor, **kinds[str(rng.choice(list(kinds)))]}


def told_photos(rng, sensor):
    if "key" in sensor:
        return {"kind": "silhouette"}
    if sensor["file"] == "jpeg":
        return {"encoding": "srgb", "noise": 0.015}
    told = {"encoding": sensor["encoding"]}
    if chance(rng, 0.5):
        read = float(np.hypot(sensor["read"], 1 / 255 / 12 ** 0.5 if sensor["bits"] == 8 else 0))
        told["noise"] = {"full_well": sensor["full_well"], "read": round(read, 5)}
    return told


def drawn(seed, size=(400, 300), samples=32):
    body, kind = kind_of(seed)
    rng = np.random.default_rng([seed, 1])
    shape = SHAPES[body](rng)
    green, rest = chance(rng, 0.12) and kind != "camera", chance(rng, 2 / 3)
    views = [["left", "right"], ["left", "right"], ["front"]][int(rng.integers(3))]
    turn = [[on_sphere(rng), round(float(rng.uniform(10, 40)), 1)]] if chance(rng, 0.6) else []
    examples = load_cases(rng, shape, views, rest or green)
    azimuth, spread = float(rng.uniform(-120, -60)), float(rng.uniform(40, 75))
    angles = {"front": azimuth, "left": azimuth - spread / 2, "right": azimuth + spread / 2}
    mu = round(float(rng.uniform(0.04, 0.07)), 4)
    sensor = draw_sensor(rng, green)
    
    skin = draw_skin(rng, float(rng.uniform(3, 5)))  # in px
    if green:
        skin["layers"] = []
    texture = {"uniform": 0.6} if green else {"from": "rest" if rest else "load1"}
    return {
        "seed": seed, "title": f"{body} {seed}", "body": body, **{k: shape[k] for k in ("regions", "edge")},
        **{k: shape[k] for k in ("scad", "blob") if k in shape}, "turn": turn,
        "move": rng.uniform(-60, 60, 3).round(2).tolist(), "fine": [], "smooth": 30,
        "mu": mu, "kappa": round(12 * mu, 4), "hidden": hidden_values(rng, kind, shape, examples, views, seed),
        "examples": examples,
        "views": {v: {"azimuth": round(angles[v], 1), "elevation": round(float(rng.uniform(8, 35)), 1)} for v in views},
        "size": list(size), "away": 7.0, "lens": chance(rng, 0.25) and not green, "clamp": chance(rng, 0.35) and not green, "green": green,
        "skin": skin, "draw_light": draw_light(rng), "samples": samples,
        "background": round(float(rng.uniform(0.02, 0.2)), 3), "props": [], "sensor": sensor,
        "told_edge": round(shape["edge"] * float(rng.uniform(0.9, 1.15)), 2),
        "told_body": {"density": 1.07e-9, "texture": texture},
        "told_model": {"material": {"law": "neo-hookean", "mu": round(mu * float(rng.uniform(0.7, 1.3)), 4),
                                    "kappa_over_mu": 12}, "fit": ["mu"]},
        "told_light": {}, "told_photos": told_photos(rng, sensor),
    }
