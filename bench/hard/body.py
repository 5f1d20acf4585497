"""The body: drawn by OpenSCAD, meshed by gmsh, and the fine surface that the photographer sees.

Lengths in mm, in the frame of the cameras. Nodes n x 3, tetrahedra n x 10 in CalculiX's order, counted from 0.
"""

import json
import os
import re
import resource
import subprocess

import numpy as np


def unit(vector):
    return np.asarray(vector, float) / np.linalg.norm(vector)


def rotation(axis, degrees):
    """3 x 3, right-handed about the axis."""
    x, y, z = unit(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


class Failed(SystemExit):
    """A program could not do what was asked."""


def run(command, folder, seconds=600):
    """Within so many seconds of computing: gmsh hangs on some surfaces, and asking it to stop is not enough."""
    limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    told = subprocess.run(command, cwd=folder, capture_output=True, text=True, stdin=subprocess.DEVNULL, preexec_fn=limit)
    if told.returncode:
        raise Failed(f"{' '.join(command)} in {folder}:\n{(told.stdout + told.stderr)[-2000:]}")


def draw(scad, turn, move, path):
    """OpenSCAD source of the part in its own frame -> STL, turned and moved."""
    folder, name = os.path.split(path)
    rows = [[*row, shift] for row, shift in zip(np.asarray(turn).tolist(), move)] + [[0, 0, 0, 1]]
    with open(path + ".scad", "w") as file:
        file.write(f"multmatrix({rows}) part();\n{scad}")
    run(["openscad", "-o", name, name + ".scad"], folder)


def melt(blob, path):
    """Metaballs by Blender -> STL."""
    with open(path + ".json", "w") as file:
        json.dump(blob, file)
    script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "blob.py")
    run(["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python", script, "--",
         path + ".json", path], os.path.dirname(path))


def read_stl(path):
    """Vertices and triangles of a text STL; equal corners are one vertex."""
    with open(path) as file:
        corners = [line.split()[1:] for line in file if line.lstrip().startswith("vertex")]
    number = {}
    faces = [number.setdefault(tuple(c), len(number)) for c in corners]
    faces = np.array(faces).reshape(-1, 3)
    sound = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return np.array([[float(x) for x in c] for c in number]), faces[sound]


def split(vertices, faces, longest):
    """Halves edges until none is longer. Neighbours halve the same edges, so that no gap opens."""
    while True:
        edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]], axis=2)
        long = np.linalg.norm(vertices[edges[..., 0]] - vertices[edges[..., 1]], axis=2) > longest
        if not long.any():
            return vertices, faces
        pairs, place = np.unique(edges[long], axis=0, return_inverse=True)
        middle = np.full(edges.shape[:2], -1)
        middle[long] = len(vertices) + place.ravel()
        vertices = np.vstack([vertices, vertices[pairs].mean(1)])
        faces = np.array([t for f, m in zip(faces.tolist(), middle.tolist()) for t in divided(f, m)])


def divided(face, middle):
    for k in range(3):
        (a, b, c), (ab, bc, ca) = (face[k:] + face[:k]), (middle[k:] + middle[:k])
        if ab >= 0 and bc >= 0 and ca >= 0:
            return [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        if ab >= 0 and bc >= 0 and ca < 0:
            return [[a, ab, c], [ab, bc, c], [ab, b, bc]]
        if ab >= 0 and bc < 0 and ca < 0:
            return [[a, ab, c], [ab, b, c]]
    return [face]


GEO = """
Merge "{stl}";
{remesh}
Surface Loop(1) = Surface{{:}};
Volume(1) = {{1}};
Mesh.CharacteristicLengthMax = {edge};
Mesh.CharacteristicLengthMin = {fine};
Mesh.CharacteristicLengthExtendFromBoundary = 0;
Mesh.CharacteristicLengthFromPoints = 0;
Mesh.Algorithm3D = 1;
Mesh.Optimize = 1;
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 1;
Mesh.MshFileVersion = 2.2;
Mesh.SaveAll = 0;
Physical Volume("BODY") = {{1}};
Field[99] = MathEval; Field[99].F = "{edge}";
{fields}
Field[100] = Min; Field[100].FieldsList = {{99{numbers}}};
Background Field = 100;
"""


REMESH = "ClassifySurfaces{40*Pi/180, 1, 1, Pi}; CreateGeometry;"


def mesh(stl, edge, places, as_drawn):
    """Nodes and quadratic tetrahedra by gmsh. places: (centre, radius, edge there); as_drawn: the STL's triangles stay."""
    folder, name = os.path.split(stl)
    fields = ""
    for k, (centre, radius, fine) in enumerate(places, 1):
        at = "".join(f" Field[{k}].{a}Center = {x:.6g};" for a, x in zip("XYZ", centre))
        fields += (f"Field[{k}] = Ball;{at} Field[{k}].Radius = {radius}; Field[{k}].Thickness = {3 * edge};"
                   f" Field[{k}].VIn = {fine}; Field[{k}].VOut = {edge};\n")
    with open(stl + ".geo", "w") as file:
        file.write(GEO.format(stl=name, remesh="" if as_drawn else REMESH, edge=edge, fine=min([edge, *(p[2] for p in places)]) / 3,
                              fields=fields, numbers="".join(f",{k}" for k in range(1, len(places) + 1))))
    run(["gmsh", "-3", name + ".geo", "-o", name + ".msh", "-v", "3", "-nt", "1"], folder, 90)
    return read_msh(stl + ".msh")


def read_msh(path):
    with open(path) as file:
        text = file.read()
    section = {m[1]: m[2].split("\n")[2:-1] for m in re.finditer(r"\$(\w+)(\n.*?)\$End\1", text, re.S)}
    nodes = np.array([[float(x) for x in line.split()] for line in section["Nodes"]])
    number = np.zeros(int(nodes[:, 0].max()) + 1, int)
    tets = [line.split()[-10:] for line in section["Elements"] if line.split()[1] == "11"]
    tets = np.array(tets, int)[:, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]]  # gmsh counts the last two edges otherwise
    used = np.unique(tets)
    place = np.zeros(number.size, int)
    place[nodes[:, 0].astype(int)] = np.arange(len(nodes))
    number[used] = np.arange(len(used))
    return nodes[place[used], 1:], number[tets]


class Body:
    """Tetrahedra, the patches of their boundary, and the surface that is photographed."""

    def __init__(self, stl, edge, places, pixel, as_drawn=False):
        self.nodes, self.tets = mesh(stl, edge, places, as_drawn)
        self.boundary = self.outer_triangles()
        self.surface, self.faces = split(*read_stl(stl), pixel)
        self.weigh()

    def outer_triangles(self):
        """Corners and middles, n x 6."""
        sides = ((0, 2, 1, 6, 5, 4), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (0, 3, 2, 7, 9, 6))
        triangles = np.vstack([self.tets[:, s] for s in sides])
        _, first, count = np.unique(np.sort(triangles[:, :3], axis=1), axis=0, return_index=True, return_counts=True)
        return triangles[first[count == 1]]

    def centres(self):
        return self.nodes[self.tets[:, :4]].mean(1)

    def patch(self, point, normal, depth=0.02):
        """Boundary triangles on a plane."""
        away = np.abs((self.nodes[self.boundary[:, :3]] - point) @ normal).max(1)
        return self.boundary[away < depth]

    def areas(self, patch):
        """Share of each node: a uniform traction's consistent forces go to the middles of the edges."""
        shares = np.zeros(len(self.nodes))
        a, b, c = (self.nodes[patch[:, k]] for k in range(3))
        each = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
        np.add.at(shares, patch[:, 3:], each[:, None])
        return shares

    def volumes(self):
        """The same for a uniform force by volume."""
        shares = np.zeros(len(self.nodes))
        corners = self.nodes[self.tets[:, :4]]
        volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
        np.add.at(shares, self.tets[:, :4], -volume[:, None] / 20)
        np.add.at(shares, self.tets[:, 4:], volume[:, None] / 5)
        return shares

    def weigh(self):
        """For each vertex of the surface: nodes and weights that carry it (the nearest of the tetrahedra)."""
        centres, corners = self.centres(), self.nodes[self.tets[:, :4]]
        inverse = np.linalg.inv(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))
        self.carriers = np.zeros((len(self.surface), 10), int)
        self.weights = np.zeros((len(self.surface), 10))
        for start in range(0, len(self.surface), 500):
            x = self.surface[start:start + 500]
            square = (centres ** 2).sum(1) - 2 * x @ centres.T
            near = np.argpartition(square, 24, axis=1)[:, :24]
            rest = np.einsum("ptij,ptj->pti", inverse[near], x[:, None] - corners[near][:, :, 0])
            bary = np.concatenate([1 - rest.sum(2, keepdims=True), rest], axis=2)
            best = bary.min(2).argmax(1)
            rows = np.arange(len(x))
            self.carriers[start:start + 500] = self.tets[near[rows, best]]
            self.weights[start:start + 500] = quadratic(bary[rows, best])

    def carried(self, displacement):
        return np.einsum("pk,pki->pi", self.weights, displacement[self.carriers])


def quadratic(b):
    pairs = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
    return np.column_stack([b * (2 * b - 1)] + [4 * b[:, i] * b[:, j] for i, j in pairs])
