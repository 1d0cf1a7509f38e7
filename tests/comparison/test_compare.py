"""What scripts/compare.py makes of runs: errors, tables, sentences. The runs themselves are the test
comparison/quick."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import compare  # noqa: E402
import compare_tables  # noqa: E402

INFINITY = float("inf")


def run(mean, cpu, peak=1e6, further=None):
    stage = {"wall": cpu, "cpu": cpu}
    return {"errors": {"mean": mean, "p99": 2 * mean, "max": 3 * mean}, "first": stage, "total": stage,
            **({"further": {"wall": further, "cpu": further}} if further else {}), "peakBytes": peak}


class Errors(unittest.TestCase):
    def test_they_are_in_percent_of_the_largest_distance(self):
        found = compare.errors([0, 1.1, 3.8], [0, 1, 4])
        self.assertAlmostEqual(found["mean"], (2.5 + 5) / 3)
        self.assertAlmostEqual(found["max"], 5)
        self.assertAlmostEqual(found["bias"], (2.5 - 5) / 3)

    def test_the_99th_percentile_leaves_one_in_a_hundred_out(self):
        found = compare.errors([1.0] * 199 + [2, 3], [1.0] * 201)
        self.assertEqual((found["p99"], found["max"]), (0, 200))

    def test_what_is_not_reached_is_counted_and_left_out(self):
        found = compare.errors([1, INFINITY, 2], [1, 1, INFINITY])
        self.assertEqual((found["samples"], found["unreached"], found["max"]), (1, 2, 0))


class Grading(unittest.TestCase):
    def grade(self, texts):
        asked = []

        def exact(files):
            for file in files:
                asked.append(pathlib.Path(file).name)
                pathlib.Path(f"{file}.exact").write_text(pathlib.Path(file).read_text())
        with tempfile.TemporaryDirectory() as folder:
            files = {name: pathlib.Path(folder) / name for name in texts}
            for name, text in texts.items():
                files[name].write_text(text)
            return compare.grade(files, exact), asked

    def test_methods_with_the_same_places_share_one_truth(self):
        places = "0,0,0,{}\n1,0,0,2\n2,0,0,4\n"
        graded, asked = self.grade({"a": places.format(0), "b": places.format(1),
                                    "c": "5,5,5,1\n6,6,6,2\n7,7,7,3\n"})
        self.assertEqual(asked, ["a", "c"])
        self.assertEqual([graded[name]["max"] for name in "abc"], [0, 25, 0])

    def test_other_places_are_refused(self):
        with self.assertRaisesRegex(RuntimeError, "other places"):
            self.grade({"a": "0,0,0,1\n1,0,0,1\n2,0,0,1\n3,0,0,1\n",
                        "b": "0,0,0,1\n1,0,0,1\n2,0,0,1\n4,0,0,1\n"})


class Words(unittest.TestCase):
    RESULTS = {"cases": {"sphere-100": {"jet": run(0.1, 1, 5e6, 1), "heat": run(0.2, 9, 9e6, 0.5),
                                        "exact": run(0.05, 90, 9e9)}}}

    def test_the_least_is_bold_as_it_is_shown(self):
        self.assertEqual(compare_tables.bold_least([1.04, None, 1.01, 2], lambda v: f"{v:.1f}"),
                         ["**1.0**", "-", "**1.0**", "2.0"])

    def test_titles(self):
        self.assertEqual(compare_tables.title("sphere-100"), "sphere, N = 100")
        self.assertEqual(compare_tables.title("cad-anchor-256-B"), "cad-anchor, 256, seed B")

    def test_every_measure_in_which_another_is_ahead_is_said(self):
        self.assertEqual(compare_tables.ahead_in_error(self.RESULTS).splitlines(), [
            "- *mean error*, exact on the mesh: sphere, N = 100 (0.050 against 0.10 %).",
            "- *99th percentile of the error*, exact on the mesh: sphere, N = 100 (0.10 against 0.20 %).",
            "- *largest error*, exact on the mesh: sphere, N = 100 (0.15 against 0.30 %)."])
        self.assertEqual(compare_tables.ahead_in_time(self.RESULTS).splitlines(), [
            "- *processor time of a further seed*, heat: sphere, N = 100 (0.50 against 1.0 s)."])

    def test_further_seeds_are_compared_with_values_at_points_too(self):
        case = {**self.RESULTS["cases"]["sphere-100"], "jet-points": run(0.1, 1, 5e6, 0.6)}
        results = {"cases": {"sphere-100": case}}
        self.assertIn("- *processor time of a further seed, against `jet` with values at 1,000 points*, heat: "
                      "sphere, N = 100 (0.50 against 0.60 s).", compare_tables.ahead_in_time(results).splitlines())
        *_, row = compare_tables.further(results).splitlines()
        self.assertEqual(row.split(" | ")[1:], ["1.0", *4 * "-", "**0.50**", *4 * "-", "90", "0.60 |"])
        self.assertNotIn("1,000", compare_tables.times(results))

    def test_a_table_has_a_dash_where_nothing_was_measured(self):
        rows = compare_tables.shape_errors(self.RESULTS).splitlines()
        self.assertIn("| heat | 0.20 / 0.40 / 0.60 |", rows)
        self.assertIn("| exact on the mesh | **0.050** / **0.10** / **0.15** |", rows)
        self.assertIn("| Dijkstra | - |", rows)


if __name__ == "__main__":
    unittest.main()
