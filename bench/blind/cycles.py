"""Blender Cycles photographs what FOLDER/scene.json tells (docs/synth.md, "Another photographer").

Light as hookeye tells it: albedo (ambient sky visibility + max(0, n.sun) visible), no light that
has bounced, the normals that the surface tells. Cycles' Blackman-Harris window of 1.5 px is 3 px wide in all.
"""

import json
import math
import os
import sys

import bpy
from mathutils import Matrix, Vector


def read_obj(path):
    vertices, uvs, normals, faces = [], [], [], []
    with open(path) as file:
        for line in file:
            word, *rest = line.split() or [""]
            if word == "v":
                vertices.append([float(x) for x in rest])
            elif word == "vt":
                uvs.append([float(x) for x in rest])
            elif word == "vn":
                normals.append([float(x) for x in rest])
            elif word == "f":
                faces.append([[int(i) - 1 for i in corner.split("/")[:2]] for corner in rest])
    return vertices, uvs, normals, faces


def body(path, material):
    vertices, uvs, normals, faces = read_obj(path)
    mesh = bpy.data.meshes.new("body")
    mesh.from_pydata(vertices, [], [[corner[0] for corner in face] for face in faces])
    layer = mesh.uv_layers.new(name="uv")
    for polygon, face in zip(mesh.polygons, faces):
        polygon.use_smooth = True
        for loop, corner in zip(polygon.loop_indices, face):
            layer.data[loop].uv = uvs[corner[1]]
    mesh.use_auto_smooth = True  # without it Blender takes normals of its own
    mesh.normals_split_custom_set_from_vertices(normals)
    mesh.materials.append(material)
    return bpy.data.objects.new("body", mesh)


def skin(albedo, glossy=None):
    """Matte; where it is glossy, a share of the light goes to a GGX lobe."""
    material = bpy.data.materials.new("skin")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    image = nodes.new("ShaderNodeTexImage")
    image.image = bpy.data.images.load(albedo)
    image.image.colorspace_settings.name = "Non-Color"
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    output = nodes.new("ShaderNodeOutputMaterial")
    links.new(image.outputs["Color"], diffuse.inputs["Color"])
    links.new(diffuse.outputs["BSDF"], output.inputs["Surface"])
    if glossy:
        lobe, mix = nodes.new("ShaderNodeBsdfGlossy"), nodes.new("ShaderNodeMixShader")
        lobe.distribution = "GGX"
        lobe.inputs["Color"].default_value = (1, 1, 1, 1)
        lobe.inputs["Roughness"].default_value = glossy["roughness"]
        mix.inputs["Fac"].default_value = glossy["share"]
        links.new(diffuse.outputs["BSDF"], mix.inputs[1])
        links.new(lobe.outputs["BSDF"], mix.inputs[2])
        links.new(mix.outputs["Shader"], output.inputs["Surface"])
    return material


def sky(scene, ambient, background):
    """Even sky of radiance `ambient`, seen by the camera as `background`."""
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    nodes.clear()
    rays, mix = nodes.new("ShaderNodeLightPath"), nodes.new("ShaderNodeMixShader")
    output = nodes.new("ShaderNodeOutputWorld")
    for slot, strength in ((1, ambient), (2, background)):
        shader = nodes.new("ShaderNodeBackground")
        shader.inputs["Strength"].default_value = strength
        shader.inputs["Color"].default_value = (1, 1, 1, 1)
        links.new(shader.outputs[0], mix.inputs[slot])
    links.new(rays.outputs["Is Camera Ray"], mix.inputs[0])
    links.new(mix.outputs[0], output.inputs["Surface"])
    scene.world = world


def sun(vector):
    vector = Vector(vector)
    light = bpy.data.lights.new("sun", "SUN")
    light.energy = math.pi * vector.length  # a matte surface sends E/pi
    light.angle = 0
    thing = bpy.data.objects.new("sun", light)
    thing.rotation_euler = vector.to_track_quat("Z", "Y").to_euler()
    return thing


def camera(photo):
    width, height = photo["size"]
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "HORIZONTAL"
    data.sensor_width = 36
    data.lens = 36 * photo["fx"] / width
    # pixel centres are integers
    data.shift_x = -(photo["cx"] - (width - 1) / 2) / width
    data.shift_y = (photo["cy"] - (height - 1) / 2) / width * photo["fx"] / photo["fy"]
    data.clip_start, data.clip_end = 0.1, 1e5
    if "lens" in photo:  # of finite aperture (its diameter), focused at a distance
        data.dof.use_dof = True
        data.dof.focus_distance = photo["lens"]["focus"]
        data.dof.aperture_fstop = data.lens / 1000 / photo["lens"]["aperture"]
    turn = Matrix(photo["R"])
    place = -(turn.transposed() @ Vector(photo["t"]))
    # Blender's camera looks along -z, y up
    to_world = (Matrix(((1, 0, 0), (0, -1, 0), (0, 0, -1))) @ turn).transposed().to_4x4()
    to_world.translation = place
    thing = bpy.data.objects.new("camera", data)
    thing.matrix_world = to_world
    return thing


def settings(scene):
    scene.render.engine = "CYCLES"
    scene.cycles.samples = int(os.environ.get("CYCLES_SAMPLES", "128"))
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 0
    scene.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    scene.cycles.filter_width = 1.5
    scene.render.threads_mode = "AUTO"
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.color_mode = "BW"


def photograph(photo, folder, material):
    scene = bpy.data.scenes.new("photo")
    settings(scene)
    scene.render.resolution_x, scene.render.resolution_y = photo["size"]
    scene.render.pixel_aspect_x = 1
    scene.render.pixel_aspect_y = photo["fx"] / photo["fy"]
    eye = camera(photo)
    for thing in (body(os.path.join(folder, photo["surface"]), material), sun(photo["sun"]), eye):
        scene.collection.objects.link(thing)
    scene.camera = eye
    sky(scene, photo["ambient"], photo["background"])
    scene.render.filepath = os.path.join(folder, photo["picture"])
    bpy.ops.render.render(write_still=True, scene=scene.name)
    bpy.data.scenes.remove(scene)


def main():
    folder = sys.argv[sys.argv.index("--") + 1]
    with open(os.path.join(folder, "scene.json")) as file:
        told = json.load(file)
    for photo in told["photos"]:
        photograph(photo, folder, skin(told["albedo"], photo.get("glossy")))


if __name__ == "__main__":
    main()
