"""Blender Cycles: the scene that lumel wrote, and bakes of diffuse light, direct and indirect, on one thread."""

import time

import bpy
import mathutils
import numpy as np


def material(name, albedo):
    """Diffuse on the front, black on the back."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    mix = tree.nodes.new("ShaderNodeMixShader")
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    tree.links.new(geometry.outputs["Backfacing"], mix.inputs[0])
    for i, color in enumerate([albedo, (0, 0, 0)]):
        diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
        diffuse.inputs["Color"].default_value = (*color, 1)
        tree.links.new(diffuse.outputs[0], mix.inputs[1 + i])
    tree.links.new(mix.outputs[0], output.inputs[0])
    return made


def add(kind, data):
    thing = bpy.data.objects.new(kind, data)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def mesh(name, positions, triangles, materials, of_triangle):
    made = bpy.data.meshes.new(name)
    made.vertices.add(len(positions))
    made.vertices.foreach_set("co", np.ascontiguousarray(positions, np.float32).ravel())
    made.loops.add(triangles.size)
    made.loops.foreach_set("vertex_index", triangles.astype(np.int32).ravel())
    made.polygons.add(len(triangles))
    made.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
    for each in materials:
        made.materials.append(each)
    made.polygons.foreach_set("material_index", of_triangle.astype(np.int32))
    made.update(calc_edges=True)
    return add(name, made)


def add_light(world):
    center, u, v, normal = world.light_axes()
    lamp = bpy.data.lights.new("lamp", "AREA")
    lamp.shape = "RECTANGLE"
    lamp.size, lamp.size_y = 2 * np.linalg.norm(u), 2 * np.linalg.norm(v)
    radiance = np.array(world.light["radiance"])
    # Of W to radiance: over pi and the area.
    lamp.energy = np.pi * lamp.size * lamp.size_y * radiance.max()
    lamp.color = radiance / radiance.max()
    to_world = np.eye(4)
    # It shines along -z.
    to_world[:3] = np.stack([u / np.linalg.norm(u), -v / np.linalg.norm(v), -normal, center], axis=1)
    add("lamp", lamp).matrix_world = mathutils.Matrix(to_world.tolist())


def set_up(world):
    """The scene, with its light. Returns the object that all surfaces belong to."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("black")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0, 0, 0, 1)
    scene.render.engine = "CYCLES"
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.max_bounces = cycles.diffuse_bounces = world.bounces
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = 0
    albedos = [material(f"part{i}", albedo) for i, albedo in enumerate(world.albedos)]
    surfaces = mesh("scene", world.positions, world.triangles, albedos, world.materials)
    add_light(world)
    return surfaces


def bake(samples, **options):
    """Processor time of a bake into the active object; that of one sample is for making the scene ready."""
    bpy.context.scene.cycles.samples = samples
    start = time.process_time()
    bpy.ops.object.bake(type="DIFFUSE", pass_filter={"DIRECT", "INDIRECT"}, **options)
    return time.process_time() - start


def activate(thing):
    """Makes an object the one that is baked."""
    bpy.context.view_layer.objects.active = thing
    thing.select_set(True)
