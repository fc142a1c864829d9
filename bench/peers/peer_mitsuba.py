"""Mitsuba 3: its path integrator on rays over the hemispheres, and its sampling of emitters for direct light.

usage: peer_mitsuba.py FOLDER ANSWER.npz RAYS
"""

import json
import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

from world import World

mi.set_variant("llvm_ad_rgb")

# The most rays per receiver that are traced at once; their sample points are spread evenly.
BATCH = 256


def material(albedo):
    return mi.load_dict({"type": "diffuse", "reflectance": {"type": "rgb", "value": albedo}})


def build(world):
    scene = {
        "type": "scene",
        # Depth counts edges of a path: one more than reflections. Direct light is sampled apart.
        "integrator": {
            "type": "path",
            "max_depth": world.bounces + 1,
            "rr_depth": 1000,
            "hide_emitters": not world.light["backing"],
        },
    }
    for i, albedo in enumerate(world.albedos):
        positions, triangles = world.part(i)
        if len(triangles):
            properties = mi.Properties()
            properties["bsdf"] = material(albedo)
            mesh = mi.Mesh(f"part{i}", len(positions), len(triangles), props=properties)
            parameters = mi.traverse(mesh)
            parameters["vertex_positions"] = positions.ravel()
            parameters["faces"] = triangles.ravel()
            parameters.update()
            scene[f"part{i}"] = mesh
    center, u, v, normal = world.light_axes()
    to_world = np.eye(4)
    to_world[:3] = np.stack([u, v, normal, center], axis=1)
    # lumel's light lets all rays pass, and so may the first rays here. Later passages count as reflections, which matters
    # for a lamp right below a ceiling: it looks like the ceiling instead.
    backing = world.light["backing"]
    scene["lamp"] = {
        "type": "rectangle",
        "to_world": mi.ScalarTransform4f(to_world),
        "bsdf": material(backing) if backing else {"type": "null"},
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": world.light["radiance"]}},
    }
    return mi.load_dict(scene)


def batch(scene, world, rays, seed):
    """The mean of one batch of rays for each receiver."""
    count = len(world.origins)
    sampler = mi.load_dict({"type": "multijitter", "sample_count": rays})
    sampler.set_samples_per_wavefront(rays)
    sampler.seed(seed, count * rays)
    receiver = dr.arange(mi.UInt32, count * rays) // rays
    columns = lambda rows: [mi.Float(np.ascontiguousarray(rows[:, k])) for k in range(3)]
    origin = dr.gather(mi.Point3f, mi.Point3f(*columns(world.origins)), receiver)
    normal = dr.gather(mi.Vector3f, mi.Vector3f(*columns(world.normals)), receiver)
    at = dr.zeros(mi.SurfaceInteraction3f, count * rays)
    at.p, at.n, at.t = origin, normal, 1
    at.sh_frame = mi.Frame3f(normal)
    to_light, weight = scene.sample_emitter_direction(at, sampler.next_2d(), True)
    direct = weight * dr.maximum(0, dr.dot(to_light.d, normal))
    direction = at.sh_frame.to_world(mi.warp.square_to_cosine_hemisphere(sampler.next_2d()))
    radiance, _, _ = scene.integrator().sample(scene, sampler, mi.RayDifferential3f(origin, direction), None, True)
    if world.light["backing"]:
        # A ray that sees the lamp is brighter than any other in this scene; the lamp itself is in the direct light.
        lamp = mi.Color3f(world.light["radiance"])
        radiance -= dr.select(radiance > 0.999 * lamp, lamp, 0)
    light = direct + radiance * dr.pi
    return np.stack([np.array(dr.block_sum(light[k], rays)) for k in range(3)], axis=1) / rays


def main(folder, answer, rays):
    world = World(folder)
    dr.set_thread_count(1)
    scene = build(world)
    # Compiles the kernels.
    size = min(int(rays), BATCH)
    batch(scene, world, size, 0)
    start = time.process_time()
    # Runs of different length share no seed: the longest is the reference.
    batches = [batch(scene, world, size, int(rays) + i) for i in range(int(rays) // size)]
    seconds = time.process_time() - start
    mean = np.mean(batches, axis=0)
    deviation = np.std(batches, axis=0, ddof=1) if len(batches) > 1 else np.full_like(mean, np.nan)
    np.savez(answer, irradiance=mean, standard_error=deviation / np.sqrt(len(batches)))
    print(json.dumps({"cpu_seconds": seconds / world.share_compared(), "version": mi.__version__}))


if __name__ == "__main__":
    main(*sys.argv[1:])
