"""Blender Cycles: a bake of diffuse light, direct and indirect, into vertex colours.

usage: peer_cycles.py FOLDER ANSWER.npz SAMPLES

Each receiver is a tiny triangle that no other ray meets, so that Cycles measures where the others do.
"""

import json
import sys

import bpy
import numpy as np

from blender import activate, bake, material, mesh, set_up
from world import World

# Size of the triangles that stand for receivers, as a share of the scene's.
RECEIVER = 4e-6


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
    activate(receivers)
    return receivers


def main(folder, answer, samples):
    world, samples = World(folder), int(samples)
    set_up(world)
    receivers = add_receivers(world)
    ready = bake(1, target="VERTEX_COLORS")
    seconds = (bake(samples, target="VERTEX_COLORS") - ready) * samples / max(1, samples - 1)
    colors = np.empty(3 * 4 * len(world.origins), np.float32)
    receivers.data.color_attributes["light"].data.foreach_get("color", colors)
    # Without the albedo, Cycles gives radiance of a white surface.
    np.savez(answer, irradiance=np.pi * colors.reshape(-1, 3, 4)[:, :, :3].mean(axis=1))
    version = bpy.app.version_string
    print("\n" + json.dumps({"cpu_seconds": seconds / world.share_compared(), "version": version}))


if __name__ == "__main__":
    main(*sys.argv[1:])
