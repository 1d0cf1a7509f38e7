#!/usr/bin/env python3
"""The manual page, the completions and docs/cli.md say what --help says.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/cli/test_pages.py [-v] [CLASS...]
"""
import json
import os
import pathlib
import pty
import re
import select
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ.get("IGEO_PROGRAM", ROOT / "build/release/bin/implicit-geodesic")).resolve()
SHARE = PROGRAM.parents[1] / "share"  # where the build puts the pages
MAN = SHARE / "man/man1/implicit-geodesic.1"
BASH = SHARE / "bash-completion/completions/implicit-geodesic"
ZSH = SHARE / "zsh/site-functions/_implicit-geodesic"
FISH = SHARE / "fish/vendor_completions.d/implicit-geodesic.fish"
COMMANDS = ("info", "batch", "batch merge")


def said(*words):
    return subprocess.run([PROGRAM, *words], check=True, capture_output=True, text=True).stdout


def help_of(command):
    """Its options and what follows them."""
    return said(*command.split(), "--help").split("\nExit codes:\n")


def options_of(body):
    """{"--output": ("FILE.vdb", "Distances as a VDB file; ...")}, read in another way than make_pages.py."""
    options = {}
    for names, argument, text in re.findall(r"^  (-[\w-]+(?:, --[\w-]+)?)(?: (\S+))? {2,}(\S.*)$",
                                            body.replace("\n" + " " * 28, "  "), re.MULTILINE):
        text = re.sub(r" \(((above|at least) 0(?=[;)])|needs|not with|\d+ to \d+)[^()]*\)$", "", " ".join(text.split()))
        options[names.split(", ")[-1]] = (argument, text)
    return options


BODY, FOOTER = help_of("")
OPTIONS = options_of(BODY)
COMMAND_OPTIONS = {command: options_of(help_of(command)[0]) for command in COMMANDS}
INFO_OPTIONS = COMMAND_OPTIONS["info"]


class Help(unittest.TestCase):
    def test_is_understood(self):
        self.assertEqual(set(OPTIONS), set(re.findall(r"^  (?:-\w, )?(--[a-z-]+)", BODY, re.MULTILINE)))
        self.assertEqual(OPTIONS["--sdf"][0], "FILE[:GRID]")
        self.assertEqual(OPTIONS["--scheme"][0], "NAME")
        self.assertEqual(OPTIONS["--quiet"], ("", "Print errors only"))
        self.assertEqual(set(INFO_OPTIONS) - set(OPTIONS), {"--json", "--unreliable"})
        self.assertEqual(INFO_OPTIONS["--json"][0], "")
        self.assertEqual(set(COMMAND_OPTIONS["batch"]) - set(OPTIONS), {"--shard", "--summary", "--log", "--dry-run"})
        self.assertEqual(set(COMMAND_OPTIONS["batch merge"]), {"--output", "--matrix", "--help"})

    def test_is_as_wide_as_a_terminal(self):
        for command in ("", *COMMANDS):
            body, footer = help_of(command)
            for line in (body + footer.partition("\nExamples:")[0]).splitlines():
                self.assertLessEqual(len(line), 80, line)


class Dump(unittest.TestCase):
    """The options as JSON, which the pages are made from."""

    def setUp(self):
        self.program = json.loads(said("--dump-options"))
        self.options = {option["names"][-1]: option for option in self.program["options"]}

    def test_has_what_the_help_has(self):
        self.assertEqual({name: (option["value"], option["text"]) for name, option in self.options.items()}, OPTIONS)
        self.assertEqual([command["name"] for command in self.program["commands"]],
                         ["implicit-geodesic info", "implicit-geodesic batch"])
        self.assertNotIn("--dump-options", BODY)

    def test_has_values_and_relations(self):
        self.assertEqual(self.options["--order"]["range"], "1 to 2")
        self.assertEqual(self.options["--band"]["range"], "above 0")
        self.assertEqual(self.options["--scheme"]["choices"], ["jet", "godunov"])
        self.assertEqual(self.options["--metric-curvature"]["choices"], ["avoid", "prefer"])
        self.assertEqual(self.options["--grids"]["separator"], ",")
        self.assertEqual(self.options["--spacing"]["excludes"], ["--levels"])
        self.assertEqual(self.options["--levels"]["excludes"], ["--spacing"])
        self.assertTrue(self.options["--seed"]["repeatable"])
        self.assertFalse(self.options["--output"]["repeatable"])

    def test_choices_are_in_the_text(self):
        for name, option in self.options.items():
            for choice in option["choices"]:
                self.assertRegex(option["text"], rf"\b{choice}\b", name)


class Build(unittest.TestCase):
    def test_goes_on_without_pages(self):
        if not shutil.which("cmake"):
            self.skipTest("cmake not found")
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run(["cmake", "-D", f"python={sys.executable}", "-D", f"program={folder}/none",
                                   "-D", f"script={ROOT}/scripts/make_pages.py", "-D", f"folder={folder}",
                                   "-P", str(ROOT / "apps/make_pages.cmake")],
                                  capture_output=True, text=True, check=True)
            self.assertIn("CMake Warning", done.stderr)
            self.assertIn("none", done.stderr)
            self.assertEqual(os.listdir(folder), [])


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
        codes = re.findall(r"(?m)^  (\d+) +(.*)$", FOOTER)
        self.assertEqual([code for code, _ in codes], ["0", "1", "2", "3", "4", "130"])
        for code, meaning in codes:
            self.assertRegex(text, rf"EXIT STATUS.* {code} {meaning} .*EXAMPLES")
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
        for name in ("a.vdb", "b c.vdb", "seeds.csv", "seeds.json", "model.obj", "notes.md"):
            pathlib.Path(self.desk.name, name).touch()
        pathlib.Path(self.desk.name, "models").mkdir()


class BashCompletion(Completion):
    def after(self, *words):
        """What Tab offers in place of the last word."""
        script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
                  '_implicit_geodesic; [[ ${#COMPREPLY[@]} -eq 0 ]] || printf "%s\\n" "${COMPREPLY[@]}"')
        done = subprocess.run(["bash", "-uc", script, "bash", str(BASH), "implicit-geodesic", *words],
                              cwd=self.desk.name, capture_output=True, text=True, check=True)
        self.assertEqual(done.stderr, "")
        return sorted(done.stdout.splitlines())

    def test_bash_knows_it(self):
        done = subprocess.run(["bash", "-c", f"source '{BASH}'; complete -p implicit-geodesic"],
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
        self.assertIn("notes.md", self.after("--report", ""))

    def test_subcommand(self):
        self.assertEqual(self.after("in"), ["info"])
        self.assertEqual(self.after("--straighten", "in"), [])
        self.assertEqual(self.after("info", ""), ["a.vdb", "b c.vdb", "model.obj", "models", "seeds.csv"])
        self.assertEqual(self.after("info", "a.vdb", "--u"), ["--unreliable"])
        self.assertEqual(self.after("info", "--unreliable", "a"), ["a.vdb"])
        self.assertEqual(self.after("info", "--json", "b"), ["b c.vdb"])
        self.assertEqual(self.after("info", "--progress", "n"), ["never"])

    def test_subcommand_of_a_subcommand(self):
        self.assertEqual(self.after("ba"), ["batch"])
        self.assertEqual(self.after("batch", ""), ["models", "seeds.csv", "seeds.json"])
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
        self.assertEqual(self.after("--color-map", "v"), ["viridis"])
        self.assertEqual(self.after("--metric-curvature", ""), ["avoid", "prefer"])
        self.assertEqual(self.after("--weight-curvature", "c"), ["crest"])
        self.assertEqual(self.after("--grids", "lo"), ["logmap"])
        self.assertEqual(self.after("--grids", "surface,c"), ["surface,color", "surface,curvature"])
        self.assertEqual(self.after("--seed", ""), [])

    def test_values_are_those_the_program_takes(self):
        for option in ("--scheme", "--space", "--up", "--color-map", "--progress", "--grids", "--weight-curvature",
                       "--metric-curvature"):
            for value in self.after(option, ""):
                # Refused, but for another reason.
                done = subprocess.run([PROGRAM, "--sdf", "none.vdb", "--seed", "0,0,0", "--image", "x.png", option, value],
                                      capture_output=True, text=True, check=False)
                self.assertIn("none.vdb", done.stderr)


class FishCompletion(Completion):
    def setUp(self):
        if not shutil.which("fish"):
            self.skipTest("fish not found (Debian: fish)")
        super().setUp()

    def after(self, line):
        done = subprocess.run(["fish", "--no-config", "-c", f"source '{FISH}'; complete -C 'implicit-geodesic {line}'"],
                              cwd=self.desk.name, capture_output=True, text=True, check=True,
                              env={**os.environ, "HOME": self.desk.name})
        self.assertEqual(done.stderr, "")
        offered = (line.partition("\t")[0] for line in done.stdout.splitlines())
        # fish also offers words that have the letters elsewhere.
        return sorted(word for word in offered if word.startswith(line.rpartition(" ")[2]))

    def test_options(self):
        self.assertEqual([word for word in self.after("--") if word.startswith("--")], sorted(OPTIONS))
        self.assertEqual(self.after("info a.vdb --u"), ["--unreliable"])
        self.assertEqual(self.after("batch merge seeds.json --"), ["--help", "--matrix", "--output"])

    def test_subcommands(self):
        self.assertEqual(self.after(""), ["a.vdb", "b c.vdb", "batch", "info", "model.obj", "models/", "seeds.csv"])
        self.assertEqual(self.after("--straighten in"), [])
        self.assertEqual(self.after("batch m"), ["merge", "models/"])

    def test_files_and_values(self):
        self.assertEqual(self.after("--sdf "), ["a.vdb", "b c.vdb", "models/"])
        self.assertEqual(self.after("--sdf=a"), ["--sdf=a.vdb"])
        self.assertEqual(self.after("info "), ["a.vdb", "b c.vdb", "model.obj", "models/", "seeds.csv"])
        self.assertIn("notes.md", self.after("--report "))
        self.assertEqual(self.after("--scheme "), ["godunov", "jet"])
        self.assertEqual(self.after("--grids surface,c"), ["surface,color", "surface,curvature"])
        self.assertEqual(self.after("--seed "), [])


class ZshCompletion(Completion):
    """Of an interactive zsh in a terminal: what it completes is known nowhere else."""

    def setUp(self):
        if not shutil.which("zsh"):
            self.skipTest("zsh not found (Debian: zsh)")
        super().setUp()
        self.home = tempfile.TemporaryDirectory()
        self.addCleanup(self.home.cleanup)
        # Files at hand: "offered" has what zsh adds, "done" is there once it has completed.
        pathlib.Path(self.home.name, ".zshrc").write_text(f"""
            fpath=('{ZSH.parent}' $fpath)
            autoload -Uz compinit; compinit -u -D
            compadd() {{
                local -a offered; builtin compadd -O offered "$@" 2>/dev/null
                (( $#offered )) && print -rl -- "${{(@Q)offered}}" >>$ZDOTDIR/offered
                builtin compadd "$@"
            }}
            complete-then-tell() {{ zle list-choices; : >$ZDOTDIR/done }}
            zle -N complete-then-tell; bindkey '^I' complete-then-tell
            """, encoding="utf-8")

    def after(self, line):
        home = pathlib.Path(self.home.name)
        for name in ("offered", "done"):
            (home / name).unlink(missing_ok=True)
        try:
            process, terminal = pty.fork()
        except OSError as error:
            self.skipTest(f"no terminal: {error}")
        if process == 0:
            os.chdir(self.desk.name)
            os.execvpe("zsh", ["zsh", "-i"], {**os.environ, "ZDOTDIR": str(home), "TERM": "xterm"})
        os.write(terminal, f"implicit-geodesic {line}\t".encode())
        shown, end = b"", time.monotonic() + 60
        while not (home / "done").exists() and time.monotonic() < end:
            if select.select([terminal], [], [], 0.02)[0]:  # read, or zsh waits
                shown += os.read(terminal, 65536)
        os.kill(process, 9)
        os.waitpid(process, 0)
        os.close(terminal)
        self.assertTrue((home / "done").exists(), shown)
        self.assertNotIn(b"_arguments:", shown)
        offered = home / "offered"
        return sorted(set(offered.read_text(encoding="utf-8").splitlines())) if offered.exists() else []

    def test_options(self):
        self.assertEqual([word for word in self.after("--") if word.startswith("--")], sorted(OPTIONS))
        self.assertEqual(self.after("--band 1 --band"), [])  # one excludes the other
        self.assertEqual(self.after("info a.vdb --u"), ["--unreliable"])
        self.assertEqual(self.after("batch merge seeds.json --"), ["--help", "--matrix", "--output"])

    def test_subcommands(self):
        self.assertEqual(self.after(""), ["a.vdb", "b c.vdb", "batch", "info", "model.obj", "models", "seeds.csv"])
        self.assertEqual(self.after("batch m"), ["merge", "models"])

    def test_files_and_values(self):
        self.assertEqual(self.after("--sdf "), ["a.vdb", "b c.vdb", "models"])
        self.assertEqual(self.after("info "), ["a.vdb", "b c.vdb", "model.obj", "models", "seeds.csv"])
        self.assertEqual(self.after("--scheme=g"), ["godunov"])
        self.assertEqual(self.after("--grids surface,c"), ["color", "curvature"])
        self.assertEqual(self.after("--seed "), [])


if __name__ == "__main__":
    if not MAN.exists():
        print(f"skipped: no {MAN}")
        sys.exit(77)
    result = unittest.main(exit=False).result
    sys.exit(1 if not result.wasSuccessful() else 77 if result.skipped else 0)
