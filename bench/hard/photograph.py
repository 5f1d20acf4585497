"""Blender Cycles photographs what FOLDER/scene.json tells: linear RGB, rows from the top, as .npy.

Unlike bench/blind/cycles.py light bounces, lamps have a size, and what stands around is in view. Run by
`blender --background --factory-startup --python photograph.py -- FOLDER`.
"""

import importlib.util
import json
import math
import os
import sys

import bpy
import numpy as np
from mathutils import Vector

HERE = os.path.dirname(os.path.abspath(__file__))
SPEC = importlib.util.spec_from_file_location("blind_cycles", os.path.join(HERE, "..", "blind", "cycles.py"))
cycles = importlib.util.module_from_spec(SPEC)  # `import cycles` is Blender's own
SPEC.loader.exec_module(cycles)


def body(positions, rest, faces, material, smooth):
    mesh = bpy.data.meshes.new("body")
    mesh.from_pydata(positions.tolist(), [], faces.tolist())
    mesh.polygons.foreach_set("use_smooth", [True] * len(faces))
    mesh.use_auto_smooth = True
    mesh.auto_smooth_angle = math.radians(smooth)
    where = mesh.attributes.new("rest", "FLOAT_VECTOR", "POINT")
    where.data.foreach_set("vector", rest.astype(np.float32).ravel())
    mesh.materials.append(material)
    return bpy.data.objects.new("body", mesh)


class Paint:
    """Nodes of a material; dots are painted by the rest position."""

    def __init__(self, name):
        self.material = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.nodes, self.links = self.material.node_tree.nodes, self.material.node_tree.links
        self.nodes.clear()

    def node(self, kind, **values):
        node = self.nodes.new(kind)
        for key, value in values.items():
            setattr(node, key, value)
        return node

    def wire(self, source, target):
        self.links.new(source, target)

    def math(self, operation, a, b):
        node = self.node("ShaderNodeMath", operation=operation)
        for slot, value in enumerate((a, b)):
            if isinstance(value, (int, float)):
                node.inputs[slot].default_value = value
            else:
                self.wire(value, node.inputs[slot])
        return node.outputs[0]

    def coverage(self, layer, place):
        """1 between the dots, 0 in them; `uneven` lets their size wander over the surface."""
        cells = self.node("ShaderNodeTexVoronoi")
        cells.inputs["Scale"].default_value = 1 / layer["cell"]
        shifted = self.node("ShaderNodeVectorMath", operation="ADD")
        self.wire(place, shifted.inputs[0])
        shifted.inputs[1].default_value = layer["shift"]
        self.wire(shifted.outputs[0], cells.inputs["Vector"])
        radius = layer["radius"]
        if layer.get("uneven"):
            drift = self.node("ShaderNodeTexNoise")
            drift.inputs["Scale"].default_value = 1 / layer["wander"]
            self.wire(shifted.outputs[0], drift.inputs["Vector"])
            radius = self.math("MULTIPLY_ADD", drift.outputs["Fac"], 2 * layer["uneven"])
            radius.node.inputs[2].default_value = layer["radius"] - layer["uneven"]
        inside = self.math("SUBTRACT", cells.outputs["Distance"], radius)
        edge = self.math("MULTIPLY", inside, 1 / layer["soft"])
        clamp = self.node("ShaderNodeClamp")
        self.wire(self.math("ADD", edge, 0.5), clamp.inputs[0])
        return clamp.outputs[0]


def skin(told):
    paint = Paint("skin")
    place = paint.node("ShaderNodeAttribute", attribute_name="rest").outputs["Vector"]
    bare = 1.0
    for layer in told["layers"]:
        bare = paint.math("MULTIPLY", bare, paint.coverage(layer, place))
    mix = paint.node("ShaderNodeMixRGB")
    mix.inputs["Color1"].default_value = [*told["dots"], 1]
    mix.inputs["Color2"].default_value = [*told["ground"], 1]
    if isinstance(bare, float):
        mix.inputs["Fac"].default_value = bare
    else:
        paint.wire(bare, mix.inputs["Fac"])
    shader = paint.node("ShaderNodeBsdfPrincipled")
    paint.wire(mix.outputs["Color"], shader.inputs["Base Color"])
    shader.inputs["Specular"].default_value = told["specular"]
    shader.inputs["Roughness"].default_value = told["roughness"]
    if told["subsurface"]:
        shader.inputs["Subsurface"].default_value = told["subsurface"]
        shader.inputs["Subsurface Radius"].default_value = [told["depth"]] * 3
        paint.wire(mix.outputs["Color"], shader.inputs["Subsurface Color"])
    paint.wire(shader.outputs["BSDF"], paint.node("ShaderNodeOutputMaterial").inputs["Surface"])
    return paint.material


def plain(colour, rough=True):
    paint = Paint("plain")
    shader = paint.node("ShaderNodeBsdfPrincipled")
    shader.inputs["Base Color"].default_value = [*colour, 1]
    shader.inputs["Specular"].default_value = 0.0 if rough else 0.5
    shader.inputs["Roughness"].default_value = 1.0 if rough else 0.35
    paint.wire(shader.outputs["BSDF"], paint.node("ShaderNodeOutputMaterial").inputs["Surface"])
    return paint.material


def box(told):
    """A clamp, a table, a backdrop: centre, axes (columns), half sizes."""
    centre, axes, half = (np.array(told[k], float) for k in ("centre", "axes", "half"))
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    corners = centre + (signs * half) @ axes.T
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = bpy.data.meshes.new("box")
    mesh.from_pydata(corners.tolist(), [], faces)
    mesh.materials.append(plain(told["colour"], told.get("rough", True)))
    return bpy.data.objects.new("box", mesh)


def lamp(told):
    """`strength` is what a matte white surface that faces it sends at `about`."""
    toward, about = Vector(told["toward"]).normalized(), Vector(told["about"])
    if told["kind"] == "sun":
        light = bpy.data.lights.new("lamp", "SUN")
        light.energy, light.angle = math.pi * told["strength"], told["angle"]
    else:
        light = bpy.data.lights.new("lamp", "AREA")
        light.shape, light.size = "SQUARE", told["size"]
        light.energy = math.pi ** 2 * told["strength"] * told["away"] ** 2
    thing = bpy.data.objects.new("lamp", light)
    thing.location = about + told.get("away", 0) * toward
    thing.rotation_euler = toward.to_track_quat("Z", "Y").to_euler()
    return thing


def settings(scene, told):
    cycles.settings(scene)
    scene.cycles.samples = told["samples"]
    scene.cycles.max_bounces = 3
    scene.cycles.diffuse_bounces = 2
    scene.cycles.glossy_bounces = 2
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    scene.render.threads_mode = "FIXED"
    scene.render.threads = 2
    scene.render.image_settings.color_mode = "RGB"


def photograph(number, photo, told, folder, shape, materials):
    scene = bpy.data.scenes.new("photo")
    settings(scene, told)
    scene.cycles.seed = number + told["seed"]
    scene.render.resolution_x, scene.render.resolution_y = photo["size"]
    eye = cycles.camera(photo)
    positions = np.load(os.path.join(folder, photo["positions"]))
    things = [body(positions, shape["rest"], shape["faces"], materials["skin"], told["smooth"]), eye]
    things += [box(prop) for prop in told["props"] + photo.get("props", [])]
    things += [lamp(each) for each in photo["light"]["lamps"]]
    for thing in things:
        scene.collection.objects.link(thing)
    scene.camera = eye
    cycles.sky(scene, photo["light"]["ambient"], told["background"])
    scene.render.filepath = os.path.join(folder, "photo.exr")
    bpy.ops.render.render(write_still=True, scene=scene.name)
    picture = bpy.data.images.load(scene.render.filepath)
    width, height = picture.size
    pixels = np.empty(width * height * 4, np.float32)
    picture.pixels.foreach_get(pixels)
    np.save(os.path.join(folder, photo["picture"]), pixels.reshape(height, width, 4)[::-1, :, :3])
    bpy.data.images.remove(picture)
    bpy.data.scenes.remove(scene)


def main():
    folder = sys.argv[sys.argv.index("--") + 1]
    with open(os.path.join(folder, "scene.json")) as file:
        told = json.load(file)
    shape = np.load(os.path.join(folder, "shape.npz"))
    materials = {"skin": skin(told["skin"])}
    for number, photo in enumerate(told["photos"]):
        photograph(number, photo, told, folder, shape, materials)


if __name__ == "__main__":
    main()
