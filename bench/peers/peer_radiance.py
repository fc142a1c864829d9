"""Radiance: rtrace -I, with its cache of ambient light or without.

usage: peer_radiance.py FOLDER ANSWER.npz ACCURACY DIVISIONS

ACCURACY is -aa; 0 gathers at every receiver afresh, for which a part of the receivers will do. DIVISIONS is -ad.
"""

import json
import os
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyradiance

from world import World

# Receivers without the cache, each of which costs the same.
FEW = 400

HOME = Path(pyradiance.__file__).parent


def numbers(values):
    return " ".join(f"{value:.9g}" for value in np.ravel(values))


def scene_text(world):
    # Back sides are black.
    yield "void brightfunc front 2 if(Rdot,1,0) . 0 0"
    for i, albedo in enumerate(world.albedos):
        yield f"front plastic part{i} 0 0 5 {numbers(albedo)} 0 0"
    # Shines, but lets rays pass.
    center, u, v, _ = world.light_axes()
    yield f"void illum lamp 1 void 0 3 {numbers(world.light['radiance'])}"
    corners = [center - u - v, center + u - v, center + u + v, center - u + v]
    yield f"lamp polygon light 0 0 12 {numbers(corners)}"
    for i, (triangle, material) in enumerate(zip(world.triangles, world.materials)):
        yield f"part{material} polygon t{i} 0 0 9 {numbers(world.positions[triangle])}"


def octree(world):
    folder = world.folder.resolve()
    file, scene = folder / "scene.oct", folder / "scene.rad"
    if not file.exists() or file.stat().st_mtime < (folder / "scene.json").stat().st_mtime:
        scene.write_text("\n".join(scene_text(world)))
        with open(file, "wb") as out:
            subprocess.run(["oconv", "-r", "65536", scene], stdout=out, check=True)
    return file


def trace(file, origins, normals, options):
    """Irradiance and processor time."""
    points = "\n".join(map(numbers, np.concatenate([origins, normals], axis=1)))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = ["rtrace", "-I", "-h", "-faa", "-ov", "-dj", "1", "-dt", "0", "-dc", "1", *options, file]
    result = subprocess.run(command, input=points, stdout=subprocess.PIPE, text=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    values = np.array([line.split()[:3] for line in result.stdout.strip().splitlines()], float)
    return values, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def main(folder, answer, accuracy, divisions):
    os.environ["PATH"] = f"{HOME / 'bin'}:{os.environ['PATH']}"
    os.environ["RAYPATH"] = f".:{HOME / 'lib'}"
    world = World(folder)
    file = octree(world)
    cached = float(accuracy) > 0
    which = world.valid if cached else world.sample[:FEW]
    origins, normals = world.all_origins[which], world.all_normals[which]
    options = ["-ab", str(world.bounces), "-aa", accuracy, "-ad", divisions, "-ds", "0.05"]
    if cached:
        options += ["-as", str(int(divisions) // 4), "-ar", "128", "-lw", "1e-5", "-lr", "8"]
    else:
        # No path ends early.
        options += ["-lw", "1e-9", "-lr", "-20"]
    _, load = trace(file, origins[:1], normals[:1], ["-ab", "0"])
    values, seconds = trace(file, origins, normals, options)
    irradiance = np.full_like(world.all_origins, np.nan)
    irradiance[which] = values
    np.savez(answer, irradiance=irradiance[world.sample])
    seconds = (seconds - load) * len(world.valid) / len(which)
    print(json.dumps({"cpu_seconds": seconds, "version": pyradiance.__version__}))


if __name__ == "__main__":
    main(*sys.argv[1:])
