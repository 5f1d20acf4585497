"""Blender makes a metaball body, cut flat at both ends: `blender --background --python blob.py -- SPEC.json OUT.stl`.

SPEC: balls [x, y, z, radius], bottom, top, facet, share, turn (3 x 3), move.
"""

import json
import sys

import bmesh
import bpy
import numpy as np

spec_path, out = sys.argv[sys.argv.index("--") + 1:]
with open(spec_path) as file:
    spec = json.load(file)

meta = bpy.data.metaballs.new("blob")
meta.resolution = meta.render_resolution = spec["facet"]
meta.threshold = 0.3
for x, y, z, radius in spec["balls"]:
    ball = meta.elements.new()
    ball.co, ball.radius = (x, y, z), radius * 1.3
thing = bpy.data.objects.new("blob", meta)
bpy.context.scene.collection.objects.link(thing)
bpy.context.view_layer.update()
mesh = bpy.data.meshes.new_from_object(thing.evaluated_get(bpy.context.evaluated_depsgraph_get()))


def cut(share):
    """The closed body. Tiny triangles would hang gmsh: corners within a share of the facet become one."""
    near = share * spec["facet"]
    solid = bmesh.new()
    solid.from_mesh(mesh)
    bmesh.ops.remove_doubles(solid, verts=solid.verts[:], dist=near)
    for vertex in solid.verts:
        for height in (spec["bottom"], spec["top"]):
            if abs(vertex.co.z - height) < near:
                vertex.co.z = height
    bmesh.ops.dissolve_degenerate(solid, edges=solid.edges[:], dist=1e-3)
    for height, up in ((spec["bottom"], -1), (spec["top"], 1)):
        geometry = solid.verts[:] + solid.edges[:] + solid.faces[:]
        bmesh.ops.bisect_plane(solid, geom=geometry, plane_co=(0, 0, height), plane_no=(0, 0, up), clear_outer=True, dist=1e-3)
        flat = [f for f in solid.faces if all(abs(v.co.z - height) < 1e-3 for v in f.verts)]  # the lid stands for them
        bmesh.ops.delete(solid, geom=flat, context="FACES")
        bmesh.ops.holes_fill(solid, edges=[e for e in solid.edges if e.is_boundary], sides=0)
    bmesh.ops.triangulate(solid, faces=solid.faces[:])
    bmesh.ops.recalc_face_normals(solid, faces=solid.faces[:])
    return solid


solid = cut(spec["share"])
if not all(edge.is_manifold for edge in solid.edges):
    raise SystemExit("blob.py: no closed body")

turn, move = np.array(spec["turn"]), np.array(spec["move"])
with open(out, "w") as file:
    file.write("solid blob\n")
    for face in solid.faces:
        file.write("facet normal 0 0 0\nouter loop\n")
        for vertex in face.verts:
            file.write("vertex {:.6f} {:.6f} {:.6f}\n".format(*(turn @ np.array(vertex.co) + move)))
        file.write("endloop\nendfacet\n")
    file.write("endsolid blob\n")
