#!/usr/bin/env python3
"""The estimate of a run beside its real error, and lengths of paths, for models as level sets, meshes and points.

usage: scripts/estimate.py --models DIR     two tables into docs/benchmarks.md, in some minutes

A run reports, as `accuracy`, by how much its distances may be off. Here that is compared with exact
polyhedral distances on the mesh of the model (igeo_peer, see scripts/compare.py), from its first vertex
to sixty others. A level set is what vdb_tool makes of the mesh, and points lie on its triangles by
chance: what either does not hold is part of the real error, of which the estimate sees only edges
that are rounded off. The lengths of the paths to the same vertices are compared with the same exact
distances. Of a model in several pieces, only that of its first vertex counts.
"""
import argparse
import csv
import json
import math
import pathlib
import random
import statistics
import tempfile

import compare
import measure

MODELS = {**compare.MODELS, "bunny, coarse": "bunny-coarse.obj", "torus": "torus.obj",
          "cad-featuretype": "cad-featuretype.stl", "foot": "foot-bones.obj", "bunny, scan": "bunny-scan.obj"}
SIZES = (128, 256)  # voxels along the longest side
FORMS = ("level set", "mesh", "points")
TARGETS, POINTS = 60, 60000
NEAR = 0.1  # of the largest distance: targets nearer than this are left out
DOCUMENT = measure.ROOT / "docs" / "benchmarks.md"


def area(a, b, c):
    """Of a triangle."""
    v, w = [[y - x for x, y in zip(a, p)] for p in (b, c)]
    return math.hypot(*(v[k - 2] * w[k - 1] - v[k - 1] * w[k - 2] for k in range(3))) / 2


def percent(share):
    """Two digits; an exact result is off by rounding."""
    if share is None:
        return "none"
    return "< 0.00001" if 0 < share < 1e-7 else measure.number(100 * share, 2)


class Model:
    """A mesh file, in a folder for what is made of it, with exact distances."""

    def __init__(self, tools, program, folder, file):
        self.file, self.folder, self.program = file, folder, program
        copy = folder / "vertices.obj"
        measure.run([program, file, "--seed", "vertex:0", "--per-vertex", copy])
        lines = [line.split() for line in copy.read_text().splitlines()]
        self.vertices = [[float(x) for x in line[1:4]] for line in lines if line[:1] == ["v"]]
        self.faces = [[int(corner.split("/")[0]) - 1 for corner in line[1:4]]
                      for line in lines if line[:1] == ["f"]]
        reached = folder / "reached.csv"
        measure.run([program, file, "--seed", "vertex:0", "--per-vertex", reached])
        with open(reached, newline="", encoding="utf-8") as rows:
            there = [p for p, row in zip(self.vertices, csv.DictReader(rows), strict=True) if row["distance"] != "inf"]
        targets = [there[int((k + 0.5) / TARGETS * len(there))] for k in range(TARGETS)]
        self.targets = folder / "targets.csv"
        self.targets.write_text("".join(compare.point(p) + "\n" for p in targets))
        asked = folder / "asked.csv"
        asked.write_text("".join(compare.point(p) + ",0\n" for p in targets))
        self.seed = compare.point(self.vertices[0])
        tools.say(tools.peer, "--method", "oracle", "--mesh", file, "--seed", self.seed, "--points", asked)
        self.exact = compare.read_points(f"{asked}.exact")[1]

    def surface(self, form, n):
        """What the program is given: words of a command line."""
        if form == "level set":
            sdf = self.folder / f"{n}.vdb"
            measure.run(["vdb_tool", "-quiet", "-read", self.file, "-mesh2ls", f"dim={n}", "width=3",
                         "name=psi", "-write", sdf])
            return [sdf]
        size = max(max(axis) - min(axis) for axis in zip(*self.vertices)) / n
        if form == "mesh":
            return [self.file, "--voxel-size", f"{size:.6g}"]
        points = self.folder / "points.xyz"
        points.write_text("".join(" ".join(f"{x:.12g}" for x in p) + "\n" for p in self.scattered()))
        return [points, "--voxel-size", f"{size:.6g}"]

    def scattered(self):
        """Points on the triangles, as many per area everywhere; the seed is the first."""
        chance = random.Random(1)
        corners = [[self.vertices[k] for k in face] for face in self.faces]
        areas = [area(*c) for c in corners]
        yield self.vertices[0]
        for a, b, c in chance.choices(corners, areas, k=POINTS - 1):
            u, v = sorted((chance.random(), chance.random()))
            yield [u * x + (v - u) * y + (1 - v) * z for x, y, z in zip(a, b, c)]

    def measured(self, form, n):
        """Estimate and mean of the real error; median of the error of lengths and the most by which a
        length exceeds its distance; both in %, with a star where the run warns."""
        paths, report = self.folder / "paths.json", self.folder / "report.json"
        done = measure.run([self.program, *self.surface(form, n), "--seed", self.seed, "--targets", self.targets,
                            "--skip-off-surface", "--paths", paths, "--report", report, "-o",
                            self.folder / "distance.vdb"], expect=(0, 3, 4))
        if done.code == 3:
            return "refused", "refused"
        said = json.loads(report.read_text())
        far = [(t, path["distance"], path["length"])
               for t, path in zip(self.exact, json.loads(paths.read_text())["paths"], strict=True)
               if NEAR * max(self.exact) < t < math.inf and path["distance"] is not None]
        if not far:
            return "none", "none"
        errors = [abs(distance / t - 1) for t, distance, _ in far]
        lengths = [abs(length / t - 1) for t, _, length in far]
        excess = [length / distance - 1 for _, distance, length in far]
        star = " *" if said["warnings"] else ""

        def shown(*values):
            return " / ".join(percent(v) for v in values) + star

        return (shown(said["accuracy"]["meanRelativeError"], statistics.fmean(errors)),
                shown(statistics.median(lengths), max(excess)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--models", type=pathlib.Path, required=True, metavar="DIR")
    parser.add_argument("--build", type=pathlib.Path, default=measure.ROOT / "build" / "release")
    options = parser.parse_args()
    tools, program = compare.Tools(options.build), options.build / "bin" / "implicit-geodesic"
    estimates, lengths = [], []
    for name, file in MODELS.items():
        with tempfile.TemporaryDirectory() as folder:
            model = Model(tools, program, pathlib.Path(folder), options.models / file)
            for n in SIZES:
                measured = [model.measured(form, n) for form in FORMS]
                for table, cells in zip((estimates, lengths), zip(*measured)):
                    table.append([f"{name}, {n}", *cells])
                    print(table[-1], flush=True)
    made = f"*: the run warns of the surface. {measure.machine()}; command: `{measure.command_line()}`."
    for mark, what, rows in (
            ("estimate", "Estimate / real error, means in % of each distance", estimates),
            ("lengths", "Error of lengths, median in % / largest excess of a length over its distance in %", lengths)):
        measure.rewrite(DOCUMENT, mark, f"{what}; {made}\n\n{measure.table(['model, voxels', *FORMS], rows)}")


if __name__ == "__main__":
    main()
