#!/usr/bin/env python3
"""Takes the pictures of docs/view.md: pages of --view in Chromium without a screen.

usage: scripts/view_pictures.py MODELS [PROGRAM]

MODELS is a folder with bunny.obj, bunny-scan.obj, bunny-points.xyz, knot.obj, brain-pial-left.ply and
cad-featuretype.stl (data/README.md says where such models are from). It writes docs/images/view/NAME.jpg and prints for
each page its size, the time to its first picture and the frames per second while it turns. It needs the packages
chromium, chromium-driver and python3-selenium, and vdb_tool for the level set of the bunny.
"""
import argparse
import base64
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests/consumers"))
import browser  # noqa: E402

QUALITY = 82  # of JPEG

# Of each picture the words of its run; M is the folder of models, D that of docs' data.
RUNS = {
    "bunny": "--sdf bunny.vdb --seed 0.5,0.35,0.25 --snap 1 --target -0.35,0.85,-0.2 --target -0.6,-0.4,0.2",
    "knot": "--mesh M/knot.obj --seed vertex:0 --target vertex:1600 --target vertex:900",
    "brain": "--mesh M/brain-pial-left.ply --seed vertex:1000 --unit mm --up z",
    "cad": "--mesh M/cad-featuretype.stl --seed 0,0,1 --snap 9 --up z",
    "scan": "--mesh M/bunny-scan.obj --seed vertex:100 --target vertex:20000",
    "points": "--points M/bunny-points.xyz --seed 0,0.1,0 --snap 1",
    "obstacles": "--sdf D/sphere.vdb --seed 0.3,0.4,0.87 --target -0.3,0.2,0.93 --target 0.9,-0.3,0.3 --obstacle-sphere 0,0.45,0.9,0.25 "
                 "--obstacle-sphere 0.75,0.1,0.7,0.2 --snap 0.1",
    "labels": "--sdf bunny.vdb --seed 0.5,0.35,0.25 --snap 1 --sample 14",
}
JOBS = ("sphere 0,0,1", "torus 1.4,0,0", "trefoil 0,-1.02,0", "box 0,0,0.5", "cylinder 0,0.5,0", "rounded_box 0,0,0.5")


def words(text: str, models: pathlib.Path) -> list[str]:
    places = {"M/": str(models.resolve()) + "/", "D/": str(ROOT / "data") + "/"}
    return [places.get(word[:2], word[:2]) + word[2:] for word in text.split()]


def make_pages(program: pathlib.Path, models: pathlib.Path, folder: pathlib.Path) -> None:
    subprocess.run(["vdb_tool", "-quiet", "-read", models.resolve() / "bunny.obj", "-mesh2ls", "dim=256", "width=3", "-write",
                    "bunny.vdb"], check=True, cwd=folder)
    for name, run in RUNS.items():
        subprocess.run([program, *words(run, models), "-q", "--view", f"{name}.html"], check=True, cwd=folder)
    jobs = [{"name": name, "sdf": str(ROOT / f"data/{name}.vdb"), "seed": seed, "snap": 1, "view": f"job-{name}.html"}
            for name, seed in map(str.split, JOBS)]
    (folder / "parts.json").write_text(json.dumps({"version": 2, "jobs": jobs}))
    subprocess.run([program, "batch", "parts.json", "-q", "--view", "batch.html"], check=True, cwd=folder)


def save(window: browser.Browser, name: str) -> None:
    shot = window.driver.execute_cdp_cmd("Page.captureScreenshot", {"format": "jpeg", "quality": QUALITY})
    file = ROOT / "docs/images/view" / f"{name}.jpg"
    file.parent.mkdir(exist_ok=True)
    file.write_bytes(base64.b64decode(shot["data"]))


def frames_per_second(window: browser.View) -> float:
    return window.driver.execute_async_script("""
        const done = arguments[0], canvas = document.getElementById("canvas"), begin = performance.now();
        const first = Number(canvas.dataset.frames);
        const step = () => {
            canvas.dispatchEvent(new KeyboardEvent("keydown", {key: "ArrowLeft"}));
            const seconds = (performance.now() - begin) / 1000;
            if (seconds < 3) requestAnimationFrame(step);
            else done((Number(canvas.dataset.frames) - first) / seconds);
        };
        requestAnimationFrame(step);""")


def take_pictures(folder: pathlib.Path) -> None:
    with browser.View() as window:
        window.size(960, 600)
        for name in RUNS:
            page = folder / f"{name}.html"
            window.open(page)
            if name == "labels":
                window.set("colorBy", "label")
            window.hover(330, 300)
            save(window, name)
            first = window.run("return performance.getEntriesByName('drawn')[0].startTime")
            print(f"{name}: {page.stat().st_size / 1e6:.2f} MB, first picture after {first / 1000:.2f} s, "
                  f"{frames_per_second(window):.0f} frames per second", flush=True)
        browser.Browser.open(window, folder / "batch.html")
        save(window, "batch")
        window.size(360, 640, phone=True)
        window.open(folder / "bunny.html")
        save(window, "phone")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", type=pathlib.Path, metavar="MODELS")
    parser.add_argument("program", nargs="?", default=ROOT / "build/release/bin/implicit-geodesic", metavar="PROGRAM")
    options = parser.parse_args()
    browser.need_browser()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        make_pages(pathlib.Path(options.program).resolve(), options.models, folder)
        take_pictures(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
