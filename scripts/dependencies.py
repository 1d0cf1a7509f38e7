#!/usr/bin/env python3
"""Lists what the program is made of: Debian packages, their versions and licenses.

usage: scripts/dependencies.py [PROGRAM] [--check docs/dependencies.md]

The libraries are those that the dynamic linker loads; versions come from dpkg, licenses from the packages'
own copyright files. With --check, compares packages and licenses with the tables of a page; versions there are those
that were tested, and change with security updates. Exit code 77 where there is no dpkg, another Debian, or a system
without the copyright files.
"""
import argparse
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
PROGRAM = ROOT / "build/release/bin/implicit-geodesic"
# Compiled in, or needed to build and test only.
HEADERS = ("nlohmann-json3-dev", "libcli11-dev", "libxxhash-dev", "libjs-three", "catch2")
# Copyright files that are not in Debian's machine-readable form, read by a person.
BY_HAND = {"libc6": "LGPL-2.1+", "libgcc-s1": "GPL-3+ with GCC exception", "libstdc++6": "GPL-3+ with GCC exception"}


def output(*command: str) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def package_of(library: str) -> str:
    """The package that holds a file; /lib may be a link to /usr/lib that dpkg does not know of."""
    real = str(pathlib.Path(library).resolve())
    for path in (real, real.removeprefix("/usr")):
        found = subprocess.run(["dpkg-query", "-S", path], capture_output=True, text=True, check=False)
        if found.returncode == 0:
            return found.stdout.split(":")[0]
    raise SystemExit(f"dependencies.py: {library} is of no package")


def license_of(package: str) -> str:
    text = pathlib.Path("/usr/share/doc", package, "copyright").read_text(errors="replace")
    found = re.search(r"^Files:\s*\*.*?^License:[ \t]*([^\n]+)", text, re.MULTILINE | re.DOTALL)
    return found[1].strip() if found else BY_HAND.get(package, "unknown")


def rows(packages: list[str]) -> list[tuple[str, str, str]]:
    return [(p, output("dpkg-query", "-W", "-f", "${Version}", p), license_of(p)) for p in packages]


def libraries(program: pathlib.Path) -> list[str]:
    paths = re.findall(r"=> (/\S+)", output("ldd", str(program)))
    return sorted({package_of(p) for p in paths})


def table(lines: list[tuple[str, str, str]]) -> str:
    head = "| package | version | license |\n|---|---|---|\n"
    return head + "".join(f"| {p} | {v} | {license} |\n" for p, v, license in lines)


def main() -> int:
    parser = argparse.ArgumentParser(description="Dependencies of the program, with versions and licenses.")
    parser.add_argument("program", nargs="?", type=pathlib.Path, default=PROGRAM)
    parser.add_argument("--check", type=pathlib.Path, help="a page to compare with")
    options = parser.parse_args()
    release = pathlib.Path("/etc/os-release")
    if not release.exists() or 'VERSION_CODENAME=bookworm' not in release.read_text():
        print("dependencies.py: this is not Debian 12")
        return 77
    try:
        loaded, headers = rows(libraries(options.program)), rows(list(HEADERS))
    except FileNotFoundError as missing:
        print(f"dependencies.py: {missing}")
        return 77
    if not options.check:
        print(table(loaded) + "\n" + table(headers), end="")
        return 0
    page = re.findall(r"^\| (\S+) \| (\d\S*-\S+) \| (.+) \|$", options.check.read_text(), re.MULTILINE)
    there = {(p, license) for p, _, license in loaded + headers}
    said = {(p, license) for p, _, license in page}
    for row in sorted(there - said):
        print("not on the page:", *row)
    for row in sorted(said - there):
        print("only on the page:", *row)
    return 1 if there != said else 0


if __name__ == "__main__":
    sys.exit(main())
