"""The body of a capture that has a tetrahedral mesh, and its told light, cameras and loads."""

import os

import meshio
import numpy as np
import yaml
from scipy.spatial import cKDTree


def unit(vector):
    return np.asarray(vector, float) / np.linalg.norm(vector)


class Body:
    def __init__(self, capture):
        with open(os.path.join(capture, "capture.yaml")) as file:
            self.told = yaml.safe_load(file)
        self.folder = capture
        mesh = meshio.read(os.path.join(capture, self.told["body"]["volume"]))
        self.nodes, self.tets = mesh.points, mesh.cells_dict["tetra10"]
        group = dict(zip(("BASE", "GRIP", "SIDE"), (mesh.field_data[k][0] for k in ("BASE", "GRIP", "SIDE"))))
        triangles, tags = mesh.cells_dict["triangle6"], mesh.cell_data_dict["gmsh:physical"]["triangle6"]
        self.patch = {name.lower(): triangles[tags == tag] for name, tag in group.items()}
        self.read_surface(os.path.join(capture, self.told["body"]["surface"]))

    def read_surface(self, path):
        with open(path) as file:
            words = [line.split() for line in file if line.strip()]
        vertices = np.array([[float(x) for x in w[1:4]] for w in words if w[0] == "v"])
        self.uv = [" ".join(w) for w in words if w[0] == "vt"]
        self.faces = np.array([[[int(i) - 1 for i in c.split("/")[:2]] for c in w[1:4]] for w in words if w[0] == "f"])
        distance, self.surface_node = cKDTree(self.nodes).query(vertices)
        assert distance.max() < 1e-4, "vertices of the surface are nodes of the mesh"

    def nodes_of(self, region):
        return np.unique(self.patch[region])

    def areas(self, region):
        """Share of each node: a uniform traction's consistent forces go to the middles of the edges."""
        shares = np.zeros(len(self.nodes))
        for triangle in self.patch[region]:
            a, b, c = self.nodes[triangle[:3]]
            shares[triangle[3:]] += np.linalg.norm(np.cross(b - a, c - a)) / 6
        return shares

    def volumes(self):
        """The same for a uniform force by volume."""
        shares = np.zeros(len(self.nodes))
        corners = self.nodes[self.tets[:, :4]]
        volume = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
        np.add.at(shares, self.tets[:, :4], -volume[:, None] / 20)
        np.add.at(shares, self.tets[:, 4:], volume[:, None] / 5)
        return shares

    def write_obj(self, path, positions):
        """The triangles between corner nodes; normals weighted by the corners' angles."""
        x = positions[self.surface_node]
        p = x[self.faces[:, :, 0]]
        normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        normals = np.zeros_like(x)
        for k in range(3):
            a, b = p[:, (k + 1) % 3] - p[:, k], p[:, (k + 2) % 3] - p[:, k]
            cosine = np.einsum("ij,ij->i", a, b) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
            np.add.at(normals, self.faces[:, k, 0], np.arccos(np.clip(cosine, -1, 1))[:, None] * normal)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        with open(path, "w") as file:
            for word, rows in (("v", x), ("vn", normals)):
                file.writelines(f"{word} {a:.9g} {b:.9g} {c:.9g}\n" for a, b, c in rows)
            file.writelines(line + "\n" for line in self.uv)
            file.writelines("f " + " ".join(f"{v + 1}/{t + 1}" for v, t in face) + "\n" for face in self.faces)
