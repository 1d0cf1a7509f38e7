#!/usr/bin/env python3
"""Repeats the experiments of Memoli and Sapiro (2001) with the program, as a user would.

Writes the tables of docs/reproduction.md, the pictures in docs/images/reproduction and all figures as
JSON in build/release/reproduction.json, and holds the claims of scripts/claims.json against them.
Needs vdb_tool, and the models that docs/reproduction.md names in --models DIR; what is not there is
left out. Plots need python3-matplotlib.

With --quick: small grids and data/trefoil.vdb in place of every model, under a minute; nothing but
the program and make_shape is needed, and everything is written to build/release/reproduction.
"""
import argparse
import concurrent.futures
import dataclasses
import json
import math
import os
import pathlib
import random
import struct
import sys
import tempfile

import lab

SCRIPT = "scripts/reproduce.py"

# The paper's Table 1: size, points of the band, h in voxels, seconds.
TABLE1 = {
    "brain": ("122 x 142 x 124", 168603, 1.75, 9.4),
    "bunny": ("81 x 80 x 65", 38107, 1.75, 1.99),
    "knot": ("80 x 81 x 44", 16095, 1.0, 0.76),
    "sphere": ("70 x 70 x 70", 11800, 1.75, 0.65),
    "torus": ("64 x 64 x 64", 21704, 1.75, 1.16),
    "teapot": ("80 x 55 x 46", 24325, 1.75, 1.22),
}

# The paper's Table 2: N and the largest error.
TABLE2 = dict(zip(range(100, 501, 20), (
    0.111035, 0.101189, 0.090596, 0.084766, 0.077357, 0.072119, 0.069262, 0.064085, 0.061003, 0.057780,
    0.056024, 0.053569, 0.051469, 0.048853, 0.047292, 0.046195, 0.044747, 0.043254, 0.041999, 0.040501,
    0.039396)))

PAPER_WITHIN = 4.1439 / 95.599  # Fig. 7: largest difference over largest distance


@dataclasses.dataclass(frozen=True)
class Model:
    file: str  # a mesh in --models, or a level set in data/
    voxels: int  # along its longest side, for as many voxels of area as in the paper
    seed: str
    target: str = ""
    fine: int = 0  # voxels along its longest side in pictures
    views: tuple = ("",)  # cameras; empty: the program's choice
    side: str = ""  # the camera that sees the path
    up: str = "y"
    ball: tuple = ()  # the obstacle of Fig. 11: x, y, z, radius
    past: str = ""  # the target behind it
    level_set: bool = True  # as vdb_tool makes one; else the mesh itself


MODELS = {
    "brain": Model("brain-pial-left.ply", 139, "-40,12,48", "-38,45,5", 256, side="-380,-20,120",
                   up="z"),
    "bunny": Model("bunny.obj", 68, "-0.770217,0.134972,0.221349", "0.779508,-0.46204,0.133255", 128,
                   ("-3.2,1.2,2.3", "-1.2,1.2,3.7", "2.9,1.4,-2.5"), side="-1.2,1.2,3.7",
                   ball=(0.1, -0.2, 0.55, 0.3), past="0.6,-0.35,0.4"),
    "knot": Model("knot.obj", 58, "0.157691,0.5,0.0726438", fine=128, up="z"),
    # Level sets of this open mesh lose the spout.
    "teapot": Model("teapot.obj", 74, "3.434,2.4729,0", fine=200, level_set=False,
                    views=("3.6,5.8,9.6,0.2,1.5,0", "-8,6,7,0.2,1.5,0", "8,5,-6,0.2,1.5,0")),
}
# In place of all of them with --quick.
STAND_IN = Model("trefoil.vdb", 120, "0,-1.02,0", "0.5,0.73,0.237", 120, side="0,-2.5,3.5", up="z",
                 ball=(-0.05, 0.26, 0.07, 0.05), past="0.5,0.73,0.237")
# Shapes with as many voxels of area as in the paper, in voxels of size 1: (parameters, seed, views).
SHAPES = {
    "sphere": (("radius=16.4",), "7,9,11.77",
               ("28,36,47,0,0,0", "50,-20,-40,0,0,0", "-28,-36,-47,0,0,0")),
    "torus": (("major=25.06", "minor=6.27"), "31.33,0,0",
              ("105,0,65,0,0,0", "33,100,65,0,0,0", "-100,0,70,0,0,0")),
}


class Missing(Exception):
    """A model that was not given."""


@dataclasses.dataclass(frozen=True)
class Bench:
    build: pathlib.Path
    models: pathlib.Path | None
    out: pathlib.Path  # where the document is, and its pictures in images/reproduction
    work: pathlib.Path  # files nobody keeps
    quick: bool

    @property
    def images(self):
        return self.out / "images" / "reproduction"

    def solve(self, *words):
        """The report of a run."""
        program = self.build / "bin" / "implicit-geodesic"
        # Exit code 4: a target is unreached, which the report says as well.
        done = lab.run([program, *words, "-q", "-o", "/dev/null", "--json", "-"], expect=(0, 4))
        return json.loads(done.stdout)

    def model(self, name):
        model = STAND_IN if self.quick else MODELS[name]
        file = self.file(model)
        if not file or not file.exists():
            raise Missing(model.file)
        return model

    def file(self, model):
        return lab.ROOT / "data" / model.file if model.file.endswith(".vdb") else \
            self.models and self.models / model.file

    def level_set(self, model, voxels):
        """The level set of a model, as words for the program; of an open mesh, the mesh itself."""
        file = self.file(model)
        if file.suffix == ".vdb":
            return ["--sdf", file]
        if not model.level_set:
            return ["--mesh", file, "--resolution", voxels]
        to = self.work / f"{file.stem}{voxels}.vdb"
        if not to.exists():
            # Its dim counts the band of three voxels on both sides.
            lab.run(["vdb_tool", "-quiet", "-read", file, "-mesh2ls", f"dim={voxels + 6}", "width=3",
                     "name=psi", "-write", to])
        return ["--sdf", to]

    def mesh(self, model):
        """The mesh file of a model."""
        file = self.file(model)
        if file.suffix != ".vdb":
            return file
        to = self.work / f"{file.stem}.obj"
        if not to.exists():
            self.solve("--sdf", file, "--seed", model.seed, "--mesh-out", to)
        return to

    def shape(self, name, voxel, half_width, *parameters):
        """The level set of a shape whose distance is known exactly."""
        key = "_".join([name, f"{voxel:.6g}", f"{half_width:.3g}", *parameters])
        to = self.work / f"{key}.vdb"
        words = [word for parameter in parameters for word in ("--param", parameter)]
        if not to.exists():
            lab.run([self.build / "bin" / "make_shape", name, "--voxel-size", repr(voxel),
                     "--half-width", half_width, *words, "-o", to])
        return ["--sdf", to]

    def picture(self, name, *words, size="360x270"):
        """Makes images/reproduction/NAME.png; the report of the run."""
        self.images.mkdir(parents=True, exist_ok=True)
        size = "160x120" if self.quick else size
        return self.solve(*words, "--image", self.images / f"{name}.png", "--image-size", size)


def image(name, alt):
    return f"![{alt}](images/reproduction/{name})"


def left_out(file):
    return f"*Left out: `{file}` was not there (`--models`).*"


def side_by_side(images, heads=None):
    heads = heads or [""] * len(images)
    return "\n".join(("| " + " | ".join(heads) + " |", "|" + ":---:|" * len(images),
                      "| " + " | ".join(images) + " |"))


def plot(draw, file):
    """Lets draw(figure) fill a figure of matplotlib and saves it; false without matplotlib."""
    try:
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import figure
    except ImportError:
        print(f"{file.name}: skipped, needs python3-matplotlib", file=sys.stderr)
        return False
    matplotlib.rcParams.update({"svg.hashsalt": SCRIPT, "font.size": 8})
    canvas = figure.Figure(layout="constrained")
    draw(canvas)
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(f".{os.getpid()}{file.name}")
    # Without a date: the same figures give the same file.
    canvas.savefig(part, dpi=90, metadata={"Date": None} if file.suffix == ".svg" else {})
    os.replace(part, file)
    return True


def difference(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def surface_values(ply):
    """(x, y, z, distance) of every vertex of --mesh-out: d where S crosses the edges of the grid."""
    header, _, body = ply.read_bytes().partition(b"end_header\n")
    count = int(header.partition(b"element vertex ")[2].split()[0])
    row = struct.Struct("<6f3Bfi")
    for x, y, z, _, _, _, _, _, _, d, _ in row.iter_unpack(body[:count * row.size]):
        yield x, y, z, d


def mesh_points(file, count):
    """About so many vertices of an .obj file, evenly spread over its list."""
    with open(file) as lines:
        points = [tuple(map(float, line.split()[1:4])) for line in lines if line.startswith("v ")]
    return points[::max(1, len(points) // count)]


def at_points(bench, points, *words):
    """Distances at points, and the largest of the surface. A few thousand points at most: a path is
    traced from each."""
    file = bench.work / "points.csv"
    file.write_text("".join("{!r},{!r},{!r}\n".format(*p) for p in points))
    report = bench.solve(*words, "--targets", file)
    return [target["distance"] for target in report["targets"]], report["distance"]["max"]


def slope(pairs):
    """Least-squares slope of log y over log x."""
    logs = [(math.log(x), math.log(y)) for x, y in pairs]
    mx, my = (sum(values) / len(logs) for values in zip(*logs))
    return sum((x - mx) * (y - my) for x, y in logs) / sum((x - mx) ** 2 for x, _ in logs)


# --- Table 1 -------------------------------------------------------------------------------------

def box_of_band(bench, words, voxel, h):
    """The box that holds the band, voxels."""
    ply = bench.work / "box.ply"
    bench.solve(*words, "--mesh-out", ply)
    axes = list(zip(*surface_values(ply)))[:3]
    return " x ".join(str(math.ceil((max(a) - min(a)) / voxel + 2 * h)) for a in axes)


def least_time(bench, words):
    """(report, least seconds of band and march on one thread)."""
    reports = [bench.solve(*words, "--threads", 1) for _ in range(1 if bench.quick else 5)]
    return reports[0], min(r["seconds"]["band"] + r["seconds"]["march"] for r in reports)


def table1_row(bench, name):
    size, points, h, seconds = TABLE1[name]
    if name in SHAPES:
        parameters, seed, _ = SHAPES[name]
        words = [*bench.shape(name, 1.0, 4, *parameters), "--seed", seed]
        band = ["--band-voxels", "1.75"]
    else:
        model = bench.model(name)
        words = [*bench.level_set(model, model.voxels), "--seed", model.seed, "--snap", 1e3]
        # Where folds or rims leave no room for 1.75 voxels, the default: sqrt(3).
        band = ["--band-voxels", "1.75"] if name == "knot" else []
    ours, godunov = least_time(bench, [*words, *band, "--scheme", "godunov", "--order", 1])
    _, jet = least_time(bench, words)
    voxel = ours["surface"]["voxelSize"]
    our_h = ours["parameters"]["bandVoxels"]
    figures = {"points": ours["band"]["nodes"], "h": our_h, "godunov": godunov, "jet": jet,
               "ratio": ours["band"]["nodes"] / points}
    row = [name, size, box_of_band(bench, words, voxel, our_h), points, figures["points"], h,
           lab.number(our_h, 3), seconds, lab.number(godunov, 2), lab.number(jet, 2)]
    return figures, row


def table1(bench):
    figures, rows, notes = {}, [], []
    for name in ("knot", *SHAPES) if bench.quick else TABLE1:
        try:
            figures[name], row = table1_row(bench, name)
            rows.append(row)
        except Missing as missing:
            notes.append(left_out(missing))
    # The knot has another h than the paper's, and with it other points.
    figures["points"] = max(abs(figures[name]["ratio"] - 1) for name in figures if name != "knot")
    text = lab.table(["model", "size, paper", "ours", "points, paper", "ours", "h, paper", "ours",
                      "time, paper", "`godunov`, order 1", "`jet`"], rows)
    return figures, "\n\n".join([text, *notes])


# --- Table 2 -------------------------------------------------------------------------------------

RADIUS = 0.4
MIDDLE = (0.5, 0.5, 0.5)
SEEDS = {"axis": (0, 0, 1), "general": (0.314106, 0.52711, 0.789615)}


def on_sphere(direction, radius=RADIUS):
    length = math.hypot(*direction)
    return [c + radius * x / length for c, x in zip(MIDDLE, direction)]


def shortcut(h, radius=RADIUS):
    """How much shorter the way to the opposite point is in the band than on the sphere: straight to
    the inner sphere of radius R - h, around it and straight up again."""
    inner = radius - h
    straight = math.sqrt(radius * radius - inner * inner)
    return math.pi * radius - 2 * straight - inner * (math.pi - 2 * math.acos(inner / radius))


def largest_error(ply, seed, radius):
    """The largest |d - great circle| over the surface: the paper's || d_S - I(d_h) ||. The vertices
    are where S crosses the edges of the grid, 1.5 million of them at N = 500."""
    a = difference(seed, MIDDLE)
    worst = 0.0
    for x, y, z, d in surface_values(ply):
        p = (x - MIDDLE[0], y - MIDDLE[1], z - MIDDLE[2])
        worst = max(worst, abs(d - radius * math.atan2(math.hypot(*cross(a, p)), dot(a, p))))
    return worst


def sphere(bench, n, radius=RADIUS):
    return bench.shape("sphere", 1 / n, math.ceil(paper_h(n) * n) + 1, "center=0.5,0.5,0.5",
                       f"radius={radius}")


def sphere_error(bench, n, seed, *options, radius=RADIUS):
    """The largest error on a sphere in the unit cube with N voxels per side."""
    surface = sphere(bench, n, radius)
    ply = bench.work / f"sphere{n}.ply"
    report = bench.solve(*surface, *options, "--seed", ",".join(map(repr, on_sphere(seed, radius))),
                         "--threads", 1, "--mesh-out", ply)
    if report["distance"]["unreached"]:
        raise RuntimeError(f"sphere, N = {n}: voxels without a distance")
    # From the point of the surface that the program found, as a user who reads the report.
    error = largest_error(ply, report["seeds"][0]["position"], radius)
    ply.unlink()
    return error


def paper_h(n):
    """The band of the paper's Table 2, for a unit cube with N voxels per side."""
    return 2 * n ** -0.7


def paper_scheme(n):
    return ["--scheme", "godunov", "--order", 1, "--band", repr(paper_h(n))]


def sphere_errors(bench, n):
    """The largest errors at N voxels per side, by column of the table."""
    general = SEEDS["general"]
    errors = {"paper": TABLE2[n],
              "shortcut": shortcut(paper_h(n)),
              "axis": sphere_error(bench, n, SEEDS["axis"], *paper_scheme(n)),
              "general": sphere_error(bench, n, general, *paper_scheme(n)),
              "order 2": sphere_error(bench, n, general, "--scheme", "godunov", "--order", 2),
              "jet": sphere_error(bench, n, general)}
    sphere(bench, n)[1].unlink()  # 50 MB at N = 500
    return errors


def table2(bench):
    sizes = [100, 120, 140] if bench.quick else list(TABLE2)
    # The march of godunov has one thread; two rows at once, the largest first.
    with concurrent.futures.ThreadPoolExecutor(max_workers=2) as pool:
        found = dict(zip(sizes[::-1], pool.map(lambda n: sphere_errors(bench, n), sizes[::-1])))
    columns = {"paper": "paper", "axis": "order 1, seed on an axis", "general": "order 1",
               "shortcut": "band alone", "order 2": "order 2", "jet": "`jet`"}
    rates = {c: slope((1 / n, found[n][c]) for n in sizes) for c in columns}
    rows = [[n, lab.number(paper_h(n), 5), *(lab.number(found[n][c], 3) for c in columns)]
            for n in sizes]
    rows.append(["fitted rate", "", *(f"{rates[c]:.3f}" for c in columns)])
    ratios = [found[n]["axis"] / found[n]["paper"] for n in sizes]
    radii = {r: sphere_error(bench, 100, SEEDS["axis"], *paper_scheme(100), radius=r)
             for r in (0.2, 0.25, 0.3, 0.35, 0.4)}
    figures = {"rows": {str(n): found[n] for n in sizes}, "rates": rates,
               "ratio": {"least": min(ratios), "largest": max(ratios)}, "jet": found[100]["jet"],
               "radii": max(radii.values()) / min(radii.values()),
               "band": max(found[n]["general"] / found[n]["shortcut"] for n in sizes)}

    def draw(figure):
        figure.set_size_inches(6.4, 3.6)
        axes = figure.subplots()
        for c, mark in zip(columns, "oxs^dv"):
            axes.loglog([1 / n for n in sizes], [found[n][c] for n in sizes], marker=mark, ms=3,
                        lw=0.8, label=f"{columns[c].replace('`', '')} ({rates[c]:.2f})")
        axes.set_xlabel("voxel size")
        axes.set_ylabel("largest error")
        axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1, 0.5), title="rate")

    text = lab.table(["N", "h", *columns.values()], rows)
    text += "\n\nOrder 1 at N = 100, seed on an axis, by the radius of the sphere: " + ", ".join(
        f"{r}: {lab.number(error, 3)}" for r, error in radii.items()) + "."
    if plot(draw, bench.images / "table2.svg"):
        text += "\n\n" + image("table2.svg", "The errors of the table over the voxel size")
    return figures, text


# --- Figures 4 to 6, and 8: pictures -------------------------------------------------------------

def three_views(bench, figure, name, lines=0):
    """(largest distance, Markdown) of a model or a shape seen from its views, with about so many
    level lines; 0: the program's choice."""
    if name in SHAPES:
        parameters, seed, views = SHAPES[name]
        words, up = [*bench.shape(name, 1.0, 4, *parameters), "--seed", seed], "z"
    else:
        model = bench.model(name)
        words = [*bench.level_set(model, model.fine), "--seed", model.seed, "--snap", 1e3]
        views, up = model.views, model.up
    largest = bench.solve(*words)["distance"]["max"]
    # --levels would do, but its spacing has six digits in the legend.
    levels = ["--spacing", f"{largest / lines:.2g}"] if lines else []
    images = []
    for k, view in enumerate(views, 1):
        camera = ["--camera=" + view] if view else []
        file = f"{figure}-{name}-{k}"
        bench.picture(file, *words, *camera, "--up", up, *levels)
        images.append(image(f"{file}.png", f"{name}, view {k}"))
    return largest, side_by_side(images)


def fig4(bench):
    figures, texts = {}, []
    for name in ("sphere", "torus", "teapot"):
        try:
            figures[name], text = three_views(bench, "fig4", name)
            texts.append(text)
        except Missing as missing:
            texts.append(left_out(missing))
    return figures, "\n\n".join(texts)


def fig5(bench):
    model = bench.model("brain")
    report = bench.picture("fig5-brain", *bench.level_set(model, model.fine), "--seed", model.seed,
                           "--snap", 1e3, "--camera=" + model.side, "--up", model.up,
                           size="560x420")
    return {"largest": report["distance"]["max"]}, image("fig5-brain.png", "distances on the brain")


def near_and_far(values, cell):
    """The largest difference of distance between points of one cell of a grid: (difference, how far
    apart the two are)."""
    cells = {}
    for x, y, z, d in values:
        key = (x // cell, y // cell, z // cell)
        low, high = cells.get(key, ((math.inf,), (-math.inf,)))
        cells[key] = min(low, (d, x, y, z)), max(high, (d, x, y, z))
    low, high = max(cells.values(), key=lambda pair: pair[1][0] - pair[0][0])
    return high[0] - low[0], math.dist(low[1:], high[1:])


def fig6(bench):
    model = bench.model("knot")
    ply = bench.work / "knot.ply"
    report = bench.picture("fig6-knot", *bench.level_set(model, model.fine), "--seed", model.seed,
                           "--snap", 1e3, "--up", model.up, "--mesh-out", ply, size="480x360")
    largest = report["distance"]["max"]
    along, apart = near_and_far(surface_values(ply), 0.1 * largest)
    figures = {"largest": largest, "along": along / largest, "apart": apart / largest}
    return figures, "\n\n".join([
        image("fig6-knot.png", "distances on the knot"),
        f"Two points {100 * apart / largest:.0f} % of the largest distance apart in space differ by "
        f"{100 * along / largest:.0f} % of it in distance."])


def fig8(bench):
    figures, texts = {}, []
    for name in ("bunny", "torus"):
        try:
            figures[name], text = three_views(bench, "fig8", name, lines=22)
            texts.append(text)
        except Missing as missing:
            texts.append(left_out(missing))
    return figures, "\n\n".join(texts)


# --- Figure 7: the mesh beside -------------------------------------------------------------------

def on_mesh(bench, mesh, seed, points):
    """(distances at points along the mesh itself, how they were found): exact by igeo_peer, where it
    was built; else by the program."""
    peer = bench.build / "tests" / "igeo_peer"
    if bench.quick or not peer.exists():
        resolution = 100 if bench.quick else 256
        found, _ = at_points(bench, points, "--mesh", mesh, "--resolution", resolution,
                             "--seed", seed, "--snap", 1e3)
        return found, f"`--mesh` at {resolution} voxels"
    file = bench.work / "mesh.csv"
    file.write_text("".join("{!r},{!r},{!r},0\n".format(*p) for p in points))
    lab.run([peer, "--method", "oracle", "--mesh", mesh, "--seed", seed, "--points", file])
    rows = pathlib.Path(f"{file}.exact").read_text().split()
    return [float(row.split(",")[3]) for row in rows], "exact polyhedral distances (`igeo_peer`)"


def draw_differences(points, values):
    """Three views of points coloured by values, the nearest on top."""
    def draw(figure):
        figure.set_size_inches(7.5, 2.6)
        for axes, (right, near) in zip(figure.subplots(1, 3), (((0, 0, 1), (-1, 0, 0)),
                                                               ((1, 0, 0), (0, 0, 1)),
                                                               ((0, 0, -1), (1, 0, 0)))):
            order = sorted(range(len(points)), key=lambda i: dot(points[i], near))
            dots = axes.scatter([dot(points[i], right) for i in order], [points[i][1] for i in order],
                                c=[values[i] for i in order], s=18, marker="o", cmap="viridis",
                                linewidths=0)
            axes.set_aspect("equal")
            axes.axis("off")
        figure.colorbar(dots, label="difference, % of the largest distance")
    return draw


def fig7(bench):
    model = bench.model("bunny")
    mesh = bench.mesh(model)
    points = mesh_points(mesh, 500 if bench.quick else 6000)
    seed = ["--seed", model.seed, "--snap", 1e3]
    truth, how = on_mesh(bench, mesh, model.seed, points)
    largest = max(truth)
    order1 = ["--scheme", "godunov", "--order", 1]
    runs = {"godunov 1": ("`godunov`, order 1", model.voxels, order1),
            "godunov 1 fine": ("`godunov`, order 1", model.fine, order1),
            "godunov 2": ("`godunov`, order 2", model.fine, ["--scheme", "godunov"]),
            "jet": ("`jet`", model.voxels, []), "jet fine": ("`jet`", model.fine, [])}
    figures = {}
    rows = [["paper, both of its methods", "-", "-", f"{100 * PAPER_WITHIN:.2f}"]]
    for key, (name, voxels, options) in runs.items():
        found, _ = at_points(bench, points, *bench.level_set(model, voxels), *seed, *options)
        percent = [100 * abs(a - b) / largest for a, b in zip(found, truth)]
        figures[key] = {"mean": sum(percent) / len(percent), "max": max(percent)}
        rows.append([name, voxels, *(lab.number(figures[key][k], 2) for k in ("mean", "max"))])
        if key == "godunov 1":
            first = percent
    text = lab.table(["method", "voxels", "mean, %", "largest, %"], rows)
    text += f"\n\nThe mesh's side: {how}, at {len(points)} vertices."
    if plot(draw_differences(points, first), bench.images / "fig7-difference.png"):
        text += "\n\n" + image("fig7-difference.png", "where the distances differ")
    return {mesh.stem: figures}, text


# --- Figures 9 to 11: paths ----------------------------------------------------------------------

def path(bench, *words):
    """The first path of a run, as written by --paths."""
    file = bench.work / "paths.json"
    bench.solve(*words, "--paths", file)
    found = json.loads(file.read_text())["paths"][0]
    if found["status"] != "reached":
        raise RuntimeError(f"a path is {found['status']}")
    return found


def to_segment(p, a, b):
    ab = difference(b, a)
    length = dot(ab, ab)
    t = min(1, max(0, dot(difference(p, a), ab) / length)) if length > 0 else 0
    return math.dist(p, [x + t * y for x, y in zip(a, ab)])


def farthest(one, other):
    """How far a vertex of one path is from another path, at most."""
    line = other["vertices"]["position"]
    return max(min(to_segment(p, a, b) for a, b in zip(line, line[1:]))
               for p in one["vertices"]["position"])


def fig9(bench):
    model = bench.model("bunny")
    ends = ["--seed", model.seed, "--target", model.target, "--snap", 1e3]
    surface = bench.level_set(model, model.fine)
    report = bench.picture("fig9-path", *surface, *ends, "--up", model.up,
                           "--camera=" + model.side, size="480x360")
    voxel = report["surface"]["voxelSize"]
    mesh = bench.mesh(model)
    along_mesh = ["--mesh", mesh, "--resolution", 100 if bench.quick else 256, *ends]
    reference = path(bench, *along_mesh, "--straighten")
    (exact,), how = on_mesh(bench, mesh, model.seed, [tuple(map(float, model.target.split(",")))])
    order1 = [*surface, *ends, "--scheme", "godunov", "--order", 1]
    runs = {"mesh": ("mesh, `jet`", along_mesh), "jet": ("level set, `jet`", [*surface, *ends]),
            "godunov": ("level set, `godunov`, order 1", order1),
            "straight": ("the same, straightened", [*order1, "--straighten"])}
    figures, rows = {"mesh's side": exact}, []
    for key, (name, words) in runs.items():
        found = path(bench, *words)
        figures[key] = {"distance": 100 * (found["distance"] / exact - 1),
                        "length": 100 * (found["arcLength"] / exact - 1),
                        "apart": farthest(found, reference) / voxel}
        rows.append([name, f"{found['distance']:.5g}", f"{figures[key]['distance']:+.2f}",
                     f"{found['arcLength']:.5g}", f"{figures[key]['length']:+.2f}",
                     lab.number(figures[key]["apart"], 2)])
    text = lab.table(["surface and scheme", "distance", "%", "length of the path", "%",
                      "apart at most, voxels"], rows)
    text += f"\n\nPercentages are of {exact:.5g}: {how}."
    return {pathlib.Path(model.file).stem: figures}, \
        image("fig9-path.png", "a geodesic") + "\n\n" + text


def fig10(bench):
    model = bench.model("brain")
    words = [*bench.level_set(model, model.fine), "--seed", model.seed, "--target", model.target,
             "--snap", 1e3, "--camera=" + model.side, "--up", model.up]
    valley = ["--weight-curvature", "valley,eps=100,p=3"]
    figures, images = {}, []
    for key, options in (("natural", []), ("valley", valley)):
        report = bench.picture(f"fig10-{key}", *words, *options, size="480x360")
        found = path(bench, *words, *options)
        figures[key] = {"length": found["arcLength"], "cost": found["length"] / found["arcLength"],
                        "largest": report["metric"]["largest"]}
        images.append(image(f"fig10-{key}.png", f"the {key} path"))
    figures["longer"] = figures["valley"]["length"] / figures["natural"]["length"]
    text = (f"The natural path is {figures['natural']['length']:.1f} mm long, that in the valley "
            f"{figures['valley']['length']:.1f} mm. Its mean cost per mm is "
            f"{figures['valley']['cost']:.0f}, where the surface has up to "
            f"{lab.number(figures['valley']['largest'])}.")
    return {pathlib.Path(model.file).stem: figures}, \
        side_by_side(images, ["g = 1", "g of the mean curvature"]) + "\n\n" + text


def fig11(bench):
    model = bench.model("bunny")
    words = [*bench.level_set(model, model.fine), "--seed", model.seed, "--target", model.past,
             "--snap", 1e3, "--up", model.up, "--camera=" + model.side]
    *centre, radius = model.ball
    ball = ["--obstacle-sphere", ",".join(map(str, model.ball))]
    figures, images = {}, []
    for key, options in (("natural", []), ("around", ball)):
        report = bench.picture(f"fig11-{key}", *words, *options)
        found = path(bench, *words, *options)
        away = min(math.dist(p, centre) for p in found["vertices"]["position"])
        figures[key] = {"length": found["arcLength"],
                        "clear": (away - radius) / report["surface"]["voxelSize"]}
        images.append(image(f"fig11-{key}.png", f"the path, {key}"))
    text = (f"The path is {figures['natural']['length']:.4g} long without and {figures['around']['length']:.4g} "
            f"with the obstacle; there it comes to within {figures['around']['clear']:.2f} voxels of it.")
    return {pathlib.Path(model.file).stem: figures}, \
        side_by_side(images, ["g = 1", "with an obstacle"]) + "\n\n" + text


# --- Figure 12: the length of the gradient -------------------------------------------------------

def crosses_on_sphere(count, step):
    """Points of the sphere, uniformly distributed, and around each one four at a distance of `step`,
    two by two opposite; as a list of the four."""
    pick = random.Random(12)
    crosses = []
    for _ in range(count):
        n = on_sphere([pick.gauss(0, 1) for _ in range(3)])
        n = [x / RADIUS for x in difference(n, MIDDLE)]
        least = min(range(3), key=lambda k: abs(n[k]))
        t = cross(n, [float(k == least) for k in range(3)])
        t = [x / math.hypot(*t) for x in t]
        for tangent in (t, cross(n, t)):
            for sign in (1, -1):
                crosses.append(on_sphere([math.cos(step / RADIUS) * x + sign *
                                          math.sin(step / RADIUS) * y for x, y in zip(n, tangent)]))
    return crosses


def fig12(bench):
    n = 60 if bench.quick else 100
    # The paper does not print its nine values of h.
    widths = [1.75, 4, 8] if bench.quick else [1.75, 2.5, 3.5, 5, 6.5, 8, 10, 12, 14]
    count, step = 1000, 1 / n
    points = crosses_on_sphere(count, step)
    surface = bench.shape("sphere", 1 / n, 15, "center=0.5,0.5,0.5", f"radius={RADIUS}")
    seed = ",".join(map(repr, on_sphere(SEEDS["general"])))
    figures, rows, lengths = {}, [], {}
    for h in widths:
        d, _ = at_points(bench, points, *surface, "--seed", seed, "--scheme", "godunov", "--order", 1,
                         "--band-voxels", h)
        # Central differences along S, over a voxel to either side.
        lengths[h] = sorted(math.hypot(d[k] - d[k + 1], d[k + 2] - d[k + 3]) / (2 * step)
                            for k in range(0, 4 * count, 4))
        share = {f"{p} %": lengths[h][int(p / 100 * (count - 1))] for p in (5, 50, 95)}
        figures[str(h)] = {**share, "spread": share["95 %"] - share["5 %"]}
        inner = 1 - h * step / RADIUS
        rows.append([h, *(f"{x:.3f}" for x in (*share.values(), figures[str(h)]["spread"], inner))])

    def draw(figure):
        figure.set_size_inches(7, 5)
        for axes, h in zip(figure.subplots(3, 3, sharex=True, sharey=True).flat, widths):
            axes.hist(lengths[h], bins=[0.5 + 0.02 * k for k in range(36)], histtype="stepfilled")
            axes.set_title(f"h = {h:g} voxels", fontsize=8)

    text = lab.table(["h, voxels", "5 %", "median", "95 %", "between 5 and 95 %", "1 - h/R"], rows)
    if plot(draw, bench.images / "fig12.svg"):
        text = image("fig12.svg", "histograms of the length of the gradient") + "\n\n" + text
    return {"narrowest": figures[str(widths[0])], "widest": figures[str(widths[-1])]}, text


EXPERIMENTS = {"table1": table1, "table2": table2, "fig4": fig4, "fig5": fig5, "fig6": fig6,
               "fig7": fig7, "fig8": fig8, "fig9": fig9, "fig10": fig10, "fig11": fig11,
               "fig12": fig12}

# What --quick has to find on its small grids and its stand-in: (figure, least, largest).
QUICK = (
    ("table1.points", 0, 0.05),  # radii are chosen for the paper's numbers
    ("table2.rates.axis", 0.55, 0.75),  # the paper's rows at these N: 0.60
    ("table2.radii", 1, 1.1),
    ("fig6.along", 0.2, 1),  # strands of the trefoil that pass each other
    ("fig7.trefoil.godunov 1.max", 0.1, 5),  # %; more than 0: the two are different computations
    ("fig7.trefoil.jet.max", 0.001, 0.5),
    ("fig9.trefoil.jet.distance", -0.2, 0.2),  # %
    ("fig9.trefoil.jet.length", -0.5, 0.5),
    ("fig9.trefoil.godunov.length", -0.5, 1),
    ("fig9.trefoil.jet.apart", 0, 1),  # voxels
    ("fig10.trefoil.longer", 1, 3),  # nothing is shorter than the natural path
    ("fig11.trefoil.natural.clear", -20, 0),  # it goes through the ball, so
    ("fig11.trefoil.around.clear", -0.5, 5),  # this one has to go around it
    ("fig12.narrowest.50 %", 0.95, 1.05),
    ("fig12.widest.5 %", 0.62, 0.72),  # 1 - h/R = 0.667: straight up from the inner sphere
)


def quick_holds(results):
    holds = True
    for figure, least, largest in QUICK:
        value = lab.look_up(results, figure)
        if value is None:
            continue
        good = least <= value <= largest
        holds = holds and good
        print(f"{'holds' if good else 'DOES NOT HOLD'}: {figure} is {value:.6g}, "
              f"from {least:g} to {largest:g}")
    return holds


def arguments():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small grids, no models, not into docs/")
    parser.add_argument("--models", type=pathlib.Path, metavar="DIR", help="folder of the models")
    parser.add_argument("--only", default=",".join(EXPERIMENTS), metavar="NAMES",
                        help="some of " + ",".join(EXPERIMENTS))
    parser.add_argument("--build", type=pathlib.Path, help="build folder [build/release]")
    options = parser.parse_args()
    options.only = options.only.split(",")
    if unknown := set(options.only) - set(EXPERIMENTS):
        parser.error("no such experiment: " + ", ".join(sorted(unknown)))
    if not options.build:
        program = os.environ.get("IGEO_PROGRAM")
        options.build = pathlib.Path(program).resolve().parents[1] if program else \
            lab.ROOT / "build" / "release"
    if not (options.build / "bin" / "implicit-geodesic").exists():
        sys.exit(f"{options.build}/bin/implicit-geodesic is not there: run scripts/build.sh release")
    return options


def main():
    options = arguments()
    out = options.build / "reproduction" if options.quick else lab.ROOT / "docs"
    document = out / "reproduction.md"
    if options.quick:
        lab.write(document, (lab.ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8"))

    results = {}
    with tempfile.TemporaryDirectory(dir=options.build) as work:
        bench = Bench(options.build, options.models, out, pathlib.Path(work), options.quick)
        for name in options.only:
            try:
                results[name], text = EXPERIMENTS[name](bench)
            except Missing as missing:
                text = left_out(missing)
            lab.rewrite(document, name, text)
            print(f"{name}: {'done' if name in results else text}", flush=True)
    if "table1" in results:
        lab.rewrite(document, "machine", f"Times: {lab.machine()}; one thread, least of five runs.")
    lab.save(results, options.build / f"reproduction{'-quick' if options.quick else ''}.json")
    holds = lab.check(results, SCRIPT)
    if options.quick:
        holds = quick_holds(results) and holds
    sys.exit(0 if holds else 1)


if __name__ == "__main__":
    main()
