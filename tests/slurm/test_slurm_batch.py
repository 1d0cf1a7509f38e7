#!/usr/bin/env python3
"""scripts/slurm_batch.sh on a Slurm of one node: the same bytes as one batch, also after failures.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/slurm/test_slurm_batch.py [-v]

Ends with 77 where Slurm is not installed or does not start, and says why.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ.get("IGEO_PROGRAM", ROOT / "build/release/bin/implicit-geodesic")).resolve()
SLURM = ROOT / "tests/slurm/slurm.sh"
SCRIPT = ROOT / "scripts/slurm_batch.sh"
ENVIRONMENT = {**os.environ, "IMPLICIT_GEODESIC": str(PROGRAM), "SOURCE_DATE_EPOCH": "0"}
MERGED = "jobs.summary.json"


def jobs(count: int) -> dict:
    return {"version": 2, "defaults": {"sdf": "torus.vdb"}, "jobs": [
        {"name": f"j{k}", "seed": [1.4, 0, 0], "max-distance": 1 + k / 100, "output": f"j{k}.vdb"}
        for k in range(count)]}


class SlurmBatch(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        shutil.copy(ROOT / "data/torus.vdb", self.folder)
        self.write(jobs(9))

    def write(self, manifest):
        (self.folder / "jobs.json").write_text(json.dumps(manifest))

    def call(self, *words):
        return subprocess.run([*map(str, words)], cwd=self.folder, env=ENVIRONMENT, capture_output=True,
                              text=True, check=False, timeout=120)

    def submit(self, shards, *options):
        """Submits, waits for the end, and returns the exit code of the merge with what it said."""
        done = self.call(SCRIPT, "jobs.json", shards, *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        numbers = re.fullmatch(r"shards: (\d+), merge: (\d+)\n", done.stdout)
        self.assertTrue(numbers, done.stdout)
        deadline = time.monotonic() + 200
        while True:
            said = self.call("scontrol", "show", "job", numbers[2]).stdout
            if re.search(r"JobState=(COMPLETED|FAILED|CANCELLED|NODE_FAIL|TIMEOUT)", said):
                break
            self.assertLess(time.monotonic(), deadline, said + self.call("squeue").stdout)
            time.sleep(0.3)
        self.array = numbers[1]
        code = re.search(r"ExitCode=(\d+):", said)[1]
        return int(code), (self.folder / f"slurm-{numbers[2]}.out").read_text()

    def log(self, shard):
        return (self.folder / f"slurm-{self.array}_{shard}.out").read_text()

    def outputs(self):
        return {file.name: file.read_bytes() for file in self.folder.glob("j*") if file.suffix == ".vdb"}

    def test_an_array_and_its_merge_are_the_whole_batch(self):
        self.assertEqual(self.call(PROGRAM, "batch", "jobs.json").returncode, 0)
        whole, outputs = (self.folder / MERGED).read_bytes(), self.outputs()
        for name in [*outputs, MERGED]:
            (self.folder / name).unlink()
        code, said = self.submit(3, "--cpus-per-task=1")
        self.assertEqual(code, 0, said)
        self.assertIn("all 9 jobs are done", said)
        self.assertEqual(self.outputs(), outputs)
        self.assertTrue((self.folder / MERGED).read_bytes() == whole)
        self.assertEqual([self.log(k).count("is done") for k in (1, 2, 3)], [3, 3, 3])

        # The same command goes on: one output is gone, and only its job runs.
        (self.folder / "j4.vdb").unlink()
        code, said = self.submit(3)
        self.assertEqual(code, 0, said)
        self.assertEqual(["job 'j4' is done" in self.log(k) for k in (1, 2, 3)], [False, True, False])
        self.assertEqual([self.log(k).count("' is done") for k in (1, 2, 3)], [0, 1, 0])
        self.assertEqual(self.outputs(), outputs)

    def test_a_failing_job_is_told_and_the_rest_is_done(self):
        manifest = jobs(4)
        manifest["jobs"][2]["seed"] = [9, 0, 0]
        self.write(manifest)
        code, said = self.submit(2)
        self.assertEqual(code, 2, said)
        self.assertIn("1 of 4 jobs failed: j2", said)
        self.assertEqual(set(self.outputs()), {"j0.vdb", "j1.vdb", "j3.vdb"})

    def test_refused_before_anything_is_submitted(self):
        manifest = jobs(4)
        manifest["jobs"][2]["sead"] = [9, 0, 0]
        self.write(manifest)
        before = sorted(os.listdir(self.folder))
        done = self.call(SCRIPT, "jobs.json", 2)
        self.assertEqual(done.returncode, 2)
        self.assertIn("job 'j2'", done.stderr)
        for words in ((), ("jobs.json",), ("jobs.json", "1"), ("jobs.json", "x")):
            done = self.call(SCRIPT, *words)
            self.assertEqual(done.returncode, 2)
            self.assertIn("usage: scripts/slurm_batch.sh", done.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), before)


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        started = subprocess.run(["bash", SLURM, "start", folder], capture_output=True, text=True, check=False)
        if started.returncode != 0:
            print("skipped: Slurm does not run here:", started.stderr.strip())
            for log in pathlib.Path(folder).glob("*.log"):
                print(f"{log.name}: {''.join(log.read_text().splitlines(True)[-3:])}")
            return 77
        ENVIRONMENT["SLURM_CONF"] = f"{folder}/slurm.conf"
        try:
            return 0 if unittest.main(exit=False).result.wasSuccessful() else 1
        finally:
            subprocess.run(["bash", SLURM, "stop", folder], check=True)


if __name__ == "__main__":
    sys.exit(main())
