"""Bodies for OpenSCAD (or, the blob, Blender), by name.

A function of the generator returns what the specification needs of the shape, in the part's own frame:
scad, regions (point on a plane, normal out of the body), held, end, edge of the tetrahedra, size, inside (where a
ball of radius `room` finds place), long (the direction in which two halves lie beside each other).
"""

SHAPES = {}


def shape(function):
    SHAPES[function.__name__] = function
    return function


def module(body):
    return "module part() {\n" + body + "\n}\n"


@shape
def block(rng):
    w, d, h = rng.uniform([30, 26, 38], [38, 34, 50]).round(2)
    r = round(float(rng.uniform(2, 4)), 2)  # a groove on two sides
    scad = module(f"difference() {{ translate([{-w / 2}, {-d / 2}, 0]) cube([{w}, {d}, {h}]);\n"
                  f"for (s = [-1, 1]) translate([s * {w / 2 + r / 2}, 0, {h * 0.6}]) rotate([90, 0, 0])"
                  f" cylinder(r = {r}, h = 200, center = true, $fn = 32); }}")
    return {"scad": scad, "regions": {"base": [[0, 0, 0], [0, 0, -1]], "end": [[0, 0, h], [0, 0, 1]]},
            "edge": 4.6, "size": h, "inside": [[0, 0, h * 0.45], [w / 2, d / 2, h / 4]], "room": 0.3 * d,
            "long": [1, 0, 0], "aim": [1.5, 5]}


@shape
def bar(rng):
    length, w, d = rng.uniform([70, 15, 13], [85, 19, 17]).round(2)
    scad = module(f"translate([0, {-w / 2}, {-d / 2}]) cube([{length}, {w}, {d}]);\n"
                  f"translate([{length * 0.35}, 0, 0]) cylinder(r = {w * 0.42:.2f}, h = {d * 0.8:.2f}, $fn = 40);")
    return {"scad": scad, "regions": {"base": [[0, 0, 0], [-1, 0, 0]], "end": [[length, 0, 0], [1, 0, 0]]},
            "edge": 4.0, "size": length, "inside": [[length / 2, 0, 0], [length / 3, w / 2, d / 2]], "room": 0.42 * d,
            "long": [1, 0, 0], "aim": [2.5, 8]}


@shape
def sheet(rng):
    length, w, t = rng.uniform([55, 38, 2.6], [68, 48, 3.4]).round(2)
    r = round(float(rng.uniform(4, 6)), 2)
    scad = module(f"difference() {{ translate([0, {-w / 2}, {-t / 2}]) cube([{length}, {w}, {t}]);\n"
                  f"translate([{length * 0.7:.2f}, {w * 0.2:.2f}, 0]) cylinder(r = {r}, h = 20, center = true, $fn = 40); }}")
    return {"scad": scad, "regions": {"base": [[0, 0, 0], [-1, 0, 0]], "end": [[length, 0, 0], [1, 0, 0]]},
            "edge": 3.2, "size": length, "inside": [[length * 0.35, -w * 0.15, 0], [length / 8, w / 8, 0]], "room": 8.0,
            "long": [0, 1, 0], "aim": [2.5, 8], "flat": True}


@shape
def bracket(rng):
    a, b, w, t = rng.uniform([54, 46, 18, 14], [66, 56, 24, 17]).round(2)
    rib, hole = rng.uniform([4, 3.5], [7, 5]).round(2)
    scad = module(f"""difference() {{ union() {{
  translate([0, {-w / 2}, 0]) cube([{a}, {w}, {t}]);
  translate([0, {-w / 2}, 0]) cube([{t}, {w}, {b}]);
  rotate([90, 0, 0]) translate([0, 0, {-rib / 2}]) linear_extrude({rib})
    polygon([[{t - 0.1}, {t - 0.1}], [{t + 20}, {t - 0.1}], [{t + 20}, {t}], [{t}, {t + 18}], [{t - 0.1}, {t + 18}]]); }}
  translate([{a - 11}, 0, -1]) cylinder(r = {hole}, h = 40, $fn = 48); }}""")
    return {"scad": scad, "regions": {"base": [[a, 0, t / 2], [1, 0, 0]], "end": [[t / 2, 0, b], [0, 0, 1]]},
            "edge": 4.2, "size": a, "inside": [[a * 0.45, 0, t / 2], [a / 6, w / 6, t / 16]], "room": 0.42 * t,
            "long": [1, 0, 0], "aim": [2, 8]}


@shape
def blob(rng):
    """Metaballs: a trunk, a head, two ears, a tail; cut flat at the bottom and across the head."""
    s = float(rng.uniform(0.9, 1.1))
    x, y = rng.uniform(-3, 3, 2)
    balls = [[0, 0, 10, 17], [x, y, 24, 14], [2 * x, 2 * y, 38, 12.5], [-11, y, 12, 9], [12, -y, 11, 9],
             [2 * x + 8, 2 * y - 3, 46, 6.5], [2 * x - 8, 2 * y - 3, 46, 6.5], [0, 13, 9, 7]]
    balls = [[round(s * float(v), 3) for v in ball] for ball in balls]
    top = round(43 * s, 3)
    return {"blob": {"balls": balls, "bottom": 0.0, "top": top, "facet": 2.4},
            "regions": {"base": [[0, 0, 0], [0, 0, -1]], "end": [[0, 0, top], [0, 0, 1]]},
            "edge": 4.4, "size": top, "inside": [[0, 0, 14 * s], [3, 3, 5]], "room": 7.0,
            "long": [1, 0, 0], "aim": [1.5, 5]}
