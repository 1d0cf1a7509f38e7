#!/usr/bin/env python3
"""`implicit-geodesic batch`: the bytes of single runs, once each, however often it is interrupted.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/cli/test_batch.py [-v]
"""
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ.get("IGEO_PROGRAM", ROOT / "build/release/bin/implicit-geodesic")).resolve()
VALIDATE = ROOT / "tests/cli/validate_json.py"
UNCHECKED = set()  # what this machine has no tool for; the test is then shown as skipped
DONE, FAILED, USAGE, UNUSABLE, UNREACHED = range(5)


def ball(corners: int) -> str:
    """An octahedron, each face cut into `corners`^2, as a ball of radius 1 in OBJ."""
    lines, numbers = [], {}

    def number(x, y, z):
        if (x, y, z) not in numbers:
            length = (x * x + y * y + z * z) ** 0.5
            numbers[x, y, z] = len(numbers) + 1
            lines.append("v {} {} {}".format(x / length, y / length, z / length))
        return numbers[x, y, z]

    faces = []
    for sx in (1, -1):
        for sy in (1, -1):
            for sz in (1, -1):
                def at(i, j, sx=sx, sy=sy, sz=sz):
                    return number(sx * i, sy * j, sz * (corners - i - j))
                for i in range(corners):
                    for j in range(corners - i):
                        faces.append((at(i, j), at(i + 1, j), at(i, j + 1))[::sx * sy * sz])
                        if i + j < corners - 1:
                            faces.append((at(i + 1, j), at(i + 1, j + 1), at(i, j + 1))[::sx * sy * sz])
    return "\n".join(lines + ["f {} {} {}".format(*face) for face in faces]) + "\n"


# Every kind of surface and result; two jobs and more on each surface.
JOBS = {
    "version": 2,
    "defaults": {"sdf": "torus.vdb", "straighten": True},
    "jobs": [
        {"name": "far", "seed": [1.4, 0, 0], "output": "far.vdb", "grids": ["gradient", "label"], "extend": True},
        {"name": "ball", "sdf": False, "mesh": "ball.obj", "resolution": 40, "seed": "0,0,1",
         "target": [[0, 1, 0], "0,0,-1"], "output": "ball.vdb", "paths": "ball.json", "image": "ball.png",
         "image-size": "160x120"},
        {"name": "near", "seed": [[1.4, 0, 0], [-1.4, 0, 0]], "max-distance": 0.3, "output": "near.vdb",
         "isolines": "near.json"},
        {"name": "path", "seed": [1.4, 0, 0], "target": [-1, 0, 0.4], "stop-at-targets": True,
         "output": "path.vdb", "--name": "d", "paths": "path.obj"},
        {"name": "paper", "seed": [1.4, 0, 0], "scheme": "godunov", "band-voxels": 2.5, "output": "paper.vdb"},
        {"name": "ball-mesh", "sdf": False, "mesh": "ball.obj", "resolution": 40, "seed": [1, 0, 0],
         "output": "ball-mesh.vdb", "mesh-out": "ball-mesh.ply", "grids": "engraved"},
        {"name": "pairs", "pairs": "pairs.csv", "pairs-out": "pairs.json", "straighten": False},
        {"name": "samples", "sample": 6, "matrix": "samples.csv", "output": "samples.vdb"},
        # Two metrics, by turns; the second of the last two may ask for a part of the band only.
        {"name": "valley", "seed": [1.4, 0, 0], "weight-curvature": "valley", "output": "valley.vdb"},
        {"name": "wall", "seed": [1.4, 0, 0], "obstacle-sphere": "0,1.4,0,0.2", "obstacle": "two_spheres.vdb",
         "output": "wall.vdb"},
        {"name": "valley-2", "seed": [-1.4, 0, 0], "weight-curvature": "valley", "output": "valley-2.vdb"},
        {"name": "wall-2", "seed": [-1.4, 0, 0], "obstacle-sphere": "0,1.4,0,0.2", "obstacle": "two_spheres.vdb",
         "max-distance": 0.5, "output": "wall-2.vdb"},
    ],
}

COUNT = len(JOBS["jobs"])
# The tests compare documents byte by byte, so these hold no times.
os.environ["SOURCE_DATE_EPOCH"] = "0"


class TempWorkspace(unittest.TestCase):
    """A folder with inputs and jobs.json."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name in ("torus.vdb", "two_spheres.vdb"):
            shutil.copy(ROOT / "data" / name, self.folder)
        (self.folder / "ball.obj").write_text(ball(24))
        (self.folder / "pairs.csv").write_text("1.4,0,0,0,1.4,0\n-1,0,0.4,0,-1,0.4\n")
        self.write(JOBS)
        self.inputs = set(os.listdir(self.folder))

    def write(self, jobs, name="jobs.json"):
        (self.folder / name).write_text(jobs if isinstance(jobs, str) else json.dumps(jobs))

    def command(self, *words):
        return [PROGRAM, *map(str, words)]

    def program(self, *words, cwd=None):
        return subprocess.run(self.command(*words), cwd=cwd or self.folder, capture_output=True, text=True,
                              check=False, timeout=200)

    def batch(self, *words, code=DONE):
        done = self.program("batch", "jobs.json", *words)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stdout if "--dry-run" not in words else "", "")
        return done.stderr

    def summary(self, name="jobs.summary.json"):
        self.valid("summary.schema.json", name)
        return json.loads((self.folder / name).read_text())

    def statuses(self, name="jobs.summary.json"):
        return {job["name"]: job["status"] for job in self.summary(name)["jobs"]}

    def valid(self, schema, name):
        done = subprocess.run(["/usr/bin/python3", VALIDATE, ROOT / "docs" / schema, self.folder / name],
                              capture_output=True, text=True, check=False)
        if done.returncode in (77, 127):
            UNCHECKED.add("schemas: python3-jsonschema is missing")
        else:
            self.assertEqual(done.returncode, 0, done.stdout)

    def outputs(self):
        """Of all jobs: name to bytes."""
        return {file.name: file.read_bytes() for file in sorted(self.folder.iterdir())
                if file.name not in self.inputs and "summary" not in file.name}

    def ran(self, said):
        """Names of the jobs that a batch says it has run."""
        return {line.split("'")[1] for line in said.splitlines() if ": job '" in line and "is done" in line}

    def refused(self, jobs, code, *says, words=()):
        """Before anything runs: nothing is written."""
        self.write(jobs)
        before = sorted(os.listdir(self.folder))
        done = self.program("batch", "jobs.json", *words)
        self.assertEqual(done.returncode, code, done.stderr)
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 2, done.stderr)
        self.assertTrue(lines[0].startswith("implicit-geodesic: error: ") and lines[1].startswith("  "))
        self.assertNotIn("exception", done.stderr)
        for part in says:
            self.assertIn(part, done.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), before)


class Log(TempWorkspace):
    """What the runs warned of, and when jobs ended."""

    def test_warnings_are_said_and_kept_and_the_log_grows(self):
        self.write({"version": 2, "defaults": {"sdf": "torus.vdb", "seed": [1.4, 0, 0]},
                    "jobs": [{"name": "idle", "obstacle-sphere": "9,9,9,1", "output": "idle.vdb"},
                             {"name": "off", "target": [5, 5, 5], "output": "off.vdb"},
                             {"name": "plain", "output": "plain.vdb"}]})
        said = self.batch("--log", "log.jsonl", code=USAGE)
        jobs = {job["name"]: job for job in self.summary()["jobs"]}
        self.assertEqual(len(jobs["idle"]["warnings"]), 1)
        self.assertIn("block", jobs["idle"]["warnings"][0])
        self.assertIn("job 'idle': " + jobs["idle"]["warnings"][0], said)
        self.assertEqual(jobs["plain"]["warnings"], [])
        # How each was made, as its documents say.
        self.assertEqual(jobs["plain"]["command"], ["--output=plain.vdb", "--sdf=torus.vdb", "--seed=1.4,0,0"])
        self.assertEqual([i["file"] for i in jobs["plain"]["inputs"]], ["torus.vdb"])
        self.assertEqual(jobs["idle"]["metric"]["obstacles"], ["sphere 9,9,9,1"])
        self.assertNotIn("metric", jobs["off"])
        lines = [json.loads(line) for line in (self.folder / "log.jsonl").read_text().splitlines()]
        self.assertEqual({line["job"]: line["status"] for line in lines},
                         {"idle": "done", "off": "failed", "plain": "done"})
        for line in lines:
            self.assertRegex(line["time"], r"^20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
            self.assertTrue(0 < line["seconds"] < 200)
            self.assertEqual(line["warnings"], jobs[line["job"]]["warnings"])
            self.assertEqual("error" in line, line["job"] == "off")
        self.batch("--log", "log.jsonl", code=USAGE)  # only what failed runs again
        self.assertEqual(len((self.folder / "log.jsonl").read_text().splitlines()), len(lines) + 1)

    def test_a_log_that_cannot_be_written_is_refused(self):
        self.assertIn("nowhere/log", self.batch("--log", "nowhere/log", code=USAGE))
        self.assertIn("which is the log", self.batch("--log", "pairs.csv", code=USAGE))
        self.assertFalse((self.folder / "jobs.summary.json").exists())


class Batch(TempWorkspace):
    def single_runs(self):
        """The commands that --dry-run prints, one by one; then their outputs are taken away."""
        printed = self.program("batch", "jobs.json", "--dry-run").stdout
        commands = [line.strip() for line in printed.splitlines() if line.startswith("  ")]
        self.assertEqual(len(commands), len(JOBS["jobs"]))
        for command in commands:
            subprocess.run(["bash", "-c", command.replace("implicit-geodesic", str(PROGRAM), 1) + " -q"],
                           cwd=self.folder, check=True)
        outputs = self.outputs()
        for name in outputs:
            (self.folder / name).unlink()
        return outputs

    def test_bytes_are_those_of_single_runs(self):
        self.valid("batch.schema.json", "jobs.json")
        single = self.single_runs()
        self.assertEqual(len(single), COUNT - 1 + 7)  # all but pairs have a volume
        summaries = set()
        for threads in (1, 2, 5):
            said = self.batch("--threads", threads)
            self.assertEqual(self.ran(said), {job["name"] for job in JOBS["jobs"]})
            together = self.outputs()
            self.assertEqual(sorted(together), sorted(single))
            for name, content in together.items():
                self.assertTrue(content == single[name], f"{name} differs with {threads} threads")
                (self.folder / name).unlink()
            self.assertEqual(set(self.statuses().values()), {"done"})
            summaries.add((self.folder / "jobs.summary.json").read_bytes())
        self.assertEqual(len(summaries), 1)

    def test_from_another_folder_and_quietly(self):
        done = self.program("batch", self.folder / "jobs.json", "-q", "--summary", "s.json", cwd=ROOT / "tests")
        try:
            self.assertEqual((done.returncode, done.stdout, done.stderr), (DONE, "", ""))
            self.assertTrue((self.folder / "far.vdb").exists())
            self.assertFalse((self.folder / "jobs.summary.json").exists())
            shutil.move(ROOT / "tests/s.json", self.folder / "s.json")
            self.assertEqual(set(self.statuses("s.json").values()), {"done"})
        finally:
            (ROOT / "tests/s.json").unlink(missing_ok=True)

    def test_what_is_done_is_not_done_again(self):
        self.batch()
        outputs, summary = self.outputs(), self.summary()
        self.assertIn(f"{COUNT} of {COUNT} jobs are done already", self.batch())
        # Times and the layout of the manifest have no effect.
        for file in self.folder.iterdir():
            os.utime(file, (time.time() + 100, time.time() + 100))
        self.write(json.dumps(JOBS, indent=4, sort_keys=True))
        self.assertEqual(self.ran(self.batch()), set())
        self.assertEqual(self.summary(), summary)

        # An output that is gone, one that is another, a summary that is gone.
        (self.folder / "path.obj").unlink()
        (self.folder / "near.vdb").write_bytes(outputs["paper.vdb"])
        self.assertEqual(self.ran(self.batch()), {"near", "path"})
        self.assertEqual(self.outputs(), outputs)

        # Content of an input; back again is another change.
        pairs = (self.folder / "pairs.csv").read_text()
        (self.folder / "pairs.csv").write_text(pairs + "0,1.4,0,1.4,0,0\n")
        self.assertEqual(self.ran(self.batch()), {"pairs"})
        (self.folder / "ball.obj").write_text(ball(25))
        self.assertEqual(self.ran(self.batch()), {"ball", "ball-mesh"})
        (self.folder / "pairs.csv").write_text(pairs)
        (self.folder / "ball.obj").write_text(ball(24))
        self.assertEqual(self.ran(self.batch()), {"ball", "ball-mesh", "pairs"})
        self.assertEqual(self.outputs(), outputs)

        # Options: of one job, of all; a job that is new.
        jobs = json.loads(json.dumps(JOBS))
        jobs["jobs"][2]["max-distance"] = 0.25
        jobs["jobs"].insert(0, {"name": "new", "seed": [0, 1.4, 0], "output": "new.vdb"})
        self.write(jobs)
        self.assertEqual(self.ran(self.batch()), {"near", "new"})
        del jobs["defaults"]["straighten"]
        self.write(jobs)
        self.assertEqual(self.ran(self.batch()), {job["name"] for job in jobs["jobs"] if "target" in job})

    def test_one_failure_does_not_stop_the_rest(self):
        jobs = json.loads(json.dumps(JOBS))
        jobs["jobs"] += [
            {"name": "off", "seed": [5, 0, 0], "output": "off.vdb"},
            {"name": "gone", "sdf": "gone.vdb", "seed": [5, 0, 0], "output": "gone.vdb.vdb"},
            {"name": "apart", "sdf": "two_spheres.vdb", "seed": "-1.2,0,0", "target": "1.2,0,0", "snap": 2,
             "output": "apart.vdb"}]
        self.write(jobs)
        said = self.batch(code=UNUSABLE)
        self.assertIn("error: job 'off': seed 0 (5,0,0) is 3.6", said)
        self.assertIn("warning: job 'apart' is done, but a target, pair or --via is unreached", said)
        self.assertIn(f"error: 2 of {COUNT + 3} jobs failed: off, gone\n", said)
        states = self.statuses()
        self.assertEqual([n for n, s in states.items() if s == "failed"], ["off", "gone"])
        self.assertEqual(states["apart"], "unreached")
        failed = {job["name"]: job for job in self.summary()["jobs"] if job["status"] == "failed"}
        self.assertEqual((failed["off"]["exitCode"], failed["gone"]["exitCode"]), (USAGE, UNUSABLE))
        self.assertIn("--snap", failed["off"]["error"]["remedy"])
        self.assertEqual(len(self.outputs()), COUNT - 1 + 7 + 1)

        # They are tried again; what is done, with 4 as well, is not.
        shutil.copy(self.folder / "torus.vdb", self.folder / "gone.vdb")
        jobs["jobs"][COUNT + 1]["seed"] = [1.4, 0, 0]
        self.write(jobs)
        said = self.batch(code=USAGE)
        self.assertEqual(self.ran(said), {"gone"})
        jobs["jobs"][COUNT]["seed"] = [1.4, 0, 0]
        self.write(jobs)
        self.assertIn("but a target, pair or --via is unreached in apart", self.batch(code=UNREACHED))

    def test_one_set_of_options_for_many_files(self):
        scans = self.folder / "scans"
        scans.mkdir()
        for name in ("b.obj", "a.obj", "c.ply", ".hidden.obj"):
            (scans / name).write_text(ball(3))
        template = {"version": 2, "files": "scans/*.obj",
                    "defaults": {"seed": "+z", "resolution": 20, "output": "out-{name}.vdb"}}
        self.write(template)
        self.valid("batch.schema.json", "jobs.json")
        self.batch()
        self.assertEqual({file.name for file in self.folder.glob("out-*")}, {"out-a.vdb", "out-b.vdb"})
        self.assertEqual(list(self.statuses()), ["a", "b"])
        self.write({"version": 2, "files": ["scans/?.obj"],
                    "defaults": {"seed": "+z", "mesh": "{file}", "resolution": 20, "per-vertex": "{name}.csv",
                                 "output": "/dev/null"}})
        self.batch()
        self.assertTrue((self.folder / "b.csv").exists())
        (scans / "t1.nii.gz").write_bytes(b"")
        self.write({**template, "files": "scans/*.nii.gz", "defaults": {"seed": "0,0,0", "iso": 60}})
        said = self.program("batch", "jobs.json", "--dry-run").stdout
        self.assertIn("--volume=scans/t1.nii.gz", said)
        self.assertIn("t1:", said.replace("'", ""))
        self.refused({"version": 2, "files": "scans/*.stl"}, UNUSABLE, "no file is like 'scans/*.stl'")
        self.refused({"version": 2, "files": 7}, UNUSABLE, "no pattern")
        self.refused({**template, "jobs": []}, UNUSABLE, "no manifest of version 2")

    def test_results_of_the_batch_are_no_files_of_its_pattern(self):
        scans = self.folder / "scans"
        scans.mkdir()
        for name in ("a.obj", "b.obj"):
            (scans / name).write_text(ball(3))
        out = {"seed": "+z", "resolution": 20}
        # Results that would be surfaces; then also some whose jobs would be refused, with the names of others.
        for files, defaults, left in (
                ("scans/*.obj", {"per-vertex": "scans/{name}-d.obj"}, 2),
                ("scans/*", {"per-vertex": "scans/{name}-d.obj", "output": "scans/{name}.vdb"}, 4)):
            self.write({"version": 2, "files": files, "defaults": {**out, **defaults}})
            self.batch()
            said = self.batch()
            self.assertIn("2 of 2 jobs are done already", said)
            self.assertIn(f'{left} files like "files" are left out, as the batch writes them itself: scans/a-d.obj, ...',
                          said)
            self.assertEqual(list(self.statuses()), ["a", "b"])

    def test_the_files_of_a_batch_get_no_job(self):
        points = {"version": 2, "files": "*.json", "defaults": {
            "seeds": "{file}", "sdf": "torus.vdb", "matrix": "{name}.csv"}}
        (self.folder / "points.json").write_text("[[1.4, 0, 0], [-1.4, 0, 0]]")
        self.write(points)
        self.batch("--log", "log.json")
        self.assertIn("1 of 1 jobs are done already", self.batch("--log", "log.json"))
        self.assertIn("3 files like", self.batch("--log", "log.json", "--dry-run"))
        (self.folder / "points.json").unlink()
        (self.folder / "jobs.summary.json").unlink()
        (self.folder / "log.json").unlink()
        self.refused(points, UNUSABLE, "the batch writes all files itself that are like its \"files\"")

    def test_defaults_without_effect_on_a_job_change_nothing_of_it(self):
        """Also --order, which has an effect on --scheme godunov alone."""
        shot = {"shoot": "1.4,0,0,0,1,0.3,1", "paths": "{name}.json", "report": "{name}.report.json"}
        self.write({"version": 2, "defaults": {"sdf": "torus.vdb", "scheme": "godunov", "order": 1,
                                               "obstacle-sphere": "0,1.4,0,0.2"},
                    "jobs": [{"name": "march", "seed": [1.4, 0, 0], "output": "march.vdb"}, {"name": "shot", **shot}]})
        said = self.program("batch", "jobs.json", "--dry-run").stdout
        self.assertIn("--obstacle-sphere=0,1.4,0,0.2 --order=1 --output=march.vdb --scheme=godunov", said)
        command = [line for line in said.splitlines() if "--shoot" in line][0].split()[1:]
        self.assertEqual([word.split("=")[0] for word in command], ["--paths", "--report", "--sdf", "--shoot"])
        self.batch()
        together = (self.folder / "shot.json").read_bytes(), (self.folder / "shot.report.json").read_bytes()
        self.assertEqual(self.program(*command).returncode, DONE)
        self.assertEqual(((self.folder / "shot.json").read_bytes(), (self.folder / "shot.report.json").read_bytes()),
                         together)
        self.assertEqual(json.loads(together[1])["parameters"]["scheme"], "jet")

    def test_a_job_of_no_file_asks_for_none(self):
        for jobs in ([{"name": "a", "mesh": "{file}", "seed": "+x"}],
                     [{"name": "a", "mesh": "ball.obj", "seed": "+x", "output": "{file}.vdb"}]):
            self.refused({"version": 2, "jobs": jobs}, UNUSABLE, "job 'a': '--", "{file}", "of no file")
        self.refused({"version": 2, "defaults": {"mesh": "{file}"}, "jobs": [{"name": "a", "seed": "+x"}]},
                     UNUSABLE, "job 'a': '--mesh={file}' asks for {file}")

    def test_a_table_of_jobs(self):
        table = self.folder / "jobs.csv"
        table.write_text('name,sdf,seed,output,extend\r\nnear,torus.vdb,"1.4,0,0",{name}.vdb,true\r\n\r\n'
                         'far,torus.vdb,"-1.4,0,0",{name}.vdb,\r\n')
        said = self.program("batch", "jobs.csv", "--dry-run").stdout
        self.assertIn("--extend --output=near.vdb", said)
        self.assertIn("--output=far.vdb --sdf=torus.vdb --seed=-1.4,0,0", said)
        shutil.copy(table, self.folder / "MORE.CSV")
        self.assertEqual(self.program("batch", "MORE.CSV", "--dry-run").stdout, said)
        self.write({"version": 2, "defaults": {"max-distance": 0.5}, "jobs": "jobs.csv"})
        self.batch()
        for text, words in (("mesh,seed\na.obj,+x\n", "no column 'name'"),
                            ("name,sdf,seed\na,torus.vdb,0,0,1\n", "line 2: 5 cells for 3 columns"),
                            ('name,sdf\na,"torus', "line 2: a quote has no end"),
                            ("name,sdf,sdf\na,b,c\n", "two columns are named 'sdf'"),
                            ("name\n", "has no jobs")):
            table.write_text(text)
            done = self.program("batch", "jobs.csv")
            self.assertEqual(done.returncode, UNUSABLE)
            self.assertIn(words, done.stderr)

    def test_refusals_before_anything_runs(self):
        good = {"name": "a", "sdf": "torus.vdb", "seed": [1.4, 0, 0], "output": "a.vdb"}

        def with_job(*more, **options):
            return {"version": 2, "jobs": [{**good, **options}, *more]}

        self.refused('{"version": 2, "jobs": [', UNUSABLE, "jobs.json is no JSON", "line 1")
        self.refused('{"version": 2, "jobs": [{"name": "a", "snap": 1e999}]}', UNUSABLE, "jobs.json is no JSON", "1e999")
        self.refused("[]", UNUSABLE, "no manifest of version 2")
        self.refused({"version": 9, "jobs": [good]}, UNUSABLE, "no manifest of version 2")
        self.refused({"version": 2, "jobs": []}, UNUSABLE, "no jobs")
        self.refused({"version": 2, "job": [], "jobs": [good]}, UNUSABLE, "'job' is no member")
        self.refused({"version": 2, "jobs": [{"seed": "1,0,0"}]}, UNUSABLE, "job 0", "has no name")
        self.refused({"version": 2, "defaults": {"name": "a"}, "jobs": [good]}, UNUSABLE, '"--name"')
        self.refused('{"version": 2, "jobs": [{"name": "a", "seed": "1,0,0", "seed": "0,1,0"}]}', UNUSABLE,
                     "'seed' is twice")
        self.refused(with_job(good), UNUSABLE, "two jobs are named 'a'")
        self.refused(with_job(sead="1,0,0"), USAGE, "job 'a'", "--sead=1,0,0")
        self.refused(with_job(**{"--seed": "1,0,0"}), UNUSABLE, "job 'a'", "with and without dashes")
        self.refused(with_job(**{"Seed": "1,0,0"}), UNUSABLE, "job 'a'", "'Seed' is no option")
        self.refused(with_job(seeds=None), UNUSABLE, "job 'a'", "'seeds'", "null")
        self.refused(with_job(seed=[[1.4, 0, [0]]]), UNUSABLE, "job 'a'", "'seed'", "[1.4,0,[0]]")
        for option in ("threads", "progress", "quiet", "verbose", "help", "version"):
            self.refused(with_job(**{option: 1}), USAGE, "job 'a'", f"--{option}=1")
        self.refused(with_job(resolution=5), USAGE, "job 'a'", "--resolution")
        self.refused(with_job(scheme="jetty"), USAGE, "job 'a'", "--scheme", "godunov")
        self.refused(with_job(seed=False), USAGE, "job 'a'", "no seed is given")
        # Whatever a value says is read before the first job runs.
        for option, value in (("seed", "1,2"), ("target", "x"), ("shoot", "1,2"), ("camera", "1,2"),
                              ("image-size", "10"), ("obstacle-sphere", "0,0,0,-1"), ("obstacle-box", "1,2,3"),
                              ("weight-curvature", "hill"), ("weight-curvature", "valley,eps=0"),
                              ("metric-curvature", "avoid,length=0"), ("matrix-rows", "3/2"), ("iso", "x")):
            bad = {**good, "name": "b", "output": "b.vdb", "matrix": "b.json", "rebuild": True, option: value}
            self.refused(with_job(bad), USAGE, "job 'b'", f"--{option}", value.split(",")[0])
        self.refused(with_job({**good, "name": "b", "output": "b.vdb", "signed": True}), USAGE, "job 'b'", "--signed")
        self.refused(with_job(isolines="nowhere/a.json"), USAGE, "job 'a'", "--isolines", "no folder 'nowhere'")
        self.refused(with_job({**good, "name": "b", "output": "./a.vdb"}), USAGE, "job 'b'", "job 'a'", "a.vdb")
        self.refused(with_job({"name": "b", "sdf": "torus.vdb", "seed": [1.4, 0, 0]}, output=False), USAGE,
                     "job 'b'", "job 'a'", "torus_geodesic.vdb")
        self.refused(with_job({**good, "name": "b", "output": "b.vdb", "weight": "a.vdb"}), USAGE,
                     "job 'b' reads 'a.vdb', which job 'a' writes")
        self.refused(with_job(report="-"), USAGE, "job 'a' writes to standard output")
        self.refused(with_job(sdf="-"), USAGE, "job 'a' reads standard input")
        self.refused(with_job(pairs="pairs.csv"), USAGE, "job 'a' writes to standard output")
        self.refused(with_job(report="jobs.summary.json"), USAGE, "the summary")
        self.refused(with_job(report="jobs.json"), USAGE, "which is the manifest")
        self.refused(with_job(), USAGE, "--shard: '3/2' is not K/N", words=("--shard", "3/2"))
        self.refused(with_job(), USAGE, "--shard: '0/2'", words=("--shard", "0/2"))
        self.refused(with_job(), USAGE, "--shard: '1'", words=("--shard", "1"))
        self.refused(with_job(), USAGE, "reads 'torus.vdb', which is the summary", words=("--summary", "torus.vdb"))
        self.refused(with_job(), UNUSABLE, "ball.obj is no JSON", words=("--summary", "ball.obj"))
        self.write({"schema": 2}, "other.json")
        self.refused(with_job(), UNUSABLE, "other.json is no summary", words=("--summary", "other.json"))
        done = self.program("batch")
        self.assertEqual(done.returncode, USAGE)
        self.assertIn("no manifest is given", done.stderr)
        self.assertEqual(self.program("batch", "none.json").returncode, UNUSABLE)

    def test_no_file_of_the_batch_overwrites_another(self):
        table = 'name,sdf,seed,output,report\na,torus.vdb,"1.4,0,0",a.vdb,{}\n'
        (self.folder / "table.csv").write_text(table.format("a.json"))
        os.link(self.folder / "table.csv", self.folder / "same.csv")
        manifest = {"version": 2, "jobs": "table.csv"}
        input_of_batch, one_place = "would overwrite the input '{}'", "two results cannot go to one place"
        for words, says in ((("--log", "jobs.json"), input_of_batch.format("jobs.json")),
                            (("--log", "./table.csv"), input_of_batch.format("table.csv")),
                            (("--log", "same.csv"), input_of_batch.format("table.csv")),
                            (("--summary", "jobs.json"), input_of_batch.format("jobs.json")),
                            (("--summary", "table.csv"), input_of_batch.format("table.csv")),
                            (("--log", "jobs.summary.json"), one_place),
                            (("--view", "s.html", "--summary", "s.html"), one_place),
                            (("--view", "s.html", "--log", "s.html"), one_place),
                            (("--summary", "nowhere/s.json"), "there is no folder 'nowhere'"),
                            (("--summary", "-"), "-: a batch writes no file to stdout"),
                            (("--log", "-"), "-: a batch writes no file to stdout"),
                            (("--view", "-"), "-: a batch writes no file to stdout"),
                            (("--view", "s.json"), "the ending is none of .html")):
            for more in ((), ("--dry-run",)):
                self.refused(manifest, USAGE, f"{words[0]} ", says, words=(*words, *more))
                self.assertEqual(json.loads((self.folder / "jobs.json").read_text()), manifest)
                self.assertEqual((self.folder / "table.csv").read_text(), table.format("a.json"))
        (self.folder / "table.csv").write_text(table.format("table.csv"))
        self.refused(manifest, USAGE, "job 'a' writes 'table.csv', which is the table of the jobs")

    def test_locks_take_no_file_away(self):
        job = {"name": "a", "sdf": "torus.vdb", "seed": "1.4,0,0", "output": "a.vdb"}
        manifest, is_lock = {"version": 2, "jobs": [job]}, "that is a lock of the batch"
        for option in ("--log", "--summary"):
            self.refused(manifest, USAGE, f"{option} ", is_lock, words=(option, "jobs.json.lock"))
        for lock in ("jobs.json.lock", "jobs.summary.json.lock"):
            self.refused({"version": 2, "jobs": [{**job, "report": lock}]}, USAGE,
                         f"job 'a' writes '{lock}', which is a lock of the batch")
            (self.folder / lock).write_text("of another program\n")
            self.refused(manifest, USAGE, f"{lock}' is no lock of a batch")
            self.assertEqual((self.folder / lock).read_text(), "of another program\n")
            (self.folder / lock).unlink()

    def test_shards_cover_all_jobs_once_and_merge_to_the_whole(self):
        self.batch()
        whole, outputs = (self.folder / "jobs.summary.json").read_bytes(), self.outputs()
        for count in (2, 3, 11):
            for name in outputs:
                (self.folder / name).unlink()
            names, ran = [], []
            for k in range(1, count + 1):
                ran += sorted(self.ran(self.batch("--shard", f"{k}/{count}")))
                names.append(f"jobs.summary-{k}-of-{count}.json")
                self.summary(names[-1])
            self.assertEqual(sorted(ran), sorted(job["name"] for job in JOBS["jobs"]))
            self.assertEqual(self.outputs(), outputs)
            random.Random(count).shuffle(names)
            done = self.program("batch", "merge", *names, "-o", "all.summary.json")
            self.assertEqual(done.returncode, DONE, done.stderr)
            self.assertTrue((self.folder / "all.summary.json").read_bytes() == whole)
            # With parts twice, and to stdout.
            done = self.program("batch", "merge", *names, "all.summary.json")
            self.assertEqual(done.stdout.encode(), whole)
        # A batch goes on from what was merged.
        self.assertIn(f"{COUNT} of {COUNT}", self.batch("--summary", "all.summary.json"))

    def test_jobs_on_one_surface_stay_together(self):
        # Three surfaces (godunov has its own) cut at one or two places.
        for count, most in ((1, 3), (2, 3 + 1), (3, 3 + 2)):
            read = 0
            for k in range(1, count + 1):
                commands = self.program("batch", "jobs.json", "--dry-run", "--shard", f"{k}/{count}").stdout
                read += len({("ball.obj" in line, "godunov" in line) for line in commands.splitlines()
                             if line.startswith("  ")})
            self.assertLessEqual(read, most)

    def test_no_more_jobs_at_once_than_memory_holds(self):
        def said(limit):
            self.write({"version": 2, "defaults": {"sdf": "torus.vdb", "memory-limit": limit}, "jobs": [
                {"name": f"j{k}", "seed": [1.4, 0, 0], "output": f"j{k}.vdb"} for k in range(5)]})
            return self.program("batch", "jobs.json", "-v", "--threads", 4).stderr

        needed = float(re.search(r"needs about (\S+) GiB", said(1e-9))[1])
        for limit, at_once in ((1.5, 1), (2.5, 2), (100, 4)):
            self.assertIn(f"; 5 jobs, {at_once} at once", said(limit * needed))

    def test_merge_refuses_what_does_not_belong_together(self):
        self.batch("--shard", "1/3")
        self.batch("--shard", "3/3")
        one, three = "jobs.summary-1-of-3.json", "jobs.summary-3-of-3.json"

        def refused(*says, parts=(one, three), code=UNUSABLE):
            done = self.program("batch", "merge", *parts, "-o", "all.json")
            self.assertEqual(done.returncode, code, done.stderr)
            for part in says:
                self.assertIn(part, done.stderr)
            self.assertFalse((self.folder / "all.json").exists())

        refused(f"{COUNT // 3} of {COUNT} jobs", "shards that are missing: 2 of 3")
        refused("none.json", parts=(one, "none.json"))
        before = (self.folder / one).read_bytes()
        done = self.program("batch", "merge", one, three, "-o", f"./{one}")
        self.assertEqual(done.returncode, USAGE)
        self.assertIn(f"-o ./{one} would overwrite the input '{one}'", done.stderr)
        self.assertEqual((self.folder / one).read_bytes(), before)
        done = self.program("batch", "merge", one, three, "-o", "nowhere/all.json")
        self.assertEqual(done.returncode, USAGE)
        self.assertIn("there is no folder 'nowhere'", done.stderr)
        refused("jobs.json is no summary", parts=("jobs.json",))
        other = self.summary(one)
        other["jobs"][0]["digest"] = "0" * 32
        self.write(other, "other.json")
        refused("job 'far' differs in", one, "other.json", parts=(one, "other.json", three))
        other["jobs"][0] = {"index": other["jobs"][0]["index"], "name": "far", "status": "waiting"}
        self.write(other, "other.json")
        self.batch("--shard", "2/3")
        refused("have not run: far", parts=("other.json", "jobs.summary-2-of-3.json", three))
        other["digest"] = "0" * 32
        self.write(other, "other.json")
        refused("different batches", parts=(one, "other.json"))

    def test_jobs_with_other_times_merge(self):
        self.write({"version": 2, "jobs": [{"name": "a", "sdf": "torus.vdb", "seed": [1.4, 0, 0],
                                            "target": [-1, 0, 0.4], "paths": "a.json"}]})
        with unittest.mock.patch.dict(os.environ):
            del os.environ["SOURCE_DATE_EPOCH"]
            for name in ("one.json", "two.json"):
                self.batch("--summary", name)
                (self.folder / "a.json").unlink()
        (first,), (second,) = self.summary("one.json")["jobs"], self.summary("two.json")["jobs"]
        self.assertNotEqual(first["outputs"], second["outputs"])
        for job in (first, second):
            self.assertGreater(job["seconds"]["march"], 0)
            self.assertGreater(job["peakMemoryBytes"], 1e6)
        done = self.program("batch", "merge", "one.json", "two.json", "-o", "all.json")
        self.assertEqual(done.returncode, DONE, done.stderr)

    def test_matrices_in_parts(self):
        across = {"target": [[1.4, 0, 0], [0, -1, 0.4], [-1.4, 0, 0]]}
        some = {"target": [*across["target"], [9, 9, 9]], "skip-off-surface": True}
        for kind, points in (("between", {}), ("across", across), ("some", some)):
            both = {"sdf": "torus.vdb", "sample": 7, "output": "/dev/null", **points}
            jobs = [{**both, "name": f"{kind}-{n}", "matrix": f"{kind}.{n}"} for n in ("csv", "json", "npy")]
            jobs += [{**both, "name": f"{kind}-{k}", "matrix": f"{kind}-{k}.json", "matrix-rows": f"{k}/3"}
                     for k in (1, 2, 3)]
            self.write({"version": 2, "jobs": jobs})
            self.batch(code=UNREACHED if kind == "some" else DONE)
            self.valid("matrix.schema.json", f"{kind}-2.json")
            parts = [f"{kind}-{k}.json" for k in (3, 1, 2)]
            for ending in ("csv", "json", "npy"):
                done = self.program("batch", "merge", "--matrix", *parts, "-o", f"joined.{ending}")
                self.assertEqual((done.returncode, done.stderr), (DONE, ""))
                joined, whole = ((self.folder / f"{name}.{ending}").read_bytes() for name in ("joined", kind))
                if ending == "json":
                    joined, whole = json.loads(joined), json.loads(whole)
                    self.assertEqual(joined.pop("command"), ["batch", "merge", "--matrix", *parts, "-o", "joined.json"])
                    self.assertIn("--sdf=torus.vdb", whole.pop("command"))
                self.assertEqual(joined, whole)

        def refused(*says, parts, output="no.csv", code=UNUSABLE):
            done = self.program("batch", "merge", "--matrix", *parts, "-o", output)
            self.assertEqual(done.returncode, code, done.stderr)
            for part in says:
                self.assertIn(part, done.stderr)
            self.assertFalse((self.folder / output).exists())

        refused("rows 2 to 3 of 7", parts=("across-1.json", "across-3.json"))
        refused("rows 4 to 6 of 7", parts=("across-1.json", "across-2.json"))
        refused("row 0", "another part", parts=("across-1.json", "across-1.json", "across-2.json", "across-3.json"))
        refused("differ in 'targets'", parts=("across-1.json", "between-2.json"))
        refused("whole matrix", parts=("across.json",))
        refused("no matrix", parts=("jobs.summary.json",))
        refused(".npy", parts=parts, output="no.txt", code=USAGE)
        self.one_way(["between-1.json", "between-2.json", "between-3.json"])
        before = (self.folder / parts[0]).read_bytes()
        done = self.program("batch", "merge", "--matrix", *parts, "-o", parts[0])
        self.assertEqual(done.returncode, USAGE)
        self.assertIn(f"would overwrite the input '{parts[0]}'", done.stderr)
        self.assertEqual((self.folder / parts[0]).read_bytes(), before)
        done = self.program("--sdf", "torus.vdb", "--sample", 3, "--matrix", "m.csv", "--matrix-rows", "1/2")
        self.assertEqual(done.returncode, USAGE)
        self.assertIn("--matrix-rows", done.stderr)

    def one_way(self, parts):
        """A row that lacks a distance which a column has, and a warning of one part alone."""
        part = json.loads((self.folder / parts[0]).read_text())
        part["distance"][0][5] = None
        self.write(part, "lost.json")
        other = json.loads((self.folder / parts[1]).read_text())
        other["warnings"].append("of this part")
        self.write(other, "other.json")
        words = "1 of 21 pairs of seeds have a path in one direction only"
        for output in ("one-way.csv", "one-way.json"):
            done = self.program("batch", "merge", "--matrix", "lost.json", "other.json", parts[2], "-o", output)
            self.assertEqual((done.returncode, done.stderr.count(f"warning: {words}")), (DONE, 1), done.stderr)
        self.valid("matrix.schema.json", "one-way.json")
        whole = json.loads((self.folder / "one-way.json").read_text())
        self.assertEqual(whole["distance"][0][5], whole["distance"][5][0])
        self.assertEqual(whole["warnings"][:-1], [*part["warnings"], "of this part"])
        self.assertIn(words, whole["warnings"][-1])


class SlurmNames(unittest.TestCase):
    def test_merge_names_summaries_beside_the_manifest(self):
        for manifest, stem in (("dir.d/jobs", "dir.d/jobs"), ("dir.d/jobs.json", "dir.d/jobs"),
                               ("/a.b/c.d/jobs.v2.json", "/a.b/c.d/jobs.v2"),
                               ("a/.hidden", "a/.hidden"), ("a/.hidden.json", "a/.hidden")):
            said = subprocess.run(["bash", ROOT / "scripts/slurm_batch.sh", "--merge", manifest, "2"], text=True,
                                  capture_output=True, check=True, env={**os.environ, "IMPLICIT_GEODESIC": "echo"})
            self.assertEqual(said.stdout.split(), [
                "batch", "merge", f"{stem}.summary-1-of-2.json", f"{stem}.summary-2-of-2.json",
                "-o", f"{stem}.summary.json"])


class Interruptions(TempWorkspace):
    """Jobs enough for a second, so that a signal finds some done and some not."""

    def setUp(self):
        super().setUp()
        self.names = [f"j{k}" for k in range(24)]
        self.write({"version": 2, "defaults": {"sdf": "torus.vdb", "grids": "gradient"}, "jobs": [
            {"name": n, "seed": [1.4, 0, 0], "max-distance": 1 + k / 100, "output": f"{n}.vdb"}
            for k, n in enumerate(self.names)]})
        start = time.monotonic()
        self.batch("-q")
        self.seconds = time.monotonic() - start
        self.expected = self.outputs()
        self.whole = (self.folder / "jobs.summary.json").read_bytes()
        self.clear()

    def clear(self):
        for file in self.folder.iterdir():
            if file.name not in self.inputs:
                file.unlink()

    def interrupted(self, number, delay, begun=False):
        """A batch that is sent a signal: what it said it has done, and its exit code. If asked for, not before
        there is a summary: a process that is still being loaded dies of any signal without a message."""
        with subprocess.Popen(self.command("batch", "jobs.json"), cwd=self.folder, stderr=subprocess.PIPE,
                              text=True) as process:
            while begun and process.poll() is None and not (self.folder / "jobs.summary.json").exists():
                time.sleep(0.002)
            time.sleep(delay)
            process.send_signal(number)
            said = process.communicate(timeout=60)[1]
        return said, process.returncode

    def test_two_at_once_do_not_compute_the_same_jobs(self):
        lock = self.folder / "jobs.summary.json.lock"
        with subprocess.Popen(self.command("batch", "jobs.json", "-q"), cwd=self.folder) as first:
            while first.poll() is None and not (self.folder / "jobs.summary.json").exists():
                time.sleep(0.002)
            first.send_signal(signal.SIGSTOP)
            self.assertTrue(lock.exists())
            done = self.recorded()
            said = self.batch(code=USAGE)
            self.assertIn(f"jobs.summary.json': process {first.pid} on host ", said)
            self.assertEqual(self.recorded(), done)
            self.batch("--dry-run")
            first.send_signal(signal.SIGCONT)
            self.assertEqual(first.wait(60), DONE)
        self.assertFalse(lock.exists())
        self.assertEqual((self.folder / "jobs.summary.json").read_bytes(), self.whole)

    def test_shards_run_side_by_side_but_none_beside_the_whole(self):
        other = "computes jobs of"
        with subprocess.Popen(self.command("batch", "jobs.json", "-q", "--shard", "1/2"), cwd=self.folder) as first:
            while first.poll() is None and not (self.folder / "jobs.summary-1-of-2.json").exists():
                time.sleep(0.002)
            first.send_signal(signal.SIGSTOP)
            for arguments in ((), ("--shard", "1/3"), ("--shard", "2/3"), ("--summary", "other.json")):
                said = self.batch("-q", *arguments, code=USAGE)
                self.assertIn(other, said)
                self.assertIn(f"process {first.pid} on host ", said)
            self.batch("-q", "--shard", "3/3")
            self.batch("-q", "--shard", "2/2")
            first.send_signal(signal.SIGCONT)
            self.assertEqual(first.wait(60), DONE)
        self.assertEqual(list(self.folder.glob("*.lock")), [])

    def test_a_lock_whose_owner_is_gone_is_taken_over(self):
        lock = self.folder / "jobs.summary.json.lock"
        self.interrupted(signal.SIGKILL, 0, begun=True)
        lock.write_text("process 1 on host elsewhere\n")
        self.batch("-q")
        self.assertFalse(lock.exists())
        self.assertEqual((self.folder / "jobs.summary.json").read_bytes(), self.whole)

    def recorded(self):
        if not (self.folder / "jobs.summary.json").exists():
            return set()
        return {name for name, status in self.statuses().items() if status == "done"}

    def test_killed_at_any_moment_it_goes_on(self):
        chance = random.Random(os.environ.get("IGEO_SEED", "7"))
        killed = 0
        for _ in range(4):
            self.clear()
            for _ in range(40):
                before = self.recorded()
                said, code = self.interrupted(signal.SIGKILL, chance.uniform(0.01, 0.5) * self.seconds)
                # Nothing twice: what was recorded is not run again.
                self.assertFalse(self.ran(said) & before)
                if code == 0:
                    break
                self.assertEqual(code, -signal.SIGKILL)
                killed += 1
                # Only what is recorded is said to be done.
                self.assertLessEqual(before | self.ran(said), self.recorded())
            self.batch("-q")
            for name, content in self.expected.items():
                self.assertTrue((self.folder / name).read_bytes() == content, name)
            self.assertTrue((self.folder / "jobs.summary.json").read_bytes() == self.whole)
        self.assertGreater(killed, 3)

    def test_ctrl_c_and_kill_leave_what_is_done_recorded(self):
        stopped = 0
        for number in (signal.SIGINT, signal.SIGTERM):
            for part in (0.3, 0.5, 0.7):
                for _ in range(6):
                    self.clear()
                    said, code = self.interrupted(number, part * self.seconds, begun=True)
                    if code != 0:
                        break
                    part /= 2  # it takes less time than when it was measured
                if code == 0:
                    continue
                stopped += 1
                self.assertEqual(code, 128 + number)
                self.assertEqual(said.count("error: "), 1, said)
                self.assertIn("error: interrupted", said)
                self.assertLessEqual(self.ran(said), self.recorded())
                names = {f.name for f in self.folder.iterdir()} - self.inputs - {"jobs.summary.json"}
                self.assertLessEqual(names, set(self.expected))  # no temporary files
                self.assertEqual({s for s in self.statuses().values()} - {"done", "waiting"}, set())
                before = self.recorded()
                self.assertEqual(self.ran(self.batch()), set(self.names) - before)
                self.assertEqual(self.outputs(), self.expected)
                self.assertTrue((self.folder / "jobs.summary.json").read_bytes() == self.whole)
        self.assertGreaterEqual(stopped, 3)


@unittest.skipUnless(shutil.which("parallel"), "parallel not found (Debian: parallel)")
class GnuParallel(TempWorkspace):
    def test_shards_side_by_side(self):
        self.batch()
        whole, outputs = (self.folder / "jobs.summary.json").read_bytes(), self.outputs()
        for name in [*outputs, "jobs.summary.json"]:
            (self.folder / name).unlink()
        environment = {**os.environ, "PATH": f"{PROGRAM.parent}:{os.environ['PATH']}", "HOME": str(self.folder)}
        script = ("parallel --will-cite -j2 implicit-geodesic batch jobs.json --shard {}/4 --threads 1 ::: {1..4} "
                  "&& implicit-geodesic batch merge jobs.summary-*-of-4.json -o jobs.summary.json")
        done = subprocess.run(["bash", "-c", script], cwd=self.folder, env=environment, capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        shutil.rmtree(self.folder / ".parallel", ignore_errors=True)
        self.assertEqual(self.outputs(), outputs)
        self.assertTrue((self.folder / "jobs.summary.json").read_bytes() == whole)


if __name__ == "__main__":
    if not PROGRAM.exists():
        print(f"skipped: no {PROGRAM}")
        sys.exit(77)
    result = unittest.main(exit=False).result
    for reason in UNCHECKED:
        print(f"not checked: {reason}")
    sys.exit(1 if not result.wasSuccessful() else 77 if result.skipped or UNCHECKED else 0)
