"""Figures 4 to 12 of the paper: each function returns (figures, Markdown)."""
import json
import math
import pathlib
import random

import measure
from reproduction.bench import (MIDDLE, RADIUS, SEEDS, SHAPES, Missing, at_points, cross, difference,
                                dot, image, left_out, mesh_points, on_sphere, plot, side_by_side,
                                surface_values)

PAPER_WITHIN = 4.1439 / 95.599  # Fig. 7: largest difference over largest distance


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
    # --levels is simpler, but its spacing has six digits in the legend.
    levels = ["--spacing", f"{largest / lines:.2g}"] if lines else []
    images = []
    for k, view in enumerate(views, 1):
        camera = ["--camera=" + view] if view else []
        file = f"{figure}-{name}-{k}"
        bench.picture(file, *words, *camera, "--up", up, *levels)
        images.append(image(f"{file}.png", f"{name}, view {k}"))
    return largest, side_by_side(images)


def rows_of_views(bench, figure, names, lines=0):
    """three_views() of several."""
    largest, texts = {}, []
    for name in names:
        try:
            largest[name], text = three_views(bench, figure, name, lines)
            texts.append(text)
        except Missing as missing:
            texts.append(left_out(missing))
    return largest, "\n\n".join(texts)


def fig4(bench):
    return rows_of_views(bench, "fig4", ("sphere", "torus", "teapot"))


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
    return rows_of_views(bench, "fig8", ("bunny", "torus"), lines=22)


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
    measure.run([peer, "--method", "oracle", "--mesh", mesh, "--seed", seed, "--points", file])
    rows = pathlib.Path(f"{file}.exact").read_text().split()
    return [float(row.split(",")[3]) for row in rows], "exact polyhedral distances (`igeo_peer`)"


def draw_differences(points, values):
    """Three views of points colored by values, the nearest on top."""
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
        rows.append([name, voxels, *(measure.number(figures[key][k], 2) for k in ("mean", "max"))])
        if key == "godunov 1":
            first = percent
    text = measure.table(["method", "voxels", "mean, %", "largest, %"], rows)
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
                        "length": 100 * (found["length"] / exact - 1),
                        "apart": farthest(found, reference) / voxel}
        rows.append([name, f"{found['distance']:.5g}", f"{figures[key]['distance']:+.2f}",
                     f"{found['length']:.5g}", f"{figures[key]['length']:+.2f}",
                     measure.number(figures[key]["apart"], 2)])
    text = measure.table(["surface and scheme", "distance", "%", "length of the path", "%",
                      "apart at most, voxels"], rows)
    text += f"\n\nPercentages are of {exact:.5g}: {how}."
    return {pathlib.Path(model.file).stem: figures}, \
        image("fig9-path.png", "a geodesic") + "\n\n" + text


def fig10(bench):
    model = bench.model("brain")
    words = [*bench.level_set(model, model.fine), "--seed", model.seed, "--target", model.target,
             "--snap", 1e3]
    view = ["--camera=" + model.side, "--up", model.up]
    valley = ["--weight-curvature", "valley," + model.valley]
    figures, images = {}, []
    for key, options in (("natural", []), ("valley", valley)):
        report = bench.picture(f"fig10-{key}", *words, *view, *options, size="480x360")
        found = path(bench, *words, *options)
        figures[key] = {"length": found["length"], "cost": found["weightedLength"] / found["length"],
                        "largest": report["metric"]["largest"]}
        images.append(image(f"fig10-{key}.png", f"the {key} path"))
    figures["longer"] = figures["valley"]["length"] / figures["natural"]["length"]
    text = (f"The natural path is {figures['natural']['length']:.1f} mm long, that in the valley "
            f"{figures['valley']['length']:.1f} mm. Its mean cost per mm is "
            f"{figures['valley']['cost']:.0f}, where the surface has up to "
            f"{measure.number(figures['valley']['largest'])}.")
    return {pathlib.Path(model.file).stem: figures}, \
        side_by_side(images, ["g = 1", "g of the mean curvature"]) + "\n\n" + text


def fig11(bench):
    model = bench.model("bunny")
    words = [*bench.level_set(model, model.fine), "--seed", model.seed, "--target", model.past,
             "--snap", 1e3]
    view = ["--camera=" + model.side, "--up", model.up]
    *center, radius = model.ball
    ball = ["--obstacle-sphere", ",".join(map(str, model.ball))]
    figures, images = {}, []
    for key, options in (("natural", []), ("around", ball)):
        report = bench.picture(f"fig11-{key}", *words, *view, *options)
        found = path(bench, *words, *options)
        away = min(math.dist(p, center) for p in found["vertices"]["position"])
        figures[key] = {"length": found["length"],
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

    text = measure.table(["h, voxels", "5 %", "median", "95 %", "between 5 and 95 %", "1 - h/R"], rows)
    if plot(draw, bench.images / "fig12.svg"):
        text = image("fig12.svg", "histograms of the length of the gradient") + "\n\n" + text
    return {"narrowest": figures[str(widths[0])], "widest": figures[str(widths[-1])]}, text
