"""Blender Cycles: a bake of diffuse light, direct and indirect, into vertex colours.

usage: peer_cycles.py FOLDER ANSWER.npz SAMPLES

Each receiver is a tiny triangle that no other ray meets, so that Cycles measures where the others do.
"""

import json
import sys
import time

import bpy
import mathutils
import numpy as np

from world import World

# Size of the triangles that stand for receivers, as a share of the scene's.
RECEIVER = 4e-6


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


def add_receivers(world):
    origins, normals = world.origins, world.normals
    other = np.where(np.abs(normals[:, :1]) > 0.5, [[0, 1, 0]], [[1, 0, 0]])
    tangents = np.cross(other, normals)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    bitangents = np.cross(normals, tangents)
    size = RECEIVER * world.size
    angles = np.arange(3) * 2 * np.pi / 3
    corners = [origins + size * (np.cos(a) * tangents + np.sin(a) * bitangents) for a in angles]
    positions = np.stack(corners, axis=1).reshape(-1, 3)
    triangles = np.arange(len(positions)).reshape(-1, 3)
    receivers = mesh("receivers", positions, triangles, [material("white", (1, 1, 1))], np.zeros(len(origins)))
    receivers.data.polygons.foreach_set("use_smooth", np.ones(len(origins), bool))
    receivers.data.normals_split_custom_set_from_vertices([tuple(n) for n in np.repeat(normals, 3, axis=0)])
    for ray in ("diffuse", "glossy", "transmission", "shadow", "volume_scatter"):
        setattr(receivers, f"visible_{ray}", False)
    colors = receivers.data.color_attributes.new("light", "FLOAT_COLOR", "POINT")
    receivers.data.color_attributes.active_color = colors
    bpy.context.view_layer.objects.active = receivers
    receivers.select_set(True)
    return receivers


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
    mesh("scene", world.positions, world.triangles, albedos, world.materials)
    add_light(world)
    return add_receivers(world)


def bake(samples):
    """Processor time of a bake; that of one sample is for making the scene ready."""
    bpy.context.scene.cycles.samples = samples
    start = time.process_time()
    bpy.ops.object.bake(type="DIFFUSE", pass_filter={"DIRECT", "INDIRECT"}, target="VERTEX_COLORS")
    return time.process_time() - start


def main(folder, answer, samples):
    world, samples = World(folder), int(samples)
    receivers = set_up(world)
    ready = bake(1)
    seconds = (bake(samples) - ready) * samples / max(1, samples - 1)
    colors = np.empty(3 * 4 * len(world.origins), np.float32)
    receivers.data.color_attributes["light"].data.foreach_get("color", colors)
    # Without the albedo, Cycles gives radiance of a white surface.
    np.savez(answer, irradiance=np.pi * colors.reshape(-1, 3, 4)[:, :, :3].mean(axis=1))
    version = bpy.app.version_string
    print("\n" + json.dumps({"cpu_seconds": seconds / world.share_compared(), "version": version}))


if __name__ == "__main__":
    main(*sys.argv[1:])
