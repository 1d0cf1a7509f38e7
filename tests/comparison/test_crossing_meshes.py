"""Meshes that cross themselves: two spindle tori, two tori, a tube over itself, a tube that runs around
twice, three tubes. Distances between vertices and lengths of paths against the exact distances on the
triangles (igeo_peer). And vertices behind the neck of a spindle torus."""
import json
import math
import os
import random
import sys
import tempfile

from exact_on_triangles import PEER, PROGRAM, exact_distances, moved, run, turn, words, write_mesh, write_points

RESOLUTION, NEAREST = 256, 10  # voxels along the largest side; nearer targets are left out
TURNS, SEEDS, TARGETS = 3, 2, 60
# Largest error of a distance, and largest excess of a path over its distance, %: 1.5 times what was
# measured, which is beside it. With links and bridges alone the spindle torus has 15 and 20. With
# straight lines, but none around vertices, it has 0.93, and the narrow one 2.02.
SHAPES = {
    "spindle torus": (0.25, 0.16),           # 0.164, 0.105
    "narrow spindle torus": (0.23, 0.042),   # 0.151, 0.028
    "two tori": (0.047, 0.032),              # 0.031, 0.021
    "tube over itself": (0.078, 0.086),      # 0.052, 0.057
    "tube around twice": (0.37, 0.63),       # 0.242, 0.420; with fits to one side: 0.706, 0.711
    "three tubes": (0.012, 0.012),           # 0.008, 0.008
}


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    return [x / math.sqrt(dot(a, a)) for x in a]


def tube(curve, along, around, radius, closed=True):
    """Around a curve on [0, 1]; the frame is carried along and its twist spread over a closed one."""
    points = [curve(k / (along if closed else along - 1)) for k in range(along)]
    tangents = [
        unit(sub(points[(k + 1) % along], points[k - 1]) if closed else
             sub(points[min(k + 1, along - 1)], points[max(k - 1, 0)])) for k in range(along)]
    normal, frames = unit(cross(tangents[0], [0.3, 0.5, 0.8])), []
    for t in tangents:
        normal = unit(sub(normal, [dot(normal, t) * x for x in t]))
        frames.append((normal, cross(t, normal)))
    back = unit(sub(normal, [dot(normal, tangents[0]) * x for x in tangents[0]]))
    twist = math.atan2(dot(back, frames[0][1]), dot(back, frames[0][0])) if closed else 0
    vertices, triangles = [], []
    for k, (p, (n, b)) in enumerate(zip(points, frames)):
        for j in range(around):
            a = 2 * math.pi * j / around - twist * k / along
            vertices.append([x + radius * (math.cos(a) * y + math.sin(a) * z)
                             for x, y, z in zip(p, n, b)])
    for k in range(along if closed else along - 1):
        for j in range(around):
            a, b = k * around + j, k * around + (j + 1) % around
            c, d = (k + 1) % along * around + j, (k + 1) % along * around + (j + 1) % around
            triangles += [(a, c, d), (a, d, b)]
    return vertices, triangles


def joined(*parts):
    vertices, triangles = [], []
    for v, t in parts:
        triangles += [[k + len(vertices) for k in one] for one in t]
        vertices += v
    return vertices, triangles


def circle(radius, middle=(0, 0, 0), x=0, y=1):
    def at(t):
        p = list(middle)
        p[x] += radius * math.cos(2 * math.pi * t)
        p[y] += radius * math.sin(2 * math.pi * t)
        return p
    return at


def twice(t):
    """Twice around, 0 to 4 voxels beside the other turn."""
    a = 2 * math.pi * t
    r = 1 + 0.01 * math.cos(a)
    return [r * math.cos(2 * a), r * math.sin(2 * a), 0.01 * math.sin(a)]


def line(k):
    a = 2 * math.pi * k / 3
    return lambda t: [math.cos(a) * (2 * t - 1), math.sin(a) * (2 * t - 1), 0.05 * k]


def shape(name):
    if name == "spindle torus":
        return tube(circle(0.2), 90, 40, 0.5)
    if name == "narrow spindle torus":
        return tube(circle(0.1), 80, 44, 0.5)
    if name == "two tori":
        return joined(tube(circle(1), 120, 24, 0.25),
                      tube(circle(1, (1, 0.05, 0), 0, 2), 90, 20, 0.2))
    if name == "tube over itself":
        return tube(lambda t: [1.2 * math.sin(2 * math.pi * t), 0.5 * math.sin(4 * math.pi * t),
                               0.02 * math.cos(2 * math.pi * t)], 160, 24, 0.2)
    if name == "tube around twice":
        return tube(twice, 240, 24, 0.25)
    return joined(*[tube(line(k), 40, 20, 0.2, closed=False) for k in range(3)])


def turned(vertices, rng):
    rows, offset = turn(rng), [rng.random() for _ in range(3)]
    return [moved(v, rows, offset) for v in vertices]


def errors(folder, vertices, triangles, rng):
    """Relative errors of distances, and excess of paths over them, of one seed."""
    mesh, targets, paths = (os.path.join(folder, f) for f in ("mesh.obj", "targets.csv", "paths.json"))
    write_mesh(mesh, vertices, triangles)
    seed, chosen = rng.choice(vertices), rng.sample(vertices, TARGETS)
    write_points(targets, chosen)
    run(PROGRAM, mesh, "--resolution", RESOLUTION, "--seed", words(seed), "--targets", targets,
        "--paths", paths)
    voxel = max(max(v[k] for v in vertices) - min(v[k] for v in vertices)
                for k in range(3)) / RESOLUTION
    found = []
    for path, d in zip(json.load(open(paths))["paths"], exact_distances(mesh, seed, chosen), strict=True):
        assert (path["distance"] is None) == math.isinf(d), (seed, path["target"])
        if math.isinf(d) or d < NEAREST * voxel:
            continue
        assert path["status"] == "reached", (seed, path["target"])
        found.append((100 * (path["distance"] / d - 1),
                      100 * (path["length"] / path["distance"] - 1), words(seed)))
    return found


def off(folder, vertices, triangles, seed, targets, resolution):
    """Errors of distances in voxels."""
    mesh, file, matrix = (os.path.join(folder, f) for f in ("mesh.obj", "targets.csv", "matrix.json"))
    write_mesh(mesh, vertices, triangles)
    write_points(file, targets)
    run(PROGRAM, mesh, "--resolution", resolution, "--seed", words(seed), "--targets", file, "--matrix",
        matrix)
    voxel = max(max(v[k] for v in vertices) - min(v[k] for v in vertices)
                for k in range(3)) / resolution
    found = json.load(open(matrix))["distance"][0]
    return [(d - e) / voxel for d, e in zip(found, exact_distances(mesh, seed, targets), strict=True)]


def is_within(name, errors, mean, most):
    measured = sum(map(abs, errors)) / len(errors), max(map(abs, errors))
    print("%s: %d distances, off by %.4f voxels, %.4f at most" % (name, len(errors), *measured))
    if measured[0] < mean and measured[1] < most:
        return True
    print("  allowed are %g and %g" % (mean, most))
    return False


def behind_neck(folder):
    vertices, triangles = shape("narrow spindle torus")
    vertices = turned(vertices, random.Random(0))
    return off(folder, vertices, triangles, vertices[894],
               [vertices[44 * k + 29] for k in range(50, 70)], RESOLUTION)


def main():
    if not os.path.exists(PEER):
        print("skipped: igeo_peer, which has exact distances, is not built (-DIGEO_PEERS=ON)")
        return 77
    failed = 0
    for name, (most, longest) in SHAPES.items():
        rng, found = random.Random(7), []
        for _ in range(TURNS):
            vertices, triangles = shape(name)
            vertices = turned(vertices, rng)
            with tempfile.TemporaryDirectory() as folder:
                for _ in range(SEEDS):
                    found += errors(folder, vertices, triangles, rng)
        assert len(found) > TURNS * SEEDS * TARGETS / 5, name
        off, over = max(found, key=lambda f: abs(f[0])), max(found, key=lambda f: f[1])
        print("%s: %d distances, off by %.3f %% at most (seed %s), paths longer by %.3f %%" %
              (name, len(found), off[0], off[2], over[1]))
        if abs(off[0]) > most or over[1] > longest:
            print("  allowed are %g and %g" % (most, longest))
            failed = 1
    with tempfile.TemporaryDirectory() as folder:
        # Mean and largest error, voxels, 1.5 times what was measured; 0.109 and 0.571 with a fit in a
        # chart that holds no folds.
        if not is_within("behind a neck", behind_neck(folder), 0.0023, 0.0035):  # 0.0015, 0.0023
            failed = 1
    return failed


if __name__ == "__main__":
    sys.exit(main())
