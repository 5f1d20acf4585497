"""The block: its surface, its capture, CalculiX's deck of its mesh, and the results of both."""

import base64
import os
import re

import numpy as np

SIZE = (100.0, 30.0, 20.0)  # mm
MU, KAPPA, DENSITY, GRAVITY = 0.03, 0.14, 1.07e-9, 9810.0  # MPa, t/mm^3, mm/s^2
FACES = ((1, 3, 2), (1, 4, 3), (5, 6, 7), (5, 7, 8), (1, 2, 6), (1, 6, 5),
         (2, 3, 7), (2, 7, 6), (3, 4, 8), (3, 8, 7), (4, 1, 5), (4, 5, 8))

CAPTURE = """hookeye: 1
title: block of many unknowns
units: {length: mm, force: N}
body: {volume: body.vtu, density: %g}
model:
  material: {law: neo-hookean, mu: %g, kappa: %g}
  gravity: [0, 0, %g]
regions:
  base: {box: [[-0.001, -1, -1], [0.001, 31, 21]]}
examples:
  weight:
    supports:
      - {region: base, fix: [x, y, z]}
"""


def write_surface(path):
    x, y, z = SIZE
    corners = [(0, 0, 0), (x, 0, 0), (x, y, 0), (0, y, 0), (0, 0, z), (x, 0, z), (x, y, z), (0, y, z)]
    with open(path, "w") as file:
        file.writelines("v %g %g %g\n" % c for c in corners)
        file.writelines("f %d %d %d\n" % f for f in FACES)


def write_capture(folder):
    with open(os.path.join(folder, "capture.yaml"), "w") as file:
        file.write(CAPTURE % (DENSITY, MU, KAPPA, -GRAVITY))


class Vtu:
    """Arrays of a file that hookeye wrote."""

    KINDS = {"Float64": np.float64, "Int64": np.int64, "UInt8": np.uint8}

    def __init__(self, path):
        with open(path) as file:
            text = file.read()
        self.arrays = {}
        for kind, name, components, data in re.findall(
                r'<DataArray type="(\w+)" Name="(\w+)" NumberOfComponents="(\d+)" format="binary"[^>]*>([^<]*)<', text):
            values = np.frombuffer(base64.b64decode(data)[8:], self.KINDS[kind])
            self.arrays[name] = values.reshape(-1, int(components)) if components != "1" else values

    def __getitem__(self, name):
        return self.arrays[name]


def write_deck(path, mesh):
    """VTK counts the middle nodes of a tetrahedron as CalculiX does."""
    points, tets = mesh["Points"], mesh["connectivity"].reshape(-1, 10) + 1
    with open(path, "w") as file:
        file.write("*NODE,NSET=NALL\n")
        file.writelines("%d,%.12g,%.12g,%.12g\n" % (i, *x) for i, x in enumerate(points, 1))
        file.write("*ELEMENT,TYPE=C3D10,ELSET=EALL\n")
        file.writelines("%d,%s\n" % (e, ",".join(map(str, tet))) for e, tet in enumerate(tets, 1))
        file.write("*NSET,NSET=BASE\n")
        file.writelines("%d,\n" % (i + 1) for i in np.flatnonzero(np.abs(points[:, 0]) < 1e-6))
        file.write("*MATERIAL,NAME=RUBBER\n*HYPERELASTIC,NEO HOOKE\n%.16g,%.16g\n*DENSITY\n%g\n" % (MU / 2, 2 / KAPPA, DENSITY))
        file.write("*SOLID SECTION,ELSET=EALL,MATERIAL=RUBBER\n*STEP,NLGEOM,INC=1000\n*STATIC\n0.1,1.,1e-5,1.\n")
        file.write("*BOUNDARY\nBASE,1,3,0.\n*DLOAD\nEALL,GRAV,%g,0.,0.,-1.\n" % GRAVITY)
        file.write("*NODE PRINT,NSET=NALL,FREQUENCY=1000\nU\n*END STEP\n")


def read_displacements(path, n):
    """The last table of a .dat file, n x 3; None: there is none."""
    table = None
    with open(path) as file:
        for line in file:
            words = line.split()
            if "displacements" in line:
                table = np.zeros((n, 3))
            elif len(words) == 4 and table is not None:
                table[int(words[0]) - 1] = [float(x) for x in words[1:]]
    return table
