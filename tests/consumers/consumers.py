"""What the scripts of this folder share: the program, its example data, and consumers in Python.

Each script runs the program and reads its files back with the programs and modules that users have.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.path.abspath(os.environ.get("IGEO_PROGRAM", ROOT / "build/release/bin/implicit-geodesic"))
DATA = ROOT / "data"
PYTHON = "/usr/bin/python3"  # Debian's own has Debian's modules


def skip_without(*modules: str) -> None:
    """Ends the script with 77 where Debian's Python lacks a module."""
    for module in modules:
        done = subprocess.run([PYTHON, "-c", f"import {module}"], capture_output=True, check=False)
        if done.returncode != 0:
            print(f"skipped: Debian's Python has no module {module}")
            sys.exit(77)


def use_debian_python(*modules: str) -> None:
    """Goes on in Debian's Python if this one lacks a module; ends with 77 where that one lacks it too."""
    skip_without(*modules)
    try:
        for module in modules:
            __import__(module)
    except ImportError:
        os.execv(PYTHON, [PYTHON, *sys.argv])


def geodesic(*arguments: str, code: int = 0) -> subprocess.CompletedProcess:
    """Runs the program; fails with its messages where it ends with another exit code."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != code:
        raise SystemExit(f"{' '.join(map(str, arguments))}: exit {done.returncode}\n{done.stderr}")
    return done


def temporary() -> tempfile.TemporaryDirectory:
    return tempfile.TemporaryDirectory(prefix="consumers-")
