"""The family: what is drawn, by which program, how it is turned, written and damaged. All from a seed."""

import json
import os
import random
import subprocess

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
SCAD = ["bracket", "tube", "gear", "plate", "rounded", "vase", "twisted", "hull", "lattice", "clevis", "knob", "cavity",
        "letters", "spring_plate"]
GMSH = ["block", "slotted", "torus", "pipes", "cone", "ball", "wedge"]
BLENDER = ["scan", "organic", "rough", "metaballs", "knot", "branches", "joined", "decimated", "monkey", "remeshed"]
PARTS = [("openscad", p) for p in SCAD] + [("gmsh", p) for p in GMSH] + [("blender", p) for p in BLENDER] + [("cgal", "rock")]
FORMATS = ["stl", "binary", "obj", "ply"]
DAMAGES = ["none"] * 6 + ["slivers", "cuts", "gaps", "hole", "flipped", "repeated", "pierced"]


def items(count, seed):
    """Of each part as many as of the others; numbers, formats and damages are drawn."""
    rng, out = random.Random(seed), []
    for i in range(count):
        maker, part = PARTS[i % len(PARTS)]
        out.append({
            "name": "%03d-%s" % (i, part), "maker": maker, "part": part, "seed": rng.randrange(1 << 30),
            "a": 45 + rng.random() * 30, "b": 30 + rng.random() * 20, "c": 6 + rng.random() * 4,
            "r": 3 + rng.random() * 3, "n": rng.randint(14, 44), "size": 4 + rng.random() * 6,
            "turn": [rng.uniform(0, 360) for _ in range(3)], "move": [rng.uniform(-300, 300) for _ in range(3)],
            "format": rng.choice(FORMATS), "damage": rng.choice(DAMAGES), "unit": rng.choice([1.0, 1.0, 1.0, 1e-3, 1 / 25.4])})
    return out


def run(command, **more):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300, **more)
    return done.stdout


def draw(item, folder, cgal):
    """item["raw"]: an STL as its program writes it."""
    raw = item["raw"]
    if item["maker"] == "openscad":
        numbers = ["part=\"%s\"" % item["part"]] + ["%s=%.4g" % (k, item[k]) for k in "abcr"]
        numbers += ["n=%d" % item["n"], "turn=%s" % item["turn"], "move=%s" % item["move"]]
        run(["openscad", "-q", "-o", raw] + [x for n in numbers for x in ("-D", n)] + [os.path.join(HERE, "parts.scad")])
    if item["maker"] == "gmsh":
        numbers = {"part": GMSH.index(item["part"]), "size": item["size"]} | {k: item[k] for k in "abcr"}
        numbers |= {"t" + k: np.radians(item["turn"][i]) for i, k in enumerate("xyz")}
        numbers |= {"m" + k: item["move"][i] for i, k in enumerate("xyz")}
        run(["gmsh", "-2", "-v", "1", "-format", "stl", "-o", raw, os.path.join(HERE, "parts.geo")]
            + [str(x) for k, v in numbers.items() for x in ("-setnumber", k, v)])
    if item["maker"] == "cgal":
        text = run([cgal, "rock", str(item["n"] * 10), str(item["seed"])] + [str(item[k] / 2) for k in "abc"])
        with open(raw, "w") as out:
            out.write(text)
        corners = read_stl(raw) @ turned(item["turn"]).T + item["move"]
        write(raw, corners, "stl")


def draw_all(family, folder, cgal):
    todo = [i for i in family if not os.path.exists(i["raw"])]
    for item in todo:
        if item["maker"] != "blender":
            draw(item, folder, cgal)
    organic = [i for i in todo if i["maker"] == "blender"]
    if organic:
        listed = os.path.join(folder, "blender.json")
        with open(listed, "w") as out:
            json.dump(organic, out)
        said = run(["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python",
                    os.path.join(HERE, "organic.py"), "--", listed])
        with open(os.path.join(folder, "blender.log"), "w") as out:
            out.write(said)


def turned(degrees):
    x, y, z = np.radians(degrees)
    def about(i, t):
        m = np.eye(3)
        j, k = (i + 1) % 3, (i + 2) % 3
        m[j, j] = m[k, k] = np.cos(t)
        m[k, j], m[j, k] = np.sin(t), -np.sin(t)
        return m
    return about(2, z) @ about(1, y) @ about(0, x)


def read_stl(file):
    """Corners, triangles x 3 x 3, of an STL in ASCII."""
    with open(file) as text:
        corners = [line.split()[1:4] for line in text if line.lstrip().startswith("vertex")]
    return np.array(corners, dtype=float).reshape(-1, 3, 3)


def write(file, corners, kind):
    if kind == "binary":
        record = np.zeros(len(corners), dtype=[("n", "<f4", 3), ("x", "<f4", (3, 3)), ("a", "<u2")])
        record["x"] = corners
        with open(file, "wb") as out:
            out.write(b"binary".ljust(80) + np.uint32(len(corners)).tobytes() + record.tobytes())
        return
    points, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    faces = index.reshape(-1, 3)
    with open(file, "w") as out:
        if kind == "stl":
            out.write("solid part\n")
            for t in corners:
                out.write("facet normal 0 0 0\nouter loop\n")
                out.writelines("vertex %.6g %.6g %.6g\n" % tuple(x) for x in t)
                out.write("endloop\nendfacet\n")
            out.write("endsolid part\n")
        if kind == "obj":
            out.writelines("v %.9g %.9g %.9g\n" % tuple(x) for x in points)
            out.writelines("f %d %d %d\n" % tuple(t + 1) for t in faces)
        if kind == "ply":
            out.write("ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
                      "element face %d\nproperty list uchar int vertex_indices\nend_header\n" % (len(points), len(faces)))
            out.writelines("%.9g %.9g %.9g\n" % tuple(x) for x in points)
            out.writelines("3 %d %d %d\n" % tuple(t) for t in faces)


def longest(corners):
    return np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).argmax(axis=1)


def damaged(corners, kind, rng):
    """What happens to surfaces on their way: 1 to 5 places."""
    out, size = [t for t in corners], np.ptp(corners.reshape(-1, 3), axis=0).max()
    some = rng.choice(len(out), size=min(5, len(out)), replace=False)
    if kind in ("slivers", "cuts"):  # an edge cut near its end, or anywhere, in both triangles
        by_edge = {}
        for t, x in enumerate(corners):
            for k in range(3):
                by_edge.setdefault(tuple(sorted([tuple(x[k]), tuple(x[(k + 1) % 3])])), []).append(t)
        touched = set()
        for t, k in zip(some, longest(corners)[some]):
            a, b = corners[t][k], corners[t][(k + 1) % 3]
            both = by_edge[tuple(sorted([tuple(a), tuple(b)]))]
            if len(both) != 2 or touched & set(both):
                continue
            touched |= set(both)
            share = rng.choice([1e-3, 1e-4, 1e-5]) if kind == "slivers" else rng.uniform(0.2, 0.8)
            middle = a + share * (b - a)
            for u in both:
                x = corners[u]
                j = next(j for j in range(3) if {tuple(x[j]), tuple(x[(j + 1) % 3])} == {tuple(a), tuple(b)})
                p, q, c = x[j], x[(j + 1) % 3], x[(j + 2) % 3]
                out[u] = np.array([p, middle, c])
                out.append(np.array([middle, q, c]))
    if kind == "gaps":  # a corner of one triangle elsewhere by a millionth to a ten-thousandth
        for t in some:
            out[t] = out[t].copy()
            out[t][rng.integers(3)] += rng.normal(size=3) * size * 10.0 ** rng.uniform(-6, -4.5)
    if kind == "hole":
        out = [x for t, x in enumerate(out) if t not in set(some[:2])]
    if kind == "flipped":
        for t in some:
            out[t] = out[t][::-1]
    if kind == "repeated":
        out += [out[t] for t in some]
    if kind == "pierced":  # a vertex pushed out through the far side
        at, through = corners[some[0]][0], corners.reshape(-1, 3).mean(axis=0)
        far = through + 1.3 * (through - at)
        out = [np.where((x == at).all(axis=1, keepdims=True), far, x) for x in out]
    return np.array(out)


def finish(item):
    """item["file"]: the surface as a user would hand it over."""
    corners = read_stl(item["raw"]) * item["unit"]
    if item["damage"] != "none":
        corners = damaged(corners, item["damage"], np.random.default_rng(item["seed"]))
    write(item["file"], corners, item["format"])
