#!/usr/bin/env python3
"""Surfaces with their distances, read by VTK: .vtp, .glb and .ply.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/consumers/test_vtk_surfaces.py

Exit code 77 where a module is missing (Debian: python3-vtk9, python3-numpy).
"""
import pathlib
import sys

import consumers

consumers.use_debian_python("numpy", "vtk")
import numpy as np  # noqa: E402
import vtk  # noqa: E402
from surfaces import MAJOR, MINOR, read_csv, write_torus  # noqa: E402
from vtk.util.numpy_support import vtk_to_numpy  # noqa: E402


def read(reader: vtk.vtkAlgorithm, file: pathlib.Path) -> vtk.vtkPolyData:
    reader.SetFileName(str(file))
    reader.Update()
    found = reader.GetOutputDataObject(0)
    while not isinstance(found, vtk.vtkPolyData):  # scenes are trees
        blocks = found.NewIterator()
        blocks.InitTraversal()
        found = blocks.GetCurrentDataObject()
    return found


def array(data: vtk.vtkPolyData, name: str) -> np.ndarray:
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def points(data: vtk.vtkPolyData) -> np.ndarray:
    return vtk_to_numpy(data.GetPoints().GetData())


def corners(data: vtk.vtkPolyData) -> np.ndarray:
    return vtk_to_numpy(data.GetPolys().GetConnectivityArray())


def own_vertices(folder: pathlib.Path) -> None:
    write_torus(folder / "torus.obj")
    run = ["--mesh", folder / "torus.obj", "--seed", "vertex:1", "--seed", "vertex:600", "--voxel-size", "0.05",
           "-q", "-o", folder / "out.vdb", "--per-seed", "--per-vertex"]
    consumers.geodesic(*run, folder / "v.vtp")
    consumers.geodesic(*run, folder / "v.csv")
    table, mesh = read_csv(folder / "v.csv"), read(vtk.vtkXMLPolyDataReader(), folder / "v.vtp")
    given = read(vtk.vtkOBJReader(), folder / "torus.obj")
    assert np.allclose(points(mesh), points(given), atol=1e-7)
    assert np.array_equal(corners(mesh), corners(given)) and mesh.GetNumberOfPolys() == given.GetNumberOfPolys()
    for name in ("distance", "distance_0", "distance_1", "label"):
        assert np.array_equal(array(mesh, name), table[name], equal_nan=True), name
    assert mesh.GetPointData().GetScalars().GetName() == "distance"


def surfaces(folder: pathlib.Path) -> None:
    # A wall that leaves a part unreached: half of the torus is beyond the limit.
    run = ["--mesh", folder / "torus.obj", "--seed", "vertex:1", "--voxel-size", "0.05", "-q", "-o", folder / "out.vdb",
           "--max-distance", "2", "--mesh-out"]
    for name in ("m.vtp", "m.glb", "m.ply"):
        consumers.geodesic(*run, folder / name)
    mesh = read(vtk.vtkXMLPolyDataReader(), folder / "m.vtp")
    distance, position = array(mesh, "distance"), points(mesh)
    known = np.isfinite(distance)
    assert 0.2 < known.mean() < 0.8 and np.isnan(distance[~known]).all()
    assert np.array_equal(array(mesh, "label"), np.where(known, 0, -1))
    gradient, normal = array(mesh, "gradient"), array(mesh, "Normals")
    away = known & (distance > 0.1) & (distance < 1)
    assert np.allclose(np.linalg.norm(gradient[away], axis=1), 1, atol=1e-5)
    assert (gradient[~known] == 0).all()
    ring = position.copy()
    ring[:, 2] = 0
    ring *= MAJOR / np.linalg.norm(ring, axis=1)[:, None]
    outward = (position - ring) / np.linalg.norm(position - ring, axis=1)[:, None]
    assert np.einsum("ij,ij->i", normal, outward).min() > 0.97, MINOR

    single = np.where(known, distance, -1).astype(np.float32)
    share = np.where(known, distance / distance[known].max(), 0)
    scene = read(vtk.vtkGLTFReader(), folder / "m.glb")
    assert np.array_equal(points(scene), position.astype(np.float32))
    assert np.array_equal(corners(scene), corners(mesh))
    assert np.array_equal(array(scene, "_DISTANCE"), single)
    assert np.array_equal(array(scene, "_LABEL"), np.where(known, 0, -1))
    assert np.allclose(array(scene, "TEXCOORD_0")[:, 0], share, atol=1e-6)
    assert np.array_equal(array(scene, "TEXCOORD_0")[:, 1], np.where(known, 0, 1))
    assert np.allclose(array(scene, "NORMAL"), normal, atol=1e-6)
    colors = array(scene, "COLOR_0")
    assert np.allclose(colors[~known], 0.5)

    ply = read(vtk.vtkPLYReader(), folder / "m.ply")
    assert np.allclose(points(ply), position, atol=1e-6)
    texture = vtk_to_numpy(ply.GetPointData().GetTCoords())
    assert np.allclose(texture[:, 0], share, atol=1e-6)
    # glTF has colors in linear light, PLY in sRGB.
    srgb = np.where(colors <= 0.0031308, 12.92 * colors, 1.055 * colors ** (1 / 2.4) - 0.055)
    assert np.abs(array(ply, "RGB")[known][:, :3] - 255 * srgb[known]).max() <= 1


def main() -> None:
    with consumers.temporary() as name:
        folder = pathlib.Path(name)
        own_vertices(folder)
        surfaces(folder)
    print(f"VTK {vtk.VTK_VERSION}")


if __name__ == "__main__":
    sys.exit(main())
