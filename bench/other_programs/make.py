"""A capture whose truth CalculiX solves and Blender photographs (README.md)."""

import argparse
import contextlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import OpenImageIO as oiio
import yaml
from scipy.spatial.transform import Rotation

from body import Body, unit
from calculix import Problem
from effects import EFFECTS

PHOTOGRAPHER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "blind", "cycles")
FULL_WELL, READ, STEP = 20000, 0.0009, 1 / 255


class Case:
    """The body with loads, light and stiffness of its own; what is hidden is appended by the effects."""

    def __init__(self, body, rng, work, pictures):
        self.body, self.rng, self.work, self.told = body, rng, work, body.told
        self.physics, self.optics, self.turned, self.follows = [], [], {}, {}
        self.place, self.force_offset = (Rotation.identity(), np.zeros(3)), np.zeros(3)
        self.mu = rng.uniform(0.042, 0.06)
        material = self.told["model"]["material"]
        scale = self.mu / material["mu"]
        material["mu"] = round(float(0.8 * self.mu), 5)
        self.kappa = self.mu * material["kappa_over_mu"]
        self.order, self.cameras = list(self.told["examples"]), list(self.told["cameras"])
        self.draw_loads(scale)
        self.draw_light()
        self.scale_pictures(pictures)

    def draw_loads(self, scale):
        for name in self.order:
            turn = Rotation.from_rotvec([0, 0, self.rng.uniform(-np.pi, np.pi)])
            for load in self.told["examples"][name].get("loads", []):
                force = np.array(load["force"]) * scale * self.rng.uniform(0.75, 1.0)
                load["force"] = (force if load["region"] == "side" else turn.apply(force)).round(4).tolist()
            held = self.held(name)
            if held:
                share = self.rng.uniform(0.75, 1.0)
                held["move"] = [round(share * x, 4) for x in held["move"]]
                if "rotate" in held:
                    held["rotate"]["degrees"] = round(share * float(self.rng.choice([-1, 1])) * held["rotate"]["degrees"], 4)

    def draw_light(self):
        sun = self.told["light"]["sun"]
        turn = Rotation.from_rotvec([0, 0, self.rng.uniform(-0.6, 0.6)])
        sun["toward"] = turn.apply(unit(sun["toward"])).tolist()

    def scale_pictures(self, scale):
        for camera in self.told["cameras"].values():
            camera["size"] = [round(scale * x) for x in camera["size"]]
            inner = camera["intrinsics"]
            for key in ("fx", "fy"):
                inner[key] *= scale
            for key in ("cx", "cy"):
                inner[key] = (inner[key] + 0.5) * scale - 0.5

    def held(self, name):
        rigid = [s["rigid"] for s in self.told["examples"][name]["supports"] if "rigid" in s]
        return rigid[0] if rigid else None

    def fitted(self, name):
        return self.told["examples"][name].get("use", "fit") == "fit"

    def force(self, name):
        return np.array(self.told["examples"][name]["loads"][0]["force"])

    def problem(self, name, hidden):
        body = self.body
        problem = Problem(body, self.mu, self.kappa, forces=np.zeros((len(body.nodes), 3)))
        problem.fixed = {node: np.zeros(3) for node in body.nodes_of("base")}
        for load in self.told["examples"][name].get("loads", []):
            shares, force = body.areas(load["region"]), np.array(load["force"])
            if hidden and name in self.turned:
                force = self.turned[name].apply(force)
            problem.forces += shares[:, None] / shares.sum() * force
        held = self.held(name)
        if held:
            share = self.follows.get(name, 1) if hidden else 1
            move, turn, centre = share * np.array(held["move"]), Rotation.identity(), np.zeros(3)
            if "rotate" in held:
                rotate = held["rotate"]
                turn = Rotation.from_rotvec(share * np.radians(rotate["degrees"]) * unit(rotate["axis"]))
                centre = np.array(rotate["center"])
            for node in body.nodes_of("grip"):
                arm = body.nodes[node] - centre
                problem.fixed[node] = turn.apply(arm) - arm + move
        if hidden:
            for change in self.physics:
                change(problem, name, self.order.index(name))
        return problem

    def solve(self, name, hidden=True):
        return self.problem(name, hidden).solve(self.work, name)

    def measure(self, name, u, force):
        """What the grip's support exerts on the body, with noise, into the capture."""
        grip = self.body.nodes_of("grip")
        for line in self.told["examples"][name].get("measured", []):
            value = force[grip].sum(0) + self.force_offset
            if "moment_on" in line:
                arms = (self.body.nodes + u)[grip] - line["about"]
                value = np.cross(arms, force[grip]).sum(0)  # the zero of the force sensor leaves moments alone
            line["value"] = (value + line["sigma"] * self.rng.normal(size=3)).round(4).tolist()

    def photo(self, name, camera):
        told, light = self.told["cameras"][camera], self.told["light"]
        photo = {"picture": f"{name}_{camera}.exr", "surface": f"{name}.obj", "size": told["size"],
                 **{k: told["intrinsics"][k] for k in ("fx", "fy", "cx", "cy")},
                 "R": np.array(told["pose"]["rotation"]), "t": np.array(told["pose"]["translation"]),
                 "ambient": light["ambient"], "background": 0.0,
                 "sun": light["sun"]["strength"] * np.array(light["sun"]["toward"])}
        for change in self.optics:
            change(photo, name, self.order.index(name), camera)
        return photo


def plain(value):
    """For json."""
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else str(value)


def develop(source, target, gain, rng):
    light = gain * oiio.ImageBuf(source).get_pixels(oiio.FLOAT)[:, :, 0].astype(float)
    light += rng.normal(size=light.shape) * np.sqrt(np.maximum(light, 0) / FULL_WELL + READ**2)
    levels = np.clip(np.round(255 * light), 0, 255).astype(np.uint8)
    save_grey(levels, target)


def save_grey(levels, target):
    spec = oiio.ImageSpec(levels.shape[1], levels.shape[0], 1, oiio.UINT8)
    picture = oiio.ImageBuf(spec)
    picture.set_pixels(spec.roi, levels[:, :, None])
    picture.write(target)


def photograph(case, displacements, out):
    albedo = oiio.ImageBuf(os.path.join(case.body.folder, case.told["body"]["texture"]["image"]))
    grey = albedo.get_pixels(oiio.FLOAT)[:, :, :3].mean(2)
    save_grey(np.round(255 * grey).astype(np.uint8), os.path.join(out, "albedo.png"))
    turn, move = case.place
    for name, u in displacements.items():
        case.body.write_obj(os.path.join(case.work, f"{name}.obj"), turn.apply(case.body.nodes + u) + move)
    photos = {(name, camera): case.photo(name, camera) for name in case.order for camera in case.cameras}
    with open(os.path.join(case.work, "scene.json"), "w") as file:
        json.dump({"albedo": os.path.abspath(os.path.join(out, "albedo.png")), "photos": list(photos.values())},
                  file, default=plain)
    subprocess.run([PHOTOGRAPHER, case.work], check=True, env={**os.environ, "CYCLES_SAMPLES": "64"})
    for (name, camera), photo in photos.items():
        develop(os.path.join(case.work, photo["picture"]), os.path.join(out, "photos", f"{name}_{camera}.png"),
                photo.get("gain", 1.0), case.rng)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--body", required=True, help="capture with a `volume` whose body and cameras are taken")
    parser.add_argument("--effect", required=True, help="+ between: " + ", ".join(EFFECTS))
    parser.add_argument("--size", type=float, default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--examples", help="comma between; all unless told")
    parser.add_argument("--pictures", type=float, default=0.75, help="their size over that of the body's capture")
    parser.add_argument("--differences", action="store_true", help="solve without the effects too, for the truth file")
    parser.add_argument("--work", help="folder that keeps decks and solutions; solved ones serve again")
    parser.add_argument("-o", "--out", required=True)
    told = parser.parse_args()
    names = told.effect.split("+")
    if unknown := [n for n in names if n not in EFFECTS]:
        parser.error(f"no effect {unknown[0]}; there are {', '.join(EFFECTS)}")
    body = Body(told.body)
    if told.examples:
        body.told["examples"] = {k: body.told["examples"][k] for k in told.examples.split(",")}
    os.makedirs(os.path.join(told.out, "photos"))
    with contextlib.ExitStack() as stack:
        work = told.work or stack.enter_context(tempfile.TemporaryDirectory())
        os.makedirs(work, exist_ok=True)
        case = Case(body, np.random.default_rng(told.seed), work, told.pictures)
        drawn = np.random.default_rng([told.seed, 1])
        truth = {"effects": {name: EFFECTS[name](case, drawn, told.size) for name in names}, "mu": case.mu,
                 "kappa": case.kappa, "command": " ".join(sys.argv)}
        with ThreadPoolExecutor(2) as pool:
            solved = dict(zip(case.order, pool.map(case.solve, case.order)))
            if told.differences:
                base = pool.map(lambda name: case.solve(name, hidden=False), case.order)
                truth["differences_rms"] = {name: np.sqrt(((solved[name][0] - u)[body.surface_node] ** 2).sum(1).mean())
                                            for name, (u, _) in zip(case.order, base)}
        for name, (u, force) in solved.items():
            case.measure(name, u, force)
        photograph(case, {name: u for name, (u, _) in solved.items()}, told.out)
    finish(case, truth, told)


def finish(case, truth, told):
    for name in ("mesh.msh", "surface.obj", "grip_faces.txt", "side_faces.txt"):
        shutil.copy(os.path.join(told.body, name), told.out)
    name = os.path.basename(os.path.normpath(told.out))
    noise = {"full_well": FULL_WELL, "read": float(np.sqrt(READ**2 + STEP**2 / 12))}
    case.told.update(title=name)
    case.told["photos"]["noise"] = noise
    with open(os.path.join(told.out, "capture.yaml"), "w") as file:
        yaml.safe_dump(case.told, file, sort_keys=False, default_flow_style=None, width=120)
    with open(os.path.normpath(told.out) + ".truth.json", "w") as file:
        json.dump(truth, file, indent=1, default=plain)


main()
