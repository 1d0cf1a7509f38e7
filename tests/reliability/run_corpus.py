#!/usr/bin/env python3
"""Feeds broken inputs (corpus.py) to the program and counts what comes of them.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/reliability/run_corpus.py [--count N] [--seed S]

Every input ends in one of these; those with a star fail the test:
  refused    exit code 2 or 3, a sentence that names the file, nothing written
  guarded    the same, by the guard against crashes of a library while it reads
  accepted   exit code 0 or 4, and the output can be read
  failed*    exit code 1: out of memory, or an error of the program
  crashed*   ended by a signal, or without a sentence
  silent*    exit code 3 without the name of the file
  hung*      not over within --timeout
  damaged*   an output changed, half there, or something else left behind
  sanitizer* a report of a sanitizer in code of ours
"""
import argparse
import collections
import concurrent.futures
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import corpus

PROGRAM = os.path.abspath(os.environ.get("IGEO_PROGRAM", corpus.ROOT / "build/release/bin/implicit-geodesic"))
BAD = ("failed", "crashed", "silent", "hung", "damaged", "sanitizer")
EARLIER = b"written by an earlier run"
OUTPUTS = ("out.vdb", "out.csv")
# Sizes that a sanitizer's allocator refuses by ending the process; the program itself gets bad_alloc.
ALLOCATION = re.compile(r"AddressSanitizer: (out-of-memory|allocation-size-too-big|calloc-overflow|"
                        r"requested allocation size|.*exceeds maximum supported size|rss-limit-exceeded|"
                        r"hard rss limit exhausted)|AddressSanitizer failed to allocate")
FRAME = re.compile(r"^ +#\d+ 0x\w+ +(?:in )?(.+)$", re.MULTILINE)
# Frames that say nothing of who called them, by name or by place; and those of a library, by place.
STANDARD = re.compile(r"__interceptor|operator (new|delete)|(mem|str)\w+ |fread |.*/c\+\+/|.*\(/lib/\S*lib(c|stdc\+\+)\.so")
LIBRARY = re.compile(r"(.* )?\(?/(usr|lib)/\S+( \(BuildId.*)?$")
ENVIRONMENT = {"ASAN_OPTIONS": "detect_leaks=0:handle_segv=2:handle_sigfpe=2:handle_abort=2:"
                               "allocator_may_return_null=0:hard_rss_limit_mb=4000:exitcode=99",
               "UBSAN_OPTIONS": "print_stacktrace=1:exitcode=99", "NO_COLOR": "1"}


def readable(file: pathlib.Path) -> bool:
    """Whether an output is whole; a .csv has a first line and ends with a line."""
    if file.suffix == ".csv":
        text = file.read_text()
        return text.startswith("pair,") and text.endswith("\n")
    done = subprocess.run(["vdb_print", "-l", str(file)], capture_output=True, check=False)
    return done.returncode == 0 and b"_geodesic" in done.stdout


def judge(case: corpus.Case, folder: pathlib.Path, code: int, err: str, earlier: bool) -> str:
    if "Sanitizer" in err or "runtime error:" in err:
        if ALLOCATION.search(err):
            return "refused"
        if error := re.search(r"^(/\S+): runtime error:", err, re.MULTILINE):
            return "library" if error[1].startswith("/usr/") else "sanitizer"
        culprit = next((frame for frame in FRAME.findall(err) if not STANDARD.match(frame)), "")
        return "library" if LIBRARY.match(culprit) else "sanitizer"
    said = re.search(r"^implicit-geodesic: error: .+", err, re.MULTILINE)
    if code < 0 or code not in (0, 1, 2, 3, 4) or (code in (1, 2, 3) and not said and not case.line.startswith("info")):
        return "crashed"
    left = {f.name for f in folder.iterdir()} - {case.file}
    if code in (0, 4):
        whole = all(readable(folder / name) for name in left if name in OUTPUTS
                    and not (earlier and (folder / name).read_bytes() == EARLIER))
        return "accepted" if whole and left <= set(OUTPUTS) else "damaged"
    if left != (set(OUTPUTS) if earlier else set()):
        return "damaged"
    if earlier and any((folder / name).read_bytes() != EARLIER for name in OUTPUTS):
        return "damaged"
    if code == 1:
        return "failed"
    # Exit code 2: the file is sound, and what it asks for is not.
    name = "standard input" if case.from_stdin else case.file
    if code == 3 and said and name not in err:
        return "silent"
    return "guarded" if "crashed" in err or "took more than" in err else "refused"


def run_case(case: corpus.Case, surface: pathlib.Path, timeout: float) -> tuple[str, float, int, str]:
    with tempfile.TemporaryDirectory(prefix="igeo-corpus-") as name:
        folder = pathlib.Path(name)
        (folder / case.file).write_bytes(case.content)
        earlier = case.number % 2 == 0
        for output in OUTPUTS if earlier else ():
            (folder / output).write_bytes(EARLIER)
        words = [{"FILE": case.file, "SURFACE": str(surface)}.get(w, w) for w in case.line.split()]
        start = time.monotonic()
        with open(folder / case.file if case.from_stdin else os.devnull, "rb") as source, \
                tempfile.TemporaryFile() as sink:
            process = subprocess.Popen([PROGRAM, *words, "--threads", "1"] + (
                [] if "info" in words else ["--memory-limit", "2"]),
                cwd=folder, stdin=source, stdout=subprocess.DEVNULL, stderr=sink,
                env={**os.environ, **ENVIRONMENT})
            try:
                code = process.wait(timeout)
            except subprocess.TimeoutExpired:
                # Its own ending tells where it was, under a sanitizer.
                process.send_signal(signal.SIGKILL)
                process.wait()
                return "hung", time.monotonic() - start, -9, ""
            seconds = time.monotonic() - start
            sink.seek(0)
            err = sink.read(20000).decode("utf-8", "replace")
        return judge(case, folder, code, err, earlier), seconds, code, err


def keep(folder: pathlib.Path, case: corpus.Case, what: str, err: str) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    stem = f"{what}-{case.number}"
    (folder / f"{stem}{pathlib.Path(case.file).suffix}").write_bytes(case.content)
    (folder / f"{stem}.txt").write_text(f"{case.line}\n{case.how}\n{err}")


def main() -> int:
    parser = argparse.ArgumentParser(description="Broken inputs against the program.")
    parser.add_argument("--count", type=int, default=500, help="how many inputs [500]")
    parser.add_argument("--first", type=int, default=0, help="the first of them [0]")
    parser.add_argument("--only", type=int, help="one input, with what the program says")
    parser.add_argument("--seed", type=int, default=1, help="of the random numbers [1]")
    parser.add_argument("--timeout", type=float, default=60, help="seconds per input [60]")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="runs at once [cores]")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for inputs that fail the test")
    options = parser.parse_args()
    missing = [tool for tool in ("vdb_tool", "vdb_print") if not shutil.which(tool)]
    if missing:
        print(f"skipped: no {', '.join(missing)} (Debian: libopenvdb-tools)")
        return 77

    counts: collections.Counter = collections.Counter()
    by_kind: dict[str, collections.Counter] = collections.defaultdict(collections.Counter)
    slowest = (0.0, -1)
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as name, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        sounds = corpus.sound_files(pathlib.Path(name))
        surface = pathlib.Path(name) / "surface.vdb"
        surface.write_bytes((corpus.ROOT / "data" / "sphere.vdb").read_bytes())
        last = options.first + options.count if options.only is None else options.only + 1
        wanted = (c for c in corpus.cases(options.seed, last, sounds)
                  if c.number >= options.first and options.only in (None, c.number))
        waiting = set()

        def collect(done):
            nonlocal slowest
            for case, (what, seconds, code, err) in (future.result() for future in done):
                counts[what] += 1
                if sum(counts.values()) % 1000 == 0:
                    print(f"{sum(counts.values())} inputs: {dict(counts)}", flush=True)
                by_kind[pathlib.Path(case.file).suffix][what] += 1
                slowest = max(slowest, (seconds, case.number))
                if what in BAD or what == "library" or options.only is not None:
                    text = err if options.only is not None else err[:300]
                    print(f"{what}: case {case.number}: {case.line} ({', '.join(case.how)}), exit code {code}\n{text}", flush=True)
                if options.keep and (what in BAD or what in ("guarded", "library")):
                    keep(options.keep, case, what, err)

        try:
            for case in wanted:
                waiting.add(pool.submit(lambda c: (c, run_case(c, surface, options.timeout)), case))
                if len(waiting) > 4 * options.jobs:
                    done, waiting = concurrent.futures.wait(
                        waiting, return_when=concurrent.futures.FIRST_COMPLETED)
                    collect(done)
        except KeyboardInterrupt:
            print("interrupted")
        collect(concurrent.futures.wait(waiting).done)

    for kind in sorted(by_kind):
        print(f"{kind:6} " + ", ".join(f"{what} {n}" for what, n in sorted(by_kind[kind].items())))
    print(f"{sum(counts.values())} inputs (seed {options.seed}) in {time.monotonic() - start:.0f} s: "
          + ", ".join(f"{n} {what}" for what, n in counts.most_common())
          + f"; the slowest took {slowest[0]:.1f} s (case {slowest[1]})")
    return 1 if any(counts[what] for what in BAD) else 0


if __name__ == "__main__":
    sys.exit(main())
