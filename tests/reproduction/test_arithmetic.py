"""The arithmetic of scripts/reproduce.py, where the answer is known."""
import math
import pathlib
import struct
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from reproduction import bench, figures, tables  # noqa: E402


class Arithmetic(unittest.TestCase):
    def test_the_way_through_a_band(self):
        # No band: around. All of the ball: straight through it.
        self.assertAlmostEqual(tables.shortcut(0, radius=2), 0)
        self.assertAlmostEqual(tables.shortcut(2, radius=2), 2 * math.pi - 4)
        # pi h - O(h^1.5) in narrow ones.
        self.assertAlmostEqual(tables.shortcut(1e-8, radius=1) / 1e-8, math.pi, places=3)

    def test_the_slope_of_a_power(self):
        self.assertAlmostEqual(bench.slope((x, 3 * x ** 0.7) for x in (1, 2, 5, 7)), 0.7)

    def test_distances_to_segments(self):
        ends = (0, 0, 0), (2, 0, 0)
        for point, distance in (((1, 1, 0), 1), ((-3, 4, 0), 5), ((2, 0, 2), 2)):
            self.assertAlmostEqual(figures.to_segment(point, *ends), distance)
        self.assertAlmostEqual(figures.to_segment((0, 3, 4), (0, 0, 0), (0, 0, 0)), 5)

    def test_how_far_paths_are_apart(self):
        def along(*points):
            return {"vertices": {"position": points}}
        straight = along((0, 0, 0), (4, 0, 0))
        self.assertAlmostEqual(figures.farthest(along((0, 0, 0), (1, 0.5, 0), (4, 0, 0)), straight), 0.5)

    def test_near_in_space_and_far_along(self):
        values = [(0.1, 0, 0, 1), (0.2, 0, 0, 1.1), (0.3, 0, 0, 7), (5, 0, 0, 9)]
        along, apart = figures.near_and_far(values, 1)
        self.assertAlmostEqual(along, 6)
        self.assertAlmostEqual(apart, 0.2)

    def test_crosses_keep_to_the_sphere(self):
        points = figures.crosses_on_sphere(20, 0.01)
        self.assertEqual(len(points), 80)
        for k in range(0, 80, 4):
            for a, b in ((k, k + 1), (k + 2, k + 3)):
                sine = math.dist(points[a], points[b]) / 2 / bench.RADIUS
                self.assertAlmostEqual(math.asin(sine) * bench.RADIUS, 0.01)
            self.assertAlmostEqual(bench.dot(bench.difference(points[k], points[k + 1]),
                                             bench.difference(points[k + 2], points[k + 3])), 0)
        for point in points:
            self.assertAlmostEqual(math.dist(point, bench.MIDDLE), bench.RADIUS)

    def test_the_largest_error_of_a_mesh(self):
        # At the seed, a quarter and half around; the second is off by 0.03.
        on = [bench.on_sphere(v) for v in ((0, 0, 1), (1, 0, 0), (0, 0, -1))]
        distances = [0, bench.RADIUS * math.pi / 2 + 0.03, bench.RADIUS * math.pi]
        with tempfile.TemporaryDirectory() as folder:
            ply = pathlib.Path(folder) / "x.ply"
            rows = b"".join(struct.pack("<6f3Bfi", *p, 0, 0, 0, 0, 0, 0, d, 0)
                            for p, d in zip(on, distances))
            names = ("float x", "float y", "float z", "float nx", "float ny", "float nz", "uchar red", "uchar green",
                     "uchar blue", "float distance", "int label")
            properties = "".join(f"property {name}\n" for name in names).encode()
            ply.write_bytes(b"ply\nelement vertex 3\n" + properties + b"end_header\n" + rows)
            self.assertAlmostEqual(tables.largest_error(ply, on[0], bench.RADIUS), 0.03, places=6)


if __name__ == "__main__":
    unittest.main()
