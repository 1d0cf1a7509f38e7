#!/usr/bin/env python3
"""A page of --view in Chromium: what is read at a pixel, the color there, controls, keys and links.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/consumers/test_chromium_view.py

Exit code 77 where Chromium or Selenium is missing (Debian: chromium chromium-driver python3-selenium), and where
the program was built without three.js.
"""
import json
import math
import pathlib
import sys

import browser
import consumers
from surfaces import read_csv, write_torus

GRID = [(x, y) for x in range(60, 660, 100) for y in range(50, 600, 90)]  # pixels of the window


def need_viewer(folder: pathlib.Path) -> None:
    """Ends with 77 where the program cannot write pages."""
    done = consumers.subprocess.run([consumers.PROGRAM, "none.vdb", "--seed", "0,0,0", "--view", folder / "a.html"],
                                    capture_output=True, text=True, check=False)
    if "three.js" in done.stderr:
        assert done.returncode == 2, done
        print("skipped: the program was built without three.js (Debian: libjs-three)")
        sys.exit(77)


def color_of(scene: dict, distance: float) -> list[float]:
    table = bytes.fromhex(scene["maps"][scene["map"]])
    x = (distance - scene["low"]) / (scene["high"] - scene["low"]) * (len(table) // 3 - 1)
    i = min(int(x), len(table) // 3 - 2)
    return [table[3 * i + c] + (x - i) * (table[3 * i + 3 + c] - table[3 * i + c]) for c in range(3)]


def distances_at(folder: pathlib.Path, surface: list, points: list) -> list[float]:
    """By a run that has the points as targets."""
    (folder / "points.txt").write_text("".join(f"{x!r},{y!r},{z!r}\n" for x, y, z in points))
    consumers.geodesic(*surface, "--targets", folder / "points.txt", "--report", folder / "r.json", "-q",
                       "-o", folder / "out.vdb")
    return [path["distance"] for path in json.loads((folder / "r.json").read_text())["targets"]]


def check_reading(view: browser.View, folder: pathlib.Path, surface: list) -> list[dict]:
    """Distances and colors at pixels all over the window; what was read there."""
    scene = view.scene()
    view.set("shade", False)
    view.set("spacing", 0)
    rows = view.pixels(folder)
    read = [{**view.hover(x, y), "pixel": (x, y)} for x, y in GRID]
    read = [r for r in read if "distance" in r]
    assert len(read) >= 10, f"the surface fills {len(read)} of {len(GRID)} places"
    points = [tuple(float(r[axis]) for axis in "xyz") for r in read]
    largest, off, color = scene["high"], 0.0, 0.0
    for r, distance in zip(read, distances_at(folder, surface, points)):
        off = max(off, abs(float(r["distance"]) - distance))
        x, y = r["pixel"]
        beside = [rows[y][x - 1], rows[y][x + 1], rows[y - 1][x], rows[y + 1][x], rows[y][x]]
        if max(max(map(abs, (p[c] - q[c] for c in range(3)))) for p in beside for q in beside) > 8:
            continue  # a path, a dot or the edge
        wanted = color_of(scene, float(r["distance"]))
        color = max(color, *(abs(rows[y][x][c] - wanted[c]) for c in range(3)))
    print(f"{len(read)} places: distances within {off / largest:.1e} of the largest, colors within {color:.1f} of 255")
    assert off < 1e-3 * largest, off
    assert color < 3, color  # measured: 1.6; a pixel covers some distances
    view.set("shade", True)
    return read


def check_vertices(read: list[dict], folder: pathlib.Path) -> None:
    """The vertex named at a place is the nearest, and has a value to match."""
    corners = [[float(c) for c in line.split()[1:]]
               for line in (folder / "torus.obj").read_text().splitlines() if line[0] == "v"]
    values = read_csv(folder / "v.csv")["distance"]
    for r in read:
        point, vertex = [float(r[axis]) for axis in "xyz"], int(r["nearest vertex"])
        away = math.dist(point, corners[vertex])
        assert away <= min(math.dist(point, c) for c in corners) + 1e-4, (r, away)
        assert abs(values[vertex] - float(r["distance"])) <= 1.1 * away, r


def check_controls(view: browser.View, folder: pathlib.Path) -> None:
    scene = view.scene()
    first = view.picture()
    view.set("spacing", view.run("return document.getElementById('spacing').max"))
    assert view.text("spacingValue").startswith("every "), view.text("spacingValue")
    assert view.picture() != first
    view.set("front", 500)
    half = view.text("frontValue")
    assert abs(float(half.split()[1]) - (scene["low"] + scene["high"]) / 2) < 1e-4, half
    view.set("shade", False)
    rows = view.pixels(folder)
    for x, y in GRID:
        distance = float(view.hover(x, y).get("distance", "0"))
        if distance > 0.6 * scene["high"]:
            r, g, b = rows[y][x]
            assert r == g == b, f"the front has passed {x}, {y} at {distance}: {rows[y][x]}"
    view.set("front", 1000)
    view.set("map", "gray")
    assert all(max(pixel) - min(pixel) <= 1 for pixel in view.pixels(folder)[300][:700:7]), "gray has a hue"
    view.run("document.getElementById('play').click()")
    view.wait("return document.getElementById('frontValue').textContent !== 'all'", "the growth")
    view.run("document.getElementById('play').click()")
    assert view.text("play") == "Grow"


def check_keys(view: browser.View) -> None:
    from selenium.webdriver.common.keys import Keys
    view.run("document.activeElement.blur(); document.body.tabIndex = -1; document.body.focus()")
    view.press(Keys.TAB)
    assert view.run("return document.activeElement.id") == "canvas"
    view.press("0")
    assert view.run("return getComputedStyle(document.getElementById('middle')).display") == "block", "no cross"
    first = view.picture()
    for keys in ([Keys.ARROW_LEFT] * 3, [Keys.ARROW_UP] * 2, ["+"] * 2, [Keys.SHIFT + Keys.ARROW_RIGHT + Keys.NULL]):
        before = view.picture()
        view.press(*keys)
        assert view.picture() != before, f"{keys} changed nothing"
    view.press("0")
    assert view.picture() == first, "0 is not the first view"
    view.press(Keys.ENTER)  # the hole of the torus, or its surface
    seen = view.run("return document.getElementById('readout').innerText")
    assert seen, "Enter read nothing"
    order = []
    for _ in range(8):
        view.press(Keys.TAB)
        order.append(view.run("return document.activeElement.id || document.activeElement.tagName.toLowerCase()"))
    wanted = ["spacing", "front", "play", "map", "shade", "reset"]
    assert order[:6] == wanted, order
    nameless = view.run("""return [...document.querySelectorAll("#panel input, #panel select, #panel button, canvas")].filter(
        (e) => !(e.getAttribute("aria-label") || (e.labels && e.labels.length) || e.textContent.trim())).map((e) => e.id)""")
    assert nameless == [], f"controls without a name: {nameless}"


def check_pick(view: browser.View, folder: pathlib.Path, read: list[dict], surface: list) -> None:
    """A click gives an option, and a run takes it."""
    place = read[len(read) // 2]
    view.click(*place["pixel"])
    option = view.run("return document.getElementById('seed').value")
    assert option.startswith("--seed "), option
    point = [float(x) for x in option.split()[1].split(",")]
    assert math.dist(point, [float(place[a]) for a in "xyz"]) < 1e-4
    consumers.geodesic(surface[0], surface[1], "--seed", option.split()[1], "-q", "-o", folder / "out.vdb")
    before = view.picture()
    view.drag((300, 300), (420, 330))
    assert view.picture() != before, "the mouse turned nothing"


def main() -> int:
    browser.need_browser()
    with consumers.temporary() as name:
        folder = pathlib.Path(name)
        need_viewer(folder)
        write_torus(folder / "torus.obj")
        surface = ["--mesh", folder / "torus.obj", "--seed", "1.4,0,0", "--voxel-size", "0.04"]
        consumers.geodesic(*surface, "--target", "-1.4,0,0", "-q", "-o", folder / "out.vdb", "--per-vertex",
                           folder / "v.csv", "--view", folder / "torus.html")
        with browser.View() as view:
            view.open(folder / "torus.html")
            assert view.run("return document.title") == "torus"
            assert view.run("return performance.getEntriesByType('resource').length") == 0, "the page asks for files"
            read = check_reading(view, folder, surface)
            check_vertices(read, folder)
            check_controls(view, folder)
            view.open(folder / "torus.html")
            check_keys(view)
            check_pick(view, folder, read, surface)
            assert view.complaints() == [], "the console complains"
            print(view.version())
    return 0


if __name__ == "__main__":
    sys.exit(main())
