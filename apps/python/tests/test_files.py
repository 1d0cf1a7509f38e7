"""Files in and out, the same numbers as the program's, and notebooks."""

import os
import subprocess
import sys

import numpy as np
import pytest

import igeo
from conftest import ROOT, ball, run_program, write_off

DATA = ROOT / "data"


def test_names_may_be_bytes(tmp_path, sphere_solver):
    write_off(tmp_path / "ball.off", *ball(8))
    file = os.fsencode(tmp_path / "ball.off")
    surface = igeo.Surface.read(file, resolution=32)
    assert surface.kind == "mesh" and len(surface.vertices) == len(ball(8)[0])
    sphere_solver.distance([0, 0, 1.0]).to_vdb(os.fsencode(tmp_path / "d.vdb"))
    igeo.Solver(igeo.Surface.read(DATA / "sphere.vdb"), weight=os.fsencode(tmp_path / "d.vdb"))
    assert len(sphere_solver.distance([0, 0, 1.0]).image(os.devnull, width=64, height=48)) > 100  # any name


@pytest.mark.parametrize("whole", ["vertex", "point"])
def test_vertices_are_those_of_the_program(tmp_path, whole):
    """Of a mesh in memory and of its file, bit by bit."""
    vertices, faces = ball(12)
    vertices = vertices * [1, 0.8, 0.6]
    write_off(tmp_path / "ball.off", vertices, faces)
    seed = "vertex:40" if whole == "vertex" else ",".join(map(repr, vertices[40].tolist()))
    files = ["--per-vertex", tmp_path / "of_program.npy", "-o", "/dev/null"]
    run_program(tmp_path / "ball.off", "--seed", seed, "--resolution", 40, *files)
    expected = np.load(tmp_path / "of_program.npy")
    seeds = [40] if whole == "vertex" else vertices[40]
    for surface in (
        igeo.Surface.from_mesh(vertices, faces, resolution=40),
        igeo.Surface.read(tmp_path / "ball.off", resolution=40),
    ):
        found = igeo.Solver(surface).distance(seeds).on_vertices
        assert found.tobytes() == expected.tobytes()


def test_matrix_is_that_of_the_program(tmp_path):
    vertices, faces = ball(12)
    write_off(tmp_path / "ball.off", vertices, faces)
    seeds = [f"--seed=vertex:{k}" for k in (0, 40, 80)]
    run_program(tmp_path / "ball.off", *seeds, "--resolution", 40, "--matrix", tmp_path / "m.npy", "-o", "/dev/null")
    solver = igeo.Solver(igeo.Surface.from_mesh(vertices, faces, resolution=40))
    assert solver.matrix([0, 40, 80]).tobytes() == np.load(tmp_path / "m.npy").tobytes()


def test_grid_is_that_of_the_program(tmp_path):
    pyopenvdb = pytest.importorskip("pyopenvdb")
    run_program(DATA / "torus.vdb", "--seed", "1.3,0,0", "-o", tmp_path / "of_program.vdb", "--snap", 9)
    surface = igeo.Surface.read(DATA / "torus.vdb")
    igeo.Solver(surface, snap=9).distance([1.3, 0, 0]).to_vdb(tmp_path / "here.vdb")
    values = []
    for file in ("here.vdb", "of_program.vdb"):
        array = np.zeros((64, 64, 64), np.float32)
        pyopenvdb.read(str(tmp_path / file), f"{surface.name}_geodesic").copyToArray(array)
        values.append(array)
    assert (values[0] == values[1]).all() and 0 < values[0].min() < values[0].max()


def test_level_sets_of_files_and_of_pyopenvdb(tmp_path):
    surface = igeo.Surface.read(DATA / "sphere.vdb")
    named = igeo.Surface.read(DATA / "sphere.vdb", grid=surface.name)
    expected = igeo.Solver(surface).distance([0, 0, 1.0]).at([[0, 0, -1.0]])[0]
    assert expected == pytest.approx(np.pi, abs=5e-3)
    assert igeo.Solver(named).distance([0, 0, 1.0]).at([[0, 0, -1.0]])[0] == expected
    with pytest.raises(igeo.Error, match="nothing"):
        igeo.Surface.read(DATA / "sphere.vdb", grid="nothing")
    pyopenvdb = pytest.importorskip("pyopenvdb")
    grid = pyopenvdb.read(str(DATA / "sphere.vdb"), surface.name)
    found = igeo.Solver(igeo.Surface.from_openvdb(grid)).distance([0, 0, 1.0]).at([[0, 0, -1.0]])[0]
    assert found == expected
    igeo.Solver(surface).distance([0, 0, 1.0]).to_vdb(tmp_path / "d.vdb", name="d")
    written = pyopenvdb.read(str(tmp_path / "d.vdb"), "d")
    assert written.activeVoxelCount() > 1000


def test_points_and_volumes_of_files(tmp_path):
    vertices, _ = ball(40)
    np.savetxt(tmp_path / "ball.xyz", vertices)
    points = igeo.Surface.read(tmp_path / "ball.xyz")
    assert points.kind == "points" and len(points.vertices) == len(vertices)
    header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 20 20 20\nencoding: raw\n\n"
    inside = np.linalg.norm(np.indices((20, 20, 20)) - 9.5, axis=0) < 7
    (tmp_path / "mask.nrrd").write_bytes(header.encode() + np.asfortranarray(inside).tobytes("F"))
    with pytest.warns(igeo.SurfaceWarning, match="mask"):
        of_file = igeo.Surface.read(tmp_path / "mask.nrrd")
    with pytest.warns(igeo.SurfaceWarning, match="mask"):
        of_array = igeo.Surface.from_volume(inside)
    assert (of_file.vertices == of_array.vertices).all()


def test_pictures_and_notebooks(tmp_path, sphere_solver):
    distance = sphere_solver.distance([0, 0, 1.0])
    png = distance.image(tmp_path / "a.png", width=64, height=48, paths_from=[[1.0, 0, 0]], spacing=0)
    assert (tmp_path / "a.png").read_bytes() == png and png[:8] == b"\x89PNG\r\n\x1a\n"
    assert png != distance.image(width=64, height=48)
    assert distance._repr_png_()[:4] == b"\x89PNG"
    assert "level set" in sphere_solver.surface._repr_html_()
    assert "1 seeds" in repr(distance) and "band" in repr(sphere_solver) and "level_set" in repr(sphere_solver.surface)


def test_the_page_is_one_file(tmp_path, sphere_solver):
    distance = sphere_solver.distance([0, 0, 1.0])
    try:
        distance.view(tmp_path / "a.html", paths_from=[[1.0, 0, 0]], spacing=0.5)
    except igeo.Error as missing:
        pytest.skip(str(missing))
    page = (tmp_path / "a.html").read_bytes()
    assert page.startswith(b"<!") and b"path_0" in page and b"http-equiv" in page


def test_vtk_is_longer_along_edges(tmp_path):
    """vtkDijkstraGraphGeodesicPath keeps to edges: never shorter, and equal along them."""
    vtk = pytest.importorskip("vtkmodules.all")
    vertices, faces = ball(24)
    points, cells = vtk.vtkPoints(), vtk.vtkCellArray()
    for v in vertices:
        points.InsertNextPoint(*v)
    for f in faces:
        cells.InsertNextCell(3, [int(k) for k in f])
    mesh = vtk.vtkPolyData()
    mesh.SetPoints(points)
    mesh.SetPolys(cells)
    dijkstra = vtk.vtkDijkstraGraphGeodesicPath()
    dijkstra.SetInputData(mesh)
    dijkstra.SetStartVertex(0)
    dijkstra.SetEndVertex(len(vertices) - 1)
    dijkstra.Update()
    weights = vtk.vtkDoubleArray()
    dijkstra.GetCumulativeWeights(weights)
    along_edges = np.array([weights.GetValue(k) for k in range(len(vertices))])
    found = igeo.Solver(igeo.Surface.from_mesh(vertices, faces)).distance([0]).on_vertices
    assert (found < along_edges + 1e-3).all()
    ring = slice(1, 49)  # one edge away
    assert np.abs(found[ring] - along_edges[ring]).max() < 1e-4


EXAMPLES = sorted((ROOT / "apps/python/examples").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=[e.stem for e in EXAMPLES])
def test_examples(example, tmp_path):
    if "matplotlib" in example.read_text():
        pytest.importorskip("matplotlib")
    done = subprocess.run([sys.executable, example], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_code_of_the_documentation(tmp_path, monkeypatch):
    """The blocks of docs/python.md, one after the other."""
    text = (ROOT / "docs/python.md").read_text()
    blocks = [part.split("```")[0] for part in text.split("```python\n")[1:]]
    assert len(blocks) > 3
    write_off(tmp_path / "model.off", *ball(12))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    exec(compile("\n".join(blocks), "docs/python.md", "exec"), {})
