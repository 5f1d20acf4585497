"""Blender's part of the family (README.md): blender --background --python organic.py -- ITEMS.json"""

import json
import math
import random
import sys

import bmesh
import bpy
from mathutils import Euler, Matrix, Vector


def clear():
    bpy.ops.wm.read_factory_settings(use_empty=True)


def noise(bm, rng, size):
    for v in bm.verts:
        v.co += Vector([rng.gauss(0, size) for _ in range(3)])


def blob(bm, rng, item, cuts):
    bmesh.ops.create_icosphere(bm, subdivisions=cuts, radius=item["b"] / 2)
    waves = [(Vector([rng.gauss(0, 1) for _ in range(3)]) * 6 / item["b"], rng.uniform(0, 6)) for _ in range(6)]
    for v in bm.verts:
        v.co *= 1 + 0.08 * sum(math.sin(w.dot(v.co) + p) for w, p in waves)


def scan(bm, rng, item):
    blob(bm, rng, item, 5)
    noise(bm, rng, 0.002 * item["b"])


def organic(bm, rng, item):
    blob(bm, rng, item, 4)


def rough(bm, rng, item):
    """Noise near a third of the edge: facets that nearly fold."""
    blob(bm, rng, item, 4)
    noise(bm, rng, 0.012 * item["b"])


def metaballs(bm, rng, item):
    ball = bpy.data.metaballs.new("balls")
    ball.resolution = 0.09 * item["b"]
    for _ in range(5):
        e = ball.elements.new()
        e.co = [rng.uniform(-0.3, 0.3) * item["b"] for _ in range(3)]
        e.radius = rng.uniform(0.25, 0.45) * item["b"]
    take(bm, bpy.data.objects.new("balls", ball))


def knot(bm, rng, item):
    curve = bpy.data.curves.new("knot", "CURVE")
    curve.dimensions, curve.bevel_depth, curve.bevel_resolution = "3D", item["r"] / 2, 3
    line = curve.splines.new("POLY")
    count, p, q = 90, 2, 3
    line.points.add(count - 1)
    for i, point in enumerate(line.points):
        t = 2 * math.pi * i / count
        radius = item["b"] / 2 * (1 + 0.4 * math.cos(q * t))
        point.co = (radius * math.cos(p * t), radius * math.sin(p * t), item["b"] / 3 * math.sin(q * t), 1)
    line.use_cyclic_u = True
    take(bm, bpy.data.objects.new("knot", curve))


def branches(bm, rng, item):
    """Blender's skin around a tree of edges."""
    mesh = bpy.data.meshes.new("tree")
    points, edges = [Vector((0, 0, 0))], []
    for _ in range(6):
        start = rng.randrange(len(points))
        way = Vector([rng.gauss(0, 1) for _ in range(3)]).normalized() * item["a"] / 2
        points.append(points[start] + way)
        edges.append((start, len(points) - 1))
    mesh.from_pydata([tuple(p) for p in points], edges, [])
    tree = bpy.data.objects.new("tree", mesh)
    bpy.context.scene.collection.objects.link(tree)
    tree.modifiers.new("skin", "SKIN")
    tree.modifiers.new("smooth", "SUBSURF").levels = 1
    for v in mesh.skin_vertices[0].data:
        v.radius = (item["r"], item["r"])
    take(bm, tree)


def joined(bm, rng, item):
    """Two blobs united by Blender's boolean."""
    parts = []
    for _ in range(2):
        own = bmesh.new()
        blob(own, rng, item, 3)
        mesh = bpy.data.meshes.new("blob")
        own.to_mesh(mesh)
        own.free()
        parts.append(bpy.data.objects.new("blob", mesh))
        bpy.context.scene.collection.objects.link(parts[-1])
    parts[1].location = (0.5 * item["b"], 0.1 * item["b"], 0)
    union = parts[0].modifiers.new("union", "BOOLEAN")
    union.operation, union.object, union.solver = "UNION", parts[1], "EXACT"
    take(bm, parts[0])


def decimated(bm, rng, item):
    own = bmesh.new()
    blob(own, rng, item, 5)
    mesh = bpy.data.meshes.new("blob")
    own.to_mesh(mesh)
    own.free()
    blob_of = bpy.data.objects.new("blob", mesh)
    bpy.context.scene.collection.objects.link(blob_of)
    blob_of.modifiers.new("decimate", "DECIMATE").ratio = 0.06
    take(bm, blob_of)


def monkey(bm, rng, item):
    """Blender's own: the eyes are open bowls, so it bounds no body."""
    bmesh.ops.create_monkey(bm, matrix=Matrix.Scale(item["b"] / 2, 4))


def remeshed(bm, rng, item):
    """The same, closed by a remesh in voxels."""
    mesh = bpy.data.meshes.new("monkey")
    own = bmesh.new()
    monkey(own, rng, item)
    own.to_mesh(mesh)
    own.free()
    of = bpy.data.objects.new("monkey", mesh)
    bpy.context.scene.collection.objects.link(of)
    voxels = of.modifiers.new("voxels", "REMESH")
    voxels.mode, voxels.voxel_size = "VOXEL", item["b"] / 20
    take(bm, of)


def take(bm, of):
    """The object's mesh after its modifiers."""
    if of.name not in bpy.context.scene.collection.objects:
        bpy.context.scene.collection.objects.link(of)
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    bm.from_mesh(of.evaluated_get(graph).to_mesh())


def write(bm, item):
    bmesh.ops.triangulate(bm, faces=bm.faces)
    place = Matrix.Translation(item["move"]) @ Euler([math.radians(t) for t in item["turn"]]).to_matrix().to_4x4()
    bm.transform(place)
    with open(item["raw"], "w") as out:
        out.write("solid part\n")
        for f in bm.faces:
            out.write("facet normal 0 0 0\nouter loop\n")
            for v in f.verts:
                out.write("vertex %.6e %.6e %.6e\n" % tuple(v.co))
            out.write("endloop\nendfacet\n")
        out.write("endsolid part\n")


for one in json.load(open(sys.argv[sys.argv.index("--") + 1])):
    clear()
    shape = bmesh.new()
    globals()[one["part"]](shape, random.Random(one["seed"]), one)
    write(shape, one)
    shape.free()
