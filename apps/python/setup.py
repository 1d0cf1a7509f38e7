"""Builds the module _igeo by CMake, from the checkout that this folder is in.

CMAKE_ARGS are further arguments of the configuration. IGEO_BUILD names a build tree that is
configured with IGEO_PYTHON for this Python, to be used instead of a new one.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parents[2]


def version() -> str:
    try:
        text = (ROOT / "CMakeLists.txt").read_text()
    except OSError:
        sys.exit(f"igeo is built from its checkout, and {ROOT} is none: pip install CHECKOUT/apps/python")
    found = re.search(r"project\(igeo VERSION ([0-9.]+)", text)
    return found.group(1) if found else "0"


class BuildByCMake(build_ext):
    def build_extension(self, ext: Extension) -> None:
        tree = os.environ.get("IGEO_BUILD") or self.configured()
        jobs = os.environ.get("IGEO_JOBS") or str(os.cpu_count() or 1)
        subprocess.run(["cmake", "--build", tree, "--target", "igeo_python", "--parallel", jobs], check=True)
        with tempfile.TemporaryDirectory() as prefix:
            install = ["cmake", "--install", tree, "--component", "python", "--strip", "--prefix", prefix]
            subprocess.run(install, check=True, stdout=subprocess.DEVNULL)
            (module,) = Path(prefix).rglob("_igeo*.so")
            target = Path(self.get_ext_fullpath(ext.name))
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(module, target)

    def configured(self) -> str:
        tree = str(ROOT / f"build/python-{sys.implementation.cache_tag}")  # kept for later builds
        options = ["-DCMAKE_BUILD_TYPE=Release", "-DIGEO_PYTHON=ON", f"-DPython_EXECUTABLE={sys.executable}"]
        options += ["-DIGEO_BUILD_APPS=OFF", "-DIGEO_BUILD_TESTS=OFF"]
        if shutil.which("ninja"):
            options.append("-GNinja")
        options += shlex.split(os.environ.get("CMAKE_ARGS", ""))
        subprocess.run(["cmake", "-S", str(ROOT), "-B", tree, *options], check=True)
        return tree


setup(
    version=version(),
    ext_modules=[Extension("igeo._igeo", sources=[])],
    cmdclass={"build_ext": BuildByCMake},
)
