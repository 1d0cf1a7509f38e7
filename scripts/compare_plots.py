"""Plots of scripts/compare.py, as SVG: errors and times against resolution."""
import math

import matplotlib

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402  after the choice of a backend without display

# One look per method in all plots; colors that differ in lightness too.
LOOKS = {"jet": ("`jet`", "#0b5fa5", "o", "-"), "godunov2": ("`godunov`, order 2", "#3d9970", "s", "-"),
         "godunov1": ("`godunov`, order 1", "#9bc53d", "D", "-"), "heat": ("heat method", "#c8553d", "^", "--"),
         "heat-10": ("heat, t = 10 h^2", "#e8a87c", "<", "--"), "marching": ("fast marching", "#7b4fa3", "P", "--"),
         "dijkstra": ("Dijkstra on edges", "#8d8d8d", "x", ":"),
         "exact": ("exact on the extracted mesh", "#222222", "v", "--")}


def setup():
    matplotlib.rcParams.update({"svg.hashsalt": "implicit-geodesic", "svg.fonttype": "none", "font.size": 10,
                                "font.family": "sans-serif", "axes.spines.top": False,
                                "axes.spines.right": False, "axes.grid": True, "grid.color": "#e5e5e5",
                                "legend.frameon": False})


def save(figure, file, creator="scripts/compare.py"):
    """The same bytes for the same figures."""
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, metadata={"Date": None, "Creator": creator})
    pyplot.close(figure)


def legend_below(figure, axes, height):
    """One legend for all panes, in a strip of this part of the figure."""
    figure.legend(*axes.get_legend_handles_labels(), loc="lower center", ncol=3)
    figure.tight_layout(rect=(0, height, 1, 1))


def line(axes, method, xs, ys, **more):
    label, color, mark, style = LOOKS[method]
    axes.loglog(xs, ys, color=color, marker=mark, linestyle=style, markersize=5, linewidth=1.5,
                label=label.replace("`", ""), **more)


def slope(axes, x, y, order):
    """A triangle of the slope -order, one octave wide, its corner at the lower left."""
    xs, ys = (x, 2 * x, x, x), (y, y * 2 ** -order, y * 2 ** -order, y)
    axes.fill(xs, ys, facecolor="#dddddd", edgecolor="#777777", linewidth=0.8, zorder=1)
    axes.annotate(f"order {order}", (x * 1.05, y * 2 ** -order), textcoords="offset points",
                  xytext=(0, -11), fontsize=8, color="#555555")


def ticks(axes, values):
    axes.set_xticks(values, [f"{v:g}" for v in values])
    axes.minorticks_off()


def series(results, shape, method, value):
    """[N], [value] of the cases of a shape that have the method."""
    points = sorted((int(name.split("-")[1]), value(case[method]))
                    for name, case in results["cases"].items()
                    if name.startswith(f"{shape}-") and method in case)
    return [n for n, _ in points], [v for _, v in points]


def convergence(results, folder):
    figure, panes = pyplot.subplots(2, 2, figsize=(9.2, 7.4), sharex="col")
    for column, shape in enumerate(("sphere", "torus")):
        for axes, key, what in zip(panes[:, column], ("mean", "max"), ("mean", "largest")):
            for method in LOOKS:
                ns, values = series(results, shape, method, lambda run, k=key: run["errors"][k])
                if ns:
                    line(axes, method, ns, values)
            axes.set_title(f"{shape}: {what} error")
            ticks(axes, series(results, shape, "jet", lambda run: 1)[0])
            axes.set_ylabel("% of the largest distance")
            for method, order, k, below in (("jet", 2, 0, 0.45), ("godunov1", 1, -2, 0.12)) \
                    if key == "mean" else ():
                ns, values = series(results, shape, method, lambda run: run["errors"]["mean"])
                slope(axes, 1.05 * ns[k], below * values[k], order)
        panes[1, column].set_xlabel("voxels per side, N")
    legend_below(figure, panes[0, 0], 0.11)
    save(figure, folder / "convergence.svg")


def work(results, folder):
    """Error against processor time: what a second buys."""
    figure, panes = pyplot.subplots(1, 2, figsize=(9.2, 4.2))
    for axes, shape in zip(panes, ("sphere", "torus")):
        for method in LOOKS:
            times = series(results, shape, method, lambda run: run["total"]["cpu"])[1]
            errors = series(results, shape, method, lambda run: run["errors"]["mean"])[1]
            if times:
                line(axes, method, times, errors)
        axes.set_title(shape)
        axes.set_xlabel("processor time, file to first seed, s")
    panes[0].set_ylabel("mean error, % of the largest distance")
    legend_below(figure, panes[0], 0.19)
    save(figure, folder / "work.svg")


# igeo_bench march --n 3800 --runs 1 --threads 2.
LARGEST = {"nodes": 100560766, "seconds": 5.1 + 16.9}


def growth(results, folder):
    """Time of jet against the number of nodes, and memory, with methods on meshes beside it."""
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(9.2, 4.2))
    runs = results.get("growth", [])
    line(left, "jet", [run["nodes"] for run in runs],
         [run["bandSeconds"] + run["marchSeconds"] for run in runs])
    left.loglog([LARGEST["nodes"]], [LARGEST["seconds"]], "o", markersize=6, markerfacecolor="white",
                color=LOOKS["jet"][1], label="jet, N = 3800, two threads")
    spheres = sorted((case["jet"]["nodes"], case) for name, case in results["cases"].items()
                     if name.startswith("sphere-"))
    for method in ("jet", "heat", "marching"):
        known = [(nodes, case[method]) for nodes, case in spheres if method in case]
        nodes = [n for n, _ in known]
        line(right, method, nodes, [run["peakBytes"] / 1e9 for _, run in known])
        if method != "jet":
            line(left, method, nodes, [sum(run[s]["cpu"] for s in ("surface", "setup", "first"))
                                       for _, run in known])
    for axes, what in ((left, "seconds, without reading the file"),
                       (right, "peak memory of the process, GB")):
        axes.set_xlabel("nodes of jet's band on the same level set")
        axes.set_ylabel(what)
    slope_up(left, 3 * spheres[-1][0], 2 * left.get_ylim()[0])
    left.legend()
    figure.tight_layout()
    save(figure, folder / "growth.svg")


def slope_up(axes, x, y):
    """A triangle of slope 1."""
    axes.fill((x, 8 * x, 8 * x, x), (y, y, 8 * y, y), facecolor="#dddddd", edgecolor="#777777",
              linewidth=0.8, zorder=1)
    axes.annotate("linear", (math.sqrt(8) * x, y), textcoords="offset points", xytext=(-12, -11),
                  fontsize=8, color="#555555")


def draw(results, folder):
    setup()
    convergence(results, folder)
    work(results, folder)
    growth(results, folder)
