#!/usr/bin/env python3
"""Whether the files for packagers can be read, and give the version of CMakeLists.txt.

Ends with 77 where PyYAML is missing.
"""
import json
import pathlib
import re
import sys

try:
    import yaml
except ImportError:
    print("no PyYAML here")
    sys.exit(77)

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGING = ROOT / "scripts/packaging"
VERSION = re.search(r"project\(igeo VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


def read_yaml(path):
    return yaml.safe_load(path.read_text())


recipe = read_yaml(PACKAGING / "conda/recipe.yaml")
port = json.loads((PACKAGING / "vcpkg/vcpkg.json").read_text())
citation = read_yaml(ROOT / "CITATION.cff")
formula = PACKAGING / "homebrew/implicit-geodesic.rb"
versions = {
    "conda": recipe["context"]["version"],
    "vcpkg": port["version"],
    "CITATION.cff": citation["version"],
    "homebrew": re.search(r"implicit-geodesic-([\d.]+)\.tar", formula.read_text())[1],
    "README.md": re.search(r"implicit-geodesic ([\d.]+\d)\)", (ROOT / "README.md").read_text())[1],
}
failures = [f"{name} has version {version}, CMakeLists.txt {VERSION}"
            for name, version in versions.items() if version != VERSION]

missing = {"cff-version", "message", "title", "authors"} - set(citation)
if missing:
    failures.append(f"CITATION.cff is without {', '.join(sorted(missing))}")

for workflow in (ROOT / ".github/workflows").glob("*.yml"):
    for name, job in read_yaml(workflow)["jobs"].items():
        for step in job["steps"]:
            for script in re.findall(r"scripts/\S+\.sh", step.get("run", "")):
                if not (ROOT / script).exists():
                    failures.append(f"{workflow.name}: job {name} runs {script}, which is not there")

print("\n".join(failures) or f"all say version {VERSION}")
sys.exit(bool(failures))
