"""One capture out of its specification (a dict as draw.py makes and bracket.json holds): solve, photograph, tell.

The capture tells what a lab would know. What is hidden stands in truth.json beside it.
"""

import json
import os
import subprocess
import sys

import numpy as np

import body as bodies
from body import Body, rotation, unit
from develop import develop, keyed

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(1, os.path.join(HERE, "..", "other_programs"))
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
        bodies.draw(self.spec["scad"], self.turn, self.move, stl)
        fine = [(self.place(c), r, e) for c, r, e in self.spec["fine"]]
        self.body = Body(stl, self.spec["edge"], fine, self.spec["surface_edge"])
        self.regions = {}
        for name, (point, normal) in self.spec["regions"].items():
            point, normal = self.place(point), self.direction(unit(normal))
            patch = self.body.patch(point, normal)
            if not len(patch):
                raise SystemExit(f"region {name}: no triangle of the mesh lies on its plane")
            self.regions[name] = (point, normal, patch)

    def problem(self, example):
        told = self.examples[example]
        problem = Problem(self.body, self.spec["mu"], self.spec["kappa"], increment=0.5,
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
        order = list(self.examples)
        self.hidden_values = {name: HIDDEN[name](self, values) for name, values in self.spec["hidden"].items()}
        self.displacement, self.plain = {}, {}
        for k, name in enumerate(order):
            base, true = self.problem(name), self.problem(name)
            for change in self.physics:
                change(true, name, k)
            self.displacement[name] = self.equilibrium(true, name)
            if differences:
                self.plain[name] = self.equilibrium(base, name)

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
                         "positions": f"{name}.npy", "picture": f"{name}_{camera}.npy", "props": []}
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
        self.files = {}
        for (name, camera), photo in asked.items():
            light = np.load(os.path.join(self.work, photo["picture"])).astype(float)
            stem = os.path.join(self.capture, "photos", f"{name}_{camera}")
            write = keyed if self.spec["sensor"].get("key") else develop
            sensor = {**self.spec["sensor"], "gain": photo.get("gain", 1.0)}
            self.files[name, camera] = os.path.relpath(write(light, sensor, stem, self.rng), self.capture)

    def pixels(self, displacement, camera):
        """Where the surface stands in a picture."""
        eye = self.spec["cameras"][camera]
        x = (self.body.surface + self.body.carried(displacement)) @ np.array(eye["R"]).T + eye["t"]
        return x[:, :2] / x[:, 2:] * eye["fx"] + [eye["cx"], eye["cy"]]

    def shifts(self):
        """By example: motion from rest and what the hidden thing moves, rms over the surface, px of the first camera."""
        rms = lambda a, b, camera: float(np.sqrt(((self.pixels(a, camera) - self.pixels(b, camera)) ** 2).sum(1).mean()))
        still = np.zeros_like(self.body.nodes)
        found = {}
        for name, told in self.examples.items():
            camera = told["photos"][0]
            u = self.displacement[name]
            found[name] = {"motion_px": rms(u, still, camera), "largest_mm": float(np.linalg.norm(self.body.carried(u), axis=1).max())}
            if name in self.plain:
                found[name]["hidden_px"] = rms(u, self.plain[name], camera)
        return found


def plain(value):
    """For json."""
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else str(value)
