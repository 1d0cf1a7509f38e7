"""Weights, tensors and obstacles as arrays and functions."""

import numpy as np
import pytest

import igeo
from conftest import sheet

# 1.5 times what was measured: 1.3e-3, 5.4e-7, 9.1e-5, 5.7e-3.
WEIGHT, TENSOR, TURNED, OBSTACLE = 1.9e-3, 8.1e-7, 1.4e-4, 8.6e-3


@pytest.fixture(scope="module")
def flat():
    return igeo.Surface.from_mesh(*sheet(21), resolution=64)


def test_weight_by_function_is_called_once(flat):
    calls = []

    def weight(points):
        calls.append(points)
        return np.full(len(points), 3.0)

    solver = igeo.Solver(flat, weight=weight)
    for seed in (0, 220):
        exact = np.linalg.norm(flat.vertices - flat.vertices[seed], axis=1)
        assert np.abs(solver.distance([seed]).on_vertices - 3 * exact).max() < 1e-5
    assert len(calls) == 1 and calls[0].ndim == 2 and calls[0].shape[1] == 3
    assert np.abs(calls[0][:, 2]).max() < 1e-9  # on the surface
    gradient = solver.distance([220]).gradient_at([[0.9, 0.5, 0]])
    assert np.linalg.norm(gradient) == pytest.approx(3, abs=1e-4)


def test_weight_that_varies(flat):
    """With the weight exp(x) the distance along x is exp(x) - 1, by array and by function."""
    seeds = np.flatnonzero(flat.vertices[:, 0] == 0)
    line = [[[0, 0, 0], [0, 1, 0]]]
    middle = np.abs(flat.vertices[:, 1] - 0.5) < 0.01
    exact = np.exp(flat.vertices[middle, 0]) - 1
    of_array = igeo.Solver(flat, weight=np.exp(flat.vertices[:, 0]))
    of_function = igeo.Solver(flat, weight=lambda p: np.exp(p[:, 0]))
    assert len(seeds) == 21
    for solver in (of_array, of_function):
        assert np.abs(solver.distance(curves=line).on_vertices[middle] - exact).max() < WEIGHT


def test_tensor(flat):
    """Cost 2 along x, 1 along y: an ellipse, by array and by function."""
    g = np.diag([4.0, 1.0, 1.0])
    stretched = flat.vertices * [2, 1, 1]
    exact = np.linalg.norm(stretched - stretched[220], axis=1)
    of_array = igeo.Solver(flat, tensor=np.broadcast_to(g, (441, 3, 3)))
    of_function = igeo.Solver(flat, tensor=lambda p: np.broadcast_to(g, (len(p), 3, 3)))
    for solver in (of_array, of_function):
        assert np.abs(solver.distance([220]).on_vertices - exact).max() < TENSOR


def test_tensors_turn_with_a_level_set():
    """Axes of the array that are turned by 30 degrees: the tensor is still that of the world."""
    axis = np.linspace(-0.8, 0.8, 65)
    turn = np.array([[np.cos(0.5), -np.sin(0.5), 0], [np.sin(0.5), np.cos(0.5), 0], [0, 0, 1]])
    affine = np.eye(4)
    affine[:3, :3] = turn * (axis[1] - axis[0])
    affine[:3, 3] = turn @ np.full(3, axis[0])
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    surface = igeo.Surface.from_level_set(np.sqrt(x**2 + y**2 + z**2) - 0.6, affine=affine)
    turned = igeo.Solver(surface, tensor=lambda p: np.broadcast_to(np.diag([4.0, 1, 1]), (len(p), 3, 3)))
    found = turned.distance([0, 0, 0.6]).at([[0, 0.6, 0]])[0]
    assert found == pytest.approx(0.3 * np.pi, abs=TURNED)  # a great circle in the plane x = 0 costs 1


def wall(points):
    return (np.abs(points[:, 0] - 0.5) < 0.05) & (points[:, 1] < 0.75)




@pytest.mark.parametrize("shape", ["box", "function", "vertices", "list"])
def test_obstacles(flat, shape):
    box = igeo.Box([0.45, -1, -1], [0.55, 0.75, 1])
    given = {
        "box": box,
        "function": wall,
        "vertices": (np.abs(flat.vertices[:, 0] - 0.5) < 0.06) & (flat.vertices[:, 1] < 0.76),
        "list": [box, igeo.Sphere([0.9, 0.9, 0], 0.01)],
    }[shape]
    distance = igeo.Solver(flat, obstacles=given).distance([[0.1, 0.5, 0]])
    found = distance.at([[0.9, 0.5, 0]])[0]
    exact = 2 * np.hypot(0.35, 0.25) + 0.1
    assert found == pytest.approx(exact, abs=OBSTACLE)
    blocked = distance.on_vertices[[10 * 21 + 2]]
    assert np.isinf(blocked).all()


def test_idle_obstacles_are_warned_of(flat):
    solver = igeo.Solver(flat, obstacles=igeo.Sphere([9, 9, 9], 1))
    with pytest.warns(igeo.SurfaceWarning, match="nothing is blocked"):
        solver.distance([0])


def test_grids_of_files(flat, tmp_path):
    """A weight in a .vdb file, written by the module itself."""
    file = tmp_path / "weight.vdb"
    igeo.Solver(flat).distance([0], start=[2.0]).to_vdb(file)
    found = igeo.Solver(flat, weight=f"{file}:mesh_geodesic").distance([220]).on_vertices
    assert found[220] == 0 and found[0] > 2 * np.hypot(0.5, 0.5)
