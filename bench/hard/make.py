"""A capture whose truth CalculiX solves and Blender photographs (README.md)."""

import argparse
import json
import os
import shutil

import numpy as np

import draw
from case import Case, plain
from hidden import EFFECTS


def flow(value):
    """One line of yaml."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k}: {flow(v)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(map(flow, value)) + "]"
    if isinstance(value, (float, np.floating)):
        return f"{value:.9g}"
    return str(value)


def block(value, depth, indent=0):
    lines = []
    for key, item in value.items():
        if isinstance(item, dict) and item and depth > 1:
            lines += [f"{' ' * indent}{key}:"] + block(item, depth - 1, indent + 2)
        else:
            lines.append(f"{' ' * indent}{key}: {flow(item)}")
    return lines


def told_regions(case):
    found = {}
    for name, (point, normal, patch) in case.regions.items():
        found[name] = {"halfspace": {"point": (point - 0.1 * normal).round(5), "normal": normal.round(7)}}
    return found


def told_cameras(case):
    found = {}
    for name, eye in case.spec["cameras"].items():
        found[name] = {"size": eye["size"], "intrinsics": {k: eye[k] for k in ("fx", "fy", "cx", "cy")},
                       "pose": {"rotation": eye["R"], "translation": eye["t"]}}
    return found


def told_examples(case):
    found = {}
    for name, told in case.examples.items():
        example = {"use": "validate"} if told["use"] == "validate" else {}
        forces = case.told_force.get(name, told["forces"])
        if told["forces"] or told["moved"]:
            example["supports"] = [{"region": r, "fix": ["x", "y", "z"]} for r in told["held"]]
            example["supports"] += [{"region": r, "move": dict(zip("xyz", v))} for r, v in told["moved"].items()]
        if forces:
            example["loads"] = [{"region": r, "force": f} for r, f in forces.items()]
        photos = {c: case.files[name, c] for c in told["photos"]}
        photos = {c: {"file": file, "mask": case.masks[c]} if c in case.masks else file for c, file in photos.items()}
        found[name] = {**example, "photos": photos}
    return found


def tell(case):
    spec = case.spec
    shutil.copy(os.path.join(case.work, "body.stl"), case.capture)
    document = {"hookeye": 1, "title": spec["title"], "units": {"length": "mm", "force": "N"},
                "body": {"surface": "body.stl", "mesh": {"edge": spec["told_edge"]}, **spec["told_body"]},
                "model": spec["told_model"], "cameras": told_cameras(case)}
    for key in ("light", "photos"):
        if spec["told_" + key]:
            document[key] = spec["told_" + key]
    document["regions"] = told_regions(case)
    document["examples"] = told_examples(case)
    with open(os.path.join(case.capture, "capture.yaml"), "w") as file:
        file.write("\n".join(block(document, 3)) + "\n")


def main():
    parser = argparse.ArgumentParser(prog="bench/hard/make", description=__doc__)
    parser.add_argument("spec", help="a seed, `bracket`, or a specification (json)")
    parser.add_argument("-o", "--out", required=True, help="gets capture/ and truth.json")
    parser.add_argument("--solve-only", action="store_true", help="print how far it moves; no photos")
    parser.add_argument("--differences", action="store_true", help="solve without what is hidden too, for truth.json")
    parser.add_argument("--keep", action="store_true", help="leave decks, solutions and linear pictures in work/")
    told = parser.parse_args()
    if told.spec == "bracket":
        spec = draw.bracket()
    elif told.spec.isdigit():
        spec = draw.drawn(int(told.spec))
    else:
        with open(told.spec) as file:
            spec = json.load(file)
    case = Case(spec, told.out)
    case.solve(told.differences)
    shifts = case.shifts()
    for name, one in shifts.items():
        print(name, " ".join(f"{k} {v:.3g}" for k, v in one.items()), flush=True)
    if told.solve_only:
        return
    case.photograph()
    tell(case)
    truth = {"title": spec["title"], "hidden": list(spec["hidden"]), "values": case.hidden_values,
             "right": sorted({e for name in spec["hidden"] for e in EFFECTS[name]}),
             "mu": spec["mu"], "kappa": spec["kappa"], "examples": shifts, "specification": spec}
    with open(os.path.join(told.out, "truth.json"), "w") as file:
        json.dump(truth, file, indent=1, default=plain)
    if not told.keep:
        shutil.rmtree(case.work)


main()
