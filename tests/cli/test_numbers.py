#!/usr/bin/env python3
"""Numbers of runs on the unit sphere of data/: opposite the seed, of caps, in other units, and out of range.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/cli/test_numbers.py [-v]
"""
import json
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ.get("IGEO_PROGRAM", ROOT / "build/release/bin/implicit-geodesic")).resolve()
SPHERE = ["--sdf", ROOT / "data/sphere.vdb"]
VOXEL, DONE, USAGE, UNUSABLE = 0.05, 0, 2, 3


def point(*p):
    return ",".join(map(repr, p))


def ball(radius, rows=40):
    """Rings of vertices between two poles."""
    rings = [[(math.sin(a) * math.cos(t), math.sin(a) * math.sin(t), math.cos(a))
              for t in (2 * math.pi * k / (2 * rows) for k in range(2 * rows))]
             for a in (math.pi * k / rows for k in range(1, rows))]
    lines = ["v {!r} {!r} {!r}".format(*(radius * c for c in p)) for ring in rings for p in ring]
    lines += [f"v 0 0 {radius!r}", f"v 0 0 {-radius!r}"]
    n, north = 2 * rows, 2 * rows * (rows - 1) + 1
    for k in range(n):
        a, b = k + 1, (k + 1) % n + 1
        last = n * (rows - 2)
        lines += [f"f {north} {a} {b}", f"f {north + 1} {last + b} {last + a}"]
        lines += [f"f {a + r} {a + r + n} {b + r + n} {b + r}" for r in range(0, last, n)]
    return "\n".join(lines) + "\n"


class Numbers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_program(self, *words):
        return subprocess.run([PROGRAM, *map(str, words), "-o", "o.vdb"], cwd=self.folder, capture_output=True,
                              text=True, check=False, timeout=100)

    def report(self, *words):
        done = self.run_program(*words, "--report", "r.json")
        self.assertEqual(done.returncode, DONE, done.stderr)
        return json.loads((self.folder / "r.json").read_text())

    def refused(self, code, phrase, *words):
        done = self.run_program(*words)
        with self.subTest(words=[str(w)[:60] for w in words], said=done.stderr):
            self.assertEqual(done.returncode, code)
            self.assertIn(phrase, done.stderr)
            self.assertFalse((self.folder / "o.vdb").exists())

    def test_opposite_the_seed(self):
        # Fronts come from all sides; the least of them counts.
        for p in ((0.0, 0.0, 1.0), (0.6, 0.0, -0.8), (0.36, 0.48, 0.8), (-0.28, 0.96, 0.0)):
            found = self.report(*SPHERE, "--seed", point(*p), "--target", point(*(-c for c in p)))
            self.assertLess(abs(found["targets"][0]["distance"] - math.pi) / VOXEL, 0.009)  # measured 0.0060

    def test_caps(self):
        # Triangles are cut where the march ends.
        for limit in (0.4, 1.0):
            found = self.report(*SPHERE, "--seed", "0,0,1", "--grids", "label", "--max-distance", limit)
            exact = 2 * math.pi * (1 - math.cos(limit))
            self.assertLess(abs(found["seeds"][0]["cell"]["area"] / exact - 1), 0.0049)  # measured 0.0032

    def test_units(self):
        for unit in (1e-9, 2e-3, 1e9):
            (self.folder / "in.obj").write_text(ball(unit))
            words = ("--mesh", "in.obj", "--resolution", 64, "--seed", point(0.0, 0.0, unit),
                     "--target", point(unit, 0.0, 0.0))
            if unit < 1e-3:
                self.refused(UNUSABLE, "smaller unit", *words)
            else:
                distance = self.report(*words)["targets"][0]["distance"]
                self.assertLess(abs(distance / unit / (math.pi / 2) - 1), 1e-3)
                (self.folder / "o.vdb").unlink()

    def test_starts_lengths_and_weights_out_of_range(self):
        for start in ("1e20", "1e39", "1e300"):
            (self.folder / "s.csv").write_text(f"x,y,z,start\n1,0,0,{start}\n")
            self.refused(USAGE, "allowed are 0 to 5e+10, 1e12 voxels", *SPHERE, "--seeds", "s.csv")
        for length in ("1e7", "1e39", "1e300"):
            self.refused(USAGE, "allowed are 0 to 500000, 1e7 voxels", *SPHERE, "--seed", "0,0,1",
                         "--shoot", f"0,0,1,1,0,0,{length}")
        mesh = ball(1.0)
        (self.folder / "in.obj").write_text(mesh)
        for weight in ("1e-30", "1e-16", "1e16", "1e30"):
            (self.folder / "w.csv").write_text(f"{weight}\n" * mesh.count("v "))
            self.refused(USAGE, "1e-15 to 1e+15", "--mesh", "in.obj", "--resolution", 40, "--seed", "0,0,1",
                         "--weight", "w.csv")


if __name__ == "__main__":
    unittest.main()
