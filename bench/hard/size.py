"""What is sized by the body itself: focal lengths, paint, forces, and how strong the hidden thing is.

Linear solves of CalculiX say how far a force moves the body; the capture's equilibria are solved in full afterwards.
"""

from dataclasses import dataclass

import numpy as np

from body import rotation, unit
from calculix import Problem
from hidden import HIDDEN, LINEAR
from stand import area_lamp, look_at, sun

LIMITS = {"ball": (1.5, 20), "halves": (0.1, 4), "swelling": (0.001, 0.05), "soft_clamp": (0.5, 400), "direction": (2, 30),
          "camera": (0.1, 20)}


@dataclass
class Linear(Problem):
    def deck(self):
        bulk = lambda mu, kappa: (9 * kappa * mu / (3 * kappa + mu), (3 * kappa - 2 * mu) / (6 * kappa + 2 * mu))
        self.material = lambda mu, kappa: "*ELASTIC\n{:.9g},{:.9g}\n".format(*bulk(mu, kappa))
        return super().deck().replace("*STEP,NLGEOM,INC=500", "*STEP")


def frame(spec, vertices):
    """Cameras, lamps and props around the vertices, and the paint in px of the first camera. Changes `spec`."""
    centre = (vertices.min(0) + vertices.max(0)) / 2
    most = max(told["aim"]["mm"] for told in spec["examples"].values() if "aim" in told)
    radius = np.linalg.norm(vertices - centre, axis=1).max()
    away = spec["away"] * radius
    spec["cameras"] = {}
    for name, view in spec["views"].items():
        eye = look_at(centre, view["azimuth"], view["elevation"], away, 1.0, spec["size"])
        seen = np.abs((vertices - centre) @ np.array(eye["R"]).T).max(0) + most
        eye["fx"] = eye["fy"] = round(float(min(0.46 * s * (away - radius) / x for s, x in zip(spec["size"], seen))), 1)
        if spec["lens"]:  # two px of blur at the far end of the body
            eye["lens"] = {"focus": away, "aperture": 2 * away ** 2 / radius / eye["fx"]}
        if spec["green"]:
            axes = np.array(eye["R"]).T
            eye["props"] = [{"centre": centre + axes[:, 2] * (radius + 90), "axes": axes, "half": [500, 500, 2],
                             "colour": [0.08, 0.55, 0.1]}]
        spec["cameras"][name] = eye
    scale = away / next(iter(spec["cameras"].values()))["fx"]
    for layer in spec["skin"]["layers"]:
        layer["cell"], layer["wander"] = layer["cell"] * scale, layer["wander"] * scale
    spec["surface_edge"] = 6 * scale
    lamps = [(sun if kind == "sun" else area_lamp)(toward, centre.tolist(), strength)
             for kind, toward, strength in spec["draw_light"]["lamps"]]
    spec["light"] = {"ambient": spec["draw_light"]["ambient"], "lamps": lamps}


def clamp(case):
    """A block that holds the base, and a table under all."""
    point, normal, patch = case.regions["base"]
    corners = case.body.nodes[np.unique(patch)]
    first = unit(np.cross(normal, [0.31, 0.92, 0.22]))
    axes = np.array([first, np.cross(normal, first), normal]).T
    inside = (corners - corners.mean(0)) @ axes
    half = [*(1.1 * np.abs(inside[:, :2]).max(0)), 5.0]
    block = {"centre": corners.mean(0) + 5.05 * normal, "axes": axes, "half": half, "colour": [0.25] * 3, "rough": False}
    low = case.body.nodes[:, 2].min() - 12
    table = {"centre": [*case.body.nodes.mean(0)[:2], low - 5], "axes": np.eye(3), "half": [300, 300, 5],
             "colour": [0.3, 0.26, 0.2]}
    case.spec["props"] = [block, table]


def forces(case):
    """The force of each example that moves it by its aim; returns the linear displacements by example."""
    found = {}
    for name, told in case.examples.items():
        aim = told.get("aim")
        if not aim:
            continue
        way = case.direction(unit(aim["direction"]))
        told["forces"] = {aim["region"]: way}
        u = case.problem(name, Linear).solve(case.work, "linear_" + name)[0]
        size = aim["mm"] / np.linalg.norm(case.body.carried(u), axis=1).max()
        told["forces"] = {aim["region"]: [float(f"{x:.4g}") for x in size * way]}
        found[name] = size * u
    return found


def hidden_px(case, values, kind, name, plain):
    """By how much the pictures of an example move, rms over the surface, by linear solves."""
    case.physics, case.optics = [], []
    HIDDEN[kind](case, values)
    order = list(case.examples).index(name)
    camera = case.examples[name]["photos"][0]
    if kind == "camera":
        camera = values["camera"]
        photo = dict(case.spec["cameras"][camera])
        case.optics[0](photo, name, len(case.examples), camera)
        return case.rms(plain, plain, case.spec["cameras"][camera], photo)
    problem = case.problem(name, Linear)
    for change in case.physics:
        change(problem, name, order)
    u = problem.solve(case.work, "linear_hidden")[0]
    return case.rms(u, plain, case.spec["cameras"][camera])


def strength(case, linear):
    """Sets how strong the hidden thing is; what is not linear stays as drawn."""
    (kind, values), = case.spec["hidden"].items()
    if kind not in LINEAR:
        return
    loaded = [n for n in linear if case.examples[n]["use"] == "fit"]
    name = values.get("example", loaded[0])
    for _ in range(2):
        px = hidden_px(case, values, kind, name, linear[name])
        ratio = values["aim_px"] / max(px, 1e-6)
        if kind == "gravity":  # the body's stiffness is what is free; loads keep their motions
            harden(case, 1 / ratio)
            break
        values["strength"] = float(np.clip(values["strength"] * ratio, *LIMITS[kind]))
        if kind in ("swelling", "camera", "direction"):
            break
    case.physics, case.optics = [], []


def harden(case, factor):
    spec = case.spec
    factor = float(np.clip(factor, 0.2, 50))
    spec["mu"], spec["kappa"] = spec["mu"] * factor, spec["kappa"] * factor
    material = spec["told_model"]["material"]
    material["mu"] = float(f"{material['mu'] * factor:.3g}")
    for told in case.examples.values():
        told["forces"] = {k: [float(f"{factor * x:.4g}") for x in f] for k, f in told["forces"].items()}
