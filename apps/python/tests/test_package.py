"""What is shipped: stubs, types, the wheel."""

import ast
import os
import pathlib
import subprocess
import sys
import zipfile

import pytest

import igeo
from conftest import ROOT
from igeo import _igeo

FOLDER = pathlib.Path(igeo.__file__).parent


def public(names):
    return {n for n in names if not n.startswith("_")}


def test_stubs_have_the_names_of_the_module():
    tree = ast.parse((FOLDER / "_igeo.pyi").read_text())
    classes = {n.name: n for n in tree.body if isinstance(n, ast.ClassDef)}
    names = set(classes) | {n.name for n in tree.body if isinstance(n, ast.FunctionDef)}
    names |= {n.target.id for n in tree.body if isinstance(n, ast.AnnAssign)} - {"__version__"}
    assert names == public(dir(_igeo))
    for name, node in classes.items():
        told = {n.name for n in node.body if isinstance(n, ast.FunctionDef)}
        told |= {n.target.id for n in node.body if isinstance(n, ast.AnnAssign)}
        assert public(told) == public(dir(getattr(_igeo, name))), name
        for function in (n for n in node.body if isinstance(n, ast.FunctionDef)):
            check_arguments(function, getattr(_igeo, name))


def check_arguments(stub, owner):
    """pybind11 writes the names of the arguments at the beginning of the docstring."""
    doc = getattr(owner, stub.name).__doc__ if not isinstance(getattr(owner, stub.name), property) else None
    if not doc or stub.name == "__init__" and "self" not in doc:
        return
    signature = doc.splitlines()[0]
    for argument in stub.args.args:
        assert f"{argument.arg}:" in signature or argument.arg == "self", (stub.name, argument.arg, signature)


def test_public_names_have_docstrings():
    for name in set(igeo.__all__) - {"__version__", "color_maps"}:
        thing = getattr(igeo, name)
        assert thing.__doc__, name
        if isinstance(thing, type) and thing.__module__.startswith("igeo.") and not issubclass(thing, tuple):
            for member in public(vars(thing)):
                assert getattr(thing, member).__doc__ or issubclass(thing, Exception), f"{name}.{member}"


def test_types():
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", os.devnull, str(FOLDER)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_wheel(tmp_path):
    """pip makes it of the built tree, and a new environment installs and imports it."""
    for module in ("pip", "wheel", "venv"):
        pytest.importorskip(module)
    build = os.environ.get("IGEO_BUILD")
    if not build:
        pytest.skip("no IGEO_BUILD, a build tree with IGEO_PYTHON")
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    command = [*pip, "wheel", "--no-build-isolation", "--no-deps", "-w", tmp_path, ROOT / "apps/python"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    (wheel,) = tmp_path.glob("igeo-*.whl")
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    files = {n for n in names if n.startswith("igeo/")}
    extension = {f for f in files if f.startswith("igeo/_igeo.") and f.endswith(".so")}
    sources = {f"igeo/{p.name}" for p in (ROOT / "apps/python/igeo").iterdir() if p.suffix in (".py", ".pyi", ".typed")}
    assert len(extension) == 1 and files == extension | sources
    assert {n.split("/")[0] for n in names} == {"igeo", f"igeo-{igeo.__version__}.dist-info"}
    folder = tmp_path / "environment"
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", folder], check=True)
    python = folder / "bin/python"
    install = [*pip, "--python", python, "install", "--no-deps", "--no-index", wheel]
    subprocess.run(install, check=True, capture_output=True)
    code = "import igeo; print(igeo.__version__, igeo.__file__)"
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    done = subprocess.run(
        [python, "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.split()[0] == igeo.__version__ and str(folder) in done.stdout
