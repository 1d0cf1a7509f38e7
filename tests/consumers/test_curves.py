"""Paths and isolines in VTK, Blender and meshio: the same numbers and edges as in the CSV.

The box has exact paths, the sphere closed isolines of known length.
"""
import csv
import json
import math
import os
import re
import shutil
import subprocess
import sys

from consumers import DATA, geodesic, temporary, use_debian_python

use_debian_python("numpy")
import numpy as np  # noqa: E402

# In Blender: of each file, per object, vertices, edges and the numbers per vertex.
IN_BLENDER = """
import bpy, json, sys
out, files = sys.argv[sys.argv.index("--") + 1], sys.argv[sys.argv.index("--") + 2:]
found = {}
for file in files:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if file.endswith(".obj"):
        bpy.ops.wm.obj_import(filepath=file, forward_axis="Y", up_axis="Z")
    elif bpy.app.version >= (3, 6):
        bpy.ops.wm.ply_import(filepath=file)
    else:
        bpy.ops.preferences.addon_enable(module="io_mesh_ply")  # 3.4 has it as an add-on
        bpy.ops.import_mesh.ply(filepath=file)
    found[file] = {o.name: {"vertices": [list(v.co) for v in o.data.vertices],
                            "edges": [list(e.vertices) for e in o.data.edges]}
                   for o in bpy.data.objects}
json.dump(found, open(out, "w"))
"""


class Table:
    """A CSV of curves: per curve its rows of x, y, z, arcLength, distance or level, nx, ny, nz."""

    def __init__(self, file):
        self.curves = {}
        with open(file, encoding="utf-8") as text:
            for row in csv.DictReader(text):
                key = int(row.get("path") or row["line"])
                number = row["distance"] if "distance" in row else row["level"]
                self.curves.setdefault(key, []).append(
                    [float(row[k]) for k in ("x", "y", "z", "arcLength")] + [float(number)]
                    + [float(row[k]) for k in ("nx", "ny", "nz")])
        self.curves = {k: np.array(v) for k, v in self.curves.items()}

    def segments(self):
        """Ends of all segments, sorted."""
        return ordered(np.concatenate([np.concatenate([c[:-1, :3], c[1:, :3]], axis=1)
                                       for c in self.curves.values()]))


def ordered(segments):
    """Segments as rows of six numbers, each with its lesser end first, sorted."""
    rows = [tuple(s) if tuple(s[:3]) <= tuple(s[3:]) else tuple(s[3:]) + tuple(s[:3])
            for s in np.round(segments, 5)]
    return np.array(sorted(rows))


def require_same(what, one, other, within):
    one, other = np.asarray(one, float), np.asarray(other, float)
    if one.shape != other.shape:
        sys.exit(f"{what}: {one.shape} and not {other.shape}")
    worst = np.abs(one - other).max() if one.size else 0
    if not worst <= within:
        sys.exit(f"{what}: off by {worst:.3g}, more than {within:.3g}")
    print(f"ok: {what}: {len(one)} rows, off by {worst:.2g}")


def check_vtk(folder, kind, table):
    try:
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
    except ImportError:
        return print("skipped: Debian's Python has no module vtk")
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(f"{folder}/{kind}.vtp")
    reader.Update()
    data = reader.GetOutput()
    all_rows = np.concatenate(list(table.curves.values()))
    points = data.GetPointData()
    arrays = [vtk_to_numpy(data.GetPoints().GetData())]
    arrays += [vtk_to_numpy(points.GetArray(n)) for n in ("arcLength", "distance", "normal")]
    require_same(f"VTK {vtk.vtkVersion.GetVTKVersion()} reads {kind}.vtp",
                 np.column_stack(arrays), all_rows, 1e-6)
    lines = data.GetLines()
    lines.InitTraversal()
    cell, lengths = vtk.vtkIdList(), []
    while lines.GetNextCell(cell):
        lengths.append(cell.GetNumberOfIds())
    require_same(f"polylines of {kind}.vtp", lengths, [len(c) for c in table.curves.values()], 0)
    require_same(f"numbers of {kind}.vtp", vtk_to_numpy(
        data.GetCellData().GetArray("path" if kind == "paths" else "line")), list(table.curves), 0)
    reader = vtk.vtkPLYReader()
    reader.SetFileName(f"{folder}/{kind}.ply")
    reader.Update()
    vertices = reader.GetOutput().GetPoints()
    require_same(f"VTK reads the vertices of {kind}.ply",
                 np.unique(np.round(vtk_to_numpy(vertices.GetData()), 5), axis=0),
                 np.unique(np.round(all_rows[:, :3], 5), axis=0), 1.1e-5)


def check_blender(folder, kind, table):
    blender = shutil.which("blender")
    if not blender:
        return print("skipped: no blender in the path")
    script, out = f"{folder}/in_blender.py", f"{folder}/blender.json"
    with open(script, "w", encoding="utf-8") as text:
        text.write(IN_BLENDER)
    files = [f"{folder}/{kind}.{ending}" for ending in ("obj", "ply")]
    done = subprocess.run([blender, "-b", "-noaudio", "--factory-startup", "--python-exit-code", "1",
                           "--python", script, "--", out, *files],
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"blender: {done.stdout}{done.stderr}")
    with open(out, encoding="utf-8") as text:
        found = json.load(text)
    version = re.search(r"Blender ([0-9.]+)", done.stdout).group(1)
    levels = {row[4] for c in table.curves.values() for row in c}
    for file in files:
        objects = found[file].values()
        segments = [o["vertices"][a] + o["vertices"][b] for o in objects for a, b in o["edges"]]
        require_same(f"Blender {version} imports {os.path.basename(file)}",
                     ordered(segments), table.segments(), 2.1e-5)
        wanted = 1 if file.endswith(".ply") else len(levels if kind == "isolines" else table.curves)
        require_same(f"objects of {os.path.basename(file)}", [len(objects)], [wanted], 0)


def check_meshio(folder, kind, table):
    try:
        import meshio
    except ImportError:
        return print("skipped: Debian's Python has no module meshio")
    points = meshio.read(f"{folder}/{kind}.obj").points
    rows = np.concatenate(list(table.curves.values()))[:, :3]
    require_same(f"meshio {meshio.__version__} reads the vertices of {kind}.obj",
                 np.unique(np.round(points, 5), axis=0), np.unique(np.round(rows, 5), axis=0), 1.1e-5)
    return None


def check_usd(folder, kind, table):
    """By USD where Python has it, else by the text."""
    file = f"{folder}/{kind}.usda"
    try:
        from pxr import Usd, UsdGeom
    except ImportError:
        print("skipped: Python has no module pxr; the text is read instead")
        with open(file, encoding="utf-8") as text:
            content = text.read()
        prims = re.findall(r"def BasisCurves .*?\n    \}", content, re.S)

        def numbers(prim, name):
            listed = re.search(re.escape(name) + r" = \[(.*?)\]", prim).group(1)
            return [float(x) for x in re.findall(r"[-+0-9.e]+", listed)]
        counts = [int(n) for p in prims for n in numbers(p, "int[] curveVertexCounts")]
        columns = [np.concatenate([numbers(p, name) for p in prims]) for name in
                   ("point3f[] points", "float[] primvars:arcLength", "float[] primvars:distance",
                    "normal3f[] normals")]
    else:
        prims = [UsdGeom.BasisCurves(p) for p in Usd.Stage.Open(file).Traverse()
                 if p.IsA(UsdGeom.BasisCurves)]
        counts = [n for p in prims for n in p.GetCurveVertexCountsAttr().Get()]
        of = UsdGeom.PrimvarsAPI
        columns = [np.concatenate([np.ravel(c) for c in lists]) for lists in (
            [p.GetPointsAttr().Get() for p in prims],
            [of(p).GetPrimvar("arcLength").Get() for p in prims],
            [of(p).GetPrimvar("distance").Get() for p in prims],
            [p.GetNormalsAttr().Get() for p in prims])]
    require_same(f"curves of {kind}.usda", counts, [len(c) for c in table.curves.values()], 0)
    columns = [c.reshape(sum(counts), -1) for c in columns]
    require_same(f"numbers of {kind}.usda", np.column_stack(columns),
                 np.concatenate(list(table.curves.values())), 1e-6)


def main():
    with temporary() as folder:
        with open(f"{folder}/box.obj", "w", encoding="utf-8") as text:
            text.write("v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 1\nv 2 0 1\nv 2 3 1\nv 0 3 1\n"
                       "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n")
        for ending in ("csv", "obj", "ply", "vtp", "usda"):
            geodesic("--mesh", f"{folder}/box.obj", "--resolution", 40, "--seed", "1,1,1", "--target",
                     "1,1,0", "--target", "0,0,0", "--via",
                     "1,0.5,1 2,0.7,0.5 1,0.5,0 0,0.3,0.5 1,0.5,1", "--straighten", "-q", "-o",
                     f"{folder}/o.vdb", "--paths", f"{folder}/paths.{ending}")
            geodesic("--sdf", DATA / "sphere_rotated.vdb", "--seed", "0,0,1", "--seed", "0,0,-1",
                     "--levels", 3, "-q", "-o", f"{folder}/o.vdb", "--isolines",
                     f"{folder}/isolines.{ending}")
        paths, isolines = Table(f"{folder}/paths.csv"), Table(f"{folder}/isolines.csv")
        require_same("lengths", [paths.curves[k][-1, 3] for k in (0, 2)], [3, 6], 1e-9)
        require_same("isolines are circles", [c[-1, 3] for c in isolines.curves.values()],
                     [2 * math.pi * math.sin(c[0, 4]) for c in isolines.curves.values()], 0.02)
        for kind, table in (("paths", paths), ("isolines", isolines)):
            check_vtk(folder, kind, table)
            check_blender(folder, kind, table)
            check_meshio(folder, kind, table)
            check_usd(folder, kind, table)


if __name__ == "__main__":
    main()
