"""What the scripts that measure share: processes, tables in documents, claims.

Tables in documents are made and never typed: a script measures, `rewrite` puts its table between two
marks of a document, and `check` compares what the text says with what was measured.
"""
import dataclasses
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
CLAIMS = ROOT / "scripts" / "claims.json"


@dataclasses.dataclass(frozen=True)
class Run:
    """A process that has ended."""
    stdout: str
    stderr: str
    code: int  # exit code; -n: ended by signal n
    wall: float  # seconds
    cpu: float  # seconds of the processor, user and system, of all threads
    peak: int  # largest resident memory, bytes; Linux counts this interpreter's own as the least


def run(command, *, expect=(0,), cwd=None, env=None, stdin="") -> Run:
    """Runs a command (a list of words) to its end.

    Raises RuntimeError, with the command and its stderr, if the exit code is not in `expect`.
    `env` adds to the environment.
    """
    words = [str(word) for word in command]
    # Files and not pipes: nothing has to be read while os.wait4 waits.
    with tempfile.TemporaryFile("w+") as source, tempfile.TemporaryFile() as out, \
            tempfile.TemporaryFile() as err:
        source.write(stdin)
        source.seek(0)
        start = time.perf_counter()
        process = subprocess.Popen(words, stdin=source, stdout=out, stderr=err, cwd=cwd,
                                   env={**os.environ, **(env or {})})
        try:
            _, status, usage = os.wait4(process.pid, 0)
        except BaseException:
            process.kill()
            process.wait()
            raise
        wall = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)  # or Popen would wait for it again
        texts = []
        for file in (out, err):
            file.seek(0)
            texts.append(file.read().decode(errors="replace"))
    done = Run(*texts, process.returncode, wall, usage.ru_utime + usage.ru_stime,
               usage.ru_maxrss * 1024)
    if done.code not in expect:
        raise RuntimeError(f"exit code {done.code} of {shlex.join(words)}\n{done.stderr.rstrip()}")
    return done


def _first(pattern, text):
    """The first group of a pattern's first match."""
    found = re.search(pattern, text, re.MULTILINE)
    return " ".join(found[1].split()) if found else "unknown"


def _read(file):
    try:
        return pathlib.Path(file).read_text()
    except OSError:
        return ""


def _says(*command):
    """What a command prints, nothing if it fails or is not there."""
    try:
        return subprocess.run(command, cwd=ROOT, capture_output=True, text=True).stdout.strip()
    except OSError:
        return ""


def commit():
    """The checkout: its commit, and whether files differ from it; documents aside, which the
    scripts themselves write."""
    name = _says("git", "rev-parse", "--short=10", "HEAD")
    if not name:
        return "no git"
    return name + (" with changes" if _says("git", "status", "--porcelain", "-uno", ":!docs") else "")


def machine():
    """What figures were measured on, in one line without names of hosts or folders."""
    memory = int(_first(r"^MemTotal:\s*(\d+)", _read("/proc/meminfo")).replace("unknown", "0"))
    compiler = _says(os.environ.get("CXX", "c++"), "--version")
    name = "GCC" if "Free Software Foundation" in compiler else "Clang"
    return ", ".join([
        _first(r"^model name\s*:\s*(.*)", _read("/proc/cpuinfo")),
        f"{len(os.sched_getaffinity(0))} cores",
        f"{memory / 2 ** 20:.1f} GiB",
        _first(r'^PRETTY_NAME="?([^"\n]*)', _read("/etc/os-release")),
        f"{name} {_first(r' ([0-9]+[.][0-9.]+)', compiler)}",
        f"commit {commit()}",
    ])


def command_line():
    """This script and its arguments as one would type them at the top of the repository. Folders
    elsewhere show their last name only."""
    def show(word):
        option, equals, value = word.rpartition("=")
        path = pathlib.Path(value)
        if not path.is_absolute():
            return word
        inside = path.resolve()
        return option + equals + (str(inside.relative_to(ROOT)) if inside.is_relative_to(ROOT)
                                  else f".../{path.name}")
    script, *arguments = sys.argv
    return shlex.join([show(str(pathlib.Path(script).resolve())), *map(show, arguments)])


def number(x, digits=3):
    """A number with so many significant digits, never as 1e-05; a dash for None."""
    if x is None:
        return "-"
    if x == 0 or x != x or x in (float("inf"), -float("inf")):
        return str(x).removesuffix(".0")
    exponent = int(f"{x:.{digits - 1}e}".partition("e")[2])
    return f"{x:.{max(0, digits - 1 - exponent)}f}"


def table(header, rows):
    """A Markdown table: the first column to the left, all others to the right."""
    lines = [header, ["---"] + ["---:"] * (len(header) - 1), *rows]
    for line in lines:
        if len(line) != len(header):
            raise ValueError(f"a row of {len(line)} cells under {len(header)} heads: {line}")
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def write(file, text):
    """Writes a text file whole or not at all, and only if it changes."""
    file = pathlib.Path(file)
    if file.exists() and file.read_text(encoding="utf-8") == text:
        return
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(f".{file.name}.{os.getpid()}.tmp")
    try:
        part.write_text(text, encoding="utf-8")
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)


def rewrite(file, name, text):
    """Replaces what is in a document between
        <!-- NAME: begin (made by COMMAND) -->
        <!-- NAME: end -->
    and leaves the marks. Raises ValueError unless the document has them once."""
    old = pathlib.Path(file).read_text(encoding="utf-8")
    marks = re.compile(rf"^(<!-- {re.escape(name)}: begin \(made by [^)\n]*\) -->\n).*?"
                       rf"^(<!-- {re.escape(name)}: end -->)$", re.DOTALL | re.MULTILINE)
    new, count = marks.subn(lambda found: found[1] + text.strip("\n") + "\n" + found[2], old)
    if count != 1:
        raise ValueError(f"{file}: needs the marks '<!-- {name}: begin (made by COMMAND) -->' and "
                         f"'<!-- {name}: end -->' once, has them {count} times")
    write(file, new)


def save(results, file):
    """Writes results (a dictionary) as JSON, with the machine and the command."""
    write(file, json.dumps({"machine": machine(), "command": command_line(), **results},
                           indent=1) + "\n")


def look_up(results, figure):
    """The value of a dotted key, such as table2.rate; None if it is not there."""
    for key in figure.split("."):
        if not isinstance(results, dict) or key not in results:
            return None
        results = results[key]
    return results


def judge(claim, results):
    """(whether a claim holds, or None where it was not measured; the line that says so)."""
    sentence, value = claim["says"], look_up(results, claim["figure"])
    text = " ".join(_read(ROOT / claim["where"]).split())
    if " ".join(sentence.split()) not in text:
        return False, f"IS NOT IN {claim['where']}: {sentence}"
    if value is None:
        return None, f"not measured here: {sentence}"
    bounds = [(kind, claim[kind]) for kind in ("at most", "at least") if kind in claim]
    if not bounds:
        raise ValueError(f"claim {claim['id']} has no bound")
    holds = all(value <= bound if kind == "at most" else value >= bound for kind, bound in bounds)
    limits = ", ".join(f"{kind} {bound:g}" for kind, bound in bounds)
    return holds, f"{'holds' if holds else 'DOES NOT HOLD'}: {sentence} (measured {value:.6g}, {limits})"


def check(results, script):
    """Compares the claims of a script, such as scripts/reproduce.py, with its results. Prints a line
    for each; false if one does not hold, or is not in the page that it names."""
    holds = True
    for claim in json.loads(CLAIMS.read_text(encoding="utf-8")):
        if script not in claim["command"].split():
            continue
        verdict, line = judge(claim, results)
        print(line)
        holds = holds and verdict is not False
    return holds
