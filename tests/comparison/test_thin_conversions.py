"""Thin parts as vdb_tool converts them to level sets: errors beside those of exact geodesics on the
mesh that vdb_tool extracts from the same level set (igeo_peer). Truth is the unfolded outline."""
import csv
import math
import os
import random
import shutil
import sys
import tempfile

from exact_on_triangles import PEER, PROGRAM, exact_distances, moved, run, turn, words, write_mesh, write_points

TURNS, TARGETS, WIDTH, FROM_EDGES = 12, 300, 16, 0.5  # lengths are in voxels
MOST = 0.95  # of the 99th percentile on the extracted mesh, in each kind; measured 0.40 to 0.63
KINDS = ("rib", "slot", "web", "channel", "plate")
CLOSED = ("narrow slots or walls with the sign of the other side", "bends or folds within")  # warnings


class Part:
    """An outline in the plane of x and z, swept along y, and rectangles that fill it."""

    def __init__(self, kind, rng):
        def thin():
            return rng.uniform(2, 4) if rng.random() < 0.5 else rng.uniform(2, 2.4)
        t, g, w, high, base = thin(), thin(), rng.uniform(6, 11), rng.uniform(4, 9), rng.uniform(4, 8)
        h = t / 2
        if kind == "rib":
            self.outline = [(-w, 0), (-h, 0), (-h, high), (h, high), (h, 0), (w, 0), (w, -base), (-w, -base)]
            self.ends = [(-w, w, -base, 0), (-h, h, 0, high)]
        elif kind == "slot":
            h = g / 2
            self.outline = [(-w, 0), (-h, 0), (-h, -high), (h, -high), (h, 0), (w, 0), (w, -high - base),
                            (-w, -high - base)]
            self.ends = [(-w, -h, -high, 0), (h, w, -high, 0), (-w, w, -high - base, -high)]
        elif kind == "web":
            self.outline = [(-w, 0), (-h, 0), (-h, high), (-w, high), (-w, high + t), (w, high + t), (w, high),
                            (h, high), (h, 0), (w, 0), (w, -t), (-w, -t)]
            self.ends = [(-w, w, -t, 0), (-h, h, 0, high), (-w, w, high, high + t)]
        elif kind == "channel":
            h = g / 2
            self.outline = [(-h, 0), (h, 0), (h, high), (h + t, high), (h + t, -t), (-h - t, -t), (-h - t, high),
                            (-h, high)]
            self.ends = [(-h - t, -h, -t, high), (h, h + t, -t, high), (-h, h, -t, 0)]
        else:
            self.outline = [(-w, 0), (w, 0), (w, -t), (-w, -t)]
            self.ends = [(-w, w, -t, 0)]
        sides = zip(self.outline, self.outline[1:] + self.outline[:1])
        self.corners = [0]
        for a, b in sides:
            self.corners.append(self.corners[-1] + math.dist(a, b))
        self.around = self.corners[-1]
        self.rows = turn(rng) if rng.random() < 0.75 else [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        self.offset = [rng.random() for _ in range(3)]

    def placed(self, x, y, z):
        return moved((x, y, z), self.rows, self.offset)

    def at(self, s, y):
        k = max(i for i, c in enumerate(self.corners[:-1]) if c <= s)
        f = (s - self.corners[k]) / (self.corners[k + 1] - self.corners[k])
        a, b = self.outline[k], self.outline[(k + 1) % len(self.outline)]
        return self.placed(a[0] + f * (b[0] - a[0]), y, a[1] + f * (b[1] - a[1]))

    def anywhere(self, rng, low, high):
        while True:
            s = rng.uniform(0, self.around)
            if min(abs(s - c) for c in self.corners) > FROM_EDGES:
                return s, rng.uniform(low, high)

    def between(self, a, b):
        """(length, edges crossed) of the shortest path around the outline; none where one over an
        end may be shorter."""
        low, high = min(a[0], b[0]), max(a[0], b[0])
        along, edges = high - low, sum(low < c < high for c in self.corners[1:-1])
        if self.around - along < along:
            along, edges = self.around - along, len(self.outline) - edges
        length = math.hypot(along, a[1] - b[1])
        return None if length > min(a[1] + b[1], 2 * WIDTH - a[1] - b[1]) else (length, max(edges, 1))

    def write(self, file):
        quads = []
        for (ax, az), (bx, bz) in zip(self.outline, self.outline[1:] + self.outline[:1]):
            quads.append([(ax, 0, az), (ax, WIDTH, az), (bx, WIDTH, bz), (bx, 0, bz)])
        for y in (0, WIDTH):
            quads += [[(x, y, z), (xx, y, z), (xx, y, zz), (x, y, zz)] for x, xx, z, zz in self.ends]
        write_mesh(file, [self.placed(*corner) for quad in quads for corner in quad],
                   [[4 * k + c for c in half] for k in range(len(quads)) for half in ((0, 1, 2), (0, 2, 3))])


def errors(folder, part, rng):
    """(error of jet, error on the extracted mesh), voxels per edge, and what jet does not reach."""
    def named(name):
        return os.path.join(folder, name)
    part.write(named("part.obj"))
    run("vdb_tool", "-quiet", "-read", named("part.obj"), "-mesh2ls", "voxel=1", "width=3", "-write",
        named("part.vdb"))
    run("vdb_tool", "-quiet", "-read", named("part.vdb"), "-ls2mesh", "-write", named("extracted.obj"))
    seed = part.anywhere(rng, 5, 11)
    targets = [part.anywhere(rng, 3, 13) for _ in range(TARGETS)]
    points = [part.at(*t) for t in targets]
    write_points(named("targets.csv"), points)
    ours = run(PROGRAM, named("part.vdb"), "--seed", words(part.at(*seed)), "--targets", named("targets.csv"),
               "--matrix", named("matrix.csv"))
    extracted = exact_distances(named("extracted.obj"), part.at(*seed), points)
    found, unreached = [], 0
    with open(named("matrix.csv")) as matrix:
        for target, row, other in zip(targets, csv.DictReader(matrix), extracted, strict=True):
            exact = part.between(seed, target)
            if exact is None:
                continue
            pair = float(row["distance_0"]), other
            if math.inf in pair:
                unreached += 1
            else:
                found.append([abs(d - exact[0]) / exact[1] for d in pair])
    # Where the file has the slot's air on the side of the solid, the run says so.
    assert not unreached or any(said in ours.stderr for said in CLOSED), ours.stderr
    return found, unreached


def share(values, part=0.99):
    return sorted(values)[int(part * (len(values) - 1))]


def main():
    missing = [name for name, there in (("igeo_peer (-DIGEO_PEERS=ON)", os.path.exists(PEER)),
                                        ("vdb_tool (libopenvdb-tools)", shutil.which("vdb_tool"))) if not there]
    if missing:
        print("skipped: there is no %s" % " and no ".join(missing))
        return 77
    failed, everything = 0, []
    for number, kind in enumerate(KINDS):
        rng, found, unreached = random.Random(number), [], 0
        for _ in range(TURNS):
            with tempfile.TemporaryDirectory() as folder:
                some, lost = errors(folder, Part(kind, rng), rng)
                found, unreached = found + some, unreached + lost
        assert len(found) > TURNS * TARGETS / 5, kind
        everything += found
        ours, mesh = ([pair[k] for pair in found] for k in range(2))
        print("%s: %d distances, 99th percentile %.3f voxels per edge, on the extracted mesh %.3f, mean %.4f "
              "and %.4f; %d unreached" % (kind, len(found), share(ours), share(mesh), sum(ours) / len(ours),
                                          sum(mesh) / len(mesh), unreached))
        failed |= share(ours) > MOST * share(mesh)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
