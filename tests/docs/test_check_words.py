"""scripts/check_words.py finds the words that it lists, in text and not in code."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "check_words.py"
sys.path.insert(0, str(SCRIPT.parent))
import check_words  # noqa: E402


def found(text, suffix=".md"):
    return [(line, words) for line, words, _ in check_words.findings(text, suffix)]


class Pages(unittest.TestCase):
    def test_words_are_found_in_any_case_and_over_line_breaks(self):
        self.assertEqual(found("The shortest Way.\nIt is held\nagainst the colours."),
                         [(1, "Way"), (2, "held against"), (3, "colours")])
        self.assertEqual(found("He normalises behaviour, a visualisation."),
                         [(1, "normalises"), (1, "behaviour"), (1, "visualisation")])

    def test_idioms_and_parts_of_words_are_no_findings(self):
        self.assertEqual(found("Either way it goes the other way round, by a one-way street, always."), [])
        self.assertEqual(found("It stands for a room-temperature exercise: otherwise concise, precise, clockwise."), [])

    def test_code_comments_and_links_are_no_findings(self):
        self.assertEqual(found("`way`, [x](a/way.md), <!-- told -->\n```text\nnobody\n```\nhttps://a.b/way/x\n"), [])
        self.assertEqual(found("```text\nnobody\n```\nnobody\n"), [(4, "nobody")])


class Sources(unittest.TestCase):
    def test_of_cpp_comments_and_strings_are_read(self):
        source = 'double way = 1;  // no way\nthrow Error("told\\"", R"(a room)");\n/* dear */ char c = \'"\'; int room;\n'
        self.assertEqual(found(source, ".cpp"), [(1, "way"), (2, "told"), (2, "room"), (3, "dear")])

    def test_a_phrase_is_found_over_two_lines_of_a_comment(self):
        self.assertEqual(found("/// It is held\n/// against it, `way`.\n", ".h"), [(1, "held against")])

    def test_of_python_comments_and_strings_are_read(self):
        self.assertEqual(found('way = 1  # a way\n"""No\nroom."""\n', ".py"), [(1, "way"), (3, "room")])


class Program(unittest.TestCase):
    def run_on(self, *paths):
        return subprocess.run([sys.executable, SCRIPT, *paths], capture_output=True, text=True)

    def test_findings_and_missing_files_have_exit_codes(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "page.md"
            page.write_text("One.\nNobody.\n")
            done = self.run_on(folder)
            self.assertEqual((done.returncode, done.stdout.splitlines()[0]),
                             (1, f"{page}:2: Nobody: no user, nothing"))
            page.write_text("One.\n")
            self.assertEqual((self.run_on(page).returncode, self.run_on(page).stdout), (0, ""))
            self.assertEqual(self.run_on(page.with_name("none.md")).returncode, 2)


if __name__ == "__main__":
    unittest.main()
