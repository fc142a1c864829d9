"""Blender Cycles: a bake of diffuse light, direct and indirect, into the lightmap coordinates that lumel wrote.

usage: peer_cycles_lightmap.py FOLDER SAMPLES

Writes page.f32 and denoised_page.f32, irradiance row by row, and prints the processor time of both.
"""

import json
import sys
import time

import bpy
import numpy as np

from blender import activate, bake, set_up
from world import World

# Lumels beside charts that get the light of the nearest in them, for readers between lumels.
MARGIN = 2


def add_image(surfaces, world):
    """The image that all materials are baked into, by coordinates of their own."""
    corners = surfaces.data.uv_layers.new(name="lightmap")
    corners.data.foreach_set("uv", world.corners().ravel())
    surfaces.data.uv_layers.active = corners
    width, height = world.description["page"]
    image = bpy.data.images.new("page", width, height, alpha=True, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    for material in surfaces.data.materials:
        node = material.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        material.node_tree.nodes.active = node
    return image


def pixels(image):
    numbers = np.empty(4 * image.size[0] * image.size[1], np.float32)
    image.pixels.foreach_get(numbers)
    return numbers.reshape(image.size[1], image.size[0], 4)


def denoised(image):
    """By Open Image Denoise, as the compositor of Blender runs it; and its processor time."""
    scene = bpy.context.scene
    group = bpy.data.node_groups.new("denoise", "CompositorNodeTree")
    group.interface.new_socket(name="Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    source = group.nodes.new("CompositorNodeImage")
    source.image = image
    filter_node = group.nodes.new("CompositorNodeDenoise")
    output = group.nodes.new("NodeGroupOutput")
    group.links.new(source.outputs["Image"], filter_node.inputs["Image"])
    group.links.new(filter_node.outputs["Image"], output.inputs[0])
    scene.compositing_node_group = group
    scene.render.use_compositing = True
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = *image.size, 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.view_settings.view_transform = "Raw"
    path = bpy.app.tempdir + "denoised.exr"
    render.filepath = path
    scene.cycles.samples = 1
    start = time.process_time()
    bpy.ops.render.render(write_still=True)
    seconds = time.process_time() - start
    result = bpy.data.images.load(path)
    result.colorspace_settings.name = "Non-Color"
    return pixels(result), seconds


def main(folder, samples):
    world, samples = World(folder), int(samples)
    surfaces = set_up(world)
    surfaces.data.shade_flat()
    image = add_image(surfaces, world)
    activate(surfaces)
    options = {"target": "IMAGE_TEXTURES", "margin": MARGIN, "margin_type": "EXTEND"}
    ready = bake(1, **options)
    seconds = (bake(samples, **options) - ready) * samples / max(1, samples - 1)
    # Without the albedo, Cycles gives radiance of a white surface.
    noisy = pixels(image)
    (np.pi * noisy[:, :, :3]).astype("<f4").tofile(world.folder / "page.f32")
    clean, more = denoised(image)
    (np.pi * clean[:, :, :3]).astype("<f4").tofile(world.folder / "denoised_page.f32")
    version = bpy.app.version_string
    print("\n" + json.dumps({"cpu_seconds": seconds, "denoised_cpu_seconds": seconds + more, "version": version}))


if __name__ == "__main__":
    main(*sys.argv[1:])
