#!/usr/bin/env python3
"""scripts/quickstart.sh: its answer is of the model that was asked for, also after failures.

usage: tests/cli/test_quickstart.py [-v]

Programs that it calls are stand-ins: vdb_tool copies its input, the program repeats the mesh.
"""
import os
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
VDB_TOOL = """#!/bin/bash
while [ $# -gt 0 ]; do
    case $1 in -read) from=$2 ;; -write) to=$2 ;; esac
    shift
done
[ -z "${BREAKS:-}" ] || { head -c 20 "$from" >"$to"; exit 1; }
cp "$from" "$to"
"""
PROGRAM = """#!/bin/bash
while [ $# -gt 0 ]; do
    case $1 in --sdf) cat "$2" ;; esac
    shift
done
"""


def mesh(size: float) -> str:
    return f"v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nv 0 0 {size}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


class Quickstart(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name in ("quickstart.sh", "mesh_tool.py"):
            self.put(f"scripts/{name}", (ROOT / "scripts" / name).read_text())
        for name in ("setup.sh", "build.sh", "make_data.sh"):
            self.put(f"scripts/{name}", "")
        self.put("data/trefoil.vdb", "")
        self.put("bin/vdb_tool", VDB_TOOL)
        self.put("build/release/bin/implicit-geodesic", PROGRAM)

    def put(self, name: str, text: str) -> pathlib.Path:
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        file.chmod(0o755)
        return file

    def run_it(self, model: pathlib.Path, **variables: str) -> subprocess.CompletedProcess:
        environment = {**os.environ, "PATH": f"{self.folder}/bin:{os.environ['PATH']}", **variables}
        return subprocess.run(["bash", self.folder / "scripts/quickstart.sh", model], env=environment,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)

    def test_two_models_of_one_name(self):
        for size in (1, 2, 1):
            model = self.put(f"m{size}/part.obj", mesh(size))
            os.utime(model, (1, 1))  # older than all that is made of it
            done = self.run_it(model)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stdout.strip(), mesh(size).strip())

    def test_a_reading_that_fails_is_done_again(self):
        for size in (1, 2):
            os.utime(self.put(f"m{size}/part.obj", mesh(size)), (1, 1))
        self.assertEqual(self.run_it(self.folder / "m1/part.obj").returncode, 0)
        other = self.folder / "m2/part.obj"
        self.assertNotEqual(self.run_it(other, BREAKS="1").returncode, 0)
        done = self.run_it(other)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.strip(), mesh(2).strip())


if __name__ == "__main__":
    unittest.main()
