#!/usr/bin/env python3
"""Pages in Chromium where something is missing or other: no WebGL, no reach, names with markup, a phone, cells,
obstacles, the page of a batch, and that of info.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/consumers/test_chromium_pages.py

Exit code 77 where Chromium or Selenium is missing, and where the program was built without three.js.
"""
import json
import math
import pathlib
import sys

import browser
import consumers
from surfaces import write_torus
from test_chromium_view import need_viewer

SPHERE = consumers.DATA / "sphere.vdb"
MARKUP = "<script>document.title = 'caught'<!--"


def check_sphere(view: browser.View, folder: pathlib.Path) -> None:
    """On a level set distances are the exact ones, within the error of its voxels and of what a page packs."""
    consumers.geodesic(SPHERE, "--seed", "0,0,1", "-q", "-o", folder / "out.vdb", "--view", folder / "sphere.html")
    view.open(folder / "sphere.html")
    off = count = 0
    for x, y in ((340, 310), (300, 200), (420, 400), (260, 330), (450, 250)):
        read = view.hover(x, y)
        point = [float(read[axis]) for axis in "xyz"]
        assert abs(math.hypot(*point) - 1) < 2e-3, point  # 1.5e-3: a triangle of 0.05 lies so far inside
        off = max(off, abs(float(read["distance"]) - math.acos(point[2] / math.hypot(*point))))
        voxel = [int(c) for c in read["voxel"].split()]
        assert all(abs(0.05 * (v - 32) - c) <= 0.026 for v, c in zip(voxel, point)), read
        count += 1
    print(f"sphere: {count} places within {off / math.pi:.1e} of the largest distance")
    assert off < 1e-3 * math.pi, off


def check_names(view: browser.View, folder: pathlib.Path) -> None:
    mesh = folder / f"{MARKUP}.obj"
    write_torus(mesh)
    (folder / "groups.json").write_text(json.dumps({"groups": {MARKUP: [[1.4, 0, 0]], "B & C": [[-1.4, 0, 0]]}}))
    consumers.geodesic("--mesh", mesh, "--seeds", folder / "groups.json", "--voxel-size", "0.08", "-q", "-o",
                       folder / "out.vdb", "--view", folder / "names.html")
    view.open(folder / "names.html")
    assert view.run("return document.title") == MARKUP
    assert view.text("panel").startswith(MARKUP)
    view.set("colorBy", "label")
    names = [f"group '{name}'" for name in (MARKUP, "B & C")]
    assert view.text("swatches").split("\n") == names, view.text("swatches")
    seen = {view.hover(x, 310).get("seed") for x in range(60, 680, 40)}
    assert set(names) <= seen, seen


def check_unreached(view: browser.View, folder: pathlib.Path) -> None:
    two = consumers.DATA / "two_spheres.vdb"
    consumers.geodesic(two, "--seed", "-1.2,0,0", "--obstacle-sphere", "-0.7,0.5,0,0.2", "-q", "-o",
                       folder / "out.vdb", "--view", folder / "two.html")
    view.open(folder / "two.html")
    swatches = view.text("swatches")
    assert "not reached, 5" in swatches and "in an obstacle, 2." in swatches, swatches
    said = {view.hover(x, y).get("distance") for x in range(40, 680, 60) for y in range(160, 460, 60)}
    assert "not reached" in said, said
    consumers.geodesic(SPHERE, "--shoot", "0,0,1,1,0,0,1", "-q", "--view", folder / "none.html")
    view.open(folder / "none.html")
    assert "No part of the surface has a distance" in view.text("facts"), view.text("facts")
    assert view.run("return document.getElementById('front').disabled")


def check_phone(view: browser.View, folder: pathlib.Path) -> None:
    view.size(390, 780, phone=True)
    view.open(folder / "sphere.html")
    box = view.run("const r = document.getElementById('canvas').getBoundingClientRect(); return [r.width, r.height]")
    assert box[0] == 390 and 300 < box[1] < 600, box
    assert view.run("return document.documentElement.scrollWidth") == 390, "the page is wider than the phone"
    before = view.run("return document.getElementById('canvas').dataset.frames")
    touch = view.driver.execute_cdp_cmd
    for kind, x in (("touchStart", 120), ("touchMove", 180), ("touchMove", 260), ("touchEnd", None)):
        points = [] if x is None else [{"x": x, "y": 240}]
        touch("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    view.settle()
    assert view.run("return document.getElementById('canvas').dataset.frames") != before, "a finger turned nothing"
    for kind, points in (("touchStart", [{"x": 195, "y": 240}]), ("touchEnd", [])):
        touch("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    view.settle()
    assert view.run("return document.getElementById('seed').value").startswith("--seed "), "a tap keeps a point"
    view.size(1000, 620)


def check_batch(view: browser.View, folder: pathlib.Path) -> None:
    jobs = [{"name": "one & <two>", "sdf": str(SPHERE), "seed": "0,0,1", "output": "one.vdb", "view": "one #1.html"},
            {"name": "failing", "sdf": str(SPHERE), "seed": "0,0,9", "output": "two.vdb", "view": "two.html"}]
    (folder / "jobs.json").write_text(json.dumps({"version": 2, "jobs": jobs}))
    consumers.geodesic("batch", folder / "jobs.json", "-q", "--view", folder / "index.html", code=2)
    browser.Browser.open(view, folder / "index.html")
    assert view.run("return document.querySelectorAll('li').length") == 2
    assert view.run("return document.querySelector('li img').naturalWidth") > 100, "no picture of the job"
    assert "one & <two>" in view.run("return document.body.innerText")
    assert "1 done, 1 failed" in view.run("return document.body.innerText")
    view.run("document.querySelector('li a').click()")
    view.wait("return performance.getEntriesByName('drawn').length > 0", "the page of the job")


def check_info(view: browser.View, folder: pathlib.Path) -> None:
    consumers.geodesic("info", consumers.DATA / "box.vdb", "--unreliable", folder / "box.html", "-q")
    view.open(folder / "box.html")
    assert "usable with care" in view.text("notes")
    assert "reliable, 9" in view.text("swatches"), view.text("swatches")
    assert view.run("return document.getElementById('front').offsetParent === null"), "no front passes over it"
    middle = view.hover(340, 310)
    assert middle["factor"] == "reliable", middle


def check_without_webgl(folder: pathlib.Path) -> None:
    with browser.Browser("--disable-3d-apis") as page:
        page.open(folder / "sphere.html")
        words = page.wait("const m = document.getElementById('message').textContent; return m.includes('WebGL') && m",
                          "words on WebGL")
        assert "picture" in words, words
        assert page.run("return document.getElementById('still').getBoundingClientRect().width") > 200
        assert page.run("return document.getElementById('facts').textContent").startswith("distance from 0 to 3.1")


def main() -> int:
    browser.need_browser()
    with consumers.temporary() as name:
        folder = pathlib.Path(name)
        need_viewer(folder)
        with browser.View() as view:
            for check in (check_sphere, check_names, check_unreached, check_phone, check_batch, check_info):
                check(view, folder)
                assert view.complaints() == [], f"the console complains after {check.__name__}"
        check_without_webgl(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
