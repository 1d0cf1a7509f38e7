"""Shapes with exact distances, and the program."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]


def program() -> str:
    path = os.environ.get("IGEO_PROGRAM", str(ROOT / "build/release/bin/implicit-geodesic"))
    if not os.path.exists(path):
        pytest.skip(f"no program {path}")
    return path


def run_program(*arguments) -> None:
    done = subprocess.run([program(), *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def grid(n: int, reach: float):
    """Axes of n points from -reach to reach, and their spacing and origin."""
    axis = np.linspace(-reach, reach, n)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    return x, y, z, axis[1] - axis[0], np.full(3, -reach)


def sheet(n: int, side: float = 1.0, height=lambda x, y: 0 * x):
    """A square of n by n vertices over x and y: vertices and faces."""
    x, y = np.meshgrid(np.linspace(0, side, n), np.linspace(0, side, n), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), height(x, y).ravel()])
    k = np.arange(n * n).reshape(n, n)
    a, b, c, d = k[:-1, :-1].ravel(), k[1:, :-1].ravel(), k[1:, 1:].ravel(), k[:-1, 1:].ravel()
    return vertices, np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def ball(n: int = 24):
    """A unit sphere of 2 n by n facets: vertices and faces."""
    theta, phi = np.meshgrid(np.pi * np.arange(1, n) / n, np.pi * np.arange(2 * n) / n, indexing="ij")
    ring = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    vertices = np.vstack([[0, 0, 1.0], ring.reshape(-1, 3), [0, 0, -1.0]])
    faces, last = [], len(vertices) - 1
    for j in range(2 * n):
        k = (j + 1) % (2 * n)
        faces.append([0, 1 + j, 1 + k])
        faces.append([last, last - 2 * n + k, last - 2 * n + j])
        for i in range(n - 2):
            a, b = 1 + i * 2 * n, 1 + (i + 1) * 2 * n
            faces += [[a + j, b + j, b + k], [a + j, b + k, a + k]]
    return vertices, np.array(faces)


def box_mesh():
    """The unit cube: 8 vertices, numbered by x + 2 y + 4 z, and 12 triangles."""
    vertices = np.array([[k & 1, k >> 1 & 1, k >> 2 & 1] for k in range(8)], dtype=float)
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return vertices, np.array([t for q in quads for t in (q[:3], [q[0], q[2], q[3]])])


def write_off(path, vertices, faces) -> None:
    """With all digits, so that reading gives the same doubles."""
    with open(path, "w", encoding="ascii") as file:
        file.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        for v in vertices:
            file.write(" ".join(repr(float(x)) for x in v) + "\n")
        for f in faces:
            file.write("3 " + " ".join(map(str, f)) + "\n")


@pytest.fixture(scope="session")
def sphere_solver():
    """On the level set of a unit sphere."""
    import igeo

    x, y, z, spacing, origin = grid(64, 1.3)
    values = np.sqrt(x**2 + y**2 + z**2) - 1
    return igeo.Solver(igeo.Surface.from_level_set(values, spacing=spacing, origin=origin))


@pytest.fixture(scope="session")
def sheet_solver():
    """On a flat square of side 1."""
    import igeo

    return igeo.Solver(igeo.Surface.from_mesh(*sheet(21), resolution=64))
