#!/usr/bin/env python3
"""The manual page, the bash completion and docs/cli.md say what --help says.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/cli/test_pages.py [-v]
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ.get("IGEO_PROGRAM", ROOT / "build/release/bin/implicit-geodesic")).resolve()
SHARE = PROGRAM.parents[1] / "share"  # where the build puts the pages
MAN = SHARE / "man/man1/implicit-geodesic.1"
COMPLETION = SHARE / "bash-completion/completions/implicit-geodesic"
COMMANDS = ("info", "batch", "batch merge")


def help_of(command):
    """Its options and what follows them."""
    said = subprocess.run([PROGRAM, *command.split(), "--help"], check=True, capture_output=True, text=True)
    return said.stdout.split("\nExit codes: ")


BODY, FOOTER = help_of("")

# {"--output": ("FILE.vdb", "Distances as a VDB file; ...")}, read in another way than make_pages.py.
def options_of(body):
    options = {}
    for names, argument, text in re.findall(
            r"^  (-\S+)((?: (?! )\S+)*)\s+(\S.*)$", body, re.MULTILINE):
        argument = re.sub(r" REQUIRED| (Needs|Excludes): .*| \.\.\.|:\{.*|:[A-Z]+ in \[.*", "", argument)
        options[names.split(",")[-1]] = (argument.strip(), text)
    return options


OPTIONS = options_of(BODY)
COMMAND_OPTIONS = {command: options_of(help_of(command)[0]) for command in COMMANDS}
INFO_OPTIONS = COMMAND_OPTIONS["info"]


class Help(unittest.TestCase):
    def test_is_understood(self):
        self.assertEqual(set(OPTIONS), set(re.findall(r"^  (?:-\w,)?(--[a-z-]+)", BODY, re.MULTILINE)))
        self.assertEqual(OPTIONS["--sdf"][0], "FILE[:GRID]")
        self.assertEqual(OPTIONS["--scheme"][0], "NAME")
        self.assertEqual(OPTIONS["--quiet"], ("", "Print errors only"))
        self.assertEqual(set(INFO_OPTIONS) - set(OPTIONS), {"--problems"})
        self.assertEqual(INFO_OPTIONS["--json"][0], "")
        self.assertEqual(set(COMMAND_OPTIONS["batch"]) - set(OPTIONS), {"--shard", "--summary", "--dry-run"})
        self.assertEqual(set(COMMAND_OPTIONS["batch merge"]), {"--output", "--matrix", "--help"})


class ManualPage(unittest.TestCase):
    def rendered(self, *options):
        if not shutil.which("groff"):
            self.skipTest("groff not found (Debian: groff-base)")
        done = subprocess.run(["groff", "-man", "-ww", "-Tascii", "-P-cbou", *options, str(MAN)],
                              check=True, capture_output=True, text=True)
        self.assertEqual(done.stderr, "")
        return done.stdout

    def test_troff_has_nothing_to_say_against_it(self):
        text = self.rendered()
        for title in ("NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "INFO", "BATCH", "BATCH MERGE", "EXIT STATUS", "EXAMPLES"):
            self.assertRegex(text, rf"(?m)^{title}$")

    def test_holds_the_help_word_by_word(self):
        text = " ".join(self.rendered("-rHY=0", "-rLL=1000n", "-dAD=l").split())
        for options in (OPTIONS, *COMMAND_OPTIONS.values()):
            for name, (argument, meaning) in options.items():
                self.assertIn(f"{name} {argument} {meaning}." if argument else f"{name} {meaning}.", text)
        footers = "".join(help_of(command)[1] for command in COMMANDS)
        for line in (FOOTER + footers).splitlines():
            if line.startswith("  implicit-geodesic "):
                self.assertIn(line.strip(), text)
        for code in re.findall(r"(\d+) [a-z]", FOOTER.split("\n\n")[0]):
            self.assertRegex(text, rf"EXIT STATUS.* {code} .*ENVIRONMENT")
        # And nothing else.
        self.assertLessEqual(set(re.findall(r"--[a-z][a-z-]*", text)),
                             set(OPTIONS).union(*COMMAND_OPTIONS.values()))


class OptionsPage(unittest.TestCase):
    """docs/cli.md, whose table has a row for every option: | `-o`, `--output FILE.vdb` | ... |"""
    maxDiff = None

    def setUp(self):
        page = (ROOT / "docs/cli.md").read_text(encoding="utf-8")
        sections = dict(re.findall(r"(?ms)^##+ ([^\n]*)\n(.*?)(?=^##+ |\Z)", page))
        self.rows = self.rows_of(page.partition("\n## ")[0])
        self.command_rows = {command: self.rows_of(sections[command]) for command in COMMANDS}

    def rows_of(self, text):
        rows = {}
        for line in text.splitlines():
            if not line.startswith("| `-"):
                continue
            cells = [cell.replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
            for names in re.findall(r"`(-[^`]*)`", cells[0]):
                name, _, argument = names.partition(" ")
                if name.startswith("--"):
                    rows[name] = (argument, cells[2])
        return rows

    def test_options_and_arguments(self):
        self.assertEqual({name: argument for name, (argument, _) in self.rows.items()},
                         {name: argument for name, (argument, _) in OPTIONS.items()})
        # What works as in the main job has no row of its own.
        for command, options in COMMAND_OPTIONS.items():
            self.assertEqual({name: argument for name, (argument, _) in self.command_rows[command].items()},
                             {name: argument for name, (argument, text) in options.items()
                              if OPTIONS.get(name) != (argument, text)}, command)

    def test_defaults(self):
        checked = 0
        for name, (_, text) in OPTIONS.items():
            default = re.search(r"\[([\w.=,]+)\]$", text)  # of one word
            if default:
                self.assertIn(default[1], self.rows[name][1].replace(", ", ","), name)
                checked += 1
        self.assertGreater(checked, 5)


class Completion(unittest.TestCase):
    def setUp(self):
        self.desk = tempfile.TemporaryDirectory()
        self.addCleanup(self.desk.cleanup)
        for name in ("a.vdb", "b c.vdb", "seeds.csv", "seeds.json", "model.obj", "notes.txt"):
            pathlib.Path(self.desk.name, name).touch()
        pathlib.Path(self.desk.name, "models").mkdir()

    def after(self, *words):
        """What Tab offers in place of the last word."""
        script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
                  '_implicit_geodesic; [[ ${#COMPREPLY[@]} -eq 0 ]] || printf "%s\\n" "${COMPREPLY[@]}"')
        done = subprocess.run(["bash", "-uc", script, "bash", str(COMPLETION), "implicit-geodesic", *words],
                              cwd=self.desk.name, capture_output=True, text=True, check=True)
        self.assertEqual(done.stderr, "")
        return sorted(done.stdout.splitlines())

    def test_bash_knows_it(self):
        done = subprocess.run(["bash", "-c", f"source '{COMPLETION}'; complete -p implicit-geodesic"],
                              capture_output=True, text=True, check=True)
        self.assertIn("-F _implicit_geodesic implicit-geodesic", done.stdout)

    def test_options(self):
        self.assertEqual([w for w in self.after("-") if w.startswith("--")], sorted(OPTIONS))
        self.assertIn("-o", self.after("-"))
        self.assertEqual(self.after("--straighten", "--prog"), ["--progress"])
        self.assertEqual(self.after("--straighten", "--seed"),
                         sorted(name for name in OPTIONS if name.startswith("--seed")))

    def test_files_by_their_ending(self):
        self.assertEqual(self.after("--sdf", ""), ["a.vdb", "b c.vdb", "models"])
        self.assertEqual(self.after("--sdf", "b"), ["b c.vdb"])
        self.assertEqual(self.after("--sdf", "=", "a"), ["a.vdb"])
        self.assertEqual(self.after("--sdf", "="), ["a.vdb", "b c.vdb", "models"])
        self.assertEqual(self.after("--sdf", "a.vdb", ":", "p"), [])
        self.assertEqual(self.after("-o", "a"), ["a.vdb"])
        self.assertEqual(self.after("--weight", "a"), ["a.vdb"])
        self.assertEqual(self.after("--seeds", "s"), ["seeds.csv", "seeds.json"])
        self.assertEqual(self.after("--paths", "m"), ["model.obj", "models"])
        self.assertEqual(self.after("--image", ""), ["models"])
        self.assertIn("notes.txt", self.after("--json", ""))

    def test_subcommand(self):
        self.assertEqual(self.after("in"), ["info"])
        self.assertEqual(self.after("--straighten", "in"), [])
        self.assertEqual(self.after("info", ""), ["a.vdb", "b c.vdb", "models"])
        self.assertEqual(self.after("info", "a.vdb", "--p"), ["--problems", "--progress"])
        self.assertEqual(self.after("info", "--problems", "a"), ["a.vdb"])
        self.assertEqual(self.after("info", "--json", "b"), ["b c.vdb"])
        self.assertEqual(self.after("info", "--progress", "n"), ["never"])

    def test_subcommand_of_a_subcommand(self):
        self.assertEqual(self.after("ba"), ["batch"])
        self.assertEqual(self.after("batch", ""), ["models", "seeds.json"])
        self.assertEqual(self.after("batch", "m"), ["merge"])
        self.assertEqual(self.after("batch", "seeds.json", "--s"), ["--shard", "--summary"])
        self.assertEqual(self.after("batch", "seeds.json", "--shard", ""), [])
        self.assertEqual(self.after("batch", "merge", "s"), ["seeds.json"])
        self.assertEqual(self.after("batch", "merge", "seeds.json", "--"), ["--help", "--matrix", "--output"])

    def test_values(self):
        self.assertEqual(self.after("--scheme", ""), ["godunov", "jet"])
        self.assertEqual(self.after("--scheme", "=", "g"), ["godunov"])
        self.assertEqual(self.after("--space", "i"), ["index"])
        self.assertEqual(self.after("--progress", ""), ["always", "auto", "never"])
        self.assertEqual(self.after("--color-map", "l"), ["lagoon"])
        self.assertEqual(self.after("--metric-curvature", ""), ["avoid", "prefer"])
        self.assertEqual(self.after("--with", "lo"), ["logmap"])
        self.assertEqual(self.after("--with", "surface,c"), ["surface,color", "surface,curvature"])
        self.assertEqual(self.after("--seed", ""), [])

    def test_values_are_those_the_program_takes(self):
        for option in ("--scheme", "--space", "--up", "--color-map", "--progress", "--with"):
            for value in self.after(option, ""):
                # Refused, but for another reason.
                done = subprocess.run([PROGRAM, "--sdf", "none.vdb", "--seed", "0,0,0", option, value],
                                      capture_output=True, text=True, check=False)
                self.assertIn("none.vdb", done.stderr)


if __name__ == "__main__":
    if not MAN.exists():
        print(f"skipped: no {MAN}")
        sys.exit(77)
    unittest.main()
