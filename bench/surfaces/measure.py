"""Meshes the family, asks CGAL what it thinks of each surface, and says who was right (README.md)."""

import argparse
import collections
import json
import os
import re
import subprocess
import time

import numpy as np

from family import HERE, draw_all, finish, items

ENDING = {"stl": "stl", "binary": "stl", "obj": "obj", "ply": "ply"}


def second_opinion(out):
    program = os.path.join(out, "cgal")
    source = os.path.join(HERE, "cgal.cpp")
    if not os.path.exists(program) or os.path.getmtime(program) < os.path.getmtime(source):
        subprocess.run(["g++", "-std=c++20", "-O2", "-DNDEBUG", "-frounding-math", source, "-o", program, "-lgmp", "-lmpfr"],
                       check=True)
    return program


def hookeye(program, item, folder):
    """What `hookeye mesh` made of it: its document or its message, and the seconds of computing."""
    body = os.path.join(folder, "body.vtu")
    if os.path.exists(body):
        os.remove(body)
    before = os.times()
    start = time.monotonic()
    try:
        done = subprocess.run([program, "mesh", item["file"], "-o", body, "--json"], capture_output=True, text=True,
                              timeout=1800)
    except subprocess.TimeoutExpired:
        return {"exit": "timeout", "seconds": 1800.0, "wall": 1800.0, "message": ""}
    now = os.times()
    found = {"exit": done.returncode, "wall": round(time.monotonic() - start, 2),
             "seconds": round(now.children_user + now.children_system - before.children_user - before.children_system, 2),
             "message": done.stderr.strip()}
    if done.returncode == 0:
        document = json.loads(done.stdout)
        found["quality"], found["said"] = document["quality"], document["said"]
    return found


def faults(seen):
    """Kinds of faults that CGAL finds, with their places. Crossings count from what rounding may do on."""
    rounding = 1e-5 * seen["largest"]
    places = collections.defaultdict(list)
    for kind, a, b in seen["bad_edges"]:
        places[kind] += [a, b]
    for pair in seen["crossings"]:
        places["crossing" if pair[0] > rounding else "touching"] += pair[1:]
    return places


SPOKEN = [("hole", "open"), ("more than two triangles", "crowded"), ("turned against", "turned"), ("intersect", "crossing"),
          ("lies within another", "nested")]


def verdict(found, seen):
    places = faults(seen)
    real = [k for k in places if k != "touching"]
    if found["exit"] == 0:
        if "crossing" in real or "open" in real:
            return "meshed wrongly"
        volume = found["quality"]["volume"]
        near = abs(volume - abs(seen["volume"])) <= 0.01 * abs(seen["volume"])
        return "meshed" if near else "meshed with another volume"
    if found["exit"] != 2:
        return "no answer"
    told = [kind for words, kind in SPOKEN if words in found["message"]]
    numbers = re.search(r"\((\S+), (\S+), (\S+)\)", found["message"])
    if not told or told[0] not in places or not numbers:
        return "refused wrongly"
    place = np.array([float(x) for x in numbers.groups()])
    distance = np.linalg.norm(np.array(places[told[0]]) - place, axis=1).min()
    return "refused" if distance <= 1e-4 * max(seen["largest"], 1e-300) else "refused at another place"


def table(results):
    rows = ["| part | made by | number | meshed | refused for a fault that is there | wrong | worst ratio, median | seconds, median | longest |",
            "|---|---|---|---|---|---|---|---|---|"]
    groups = collections.defaultdict(list)
    for r in results:
        groups[(r["part"], r["maker"])].append(r)
    for (part, maker), group in list(groups.items()) + [(("all", ""), results)]:
        count = collections.Counter(r["verdict"] for r in group)
        meshed, refused = count["meshed"], count["refused"]
        ratios = [r["quality"]["min_radius_ratio"] for r in group if "quality" in r]
        rows.append("| %s | %s | %d | %d | %d | %d | %s | %.1f | %.1f |" % (
            part, maker, len(group), meshed, refused, len(group) - meshed - refused,
            "%.3f" % np.median(ratios) if ratios else "", np.median([r["seconds"] for r in group]),
            max(r["seconds"] for r in group)))
    return "\n".join(rows)


def main():
    ask = argparse.ArgumentParser(description=__doc__)
    ask.add_argument("hookeye")
    ask.add_argument("out", help="folder for surfaces and results")
    ask.add_argument("--count", type=int, default=512)
    ask.add_argument("--seed", type=int, default=1)
    ask.add_argument("--every", type=int, default=1, help="take every n-th surface of the family")
    told = ask.parse_args()
    os.makedirs(os.path.join(told.out, "raw"), exist_ok=True)
    os.makedirs(os.path.join(told.out, "surfaces"), exist_ok=True)
    cgal = second_opinion(told.out)
    family = items(told.count, told.seed)[::told.every]
    for item in family:
        item["raw"] = os.path.join(told.out, "raw", item["name"] + ".stl")
        item["file"] = os.path.join(told.out, "surfaces", item["name"] + "." + ENDING[item["format"]])
    draw_all(family, told.out, cgal)
    results = []
    for item in family:
        if not os.path.exists(item["raw"]):
            print("%s: %s drew nothing" % (item["name"], item["maker"]))
            continue
        finish(item)
        seen = json.loads(subprocess.run([cgal, "opinion", item["file"]], capture_output=True, text=True, check=True).stdout)
        found = hookeye(told.hookeye, item, told.out)
        result = item | found | {"faults": {k: len(v) for k, v in faults(seen).items()}, "verdict": verdict(found, seen)}
        results.append(result)
        print("%-18s %-8s %-8s %-24s %6.1f s  %s" % (
            item["name"], item["format"], item["damage"], result["verdict"], found["seconds"],
            "worst ratio %.3f" % found["quality"]["min_radius_ratio"] if "quality" in found else found["message"][-150:]), flush=True)
        with open(os.path.join(told.out, "results.json"), "w") as out:
            json.dump(results, out, indent=1)
    text = table(results)
    with open(os.path.join(told.out, "table.md"), "w") as out:
        out.write(text + "\n")
    print(text)


if __name__ == "__main__":
    main()
