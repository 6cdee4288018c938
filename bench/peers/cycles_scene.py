"""Draws one mesh by Blender's path tracer: what bench/peers/cycles gives to blender -b --python. The last argument is a
file of JSON: mesh, texture (or null), is_smooth, camera (as conic's own JSON), sky (its radiance), sun (the direction
towards it, or null), aperture and focus, samples, seed, threads, and out, an .exr, beside which the same numbers go to
OUT.rgba: floats, from the lowest row up. Prints the seconds of the rendering.
"""
import array
import json
import math
import sys
import time

import bpy
import mathutils

job = json.load(open(sys.argv[-1], encoding="utf-8"))


def read_mesh():
    """The file's own places and faces, which Blender's importer would turn."""
    places, uvs, faces, face_uvs = [], [], [], []
    for line in open(job["mesh"], encoding="utf-8"):
        row = line.split()
        if row[:1] == ["v"]:
            places.append(tuple(map(float, row[1:4])))
        elif row[:1] == ["vt"]:
            uvs.append(tuple(map(float, row[1:3])))
        elif row[:1] == ["f"]:
            corners = [corner.split("/") for corner in row[1:]]
            faces.append([int(corner[0]) - 1 for corner in corners])
            face_uvs += [uvs[int(corner[1]) - 1] if len(corner) > 1 and corner[1] else (0.0, 0.0) for corner in corners]
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata(places, [], faces)
    layer = mesh.uv_layers.new()
    for loop, uv in zip(layer.data, face_uvs):
        loop.uv = uv
    for polygon in mesh.polygons:
        polygon.use_smooth = job["is_smooth"]
    return mesh


def make_material():
    """White, or the texture, and matt."""
    material = bpy.data.materials.new("matt")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    out, matt = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeBsdfDiffuse")
    matt.inputs["Color"].default_value = (1, 1, 1, 1)
    matt.inputs["Roughness"].default_value = 0
    links.new(matt.outputs["BSDF"], out.inputs["Surface"])
    if job["texture"]:
        texture = nodes.new("ShaderNodeTexImage")
        texture.image = bpy.data.images.load(job["texture"])
        links.new(texture.outputs["Color"], matt.inputs["Color"])
    return material


def make_camera(scene):
    given = job["camera"]
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.sensor_width = "HORIZONTAL", 36
    data.lens = given["fx"] / given["width"] * 36
    data.shift_x = (given["width"] / 2 - given["cx"]) / given["width"]
    data.shift_y = (given["cy"] - given["height"] / 2) / given["width"]
    data.clip_start, data.clip_end = 1e-3, 1e6
    if job["aperture"] > 0:
        data.dof.use_dof, data.dof.focus_distance = True, job["focus"]
        data.dof.aperture_fstop = data.lens * 1e-3 / job["aperture"]
    camera = bpy.data.objects.new("camera", data)
    turn = mathutils.Matrix.Diagonal((1, -1, -1, 1))
    camera.matrix_world = mathutils.Matrix(given["world_to_camera"]).inverted() @ turn
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = given["width"], given["height"]
    scene.render.resolution_percentage = 100
    scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = 1, given["fx"] / given["fy"]


def make_light(scene):
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (job["sky"],) * 3 + (1,)
    scene.world = world
    if job["sun"]:
        data = bpy.data.lights.new("sun", "SUN")
        data.energy, data.angle = math.pi, 0  # a white surface that faces it is 1
        sun = bpy.data.objects.new("sun", data)
        sun.rotation_mode = "QUATERNION"
        sun.rotation_quaternion = mathutils.Vector(job["sun"]).to_track_quat("Z", "Y")
        scene.collection.objects.link(sun)


def settle(scene):
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", job["samples"], job["seed"]
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = 0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.pixel_filter_type = "BOX"
    scene.render.film_transparent = True
    scene.render.threads_mode, scene.render.threads = "FIXED", job["threads"]
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.filepath = job["out"]


def main():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    mesh = read_mesh()
    mesh.materials.append(make_material())
    scene.collection.objects.link(bpy.data.objects.new("mesh", mesh))
    make_camera(scene)
    make_light(scene)
    settle(scene)
    start = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    print(f"\nseconds {time.perf_counter() - start:.3f}")
    picture = bpy.data.images.load(job["out"])
    numbers = array.array("f", bytes(16 * picture.size[0] * picture.size[1]))
    picture.pixels.foreach_get(numbers)
    with open(job["out"] + ".rgba", "wb") as file:
        numbers.tofile(file)


main()
