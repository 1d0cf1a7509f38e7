#!/usr/bin/env python3
"""Distances at the vertices of a mesh, foot points and matrices, read by NumPy, nibabel and meshio.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/consumers/test_vertex_arrays.py

Exit code 77 where a module is missing (Debian: python3-numpy, python3-nibabel, python3-meshio).
"""
import json
import pathlib
import sys

import consumers

consumers.use_debian_python("numpy", "nibabel", "meshio")
import meshio  # noqa: E402
import nibabel  # noqa: E402
import numpy as np  # noqa: E402
from surfaces import read_csv, write_torus  # noqa: E402

REGIONS = {"front": [1, 2, 3], "back": [600, 601], "top, left": [300]}
NAMES = ["distance_front", "distance_back", "distance_top__left"]


def vertices(folder: pathlib.Path) -> None:
    count = write_torus(folder / "torus.obj")
    (folder / "regions.json").write_text(json.dumps({"groups": REGIONS}))
    run = ["--mesh", folder / "torus.obj", "--seeds", folder / "regions.json", "--voxel-size", "0.05", "-q",
           "-o", folder / "out.vdb", "--per-seed", "--per-vertex"]
    for name in ("v.csv", "v.npy", "v.npz", "v.ply", "v.func.gii"):
        consumers.geodesic(*run, folder / name)
    table = read_csv(folder / "v.csv")
    distance, label = np.array(table["distance"]), np.array(table["label"])
    columns = np.array([table[name] for name in NAMES]).T
    assert len(distance) == count and columns.shape == (count, 3)
    # Not used; a copy; the seeds of each region.
    assert np.isnan(distance[0]) and distance[-1] == distance[1] == 0
    for k, numbers in enumerate(REGIONS.values()):
        assert (columns[numbers, k] == 0).all() and (label[numbers] == k).all()
    used = slice(1, None)
    assert np.allclose(columns[used].min(axis=1), distance[used], atol=2e-3)
    near = np.sort(columns[used], axis=1)
    clear = near[:, 1] - near[:, 0] > 0.05
    assert (columns[used].argmin(axis=1) == label[used])[clear].all() and clear.sum() > 1000

    assert np.array_equal(np.load(folder / "v.npy", allow_pickle=False), columns, equal_nan=True)
    archive = np.load(folder / "v.npz", allow_pickle=False)
    assert np.array_equal(archive["distance"], distance, equal_nan=True)
    assert np.array_equal(archive["distances"], columns, equal_nan=True)
    assert np.array_equal(archive["label"], label) and archive["label"].dtype == np.int32

    shown = np.where(np.isfinite(distance), distance, -1).astype(np.float32)
    arrays = nibabel.load(folder / "v.func.gii").darrays
    names = [dict(array.meta)["Name"] for array in arrays]
    assert names == ["distance", "label"] + NAMES, names
    assert all(array.data.dtype == np.float32 for array in arrays)
    assert np.array_equal(arrays[0].data, shown) and np.array_equal(arrays[1].data, label)
    assert np.array_equal(arrays[3].data[1:], columns[1:, 1].astype(np.float32))

    given, mesh = meshio.read(folder / "torus.obj"), meshio.read(folder / "v.ply")
    assert np.array_equal(mesh.points, given.points)
    assert np.array_equal(mesh.cells_dict["quad"], given.cells_dict["quad"])
    for name in ("distance", "quality"):
        assert np.array_equal(mesh.point_data[name], shown)
    assert np.array_equal(mesh.point_data["distance_back"][1:], columns[1:, 1].astype(np.float32))
    share = np.where(shown >= 0, distance / np.nanmax(distance), 0)
    assert np.allclose(mesh.point_data["s"], share, atol=1e-6)
    assert np.array_equal(mesh.point_data["t"], np.where(shown >= 0, 0, 1))


def matrices(folder: pathlib.Path) -> None:
    run = ["--mesh", folder / "torus.obj", "--seeds", folder / "regions.json", "--voxel-size", "0.05", "-q",
           "-o", folder / "out.vdb", "--matrix"]
    between = [folder / "m.npy", folder / "m.csv", folder / "m.json"]
    for file in between:
        consumers.geodesic(*run, file)
    matrix = np.load(between[0], allow_pickle=False)
    assert matrix.shape == (3, 3) and (matrix == matrix.T).all() and (matrix.diagonal() == 0).all()
    columns = np.load(folder / "v.npy")
    for i in range(3):
        for j, numbers in enumerate(REGIONS.values()):
            assert abs(columns[numbers, i].min() - matrix[i, j]) < 2e-3
    document = json.loads(between[2].read_text())
    assert document["seeds"][0] == {"group": "front", "points": 3}
    assert np.array_equal(np.array(document["distance"]), matrix)
    lines = between[1].read_text().splitlines()
    assert lines[0] == "target,x,y,z," + ",".join(NAMES)
    assert lines[3].startswith("top__left,nan,nan,nan,")

    # Every vertex a target: one table, one line of summary.
    used = range(1, 1153)
    (folder / "all.csv").write_text("\n".join(map(str, used)))
    done = consumers.geodesic(*[word for word in run if word != "-q"], folder / "t.csv",
                              "--targets", folder / "all.csv")
    assert "1152 targets: distances from 0 to" in done.stderr and done.stderr.count("target") == 1, done.stderr
    table = np.genfromtxt(folder / "t.csv", delimiter=",", names=True)
    assert len(table) == 1152
    assert np.allclose(table["distance_back"], columns[1:1153, 1], atol=1e-9)
    given = meshio.read(folder / "torus.obj").points[1:1153]
    assert np.allclose(np.array([table["x"], table["y"], table["z"]]).T, given, atol=1e-12)


def samples(folder: pathlib.Path) -> None:
    run = ["--mesh", folder / "torus.obj", "--seed", "vertex:1", "--voxel-size", "0.05", "-q",
           "-o", folder / "out.vdb", "--samples"]
    for name in ("s.npz", "s.csv", "s.ply"):
        consumers.geodesic(*run, folder / name)
    archive = np.load(folder / "s.npz", allow_pickle=False)
    position, distance, gradient = archive["position"], archive["distance"], archive["gradient"]
    assert len(np.unique(position, axis=0)) == len(position) > 3000
    assert np.allclose(np.linalg.norm(archive["normal"], axis=1), 1, atol=1e-6)
    assert np.allclose(np.linalg.norm(gradient, axis=1)[distance > 0.1], 1, atol=1e-5)
    assert np.abs(np.einsum("ij,ij->i", gradient, archive["normal"])).max() < 1e-5
    assert (archive["label"] == 0).all()
    table = read_csv(folder / "s.csv")
    assert np.array_equal(table["distance"], distance) and np.array_equal(table["x"], position[:, 0])
    assert np.array_equal(np.float32(table["gy"]), np.float32(gradient[:, 1]))
    cloud = meshio.read(folder / "s.ply")
    assert np.array_equal(cloud.points, position)
    assert np.array_equal(cloud.point_data["distance"], distance)


def main() -> None:
    with consumers.temporary() as name:
        folder = pathlib.Path(name)
        vertices(folder)
        matrices(folder)
        samples(folder)
    print(f"NumPy {np.__version__}, nibabel {nibabel.__version__}, meshio {meshio.__version__}")


if __name__ == "__main__":
    sys.exit(main())
