#!/usr/bin/env python3
"""Draws docs/images/method.svg: band, core, foot points, front and cut links, on cross-sections.

Everything is computed by the rules of the code, in two dimensions: the band |psi| < sqrt(3), the core
|psi| <= 0.55 max |n_k| (Band::numberCore), links between core nodes that touch, cut where normals are at a
cosine below -0.2 (kOppositeNormals), buckets half a voxel wide (JetOptions::bucketWidth).

usage: scripts/draw_method.py [FILE]   needs python3-matplotlib
"""
import itertools
import math
import pathlib
import sys

import matplotlib
import numpy as np

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402  after the choice of a backend without display
from matplotlib.patches import PathPatch  # noqa: E402
from matplotlib.path import Path  # noqa: E402

BAND, CORE, SURFACE, FRONT, CUT = "#dcebf7", "#9cc4e4", "#222222", "#e07b00", "#c8102e"


class Section:
    """The nodes of a band around a curve: index, foot point, normal, arc length of the foot point."""

    def __init__(self, curve, width, height):
        self.curve, self.size = curve, (width, height)
        arc = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(curve, axis=0).T))])
        tangent = np.gradient(curve, axis=0)
        normals = np.stack([-tangent[:, 1], tangent[:, 0]], 1) / np.hypot(*tangent.T)[:, None]
        self.band, self.core = [], {}
        for node in itertools.product(range(width), range(height)):
            k = np.argmin(np.hypot(*(curve - node).T))
            if k in (0, len(curve) - 1):
                continue
            psi, normal = math.dist(node, curve[k]), normals[k]
            if psi < math.sqrt(3):
                self.band.append(node)
            if psi <= 0.55 * max(abs(normal)):
                self.core[node] = (curve[k], normal, arc[k])

    def links(self):
        """(foot points of two core nodes that touch, whether a front may pass)."""
        for a, b in itertools.combinations(self.core, 2):
            if max(abs(a[0] - b[0]), abs(a[1] - b[1])) == 1:
                (ya, na, _), (yb, nb, _) = self.core[a], self.core[b]
                yield (ya, yb), float(na @ nb) >= -0.2

    def draw(self, axes):
        def squares(nodes, color):
            unit = Path([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (0, 0)], closed=True)
            path = Path.make_compound_path(*(Path(unit.vertices + n, unit.codes) for n in nodes))
            axes.add_patch(PathPatch(path, facecolor=color, edgecolor="white", linewidth=0.8))
        squares(self.band, BAND)
        squares(self.core, CORE)
        axes.plot(*self.curve[::16].T, color=SURFACE, linewidth=1.6)
        axes.set_xlim(-0.5, self.size[0] - 0.5)
        axes.set_ylim(-0.5, self.size[1] - 0.5)
        axes.set_aspect("equal")
        axes.axis("off")


def lines(axes, ends, **look):
    """Separate lines as one path."""
    axes.plot(*np.concatenate([[*pair, (math.nan, math.nan)] for pair in ends]).T, **look)


def label(axes, text, at, to, color="#222222"):
    axes.annotate(text, to, xytext=at, fontsize=10, color=color, ha="center", va="center",
                  arrowprops={"arrowstyle": "-", "color": color, "linewidth": 0.8, "shrinkB": 2})


def draw_march(axes):
    x = np.linspace(-1, 19, 2001)
    section = Section(np.stack([x, 4.3 + 1.9 * np.sin(x / 2.6 + 0.4)], 1), 19, 9)
    section.draw(axes)
    lines(axes, [(node, y) for node, (y, _, _) in section.core.items()], color="#555555", linewidth=0.8)
    axes.scatter(*np.array(list(section.core)).T, s=5, color="#555555", linewidth=0)
    # From a seed on, the distances of the front at a bucket's start.
    seed_arc = sorted(arc for _, _, arc in section.core.values())[3]
    start = 9.5
    groups = {"#0b5fa5": [], FRONT: [], "white": []}
    for foot, _, arc in section.core.values():
        d = abs(arc - seed_arc)
        groups["#0b5fa5" if d < start else FRONT if d < start + 0.5 else "white"].append((d, foot))
    for color, points in groups.items():
        axes.scatter(*np.array([foot for _, foot in points]).T, s=34, color=color, edgecolor=SURFACE,
                     linewidth=0.9, zorder=3)
    seed = min(groups["#0b5fa5"], key=lambda p: p[0])[1]
    axes.scatter(*seed, s=150, marker="*", color="#ffd23f", edgecolor=SURFACE, linewidth=0.9, zorder=4)
    front = groups[FRONT][0][1]
    ahead = section.curve[np.argmin(np.hypot(*(section.curve - front).T)) + 130]
    axes.annotate("", ahead, xytext=front, zorder=5,
                  arrowprops={"arrowstyle": "-|>", "color": FRONT, "linewidth": 2, "shrinkA": 3, "shrinkB": 0})
    behind = max(groups["#0b5fa5"], key=lambda p: p[0])[1]
    waiting = sorted(groups["white"], key=lambda p: p[0])[3][1]
    node = (17, 5)
    label(axes, "seed", (seed[0] - 1.2, seed[1] + 2.3), seed)
    label(axes, "accepted: value u, gradient g", (5.2, 0.7), behind, "#0b5fa5")
    label(axes, "bucket that is solved", (9.6, 6.4), front, FRONT)
    label(axes, "waiting", (14.6, 0.9), waiting)
    label(axes, "node of the core\nand its foot point on S", (13.0, 7.4),
          (np.array(node) + section.core[node][0]) / 2)
    axes.text(17.0, 2.2, "band: |ψ| < √3", fontsize=10, ha="center", color="#41729f")
    label(axes, "S: ψ = 0", (1.6, 1.9), section.curve[620])
    axes.set_title("The front goes from foot point to foot point", fontsize=11)


def draw_links(axes):
    # A slot 1.7 voxels wide.
    half, depth, rim = 0.85, 2.2, 1.5
    turn = np.linspace(0, math.pi / 2, 200)
    right = [np.stack([5.5 + half * np.sin(turn), depth - half * np.cos(turn)], 1),
             np.stack([np.full(300, 5.5 + half), np.linspace(depth, 5.2, 300)], 1),
             np.stack([5.5 + half + rim * (1 - np.cos(turn)), 5.2 + rim * np.sin(turn)], 1),
             np.stack([np.linspace(5.5 + half + rim, 12.2, 300), np.full(300, 5.2 + rim)], 1)]
    right = np.concatenate(right)
    left = right[::-1] * (-1, 1) + (11, 0)
    section = Section(np.concatenate([left, right]), 12, 9)
    section.draw(axes)
    links = list(section.links())
    lines(axes, [feet for feet, open_ in links if open_], color="#444444", linewidth=1.1)
    cut = [feet for feet, open_ in links if not open_]
    lines(axes, cut, color=CUT, linewidth=1.2, linestyle=(0, (3, 2)))
    axes.scatter(*np.array([foot for foot, _, _ in section.core.values()]).T, s=26, color="white",
                 edgecolor=SURFACE, linewidth=0.9, zorder=3)
    middle = np.mean(max(cut, key=lambda feet: feet[0][1] + feet[1][1]), axis=0)
    label(axes, "cut links between\nsheets that face each other", (5.5, 7.8), middle, CUT)
    label(axes, "links", (9.6, 4.3), (8.9, 6.7))
    axes.set_title("No link leads across a slot", fontsize=11)
    assert cut and len(cut) < len(links) / 2


def main():
    file = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[1] / "docs/images/method.svg"
    matplotlib.rcParams.update({"svg.hashsalt": "implicit-geodesic", "svg.fonttype": "none",
                                "font.family": "sans-serif"})
    figure, (march, links) = pyplot.subplots(1, 2, figsize=(11, 3.9), gridspec_kw={"width_ratios": (19, 12)})
    draw_march(march)
    draw_links(links)
    figure.tight_layout(pad=0.4)
    # The same bytes for the same picture.
    figure.savefig(file, metadata={"Date": None, "Creator": "scripts/draw_method.py"})


if __name__ == "__main__":
    main()
