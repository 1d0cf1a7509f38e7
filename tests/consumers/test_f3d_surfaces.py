#!/usr/bin/env python3
"""F3D finds the distances in .vtp, .glb and .ply files: what it tells of them, without a display.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/consumers/test_f3d_surfaces.py

Exit code 77 where F3D is missing (Debian: f3d).
"""
import pathlib
import re
import shutil
import subprocess
import sys

import consumers
from surfaces import read_csv, write_torus


def told(file: pathlib.Path) -> dict[str, list[float]]:
    """The arrays at the points, with their ranges."""
    done = subprocess.run(["f3d", "--no-render", "--verbose", str(file)], capture_output=True, text=True, check=False)
    ranges = {}
    for name, bounds in re.findall(r"^ +(\w+) : [a-z ]+ : (\[.*\])", done.stdout + done.stderr, re.MULTILINE):
        ranges[name] = [float(x) for x in re.findall(r"[-+.\de]+", bounds)]
    return ranges


def main() -> int:
    if not shutil.which("f3d"):
        print("skipped: there is no f3d")
        return 77
    with consumers.temporary() as name:
        folder = pathlib.Path(name)
        write_torus(folder / "torus.obj")
        run = ["--mesh", folder / "torus.obj", "--seed", "vertex:1", "--voxel-size", "0.1", "-q", "-o",
               folder / "out.vdb"]
        consumers.geodesic(*run, "--per-vertex", folder / "v.csv")
        largest = max(read_csv(folder / "v.csv")["distance"][1:])
        consumers.geodesic(*run, "--per-vertex", folder / "v.vtp")
        ranges = told(folder / "v.vtp")
        assert abs(ranges["distance"][1] - largest) < 1e-5, ranges
        for file, distance in (("m.vtp", "distance"), ("m.glb", "_DISTANCE")):
            consumers.geodesic(*run, "--mesh-out", folder / file)
            ranges = told(folder / file)
            assert ranges[distance][0] < 0.05 and abs(ranges[distance][1] - largest) < 0.01, ranges
        assert ranges["TEXCOORD_0"][1] == 1, ranges
        consumers.geodesic(*run, "--mesh-out", folder / "m.ply")
        assert told(folder / "m.ply")["TCoords"][1] == 1
    version = subprocess.run(["f3d", "--version"], capture_output=True, text=True, check=False).stdout
    print(version.splitlines()[0])
    return 0


if __name__ == "__main__":
    sys.exit(main())
