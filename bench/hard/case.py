"""One capture out of its specification (a dict as draw.py makes and bracket.json holds): solve, photograph, tell.

The capture tells what a lab would know. What is hidden stands in truth.json beside it.
"""

import itertools
import json
import os
import subprocess
import sys

import numpy as np

import body as bodies
from body import Body, rotation, unit
from develop import develop, keyed, write_png

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(1, os.path.join(HERE, "..", "other_programs"))
import size  # noqa: E402
from calculix import Problem  # noqa: E402
from hidden import HIDDEN  # noqa: E402


class Case:
    def __init__(self, spec, out):
        self.spec, self.out, self.work = spec, out, os.path.join(out, "work")
        self.capture = os.path.join(out, "capture")
        os.makedirs(self.work, exist_ok=True)
        os.makedirs(os.path.join(self.capture, "photos"), exist_ok=True)
        self.rng = np.random.default_rng([spec["seed"], 7])
        self.turn = np.eye(3)
        for axis, degrees in spec["turn"]:
            self.turn = rotation(axis, degrees) @ self.turn
        self.move = np.array(spec["move"], float)
        self.examples = spec["examples"]
        self.physics, self.optics, self.told_force = [], [], {}
        self.shape()

    def place(self, point):
        """From the part's frame to the cameras'."""
        return self.turn @ np.asarray(point, float) + self.move

    def direction(self, vector):
        return self.turn @ np.asarray(vector, float)

    def shape(self):
        stl = os.path.join(self.work, "body.stl")
        if "blob" in self.spec:
            self.blob(stl)
        else:
            bodies.draw(self.spec["scad"], self.turn, self.move, stl)
            self.fill(stl)
        self.regions = {}
        for name, (point, normal) in self.spec["regions"].items():
            point, normal = self.place(point), self.direction(unit(normal))
            patch = self.body.patch(point, normal)
            if not len(patch):
                raise SystemExit(f"region {name}: no triangle of the mesh lies on its plane")
            self.regions[name] = (point, normal, patch)
        if self.spec.get("clamp"):
            size.clamp(self)

    def blob(self, stl):
        """Merged a little more or less until gmsh fills it."""
        for share in (0.3, 0.2, 0.1, 0.35, 0.25, 0.15):
            told = {**self.spec["blob"], "share": share, "turn": self.turn.tolist(), "move": self.move.tolist()}
            try:
                bodies.melt(told, stl)
                return self.fill(stl)
            except bodies.Failed as failed:
                last = failed
        raise last

    def fill(self, stl):
        if "cameras" not in self.spec:
            size.frame(self.spec, bodies.read_stl(stl)[0])
        fine = [(self.place(c), r, e) for c, r, e in self.spec["fine"]]
        self.body = Body(stl, self.spec["edge"], fine, self.spec["surface_edge"], "blob" in self.spec)

    def problem(self, example, kind=Problem):
        told = self.examples[example]
        problem = kind(self.body, self.spec["mu"], self.spec["kappa"], increment=0.5,
                       forces=np.zeros((len(self.body.nodes), 3)))
        for region in told["held"]:
            for node in np.unique(self.regions[region][2]):
                problem.fixed[node] = np.zeros(3)
        for region, vector in told["moved"].items():
            for node in np.unique(self.regions[region][2]):
                problem.fixed[node] = np.array(vector)
        for region, force in told["forces"].items():
            shares = self.body.areas(self.regions[region][2])
            problem.forces += shares[:, None] / shares.sum() * np.array(force)
        return problem

    def solve(self, differences):
        """Displacements of the nodes by example, with what is hidden and, for `differences`, without."""
        if "views" in self.spec:
            size.strength(self, size.forces(self))
        self.hidden_values = {name: HIDDEN[name](self, values) for name, values in self.spec["hidden"].items()}
        order = list(self.examples)
        loaded = [n for n, told in self.examples.items() if told["forces"]]
        turned = [values["example"] for values in self.spec["hidden"].values() if "example" in values]
        reference = self.reference()
        without = order if differences else [loaded[0], loaded[-1], *turned] if self.physics else []
        if without and reference:
            without = [*without, reference]
        self.displacement, self.plain = {}, {}
        for k, name in enumerate(order):
            base, true = self.problem(name), self.problem(name)
            for change in self.physics:
                change(true, name, k)
            self.displacement[name] = self.equilibrium(true, name)
            if name in without:
                self.plain[name] = self.equilibrium(base, name)

    def reference(self):
        """The example whose photos give the texture, if any does: the model's picture of it is right, whatever is hidden."""
        texture = self.spec["told_body"].get("texture")
        return texture.get("from") if isinstance(texture, dict) else None

    def equilibrium(self, problem, name):
        if not (problem.forces.any() or problem.growth is not None or any(np.any(u) for u in problem.fixed.values())):
            return np.zeros_like(self.body.nodes)
        return problem.solve(self.work, name)[0]

    def photos(self):
        """What is asked of the photographer, by example and camera."""
        asked = {}
        for k, (name, told) in enumerate(self.examples.items()):
            for camera in told["photos"]:
                photo = {**self.spec["cameras"][camera], "light": self.spec["light"],
                         "positions": f"{name}.npy", "picture": f"{name}_{camera}.npy"}
                for change in self.optics:
                    change(photo, name, k, camera)
                asked[name, camera] = photo
        return asked

    def photograph(self):
        for name, u in self.displacement.items():
            np.save(os.path.join(self.work, f"{name}.npy"), self.body.surface + self.body.carried(u))
        np.savez(os.path.join(self.work, "shape.npz"), rest=self.body.surface, faces=self.body.faces)
        asked = self.photos()
        scene = {key: self.spec[key] for key in ("skin", "samples", "seed", "smooth", "background", "props")}
        with open(os.path.join(self.work, "scene.json"), "w") as file:
            json.dump({**scene, "photos": list(asked.values())}, file, default=plain)
        with open(os.path.join(self.work, "blender.log"), "w") as log:
            subprocess.run(["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python",
                            os.path.join(HERE, "photograph.py"), "--", self.work], check=True, stdout=log)
        self.files, self.masks = {}, {}
        if self.spec.get("clamp"):
            self.mask_clamp()
        for (name, camera), photo in asked.items():
            light = np.load(os.path.join(self.work, photo["picture"])).astype(float)
            stem = os.path.join(self.capture, "photos", f"{name}_{camera}")
            write = keyed if self.spec["sensor"].get("key") else develop
            sensor = {**self.spec["sensor"], "gain": photo.get("gain", 1.0)}
            self.files[name, camera] = os.path.relpath(write(light, sensor, stem, self.rng), self.capture)

    def mask_clamp(self):
        """The clamp hides what it holds: it is masked as a lab would, by its outline with a margin of 2 px."""
        block = self.spec["props"][0]
        signs = np.array(list(itertools.product((-1, 1), repeat=3)))
        corners = block["centre"] + (signs * block["half"]) @ np.transpose(block["axes"])
        for camera, eye in self.spec["cameras"].items():
            x = corners @ np.array(eye["R"]).T + eye["t"]
            outline = x[:, :2] / x[:, 2:] * eye["fx"] + [eye["cx"], eye["cy"]]
            self.masks[camera] = f"photos/mask_{camera}.png"
            hidden = within(outline, eye["size"], 2.0)
            write_png(os.path.join(self.capture, self.masks[camera]), np.where(hidden, 0, 255).astype(np.uint8))

    def pixels(self, displacement, eye):
        """Where the surface stands in a camera's picture."""
        x = (self.body.surface + self.body.carried(displacement)) @ np.array(eye["R"]).T + eye["t"]
        return x[:, :2] / x[:, 2:] * eye["fx"] + [eye["cx"], eye["cy"]]

    def rms(self, a, b, eye, other=None):
        """px between two states, or of one state in two cameras."""
        return float(np.sqrt(((self.pixels(a, eye) - self.pixels(b, other or eye)) ** 2).sum(1).mean()))

    def shifts(self):
        """By example: motion from rest and what the hidden thing moves, rms over the surface, px of the first camera."""
        still, reference = np.zeros_like(self.body.nodes), self.reference()
        found = {}
        for name, told in self.examples.items():
            eye, u = self.spec["cameras"][told["photos"][0]], self.displacement[name]
            found[name] = {"motion_px": self.rms(u, still, eye),
                           "largest_mm": float(np.linalg.norm(self.body.carried(u), axis=1).max())}
            if name in self.plain:
                found[name]["hidden_px"] = self.rms(u, self.plain[name], eye)
                if reference in self.plain:  # the texture has what is hidden of its own photos
                    lacks = [self.pixels(self.displacement[n], eye) - self.pixels(self.plain[n], eye) for n in (name, reference)]
                    found[name]["seen_px"] = float(np.sqrt(((lacks[0] - lacks[1]) ** 2).sum(1).mean()))
        for name, camera in itertools.product(self.examples, self.spec["cameras"]):
            photo = dict(self.spec["cameras"][camera])
            for change in self.optics:
                change(photo, name, list(self.examples).index(name), camera)
            if self.optics:
                u = self.displacement[name]
                found[name][f"moved_px_{camera}"] = self.rms(u, u, self.spec["cameras"][camera], photo)
        return found


def within(points, size, margin):
    """Pixels in the convex hull of points, and around it. Rows x columns."""
    x, y = np.meshgrid(np.arange(size[0]), np.arange(size[1]))
    inside = np.ones(x.shape, bool)
    for a, b in itertools.permutations(points, 2):  # a pair with all points on one side bounds the hull
        out = np.array([b[1] - a[1], a[0] - b[0]]) / max(np.linalg.norm(b - a), 1e-9)
        if np.max((points - a) @ out) < 1e-6:
            inside &= (x - a[0]) * out[0] + (y - a[1]) * out[1] < margin
    return inside


def plain(value):
    """For json."""
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else str(value)
