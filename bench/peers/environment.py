"""What the peers need: a virtual environment with their packages, and LLVM for Mitsuba."""

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HOME = ROOT / "target" / "peers"
PYTHON = HOME / "venv" / "bin" / "python"

# Measured with Mitsuba 3.9.1, Blender 5.0.1 (which needs Python 3.11) and pyradiance 1.3.1.
PACKAGES = {"mitsuba": "mitsuba", "cycles": "bpy", "radiance": "pyradiance"}

# LLVM 15 cannot compile Mitsuba's kernels (it stops at "Cannot select: fmaximum"); 19 can.
OLDEST_LLVM = 17


def set_up(peers=tuple(PACKAGES)):
    """Makes the environment; returns why a peer cannot run, by its name."""
    if not PYTHON.exists():
        subprocess.run([sys.executable, "-m", "venv", HOME / "venv"], check=True)
    missing = {}
    for peer, package in {"numpy": "numpy", **{peer: PACKAGES[peer] for peer in peers}}.items():
        if not succeeds([PYTHON, "-c", f"import {package}"]):
            print(f"installing {package} into {HOME / 'venv'}", flush=True)
            install = [PYTHON, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", package]
            result = subprocess.run(install, stderr=subprocess.PIPE, text=True)
            if result.returncode != 0:
                missing[peer] = f"pip install {package}: {last_line(result.stderr)}"
    if "numpy" in missing:
        sys.exit(f"error: {missing['numpy']}")
    if "mitsuba" in peers and "mitsuba" not in missing and "DRJIT_LIBLLVM_PATH" not in os.environ:
        library = find_llvm() or fetch_llvm()
        if library:
            os.environ["DRJIT_LIBLLVM_PATH"] = str(library)
        else:
            missing["mitsuba"] = f"no LLVM from {OLDEST_LLVM} on; set DRJIT_LIBLLVM_PATH to a libLLVM"
    return missing


def find_llvm():
    """The newest LLVM of the system, or the one that was fetched."""
    folders = [HOME / "llvm", Path("/usr/lib"), Path("/usr/local/lib")]
    found = [file for folder in folders for file in folder.rglob("libLLVM*.so*") if llvm_version(file) >= OLDEST_LLVM]
    return max(found, key=llvm_version, default=None)


def llvm_version(file):
    number = re.search(r"libLLVM(?:-(\d+)\.so|\.so\.(\d+))", file.name)
    return int(number[1] or number[2]) if number else 0


def fetch_llvm():
    """Debian's package, unpacked beside the environment: nothing is installed."""
    folder = HOME / "llvm"
    folder.mkdir(parents=True, exist_ok=True)
    if succeeds(["apt-get", "download", "libllvm19"], cwd=folder):
        for package in folder.glob("*.deb"):
            succeeds(["dpkg-deb", "-x", package, folder])
            package.unlink()
    return find_llvm()


def succeeds(command, **options):
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    try:
        return subprocess.run(command, **quiet, **options).returncode == 0
    except OSError:
        return False


def last_line(text):
    lines = [line for line in text.splitlines() if line.strip()]
    return lines[-1].strip() if lines else "no message"
