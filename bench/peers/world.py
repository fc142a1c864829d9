"""The scene that lumel wrote for its peers, and how far an answer is from the reference."""

import json
from pathlib import Path

import numpy as np


class World:
    """Geometry, light and receivers; metres and W/(m2 sr)."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.description = json.loads((self.folder / "scene.json").read_text())
        self.bounces = self.description["bounces"]
        self.albedos = self.description["albedos"]
        self.light = self.description["light"]
        self.positions = self._read("positions.f32", 3)
        self.triangles = self._read("triangles.u32", 3)
        # The material of each triangle.
        self.materials = self._read("materials.u32")
        self.size = float(np.ptp(self.positions, axis=0).max())
        if (self.folder / "receivers.f32").exists():
            self._read_receivers()

    def _read_receivers(self):
        receivers = self._read("receivers.f32", 6)
        self.all_origins, self.all_normals = receivers[:, :3], receivers[:, 3:]
        # Receivers that are compared, in random order, and all vertices that can be measured, for which times are. At
        # nodes, these are receivers too.
        self.sample = self._read("sample.u32")
        self.valid = self._read("valid.u32")
        self.origins, self.normals = self.all_origins[self.sample], self.all_normals[self.sample]

    def corners(self):
        """Lightmap coordinates of the corners of all triangles."""
        return self._read("corners.f32", 2)

    def light_axes(self):
        """Centre, half edges and the direction it shines in."""
        return [np.array(self.light[key]) for key in ("center", "u", "v", "normal")]

    def part(self, material):
        """The positions and triangles of one material."""
        used, triangles = np.unique(self.triangles[self.materials == material], return_inverse=True)
        return self.positions[used], triangles.reshape(-1, 3).astype(np.uint32)

    def share_compared(self):
        """Receivers that are compared over the vertices that can be measured."""
        return len(self.sample) / len(self.valid)

    def reference(self):
        """Irradiance of the receivers that are compared, and its standard error."""
        stored = np.load(self.folder / "reference.npz")
        return stored["irradiance"], stored["standard_error"]

    def long_solve(self):
        """The same by a long solve of lumel on a finer mesh."""
        return self._read("long.f32", 3), self._read("long_error.f32", 3)

    def _read(self, name, columns=1):
        kind = "<f4" if name.endswith(".f32") else "<u4"
        numbers = np.fromfile(self.folder / name, kind)
        return numbers.reshape(-1, columns) if columns > 1 else numbers


def rms(vectors):
    """The root mean square of the lengths of vectors."""
    return float(np.sqrt((np.asarray(vectors, float) ** 2).sum(1).mean()))


def error(answer, reference, left_out=0.0):
    """RMS difference over the RMS of the reference, a share of the worst receivers left out of both."""
    squares = ((answer - reference) ** 2).sum(1)
    kept = np.argsort(squares)[: round(len(squares) * (1 - left_out))]
    return rms((answer - reference)[kept]) / rms(reference[kept])
