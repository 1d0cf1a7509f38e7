#!/usr/bin/env python3
"""Inputs made to hurt: each ends with exit code 2 or 3 and a sentence, and none asks for a report.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/cli/test_hostile.py [-v]
"""
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ.get("IGEO_PROGRAM", ROOT / "build/release/bin/implicit-geodesic")).resolve()
DONE, USAGE, UNUSABLE = 0, 2, 3

DEEP = 100000
LISTS = "[" * DEEP + "]" * DEEP
OBJECTS = '{"a":' * DEEP + "1" + "}" * DEEP
NEAR = ["--sdf", "sphere.vdb", "--seed", "0,0,1", "--max-distance", "0.1"]
JOB = {"name": "a", "sdf": "sphere.vdb", "seed": "0,0,1", "max-distance": 0.1, "output": "a.vdb"}


def counted(text: bytes) -> bytes:
    """A string as a VDB file has it."""
    return struct.pack("<I", len(text)) + text


class Hostile(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        shutil.copy(ROOT / "data/sphere.vdb", self.folder)

    def write(self, name, content):
        (self.folder / name).write_text(content if isinstance(content, str) else json.dumps(content))

    def run_program(self, *words, **how):
        return subprocess.run([PROGRAM, *words], cwd=self.folder, stderr=subprocess.PIPE, check=False, timeout=100,
                              **{"stdout": subprocess.PIPE, **how})

    def refused(self, phrase, *words, code=UNUSABLE, **how):
        """Of the words, `phrase` is held by the message."""
        done = self.run_program(*words, **how)
        said = done.stderr.decode()
        with self.subTest(command=[word[:60] for word in words], said=said[:300]):
            self.assertEqual(done.returncode, code)
            self.assertIn(phrase, said)
            self.assertNotIn("report this", said)
            self.assertFalse([c for c in said if ord(c) < 32 and c != "\n"])

    # JSON

    def test_deep_json_is_refused(self):
        readers = [("--seeds", NEAR[:2]), ("--targets", NEAR), ("--seed-curve", NEAR[:2]), ("--pairs", NEAR[:2])]
        for deep in (LISTS, OBJECTS):
            self.write("deep.json", deep)
            for option, others in readers:
                self.refused("nested more than 100 deep", *others, option, "deep.json")
            for command in (["batch"], ["batch", "merge"], ["batch", "merge", "--matrix"]):
                self.refused("nested more than 100 deep", *command, "deep.json")
            for document in ('{"version": 2, "jobs": [{"name": "a", "seed": %s}]}',
                             '{"version": 2, "defaults": {"seed": %s}, "jobs": [{"name": "a"}]}',
                             '{"version": 2, "$schema": %s, "jobs": [{"name": "a"}]}'):
                self.write("jobs.json", document % deep)
                self.refused("nested more than 100 deep", "batch", "jobs.json")
        self.write("deep.json", '[{"position": [0, 0, 1], "more": %s}]' % LISTS)
        self.refused("nested more than 100 deep", *NEAR[:2], "--seeds", "deep.json")

    def test_numbers_of_shards_are_checked(self):
        summary = {"schema": 2, "type": "summary", "creator": "x", "manifest": "jobs.json", "digest": "0",
                   "count": 7, "shard": None, "jobs": []}
        for number, count in ((1, 2**63), (2**63, 2**63), (0, 0), (-1, -5), (5, 3), (1, 1e300)):
            self.write("part.json", {**summary, "shard": {"number": number, "count": count}})
            self.refused("which does not exist", "batch", "merge", "part.json")
        for count in (2**63, -1):
            self.write("part.json", {**summary, "count": count})
            self.refused("more than 1000000000", "batch", "merge", "part.json")
        self.write("part.json", {**summary, "jobs": [{"index": 2**63, "name": "a"}]})
        self.refused("has job 9223372036854775808 of 7", "batch", "merge", "part.json")

    def test_parts_of_matrices_are_checked(self):
        point = {"position": [0, 0, 0]}
        part = {"schema": 2, "type": "matrix", "seeds": [point, point], "targets": [point, point],
                "rows": {"first": 0, "count": 2}, "distance": [[0, 1], [1, 0]], "asymmetry": 0}
        self.write("part.json", part)
        self.assertEqual(self.run_program("batch", "merge", "--matrix", "part.json").returncode, DONE)
        for change in ({"seeds": 5}, {"targets": None}, {"seeds": [0, 0]}, {"targets": [point, {"position": [0]}]},
                       {"targets": [point, {"group": 5}]}, {"distance": {}}, {"distance": [["a", 1], [1, 0]]},
                       {"distance": [[0], [1]]}, {"distance": [[0, 1]]}, {"rows": {"first": 2**63, "count": 2}},
{"rows": []}, {"distance": [5, 6]}):
            self.write("part.json", {**part, **change})
            self.refused("in no part" if "first" in change.get("rows", {}) else "part.json",
                         "batch", "merge", "--matrix", "part.json")
        for name in ("seeds", "targets", "distance", "asymmetry", "rows", "type"):
            self.write("part.json", {key: value for key, value in part.items() if key != name})
            self.refused("part.json", "batch", "merge", "--matrix", "part.json")

    # Names

    def test_control_characters_in_names_are_refused(self):
        for name in ("a\0b", "a\nb", "\x1b[31mred", "a\x7f"):
            self.write("jobs.json", {"version": 2, "jobs": [{**JOB, "name": name}]})
            self.refused("control character", "batch", "jobs.json")
            for option in ("output", "--name", "sdf", "seeds", "report"):
                self.write("jobs.json", {"version": 2, "jobs": [{**JOB, option: name + ".vdb"}]})
                self.refused("control character", "batch", "jobs.json")
            if "\0" not in name:
                self.refused("control character", *NEAR, "-o", name + ".vdb", code=USAGE)
                self.refused("control character", *NEAR, "--name", name, code=USAGE)
                self.refused("No such file", "--sdf", name + ".vdb", "--seed", "0,0,1", "-o", "x.vdb")
        self.assertEqual(sorted(os.listdir(self.folder)), ["jobs.json", "sphere.vdb"])

    def test_names_of_jobs_stay_in_the_folder(self):
        for name in ("../t", "a/../../t", "/t", "/tmp/t"):
            for option in ("output", "report", "image"):
                self.write("jobs.json", {"version": 2, "jobs": [{**JOB, "name": name, option: "{name}.vdb"}]})
                self.refused("leads out of the folder", "batch", "jobs.json")
        self.assertEqual(sorted(os.listdir(self.folder)), ["jobs.json", "sphere.vdb"])

    def test_names_of_grids_do_not_rule_the_terminal(self):
        whole = (self.folder / "sphere.vdb").read_bytes()
        (self.folder / "bad.vdb").write_bytes(whole.replace(counted(b"psi"), counted(b"\x1b[m")))
        self.refused("grid '\\x1b[m'", "--sdf", "bad.vdb:\x1b[m", "--rebuild", "--iso", "9", "--seed", "0,0,1")
        done = self.run_program("info", "bad.vdb")
        self.assertEqual(done.returncode, DONE)
        self.assertIn(b"\\x1b[m: float", done.stdout)
        self.assertNotIn(b"\x1b", done.stdout)

    # Places

    def test_links_to_one_file_are_one_output(self):
        for name in ("first.json", "second.json"):
            (self.folder / name).symlink_to("not_there.json")
        self.refused("two results cannot go to one place", *NEAR, "-o", "x.vdb", "--isolines", "first.json",
                     "--report", "second.json", code=USAGE)
        self.write("jobs.json", {"version": 2, "jobs": [{**JOB, "isolines": "first.json"},
                                                        {**JOB, "name": "b", "output": "b.vdb",
                                                         "isolines": "second.json"}]})
        self.refused("which job 'a' writes", "batch", "jobs.json", code=USAGE)

    def test_links_in_a_circle_are_refused(self):
        names = ["loop" + ending for ending in (".vdb", ".json", ".ply", ".xyz")]
        for name in names:
            (self.folder / name).symlink_to(name)
        (self.folder / "folder").symlink_to("folder")
        self.refused("run in a circle", *NEAR, "-o", "loop.vdb")
        for option in ("--report", "--isolines"):
            self.refused("run in a circle", *NEAR, "-o", "x.vdb", option, "loop.json")
        self.refused("there is no folder", *NEAR, "-o", "folder/x.vdb", code=USAGE)
        reads = [["--sdf", "loop.vdb"], ["--sdf", "loop.vdb:psi"], ["--mesh", "loop.ply"], ["--points", "loop.xyz"],
                 ["--sdf", "folder/x.vdb"]]
        for words in reads:
            self.refused("Too many levels", *words, "--seed", "0,0,1")
        for option in ("--seeds", "--targets", "--seed-curve", "--pairs"):
            self.refused("Too many levels", *NEAR, option, "loop.json")
        for option in ("--seed-mask", "--weight", "--obstacle", "--metric"):
            self.refused("Too many levels", *NEAR, option, "loop.vdb")
        for command in (["batch"], ["batch", "merge"]):
            self.refused("loop.json", *command, "loop.json")
        for name in names:
            self.assertTrue((self.folder / name).is_symlink(), name)

    def test_without_a_working_folder(self):
        whole = self.folder / "sphere.vdb"
        self.write("jobs.json", {"version": 2, "jobs": [JOB]})

        def refused(code, phrase, *words):
            script = ("import os, subprocess, sys\nos.mkdir('gone')\nos.chdir('gone')\nos.rmdir('../gone')\n"
                      "sys.exit(subprocess.run(sys.argv[1:]).returncode)")
            done = subprocess.run([sys.executable, "-c", script, PROGRAM, *words], cwd=self.folder,
                                  capture_output=True, text=True, check=False, timeout=100)
            with self.subTest(words=words, said=done.stderr):
                self.assertEqual(done.returncode, code)
                self.assertIn(phrase, done.stderr)

        near = ["--sdf", whole, *NEAR[2:]]
        refused(UNUSABLE, "the working folder is gone", *near)
        refused(UNUSABLE, "the working folder is gone", "batch", "jobs.json")
        refused(DONE, "distances up to", *near, "-o", self.folder / "x.vdb")
        refused(DONE, "the job is done", "batch", self.folder / "jobs.json")
        refused(DONE, "", "info", whole)

    def test_full_standard_output(self):
        self.write("jobs.json", {"version": 2, "jobs": [JOB]})
        for words in (["info", "sphere.vdb"], ["info", "sphere.vdb", "--json"], ["--help"], ["--version"],
                      ["info", "--help"], ["batch", "--help"], ["batch", "jobs.json", "--dry-run"],
                      [*NEAR, "-o", "x.vdb", "--report", "-"]):
            with open("/dev/full", "wb") as full:
                self.refused("cannot write 'standard output': No space left", *words, stdout=full)

    # Volumes

    def test_damaged_types_of_metadata_do_no_harm(self):
        whole = (self.folder / "sphere.vdb").read_bytes()
        for name, kind in ((b"class", b"string"), (b"file_compression", b"string"), (b"file_bbox_max", b"vec3i"),
                           (b"file_mem_bytes", b"int64"), (b"is_saved_as_half_float", b"bool")):
            self.assertEqual(whole.count(counted(name) + counted(kind)), 1)
            for other in (kind[:-1] + b"Z", b"vec3s" if kind == b"vec3i" else b"\xff" * len(kind)):
                damaged = whole.replace(counted(name) + counted(kind), counted(name) + counted(other))
                (self.folder / "bad.vdb").write_bytes(damaged)
                done = self.run_program("--sdf", "bad.vdb", *NEAR[2:], "-o", "x.vdb", "--grids", "surface,engraved",
                                        "--image", "x.png", "--image-size", "64x48")
                self.assertEqual((done.returncode, b"report this" in done.stderr), (DONE, False), done.stderr)

    def test_voxels_too_small_for_a_grid(self):
        # A volume of voxels of 5e-6, which OpenVDB reads and cannot compute with.
        whole = (self.folder / "sphere.vdb").read_bytes()
        scale, small = struct.pack("<d", 0.050000000000000044), struct.pack("<d", 5e-6)
        self.assertGreater(whole.count(scale), 0)
        (self.folder / "bad.vdb").write_bytes(whole.replace(scale, small))
        self.refused("smaller unit", "--sdf", "bad.vdb", "--seed", "0,0,5e-5")
        lines = ["v {} {} {}".format(2e-3 * x, 2e-3 * y, 0) for x in range(2) for y in range(2)]
        self.write("part.obj", "\n".join([*lines, "f 1 2 4 3"]) + "\n")
        self.write("part.xyz", "".join("{} {} 0\n".format(4e-8 * x, 4e-8 * y) for x in range(50) for y in range(50)))
        for words in (["--mesh", "part.obj"], ["--points", "part.xyz"]):
            self.refused("smaller unit, as millimeters instead of meters", *words, "--seed", "0,0,0")
        self.assertIn(b"smaller unit", self.run_program("info", "part.obj").stdout)
        done = self.run_program("--mesh", "part.obj", "--resolution", "100", "--seed", "0,0,0")
        self.assertEqual(done.returncode, DONE, done.stderr)


if __name__ == "__main__":
    if os.name != "posix":
        print("needs a system with symbolic links and /dev/full")
        sys.exit(77)
    unittest.main()
