"""Equilibria by CalculiX: quadratic tetrahedra, large deformation.

A problem is told by name: what is left out is as in the told model.
"""

import hashlib
import os
import subprocess
from dataclasses import dataclass, field

import numpy as np

FACES = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))  # S1 .. S4 of a C3D10


def neo_hooke(mu, kappa):
    return f"*HYPERELASTIC,NEO HOOKE\n{mu / 2:.10g},{2 / kappa:.10g}\n"


@dataclass
class Problem:
    body: object
    mu: float
    kappa: float
    material: object = neo_hooke  # of mu and kappa
    name: str = "RUBBER"  # CalculiX chooses its user materials by the beginning of the name
    axes: np.ndarray = None  # of the material: first, second
    stiffness: np.ndarray = None  # factor on both moduli by element
    fixed: dict = field(default_factory=dict)  # node -> three displacements
    springs: dict = field(default_factory=dict)  # node -> two stiffnesses: z, across
    forces: np.ndarray = None  # dead, n x 3
    pressure: tuple = None  # triangles (corners), pressure
    growth: np.ndarray = None  # thermal strain by node
    wall: tuple = None  # point, normal into the free half, stiffness [stress / length]
    increment: float = 0.25  # the first share of the load

    def outer_faces(self):
        """Faces without a neighbour: sorted corners -> (element, number of the face)."""
        seen = {}
        for element, tet in enumerate(self.body.tets):
            for number, face in enumerate(FACES, 1):
                key = tuple(sorted(tet[list(face)]))
                seen[key] = None if key in seen else (element, number)
        return {key: place for key, place in seen.items() if place}

    def deck(self):
        self.ends = []  # what belongs into the step
        lines = ["*NODE,NSET=NALL"]
        lines += [f"{i},{x:.9g},{y:.9g},{z:.9g}" for i, (x, y, z) in enumerate(self.body.nodes, 1)]
        lines += ["*ELEMENT,TYPE=C3D10,ELSET=EALL"]
        lines += [",".join(map(str, [e, *(tet + 1)])) for e, tet in enumerate(self.body.tets, 1)]
        if self.growth is not None:
            lines += ["*INITIAL CONDITIONS,TYPE=TEMPERATURE", "NALL,0."]
            self.ends += ["*TEMPERATURE"] + [f"{i},{t:.9g}" for i, t in enumerate(self.growth, 1)]
        lines += self.sections() + self.foundation() + self.obstacle()
        lines += ["*STEP,NLGEOM,INC=500", "*STATIC", f"{self.increment},1.,1e-5,0.5"]
        lines += ["*CONTROLS,PARAMETERS=FIELD", "1e-5,1e-4,,,1e-3,1e-8"]
        if self.fixed:
            lines += ["*BOUNDARY"]
            lines += [f"{i + 1},{k},{k},{u:.10g}" for i, move in self.fixed.items() for k, u in enumerate(move, 1)]
        if self.forces is not None:
            lines += ["*CLOAD"]
            lines += [f"{i + 1},{k + 1},{self.forces[i, k]:.10g}" for i, k in zip(*np.nonzero(self.forces))]
        if self.pressure:
            outer = self.outer_faces()
            lines += ["*DLOAD"]
            for triangle in self.pressure[0]:
                element, number = outer[tuple(sorted(triangle))]
                lines += [f"{element + 1},P{number},{self.pressure[1]:.10g}"]
        lines += self.ends
        lines += ["*NODE PRINT,NSET=NALL,FREQUENCY=9999", "U,RF", "*END STEP", ""]
        return "\n".join(lines)

    def sections(self):
        factors = np.ones(len(self.body.tets)) if self.stiffness is None else self.stiffness
        lines = []
        turned = ""
        if self.axes is not None:
            lines += ["*ORIENTATION,NAME=FRAME", ",".join(f"{x:.9g}" for x in np.ravel(self.axes))]
            turned = ",ORIENTATION=FRAME"
        for k, factor in enumerate(np.unique(factors)):
            lines += [f"*ELSET,ELSET=PART{k}"] + [str(e + 1) for e in np.flatnonzero(factors == factor)]
            lines += [f"*MATERIAL,NAME={self.name}{k}", self.material(self.mu * factor, self.kappa * factor).rstrip()]
            if self.growth is not None:
                lines += ["*EXPANSION,ZERO=0.", "1."]
            lines += [f"*SOLID SECTION,ELSET=PART{k},MATERIAL={self.name}{k}{turned}"]
        return lines

    def foundation(self):
        """A grounded spring for every direction of every node."""
        lines, element = [], len(self.body.tets)
        for node, (normal, across) in self.springs.items():
            for direction, k in ((1, across), (2, across), (3, normal)):
                element += 1
                lines += [f"*ELEMENT,TYPE=SPRING1,ELSET=S{element}", f"{element},{node + 1}"]
                lines += [f"*SPRING,ELSET=S{element}", f"{direction}", f"{k:.10g}"]
        return lines

    def obstacle(self):
        """A rigid brick whose face is the wall, and contact of every face of the body with it."""
        if not self.wall:
            return []
        point, normal, stiffness = self.wall
        first = np.cross(normal, [0, 0, 1] if abs(normal[2]) < 0.9 else [1, 0, 0])
        first /= np.linalg.norm(first)
        second, size = np.cross(normal, first), 150
        # the brick lies behind the wall; corners 5 to 8, its face S2, on it
        square = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        corners = [point + size * (a * first + b * second) - depth * normal
                   for depth in (20, 0) for a, b in square]
        base = len(self.body.nodes) + 1
        lines = ["*NODE"] + [f"{base + i},{x:.9g},{y:.9g},{z:.9g}" for i, (x, y, z) in enumerate(corners)]
        lines += ["*ELEMENT,TYPE=C3D8,ELSET=WALL", ",".join(map(str, [900001, *range(base, base + 8)]))]
        lines += ["*MATERIAL,NAME=STONE", "*ELASTIC", "1000.,0.3", "*SOLID SECTION,ELSET=WALL,MATERIAL=STONE"]
        lines += ["*SURFACE,NAME=STANDS", "900001,S2", "*SURFACE,NAME=SKIN"]
        lines += [f"{e + 1},S{number}" for e, number in self.outer_faces().values()]
        lines += ["*SURFACE INTERACTION,NAME=TOUCH", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", f"{stiffness:.9g}"]
        lines += ["*CONTACT PAIR,INTERACTION=TOUCH,TYPE=SURFACE TO SURFACE", "SKIN,STANDS"]
        self.ends += ["*BOUNDARY"] + [f"{base + i},1,3,0." for i in range(8)]
        return lines

    def solve(self, folder, name):
        """Displacements and forces of the supports on the body, n x 3. A deck solved before is not solved again."""
        deck = self.deck()
        name += "-" + hashlib.sha256(deck.encode()).hexdigest()[:12]
        if not os.path.exists(os.path.join(folder, name + ".done")):
            run_ccx(deck, folder, name)
        u, inner = read_dat(os.path.join(folder, name + ".dat"), len(self.body.nodes))
        return u, inner if self.forces is None else inner - self.forces  # RF leaves them out


def run_ccx(deck, folder, name):
    with open(os.path.join(folder, name + ".inp"), "w") as file:
        file.write(deck)
    told = subprocess.run(["ccx", "-i", name], cwd=folder, capture_output=True, text=True,
                          env={**os.environ, "OMP_NUM_THREADS": "1"})
    if told.returncode or "*ERROR" in told.stdout:
        raise SystemExit(f"ccx fails on {folder}/{name}.inp:\n{told.stdout[-2000:]}")
    open(os.path.join(folder, name + ".done"), "w").close()


def read_dat(path, n):
    tables = []
    with open(path) as file:
        for line in file:
            words = line.split()
            if "for set NALL" in line:
                tables.append(np.zeros((n, 3)))
            elif len(words) == 4 and tables:
                tables[-1][int(words[0]) - 1] = [float(x) for x in words[1:]]
    if len(tables) < 2:
        raise SystemExit(f"{path}: no displacements, ccx has not converged")
    return tables[-2:]
