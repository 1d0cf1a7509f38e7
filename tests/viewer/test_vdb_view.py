#!/usr/bin/env python3
"""What a person sees in OpenVDB's vdb_view: the surface with isolines and geodesics cut into it, and
the distances as colored voxels. On a display of its own, in software; screenshots go to IGEO_SHOTS.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/viewer/test_vdb_view.py [-v]

Exit code 77 where something is missing (scripts/setup.sh --viewer installs it).
"""
import os
import pathlib
import pty
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))
import images  # noqa: E402

PROGRAM = os.path.abspath(os.environ.get("IGEO_PROGRAM", ROOT / "build/release/bin/implicit-geodesic"))
SHOTS = os.environ.get("IGEO_SHOTS")
WIDTH, HEIGHT = 900, 800  # the window vdb_view opens
PATIENCE = 60  # seconds, for what takes one


class Screen:
    """An X server without a screen, whose picture is a file."""

    def __init__(self, folder):
        self.picture = os.path.join(folder, "Xvfb_screen0")
        number, told = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(told), "-screen", "0", f"{WIDTH}x{HEIGHT}x24",
             "-fbdir", folder, "-nolisten", "tcp", "-noreset"],
            pass_fds=[told], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(told)
        with os.fdopen(number) as file:
            self.name = ":" + file.readline().strip()
        if self.name == ":":
            raise RuntimeError("Xvfb does not start")
        self.environment = dict(os.environ, DISPLAY=self.name, LIBGL_ALWAYS_SOFTWARE="1")

    def close(self):
        self.server.terminate()
        self.server.wait()

    def xdotool(self, *words):
        done = subprocess.run(["xdotool", *words], env=self.environment, capture_output=True,
                              text=True, timeout=PATIENCE, check=False)
        return done.stdout.strip()

    def still(self):
        """The picture once it has stopped changing."""
        last = None
        for _ in range(int(PATIENCE / 0.3)):
            with open(self.picture, "rb") as file:
                now = file.read()
            if now == last:
                return images.read_framebuffer(self.picture)
            last = now
            time.sleep(0.3)
        raise AssertionError("the picture never comes to rest")


class Viewer:
    """vdb_view on one file; its views are off at the start."""

    def __init__(self, screen, file):
        self.screen = screen
        # A stdin that is no terminal would be read instead of the file.
        self.terminal, stdin = pty.openpty()
        self.process = subprocess.Popen(["vdb_view", file], env=screen.environment, stdin=stdin,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(stdin)
        self.title_with("(1 of ")
        screen.xdotool("mousemove", str(WIDTH // 2), str(HEIGHT // 2))
        self.press("1")  # the tree, shown at first
        self.press("i")  # text about the grid

    def title_with(self, words):
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            title = self.screen.xdotool("search", "--name", "vdb_view|of", "getwindowname")
            if words in title:
                return title
            if self.process.poll() is not None:
                raise AssertionError(f"vdb_view ended with {self.process.returncode}")
            time.sleep(0.1)
        raise AssertionError(f"no window says {words!r}, but {title!r}")

    def press(self, key):
        """Presses a key that changes the picture; the picture then."""
        before = self.screen.still()
        self.screen.xdotool("key", key)
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            after = self.screen.still()
            if after != before:
                return after
        raise AssertionError(f"key {key} changes nothing")

    def close(self):
        self.screen.xdotool("key", "Escape")
        code = self.process.wait(PATIENCE)
        os.close(self.terminal)
        return code


def drawn(picture, background):
    """Where two pictures differ: {(x, y): color}."""
    return {(x, y): p for y, row in enumerate(picture)
            for x, p in enumerate(row) if p != background[y][x]}


def gray(color):
    return sum(color) / 3


class WhatOneSees(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.desk = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.desk.cleanup)
        cls.screen = Screen(cls.desk.name)
        cls.addClassCleanup(cls.screen.close)

    def view(self, file):
        viewer = Viewer(self.screen, file)
        self.addCleanup(viewer.process.kill)
        return viewer

    def run_program(self, *options):
        out = os.path.join(self.desk.name, "out.vdb")
        subprocess.run([PROGRAM, "--sdf", f"{ROOT}/data/trefoil.vdb", "--seed", "0,-1.02,0",
                        "-q", "-o", out, *options], check=True)
        return out

    def shot(self, name, picture):
        if SHOTS:
            images.write_png(os.path.join(SHOTS, name + ".png"), picture)

    def surface(self, file, name):
        """The surface that vdb_view shows of a file's first grid: {(x, y): color}."""
        viewer = self.view(file)
        background = self.screen.still()
        picture = viewer.press("2")
        self.shot(name, picture)
        self.assertEqual(viewer.close(), 0)
        return drawn(picture, background)

    def test_grooves_on_the_surface(self):
        plain = self.surface(f"{ROOT}/data/trefoil.vdb", "plain")
        engraved = self.surface(self.run_program("--grids", "engraved"), "engraved")
        for seen in (plain, engraved):
            share = len(seen) / (WIDTH * HEIGHT)
            self.assertGreater(share, 0.1)
            self.assertLess(share, 0.5)
            self.assertGreater(len(set(seen.values())), 50)  # lit, not flat
        # Engraving only takes away: no pixel is new but where the mesh differs by less than one.
        self.assertLess(len(engraved.keys() - plain.keys()), 0.002 * len(plain))
        self.assertGreater(len(plain.keys() - engraved.keys()), 0.005 * len(plain))
        both = plain.keys() & engraved.keys()
        changed = sum(abs(gray(plain[at]) - gray(engraved[at])) > 10 for at in both) / len(both)
        print(f"engraved: {len(engraved)} of {len(plain)} pixels, {100 * changed:.0f} % shaded again,"
              f" {len(engraved.keys() - plain.keys())} new", file=sys.stderr)
        self.assertGreater(changed, 0.1)

    def test_distances_as_colors(self):
        viewer = self.view(self.run_program("--grids", "surface"))
        viewer.screen.xdotool("key", "Right")
        self.assertIn("psi_geodesic (2 of 2)", viewer.title_with("(2 of 2)"))
        background = self.screen.still()
        picture = viewer.press("3")
        self.shot("distance", picture)
        seen = drawn(picture, background)
        self.assertEqual(viewer.close(), 0)
        # vdb_view goes from blue at the least value to yellow at the largest.
        blue = sum(b > r + 30 for r, g, b in seen.values()) / len(seen)
        yellow = sum(r > b + 30 for r, g, b in seen.values()) / len(seen)
        print(f"distances: {len(seen)} pixels, {100 * blue:.0f} % blue, {100 * yellow:.0f} % yellow,"
              f" {len(set(seen.values()))} colors", file=sys.stderr)
        self.assertGreater(len(seen), 0.1 * WIDTH * HEIGHT)
        self.assertGreater(blue, 0.05)
        self.assertGreater(yellow, 0.05)
        self.assertGreater(len(set(seen.values())), 100)


if __name__ == "__main__":
    missing = [t for t in ("Xvfb", "xdotool", "vdb_view") if not shutil.which(t)]
    if missing:
        print(f"skipped: {', '.join(missing)} not found (scripts/setup.sh --viewer)")
        sys.exit(77)
    unittest.main()
