#!/usr/bin/env python3
"""implicit-geodesic between OpenVDB's own programs: vdb_tool, vdb_print and vdb_render.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/cli/test_openvdb_tools.py [-v]

Exit code 77 where they are missing (Debian: libopenvdb-tools).
"""
import math
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))
import images  # noqa: E402

PROGRAM = os.path.abspath(os.environ.get("IGEO_PROGRAM", ROOT / "build/release/bin/implicit-geodesic"))


class Pipelines(unittest.TestCase):
    def setUp(self):
        self.desk = tempfile.TemporaryDirectory()
        self.addCleanup(self.desk.cleanup)

    def path(self, name):
        return os.path.join(self.desk.name, name)

    def shell(self, line, good=True):
        """Runs a line of bash in the test's folder; `geodesic` is the program. Gives its stdout."""
        done = subprocess.run(
            ["bash", "-c", f"set -o pipefail; geodesic() {{ {shlex.quote(PROGRAM)} \"$@\"; }}; {line}"],
            cwd=self.desk.name, capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(done.returncode == 0, good, f"{line}\n{done.stdout}\n{done.stderr}")
        self.stderr = done.stderr
        return done.stdout

    def grids(self, printed):
        """name -> active voxels, of vdb_tool -print (which writes to stderr)."""
        return {name: int(count) for name, count in
                re.findall(r'VDB grid:.* name = "([^"]*)".*voxels = (\d+)', printed)}

    def test_vdb_tool_on_both_sides(self):
        for codec in ("none", "zip", "blosc", "active"):
            with self.subTest(codec=codec):
                self.shell(
                    f"vdb_tool -quiet -sphere dim=64 radius=1 name=ball -write stdout.vdb codec={codec}"
                    " | geodesic --sdf - --seed 0,0,1 --grids surface,gradient,label,color,engraved -o - -v"
                    " | vdb_tool -read stdin.vdb -print")
                found = self.grids(self.stderr)
                self.assertEqual(set(found), {
                    "ball", "ball_geodesic", "ball_geodesic_gradient", "ball_label",
                    "ball_geodesic_color", "ball_engraved"})
                said = re.search(r"(\d+) nodes; \1 reached", self.stderr)
                self.assertEqual(found["ball_geodesic"], int(said[1]))

    def test_half_floats(self):
        line = ("vdb_tool -quiet -sphere dim=64 radius=1 -write stdout.vdb bits={}"
                " | geodesic --sdf - --seed 0,0,1 --target 0,0,-1 -q -o /dev/null --report -"
                " | python3 -c 'import json, sys; print(json.load(sys.stdin)[\"targets\"][0][\"distance\"])'")
        whole, half = (float(self.shell(line.format(bits))) for bits in (32, 16))
        # Halves have 11 bits: psi, below 3 voxels, is off by at most 2^-11 of that at each voxel.
        # A path of length pi on a sphere whose radius is off by r is off by pi r.
        self.assertAlmostEqual(half, whole, delta=math.pi * 3 * 2 / 64 * 2 ** -11)

    def test_one_of_several_grids(self):
        two = "vdb_tool -quiet -sphere dim=40 radius=1 name=a -sphere dim=40 radius=2 name=b -write stdout.vdb"
        self.shell(f"{two} | geodesic --sdf - --seed 0,0,1 -o out.vdb", good=False)
        self.assertIn("holds 2 level sets", self.stderr)
        self.assertIn("name one: -:", self.stderr)
        self.shell(f"{two} | geodesic --sdf -:b --seed 0,0,2 -o out.vdb")
        self.shell("vdb_tool -read out.vdb -print")
        self.assertEqual(list(self.grids(self.stderr)), ["b_geodesic"])

    def test_turned_and_moved(self):
        # On a sphere, wherever it starts, the largest distance is half the circumference, less
        # what lies within a voxel of the far pole.
        turn = "vdb_tool -quiet -sphere dim=64 radius=1 -transform vdb=0 {} -write stdout.vdb"
        line = " | geodesic --sdf - --seed 1,2,4 -o out.vdb"
        self.shell(turn.format("'rotate=(0.5,0.3,0.2)' 'translate=(1,2,3)'") + line)
        largest = float(re.search(r"distances up to (\S+)", self.stderr)[1])
        self.assertAlmostEqual(largest, math.pi, delta=2 / 58)
        # vdb_tool scales the transform and leaves the values: that is no distance any more.
        self.shell(turn.format("scale=2 'translate=(1,2,2)'") + line, good=False)
        self.assertIn("psi is not a distance", self.stderr)
        self.assertIn("scaled", self.stderr)

    def test_fog_and_nothing_are_refused(self):
        self.shell("vdb_tool -quiet -sphere dim=40 -ls2fog -write stdout.vdb"
                   " | geodesic --sdf - --seed 0,0,1 -o out.vdb", good=False)
        self.assertIn("fog volume", self.stderr)
        self.shell("true | geodesic --sdf - --seed 0,0,1 -o out.vdb", good=False)
        self.assertIn("standard input is empty", self.stderr)
        self.assertFalse(os.path.exists(self.path("out.vdb")))

    def test_mesh_in_mesh_out(self):
        self.shell("vdb_tool -quiet -sphere dim=64 radius=1 -ls2mesh -write ball.ply &&"
                   " vdb_tool -quiet -read ball.ply -mesh2ls dim=64 name=psi -write stdout.vdb"
                   " | geodesic --sdf - --seed 0,0,1 --grids engraved -o out.vdb &&"
                   " vdb_tool -quiet -read out.vdb grids=psi_engraved -ls2mesh -write engraved.obj")
        radii = []
        with open(self.path("engraved.obj"), encoding="ascii") as file:
            for line in file:
                if line.startswith("v "):
                    radii.append(math.hypot(*map(float, line.split()[1:4])))
        voxel = 2 / 58
        self.assertGreater(len(radii), 1000)
        self.assertLess(max(radii), 1 + 0.5 * voxel)  # cut into, nothing added
        self.assertLess(min(radii), 1 - 0.5 * voxel)
        self.assertGreater(min(radii), 1 - 3 * voxel)  # within the layer of psi

    def test_vdb_print_shows_what_was_written(self):
        self.shell(f"geodesic --sdf {ROOT}/data/sphere.vdb --seed 0,0,1 -q -o out.vdb")
        long = self.shell("vdb_print -l out.vdb")
        self.assertRegex(long, r"creator: implicit-geodesic \d")
        self.assertRegex(long, r"Name: psi_geodesic\n")
        self.assertRegex(long, r"geodesic_scheme: jet")
        values = [float(re.search(rf"{end} value: (\S+)", long)[1]) for end in ("Min", "Max", "Background")]
        self.assertLess(values[0], 0.05 * math.sqrt(3))  # the seed is within a voxel
        self.assertEqual(values[1], values[2])  # unreached voxels close sublevel sets
        self.assertAlmostEqual(values[1], math.pi, delta=0.05)
        self.assertEqual(float(re.search(r"geodesic_max: (\S+)", long)[1]), values[1])

    def test_vdb_render_paints_the_distance(self):
        self.shell(f"geodesic --sdf {ROOT}/data/sphere.vdb --seed 0,0,1 --grids surface,color"
                   " --color-map gray -q -o out.vdb && vdb_render out.vdb out.png -name psi"
                   " -color psi_geodesic_color -camera ortho -frame 2.5 -translate 0,0,3"
                   " -lookat 0,0,0 -shader matte -res 250x250")
        rows = images.read_png(self.path("out.png"))
        self.assertEqual((len(rows), len(rows[0])), (250, 250))
        seen = 0
        for y, row in enumerate(rows):
            for x, pixel in enumerate(row):
                r = math.hypot(x + 0.5 - 125, y + 0.5 - 125) / 100
                if r > 1.03:
                    self.assertEqual(pixel, (0, 0, 0))
                elif r < 0.95:
                    # From above the seed, distance asin r. Gray goes from black to white in sRGB,
                    # which the grid holds and vdb_render writes as it is. It takes the nearest
                    # voxel, at most half a diagonal away; a gray level is 0.0123 of distance.
                    self.assertEqual(len(set(pixel)), 1)
                    distance = (pixel[0] + 0.5) / 256 * math.pi
                    self.assertAlmostEqual(distance, math.asin(r), delta=0.05 * math.sqrt(3) / 2 + 0.0123)
                    seen += 1
        self.assertGreater(seen, 28000)

    def test_vdb_render_needs_no_name(self):
        # It takes the first float grid, and psi comes first.
        line = f"geodesic --sdf {ROOT}/data/trefoil.vdb --seed 0,-1.02,0 -q -o out.vdb --grids surface"
        render = "-translate 0,-2,3 -lookat 0,0,0 -res 160x120"
        self.shell(f"{line} && vdb_render out.vdb first.png {render} &&"
                   f" vdb_render out.vdb named.png -name psi {render}")
        first = images.read_png(self.path("first.png"))
        self.assertEqual(first, images.read_png(self.path("named.png")))
        shown = [p for row in first for p in row if p != (0, 0, 0)]
        self.assertGreater(len(shown), 0.1 * 160 * 120)
        self.assertGreater(len(set(shown)), 50)  # shaded


if __name__ == "__main__":
    missing = [t for t in ("vdb_tool", "vdb_print", "vdb_render") if not shutil.which(t)]
    if missing:
        print(f"skipped: {', '.join(missing)} not found (Debian: libopenvdb-tools)")
        sys.exit(77)
    unittest.main()
