"""Equal-error times of lumel, Mitsuba 3, Blender Cycles and Radiance: `cargo x bench peers`.

usage: cargo x bench peers [--scene NAME]... [--places PLACES]... [--only PEER]... [--fresh] [--json FILE]

All compute the irradiance of the same receivers with four reflections after the direct light, on one thread. At nodes,
receivers are the vertices of lumel's mesh, and lumel measures at just these points. Over surfaces, they are random
points; lumel solves on its mesh and reads what lies between its vertices. The other renderers need no mesh: they
measure at the points, and the time they take for one is multiplied by the number of lumel's vertices. Each climbs a
ladder of settings until its error is below the target; the processor time at the target is read off between two rungs.
Results of peers are kept in target/peers/results and measured again only with --fresh or when the scene or the way to
measure changes; lumel is measured every time.

  --scene NAME   only cornell-box or sponza
  --places PLACES
                 only nodes or surfaces
  --only PEER    measure only lumel, mitsuba, cycles, radiance-cached or radiance; others are read from earlier runs
  --fresh        measure everything anew
  --json FILE    write the results as JSON too
"""

import argparse
import hashlib
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import environment
from environment import HOME, PYTHON, last_line

# Error, and the share of the worst receivers that are left out.
TARGETS = {"cornell-box": (0.02, 0.0), "sponza": (0.05, 0.02)}

# Who is measured where. Radiance's cache is for the vertices of a mesh, and without it the others are faster.
PEERS = {
    "nodes": ["lumel", "mitsuba", "cycles", "radiance-cached", "radiance"],
    "surfaces": ["lumel", "mitsuba", "cycles"],
}

# Settings, from the cheapest on.
LADDERS = {
    "lumel": [(2, 8), (4, 16), (8, 32), (16, 64), (32, 128), (64, 256), (128, 512)],
    "mitsuba": [(16,), (64,), (256,), (1024,), (4096,)],
    "cycles": [(4,), (16,), (64,), (256,), (1024,)],
    "radiance-cached": [(0.5, 64), (0.3, 64), (0.3, 128), (0.3, 256), (0.2, 512), (0.15, 1024)],
    "radiance": [(0, 8), (0, 16), (0, 32), (0, 64)],
}
SETTINGS = {
    "lumel": "direct and indirect samples",
    "mitsuba": "rays",
    "cycles": "samples, three per receiver",
    "radiance-cached": "-aa and -ad",
    "radiance": "-aa and -ad",
}
# Seeds of lumel, of which the median time and the RMS error are taken; the times of its peers are their lowest.
SEEDS = 5
# Rays of Mitsuba's run that all are compared with.
REFERENCE = 16384
# A rung that takes longer, seconds, is given up.
PATIENCE = 1800
# Runs of a peer that take less, seconds, are done again: of REPEATS the one with the least processor time counts.
SHORT = 20
REPEATS = 3


def main():
    options = arguments()
    missing = environment.set_up()
    if Path(sys.prefix).resolve() != (HOME / "venv").resolve():
        # From here on with numpy.
        os.execv(PYTHON, [str(PYTHON), __file__, *sys.argv[1:]])
    results = {
        places: {scene: measure((scene, places), options, missing) for scene in options.scene or TARGETS}
        for places in options.places or PEERS
    }
    if options.json:
        Path(options.json).write_text(json.dumps({"machine": machine(), "places": results}, indent=2) + "\n")


def arguments():
    parser = argparse.ArgumentParser(usage=__doc__, add_help=True)
    parser.add_argument("--scene", action="append", choices=list(TARGETS))
    parser.add_argument("--places", action="append", choices=list(PEERS))
    parser.add_argument("--only", action="append", choices=list(LADDERS))
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--json")
    return parser.parse_args()


def machine():
    info = Path("/proc/cpuinfo")
    names = [line for line in info.read_text().splitlines() if line.startswith("model name")] if info.exists() else []
    return {"processor": names[0].split(":")[1].strip() if names else "unknown", "cores": os.cpu_count()}


def folder_of(case):
    scene, places = case
    return HOME / places / scene


def results_of(case):
    scene, places = case
    return HOME / "results" / places / scene


def measure(case, options, missing):
    """What all peers need for a case: a scene, and the places where they are compared."""
    from world import World

    folder, (scene, places) = folder_of(case), case
    lumel("export", *case, folder)
    world = World(folder)
    key = digest(*(folder / file for file in ("scene.json", "sample.u32", "positions.f32", "receivers.f32")))
    target, left_out = TARGETS[scene]
    description = world.description
    print(
        f"\n{scene}: {description['valid']} vertices can be measured; {description['sample']} {places_text(places)} are "
        f"compared; {world.bounces} bounces\n"
        f"target: an RMS error of {target:.0%}" + (f", the worst {left_out:.0%} left out" if left_out else ""),
        flush=True,
    )
    check = make_reference(case, world, key, options, missing)
    peers = {}
    for peer in PEERS[places]:
        climbed = climb(peer, case, key, options, missing)
        peers[peer] = {**climbed, **at_target(climbed.get("rungs", []), target)}
    show(peers)
    return {"vertices": description["valid"], "target": target, "left_out": left_out, "check": check, "peers": peers}


def places_text(places):
    return {"nodes": "of them", "surfaces": "random points"}[places]


def lumel(*words):
    """Runs lumel's part on one thread; returns the JSON it prints last, if any."""
    program = os.environ.get("LUMEL_PEERS")
    if not program:
        sys.exit("error: LUMEL_PEERS names no program; start this by `cargo x bench peers`")
    command = [program, *map(str, words)]
    threads = {} if words[0] in ("long", "export-lumels") else {"RAYON_NUM_THREADS": "1"}
    result = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, env={**os.environ, **threads})
    line = last_line(result.stdout)
    return json.loads(line) if line.startswith("{") else None


def climb(peer, case, key, options, missing):
    """The rungs of a ladder up to the first whose error is below the target."""
    file = results_of(case) / f"{peer}.json"
    script = Path(__file__).with_name(f"peer_{peer.split('-')[0]}.py")
    key = [key, digest(script) if script.exists() else None, LADDERS[peer]]
    key = json.loads(json.dumps(key))
    old = stored(file)
    wanted = not options.only or peer in options.only
    if old and (not wanted or (peer != "lumel" and not options.fresh and old["key"] == key)):
        if old["key"] != key:
            print(f"{peer}: measured in another way or scene; shown nevertheless", flush=True)
        return old
    if not wanted:
        return {"failed": "not measured"}
    if reason := missing.get(peer.split("-")[0]):
        return {"failed": reason}
    target, _ = TARGETS[case[0]]
    rungs = []
    for setting in LADDERS[peer]:
        try:
            rung = measure_lumel(case, setting) if peer == "lumel" else measure_peer(script, case, setting)
        except (RuntimeError, subprocess.TimeoutExpired) as problem:
            if not rungs:
                return {"failed": str(problem)}
            break
        rungs.append({"setting": setting, **rung})
        error = rung["error"]
        print(f"  {peer:<16} {str(setting):<14} {rung['cpu_seconds']:>9.2f} s   {error:>7.2%}", flush=True)
        if error < target:
            break
    file.parent.mkdir(parents=True, exist_ok=True)
    result = {"key": key, "rungs": rungs, "settings": SETTINGS[peer]}
    file.write_text(json.dumps(result, indent=2))
    return result


def measure_lumel(case, setting):
    import numpy as np
    from world import World, error

    folder, (scene, _) = folder_of(case), case
    world = World(folder)
    runs, squares = [], []
    for seed in range(SEEDS):
        runs.append(lumel("solve", *case, folder, *setting, seed))
        answer = np.fromfile(folder / "lumel.f32", "<f4").reshape(-1, 3)[world.sample]
        squares.append(error(answer, world.reference()[0], TARGETS[scene][1]) ** 2)
    seconds = sorted(run["cpu_seconds"] for run in runs)
    return {"cpu_seconds": seconds[SEEDS // 2], "cpu_lowest": seconds[0], "error": float(np.sqrt(np.mean(squares)))}


def measure_peer(script, case, setting):
    import numpy as np
    from world import World, error

    world = World(folder_of(case))
    start = time.monotonic()
    printed = run_peer(script, world.folder, setting, "answer.npz")
    if time.monotonic() - start < SHORT:
        # Processor time of the same bake in Cycles varies by a factor of two.
        again = [run_peer(script, world.folder, setting, "answer.npz") for _ in range(REPEATS - 1)]
        printed = min([printed, *again], key=lambda run: run["cpu_seconds"])
    irradiance, reference = np.load(world.folder / "answer.npz")["irradiance"], world.reference()[0]
    measured = np.isfinite(irradiance[:, 0])
    return {**printed, "error": error(irradiance[measured], reference[measured], TARGETS[case[0]][1])}


def run_peer(script, folder, setting, answer):
    """Lets a peer write its answer; returns the JSON it prints."""
    command = [PYTHON, script, folder, folder / answer, *map(str, setting)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
    if result.returncode != 0:
        raise RuntimeError(f"{script.name} failed: {last_line(result.stderr)}")
    return json.loads(last_line(result.stdout))


def at_target(rungs, target):
    """Processor seconds at the target, by a power law between two rungs or through the last two."""
    import math

    if not rungs:
        return {}
    below = next((i for i, rung in enumerate(rungs) if rung["error"] <= target), None)
    if below == 0:
        return {"cpu_seconds": rungs[0]["cpu_seconds"], "how": "at most"}
    if below is None and len(rungs) < 2:
        return {}
    b = len(rungs) - 1 if below is None else below
    (t0, e0), (t1, e1) = [(rungs[i]["cpu_seconds"], rungs[i]["error"]) for i in (b - 1, b)]
    if e1 >= e0:
        return {}
    share = math.log(target / e0) / math.log(e1 / e0)
    seconds = t0 * (t1 / t0) ** share
    # More samples may take less time, where fewer need other rays besides.
    cheapest = min((rung["cpu_seconds"] for rung in rungs if rung["error"] <= target), default=math.inf)
    if cheapest < seconds:
        return {"cpu_seconds": cheapest, "how": "at most"}
    return {"cpu_seconds": seconds, "how": "extrapolated" if below is None else "interpolated"}


def show(peers):
    ours = peers["lumel"].get("cpu_seconds")
    print(f"\n  {'':<16}{'CPU seconds':>14}{'over lumel':>12}")
    for peer, result in peers.items():
        seconds = result.get("cpu_seconds")
        if seconds is None:
            print(f"  {peer:<16}{'-':>14}   {result.get('failed', 'the target is out of reach')}")
            continue
        result["over_lumel"] = seconds / ours if ours else None
        ratio = f"{seconds / ours:.1f}" if ours else "-"
        print(f"  {peer:<16}{seconds:>14.2f}{ratio:>12}   {result['how']}")


def make_reference(case, world, key, options, missing):
    """Mitsuba's answer with many rays, which lumel's approach as the mesh gets finer; without it, lumel's long solve."""
    import numpy as np
    from world import error, rms

    file = results_of(case) / "reference.json"
    script = Path(__file__).with_name("peer_mitsuba.py")
    reason = missing.get("mitsuba")
    key = [key, digest(script), REFERENCE, reason]
    result = stored(file)
    if options.fresh or not result or result["key"] != key or not (world.folder / "reference.npz").exists():
        print("  making the reference", flush=True)
        lumel("long", *case, world.folder)
        irradiance, standard_error = world.long_solve()
        np.savez(world.folder / "reference.npz", irradiance=irradiance, standard_error=standard_error)
        result = {"key": key, "from": f"lumel only: {reason}"}
        if not reason:
            run_peer(script, world.folder, (REFERENCE,), "reference.npz")
            reference, noise = world.reference()
            noise = np.hypot(rms(noise), rms(standard_error)) / rms(reference)
            result |= {
                "from": f"Mitsuba, {REFERENCE} rays",
                "mean_of_long_solve": float(irradiance.mean() / reference.mean()),
                "difference": error(irradiance, reference),
                "difference_without_worst": error(irradiance, reference, 0.02),
                "noise": float(noise),
            }
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(result, indent=2))
    print(f"  reference: {result['from']}", flush=True)
    if "noise" in result:
        print(
            f"  a long solve of lumel on a finer mesh has {result['mean_of_long_solve']:.4f} times its mean; RMS "
            f"difference {result['difference']:.2%} ({result['difference_without_worst']:.2%} without the worst 2%), "
            f"of which noise {result['noise']:.2%}",
            flush=True,
        )
    return result


def stored(file):
    return json.loads(file.read_text()) if file.exists() else None


def digest(*files):
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:16]


if __name__ == "__main__":
    main()
