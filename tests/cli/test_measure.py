"""What the measuring scripts share (scripts/measure.py): processes, tables, documents, claims; and how
they close a mesh (scripts/mesh_tool.py)."""
import json
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import measure  # noqa: E402
import mesh_tool  # noqa: E402

DOCUMENT = """before
<!-- errors: begin (made by scripts/x.py) -->
old
<!-- errors: end -->
after
"""


class Processes(unittest.TestCase):
    def test_a_run_has_what_the_process_printed_and_took(self):
        # Works on 64 MiB for a fifth of a second of its own processor.
        script = ("import sys, time\nx = bytearray(b'1') * 2**26\n"
                  "while time.process_time() < 0.2: pass\n"
                  "print(sys.stdin.read()); print('e', file=sys.stderr); sys.exit(3)")
        done = measure.run([sys.executable, "-c", script], expect=(3,), stdin="in")
        self.assertEqual((done.stdout, done.stderr, done.code), ("in\n", "e\n", 3))
        self.assertGreaterEqual(done.cpu, 0.2)
        self.assertGreaterEqual(done.wall, 0.15)
        self.assertGreaterEqual(done.peak, 2 ** 26)

    def test_a_failure_names_the_command_and_its_words(self):
        with self.assertRaisesRegex(RuntimeError, r"(?s)exit code 2 of sh -c .*oh no"):
            measure.run(["sh", "-c", "echo oh no >&2; exit 2"])

    def test_a_signal_is_a_negative_code(self):
        self.assertEqual(measure.run(["sh", "-c", "kill -9 $$"], expect=(-9,)).code, -9)


class Tables(unittest.TestCase):
    def test_numbers_keep_their_digits(self):
        shown = [measure.number(x) for x in (0.000734, 9.996, 123.4, 56789, 0, None, -0.5)]
        self.assertEqual(shown, ["0.000734", "10.0", "123", "56789", "0", "-", "-0.500"])

    def test_a_table_is_markdown(self):
        self.assertEqual(measure.table(["a", "b"], [["x", 1]]), "| a | b |\n| --- | ---: |\n| x | 1 |")
        with self.assertRaises(ValueError):
            measure.table(["a", "b"], [["x"]])


class Documents(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = pathlib.Path(folder.name) / "page.md"
        self.file.write_text(DOCUMENT)

    def test_what_stands_between_the_marks_is_replaced(self):
        measure.rewrite(self.file, "errors", r"new \1")
        self.assertEqual(self.file.read_text(), DOCUMENT.replace("old", r"new \1"))

    def test_an_unchanged_document_is_left_alone(self):
        before = self.file.stat()
        measure.rewrite(self.file, "errors", "old")
        self.assertEqual(self.file.stat().st_ino, before.st_ino)
        self.assertEqual(list(self.file.parent.iterdir()), [self.file])

    def test_missing_and_doubled_marks_are_refused(self):
        with self.assertRaisesRegex(ValueError, "0 times"):
            measure.rewrite(self.file, "times", "new")
        self.file.write_text(DOCUMENT * 2)
        with self.assertRaisesRegex(ValueError, "2 times"):
            measure.rewrite(self.file, "errors", "new")


class Claims(unittest.TestCase):
    CLAIM = {"id": "x", "says": "It is\nfast.", "where": "", "command": "scripts/x.py",
             "figure": "march.seconds", "at most": 2}

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.page = pathlib.Path(folder.name) / "page.md"
        self.page.write_text("So: It is fast. Indeed.")

    def verdict(self, results, **changes):
        return measure.judge({**self.CLAIM, "where": str(self.page), **changes}, results)[0]

    def test_a_bound_is_held_against_the_figure(self):
        self.assertIs(self.verdict({"march": {"seconds": 2}}), True)
        self.assertIs(self.verdict({"march": {"seconds": 2.1}}), False)
        self.assertIs(self.verdict({"march": {"seconds": 2.1}}, **{"at most": 3, "at least": 2}), True)

    def test_what_was_not_measured_is_neither(self):
        self.assertIsNone(self.verdict({"march": {}}))
        self.assertIsNone(self.verdict({"march": 3}))

    def test_a_sentence_that_does_not_stand_there_fails(self):
        self.assertIs(self.verdict({"march": {"seconds": 1}}, says="It is slow."), False)

    def test_the_claims_of_this_repository_stand_where_they_say(self):
        for claim in json.loads(measure.CLAIMS.read_text()):
            with self.subTest(claim["id"]):
                self.assertIsNone(measure.judge(claim, {})[0], measure.judge(claim, {})[1])
                self.assertTrue((measure.ROOT / claim["command"].split()[0]).is_file())
                self.assertTrue({"at most", "at least"} & set(claim))


class Holes(unittest.TestCase):
    def test_a_tube_of_faces_with_vertices_of_their_own_gets_two_caps(self):
        corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
        with tempfile.TemporaryDirectory() as folder:
            tube, closed = f"{folder}/tube.obj", f"{folder}/closed.obj"
            with open(tube, "w") as file:
                for (a, b), (c, d) in zip(corners, corners[1:] + corners[:1]):
                    file.write("".join(f"v {x} {y} {z}\n" for x, y, z in
                                       ((a, b, 0), (c, d, 0), (c, d, 3), (a, b, 3))))
                    file.write("f -4 -3 -2 -1\n")
            mesh_tool.close(tube, closed)
            vertices, faces = mesh_tool.read_obj(closed)
        self.assertEqual(sorted(vertices)[4:6], [(0.5, 0.5, 0), (0.5, 0.5, 3)])
        self.assertEqual((len(vertices), len(faces)), (10, 4 + 2 * 4))
        edges = [edge for face in faces for edge in zip(face, face[1:] + face[:1])]
        self.assertEqual(len(edges), len(set(edges)))
        self.assertEqual(set(edges), {(b, a) for a, b in edges})


class Machine(unittest.TestCase):
    def test_it_is_one_line_without_names_of_folders(self):
        line = measure.machine()
        self.assertNotIn("\n", line)
        self.assertNotIn("/home", line)
        self.assertNotIn(str(measure.ROOT), line)


if __name__ == "__main__":
    unittest.main()
