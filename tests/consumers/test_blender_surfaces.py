#!/usr/bin/env python3
"""Surfaces with their distances, imported by Blender: .ply, .glb and .obj.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/consumers/test_blender_surfaces.py

Exit code 77 where Blender is missing (Debian: blender).
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys

import consumers
from surfaces import read_csv, write_torus

# Runs in Blender: what its importers make of each file, as JSON.
SCRIPT = """
import json, os, sys
import numpy
if not hasattr(numpy, "bool"):
    numpy.bool = bool  # Blender 3.4's reader of glTF asks for it; NumPy 1.24 has it no more
import bpy

def importer(file):
    if file.endswith(".glb"):
        return bpy.ops.import_scene.gltf
    new = getattr(bpy.ops.wm, file[-3:] + "_import", None)
    try:
        new.get_rna_type()
        return new
    except Exception:
        return bpy.ops.import_mesh.ply if file.endswith(".ply") else bpy.ops.import_scene.obj

found = {}
for file in sys.argv[sys.argv.index("--") + 1:]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    importer(file)(filepath=file)
    thing = next(o for o in bpy.data.objects if o.type == "MESH")
    mesh = thing.data
    share = {}
    if mesh.uv_layers:
        for corner in mesh.loops:
            share[corner.vertex_index] = list(mesh.uv_layers[0].data[corner.index].uv)
    found[os.path.basename(file)] = {
        "points": [list(thing.matrix_world @ v.co) for v in mesh.vertices],
        "faces": len(mesh.polygons), "uv": share,
        "attributes": {a.name: [a.domain, a.data_type] for a in mesh.attributes}}
with open("found.json", "w") as file:
    json.dump(found, file)
"""


def close(a: list[float], b: list[float], by: float = 1e-5) -> bool:
    return len(a) == len(b) and all(abs(x - y) <= by for x, y in zip(a, b))


def main() -> int:
    blender = shutil.which("blender")
    if not blender:
        print("skipped: there is no blender")
        return 77
    # Debian's Blender takes the modules of the first Python in the path.
    environment = {**os.environ, "PATH": os.pathsep.join([os.path.dirname(blender), "/usr/bin", "/bin"])}
    with consumers.temporary() as name:
        folder = pathlib.Path(name)
        count = write_torus(folder / "torus.obj")
        run = ["--mesh", folder / "torus.obj", "--seed", "vertex:1", "--voxel-size", "0.1", "-q",
               "-o", folder / "out.vdb"]
        for file in ("v.csv", "v.ply", "v.obj"):
            consumers.geodesic(*run, "--per-vertex", folder / file)
        for file in ("m.ply", "m.glb", "m.obj"):
            consumers.geodesic(*run, "--mesh-out", folder / file)
        consumers.geodesic(*run, "--mesh-out", folder / "z.glb", "--up", "z")
        (folder / "script.py").write_text(SCRIPT)
        files = [folder / file for file in ("v.ply", "m.ply", "m.glb", "z.glb", "m.obj", "v.obj")]
        done = subprocess.run([blender, "-b", "-noaudio", "--factory-startup", "--python-exit-code", "1", "--python",
                               str(folder / "script.py"), "--", *map(str, files)],
                              cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=250)
        assert done.returncode == 0, done.stdout + done.stderr
        version = next(line for line in done.stdout.splitlines() if line.startswith("Blender"))
        found = json.loads((folder / "found.json").read_text())
        table = read_csv(folder / "v.csv")
    distance = table["distance"]
    largest = max(distance[1:])

    own = found["v.ply"]
    assert len(own["points"]) == count and own["faces"] == 48 * 24
    for vertex, (u, v) in own["uv"].items():
        assert abs(u - distance[int(vertex)] / largest) < 1e-6 and v == 0
    assert len(own["uv"]) == count - 1  # all that a face uses
    assert "Col" in own["attributes"]

    # Blender turns glTF's y to its z; --up z undoes that beforehand.
    given, turned, kept = found["m.ply"], found["m.glb"], found["z.glb"]
    for p, q, r in zip(given["points"], turned["points"], kept["points"]):
        assert close([p[0], -p[2], p[1]], q) and close(p, r)
    assert given["faces"] == turned["faces"] == found["m.obj"]["faces"]
    for vertex, (u, _) in turned["uv"].items():
        assert abs(u - given["uv"][vertex][0]) < 1e-6
    assert len(found["v.obj"]["points"]) >= count - 1
    print(version)
    return 0


if __name__ == "__main__":
    sys.exit(main())
