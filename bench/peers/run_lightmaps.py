"""Lightmaps of lumel and Blender Cycles at equal error: `cargo x bench lightmap --cycles`.

usage: cargo x bench lightmap --cycles [SCENE]... [--fresh] [--json FILE]

Both bake the irradiance of the same scene, with four reflections after the direct light, into the same lumels of one
page, on one thread. Light is read bilinearly at random points of the surfaces and compared with many samples there.
Each climbs a ladder of samples until its error is below 2 %, once as it is and once denoised, lumel by its own
denoiser, Cycles by Open Image Denoise; the processor time at 5 % and at 2 % is read off between two rungs. Results of
Cycles are kept in target/peers/lightmaps and measured again only with --fresh or when the scene changes.

Scenes: cornell-box, sponza
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import environment
from environment import HOME, PYTHON
from run import at_target, digest, last_line, lumel, machine, stored

SCENES = ["cornell-box", "sponza"]

TARGETS = [0.05, 0.02]

# The share of the worst points that are left out, as in `cargo x bench lightmap`.
LEFT_OUT = 0.02

LADDERS = {
    "lumel": [(2, 8), (4, 16), (8, 32), (16, 64), (32, 128), (64, 256), (128, 512)],
    "cycles": [(2,), (4,), (16,), (64,), (256,), (1024,)],
}

# Runs of lumel, of which the median time and the RMS error are taken; the time of Cycles is the lowest of as many.
SEEDS = 3
# A rung of Cycles that takes longer, seconds, is given up, and is measured once if it takes longer than SHORT.
PATIENCE = 3600
SHORT = 20

KINDS = {"noisy": "cpu_seconds", "denoised": "denoised_cpu_seconds"}


def main():
    parser = argparse.ArgumentParser(usage=__doc__.replace("%", "%%"))
    parser.add_argument("scenes", nargs="*", choices=[*SCENES, []])
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--json")
    options = parser.parse_args()
    missing = environment.set_up(["cycles"])
    if Path(sys.prefix).resolve() != (HOME / "venv").resolve():
        # From here on with numpy.
        os.execv(PYTHON, [str(PYTHON), __file__, *sys.argv[1:]])
    results = {scene: measure(scene, options, missing) for scene in options.scenes or SCENES}
    if options.json:
        Path(options.json).write_text(json.dumps({"machine": machine(), "scenes": results}, indent=2) + "\n")


def measure(scene, options, missing):
    folder = HOME / "lightmaps" / scene
    description = lumel("export-lumels", scene, folder)
    print(
        f"\n{scene}: {description['lumels']} lumels, {description['points']} random points, reference with a noise of "
        f"{description['noise']:.2%}; {description['bounces']} bounces; the worst {LEFT_OUT:.0%} left out",
        flush=True,
    )
    rungs = {"lumel": climb("lumel", lambda setting: bake_lumel(scene, folder, setting))}
    kept = folder / "cycles.json"
    key = json.loads(json.dumps([LADDERS["cycles"], digest(*(folder / file for file in ("scene.json", "corners.f32")))]))
    old = stored(kept)
    if reason := missing.get("cycles"):
        print(f"  cycles: {reason}")
    elif old and old["key"] == key and not options.fresh:
        rungs["cycles"] = old["rungs"]
    else:
        rungs["cycles"] = climb("cycles", lambda setting: bake_cycles(scene, folder, setting))
        kept.write_text(json.dumps({"key": key, "rungs": rungs["cycles"]}, indent=2))
    show(rungs)
    return {"description": description, "rungs": rungs}


def climb(who, bake):
    """The rungs of a ladder up to the first where both kinds are below the last target."""
    rungs = []
    for setting in LADDERS[who]:
        try:
            rungs.append({"setting": setting, **bake(setting)})
        except (RuntimeError, subprocess.TimeoutExpired) as problem:
            print(f"  {who}: {problem}")
            break
        print(f"  {who:<8} {str(setting):<12} {words(rungs[-1])}", flush=True)
        if all(rungs[-1][kind]["error"] < TARGETS[-1] for kind in KINDS):
            break
    return rungs


def words(rung):
    return "   ".join(f"{kind} {rung[kind]['cpu_seconds']:8.2f} s {rung[kind]['error']:7.2%}" for kind in KINDS)


def bake_lumel(scene, folder, setting):
    import numpy as np

    runs, squares = [], []
    for seed in range(SEEDS):
        runs.append(lumel("bake-lumels", scene, folder, *setting, seed))
        squares.append([error_of(folder, f"{kind}.f32") ** 2 for kind in KINDS])
    errors = np.sqrt(np.mean(squares, axis=0))
    seconds = [float(np.median([run[key] for run in runs])) for key in KINDS.values()]
    return {kind: {"cpu_seconds": s, "error": float(e)} for kind, s, e in zip(KINDS, seconds, errors)}


def bake_cycles(scene, folder, setting):
    runs = [run_cycles(folder, setting)]
    while len(runs) < SEEDS and runs[0]["cpu_seconds"] < SHORT:
        runs.append(run_cycles(folder, setting))
    rung = {}
    for kind, key in KINDS.items():
        page = "page.f32" if kind == "noisy" else "denoised_page.f32"
        lumel("read-lumels", scene, folder, page, "answer.f32")
        rung[kind] = {"cpu_seconds": min(run[key] for run in runs), "error": error_of(folder, "answer.f32")}
    return {**rung, "version": runs[0]["version"]}


def run_cycles(folder, setting):
    script = Path(__file__).with_name("peer_cycles_lightmap.py")
    command = [PYTHON, script, folder, *map(str, setting)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
    if result.returncode != 0:
        raise RuntimeError(f"{script.name} failed: {last_line(result.stderr)}")
    return json.loads(last_line(result.stdout))


def error_of(folder, name):
    import numpy as np
    from world import error

    read = lambda file: np.fromfile(folder / file, "<f4").reshape(-1, 3).astype(float)
    return error(read(name), read("reference.f32"), LEFT_OUT)


def show(rungs):
    print(f"\n  {'':<20}" + "".join(f"{who:>12}" for who in rungs) + f"{'over lumel':>14}")
    for target in TARGETS:
        for kind in KINDS:
            at = [at_target([rung[kind] for rung in rungs[who]], target) for who in rungs]
            cells = [f"{a['cpu_seconds']:.2f}" if a else "-" for a in at]
            ratio = f"{at[1]['cpu_seconds'] / at[0]['cpu_seconds']:.1f}" if len(at) > 1 and all(at) else "-"
            how = {a["how"] for a in at if a} - {"interpolated"}
            line = f"  {kind + ' to ' + format(target, '.0%'):<20}" + "".join(f"{cell:>12}" for cell in cells)
            print(f"{line}{ratio:>14}   {', '.join(sorted(how))}")


if __name__ == "__main__":
    main()
