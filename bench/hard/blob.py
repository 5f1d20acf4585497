"""Blender makes a metaball body, cut flat at both ends: `blender --background --python blob.py -- SPEC.json OUT.stl`.

SPEC: balls [x, y, z, radius], bottom, top, facet, turn (3 x 3), move.
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

solid = bmesh.new()
solid.from_mesh(mesh)
for height, up in ((spec["bottom"], -1), (spec["top"], 1)):
    geometry = solid.verts[:] + solid.edges[:] + solid.faces[:]
    cut = bmesh.ops.bisect_plane(solid, geom=geometry, plane_co=(0, 0, height), plane_no=(0, 0, up),
                                 clear_outer=True, dist=1e-4)
    rim = [e for e in cut["geom_cut"] if isinstance(e, bmesh.types.BMEdge)]
    bmesh.ops.remove_doubles(solid, verts=list({v for e in rim for v in e.verts}), dist=0.25 * spec["facet"])
    bmesh.ops.holes_fill(solid, edges=[e for e in solid.edges if e.is_boundary], sides=0)
bmesh.ops.triangulate(solid, faces=solid.faces[:])
bmesh.ops.recalc_face_normals(solid, faces=solid.faces[:])

turn, move = np.array(spec["turn"]), np.array(spec["move"])
with open(out, "w") as file:
    file.write("solid blob\n")
    for face in solid.faces:
        file.write("facet normal 0 0 0\nouter loop\n")
        for vertex in face.verts:
            file.write("vertex {:.6f} {:.6f} {:.6f}\n".format(*(turn @ np.array(vertex.co) + move)))
        file.write("endloop\nendfacet\n")
    file.write("endsolid blob\n")
