"""Tables 1 and 2 of the paper: each function returns (figures, Markdown)."""
import concurrent.futures
import math

import measure
from reproduction.bench import (MIDDLE, RADIUS, SEEDS, SHAPES, Missing, cross, difference, dot, image,
                                left_out, on_sphere, plot, slope, surface_values)

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
        # Where folds or rims do not allow 1.75 voxels, the default: sqrt(3).
        band = ["--band-voxels", "1.75"] if name == "knot" else []
    ours, godunov = least_time(bench, [*words, *band, "--scheme", "godunov", "--order", 1])
    _, jet = least_time(bench, words)
    voxel = ours["surface"]["voxelSize"]
    our_h = ours["parameters"]["bandVoxels"]
    figures = {"points": ours["band"]["nodes"], "h": our_h, "godunov": godunov, "jet": jet,
               "ratio": ours["band"]["nodes"] / points}
    row = [name, size, box_of_band(bench, words, voxel, our_h), points, figures["points"], h,
           measure.number(our_h, 3), seconds, measure.number(godunov, 2), measure.number(jet, 2)]
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
    text = measure.table(["model", "size, paper", "ours", "points, paper", "ours", "h, paper", "ours",
                      "time, paper", "`godunov`, order 1", "`jet`"], rows)
    return figures, "\n\n".join([text, *notes])


def shortcut(h, radius=RADIUS):
    """How much shorter the path to the opposite point is in the band than on the sphere: straight to
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
    rows = [[n, measure.number(paper_h(n), 5), *(measure.number(found[n][c], 3) for c in columns)]
            for n in sizes]
    rows.append(["fitted rate", "", *(f"{rates[c]:.3f}" for c in columns)])
    ratios = [found[n]["axis"] / found[n]["paper"] for n in sizes]
    radii = {r: sphere_error(bench, 100, SEEDS["axis"], *paper_scheme(100), radius=r)
             for r in (0.2, 0.25, 0.3, 0.35, 0.4)}
    figures = {"rows": {str(n): found[n] for n in sizes}, "rates": rates,
               "ratio": {"least": min(ratios), "largest": max(ratios)},
               "jet": max(found[n]["jet"] / found[n]["paper"] for n in sizes),
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

    text = measure.table(["N", "h", *columns.values()], rows)
    text += "\n\nOrder 1 at N = 100, seed on an axis, by the radius of the sphere: " + ", ".join(
        f"{r}: {measure.number(error, 3)}" for r, error in radii.items()) + "."
    if plot(draw, bench.images / "table2.svg"):
        text += "\n\n" + image("table2.svg", "The errors of the table over the voxel size")
    return figures, text
