"""What tests against exact distances on triangles (igeo_peer) share. Points are lists of three numbers."""
import math
import os
import subprocess
import sys

PROGRAM = os.environ["IGEO_PROGRAM"]
PEER = os.path.join(sys.argv[1], "igeo_peer")


def run(*args):
    """4: some target is not reached."""
    done = subprocess.run([str(a) for a in args], capture_output=True, text=True)
    assert done.returncode in (0, 4), done.stderr
    return done


def words(p, between=","):
    return between.join("%.17g" % x for x in p)


def write_points(file, points, end=""):
    with open(file, "w") as out:
        out.writelines(words(p) + end + "\n" for p in points)


def write_mesh(file, vertices, triangles):
    with open(file, "w") as out:
        out.writelines("v %s\n" % words(v, " ") for v in vertices)
        out.writelines("f %d %d %d\n" % tuple(k + 1 for k in t) for t in triangles)


def exact_distances(mesh, seed, points):
    """From a seed on the triangles of a file; inf: unreached."""
    file = mesh + ".points.csv"
    write_points(file, points, ",0")
    run(PEER, "--method", "oracle", "--mesh", mesh, "--seed", words(seed), "--points", file)
    with open(file + ".exact") as rows:
        return [float(row.split(",")[3]) for row in rows]


def turn(rng):
    """A rotation, by its rows; each is as likely."""
    w, x, y, z = (rng.gauss(0, 1) for _ in range(4))
    n = math.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / n, x / n, y / n, z / n
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]


def moved(p, rows, offset):
    return [sum(r * c for r, c in zip(row, p)) + o for row, o in zip(rows, offset)]
