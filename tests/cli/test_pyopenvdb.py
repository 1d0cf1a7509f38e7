#!/usr/bin/env python3
"""Every grid of the output, read by OpenVDB's module for Python as Debian packages it.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/cli/test_pyopenvdb.py

Exit code 77 where the module is missing (Debian: python3-openvdb, for Debian's own Python).
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.path.abspath(os.environ.get("IGEO_PROGRAM", ROOT / "build/release/bin/implicit-geodesic"))
PYTHON = "/usr/bin/python3"
ALL = "surface,gradient,label,color,logmap,weight,curvature,engraved"
READ = """
import json, sys
try:
    import pyopenvdb
except ImportError:
    import openvdb as pyopenvdb
grids, metadata = pyopenvdb.readAll(sys.argv[1])
label = next(g for g in grids if g.name.endswith("_label"))
values = sorted({value for value in (item.value for item in label.citerOnValues())})
print(json.dumps([[g.name for g in grids], values]))
"""


def main() -> int:
    has = subprocess.run([PYTHON, "-c", "try:\n import pyopenvdb\nexcept ImportError:\n import openvdb"],
                         capture_output=True, check=False) if os.path.exists(PYTHON) else None
    if has is None or has.returncode != 0:
        print("no OpenVDB module in Debian's Python: python3-openvdb")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out.vdb")
        subprocess.run([PROGRAM, "--sdf", str(ROOT / "data/sphere.vdb"), "--seed", "0,0,1", "--seed", "0,0,-1",
                        "--seed", "1,0,0", "--grids", ALL, "-o", out, "-q"], check=True)
        done = subprocess.run([PYTHON, "-c", READ, out], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            print(done.stderr)
            return 1
        names, labels = json.loads(done.stdout)
    assert len(names) == 12, names
    assert labels == [0, 1, 2], labels
    print("read: " + ", ".join(names))
    return 0


if __name__ == "__main__":
    sys.exit(main())
