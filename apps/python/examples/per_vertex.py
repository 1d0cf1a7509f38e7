"""Distances at the vertices of a mesh from the vertex that is farthest along y.

usage: per_vertex.py [MESH [OUT.npy]]; without a mesh, a torus
"""

import sys

import numpy as np

import igeo


def torus(n=48):
    """Vertices and faces of a torus of radii 1 and 0.4."""
    u, v = np.meshgrid(2 * np.pi * np.arange(2 * n) / (2 * n), 2 * np.pi * np.arange(n) / n, indexing="ij")
    ring = 1 + 0.4 * np.cos(v)
    vertices = np.stack([ring * np.cos(u), ring * np.sin(u), 0.4 * np.sin(v)], axis=-1).reshape(-1, 3)
    k = np.arange(2 * n * n).reshape(2 * n, n)
    a, b = k, np.roll(k, -1, axis=0)
    c, d = np.roll(b, -1, axis=1), np.roll(a, -1, axis=1)
    faces = np.concatenate([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)]).reshape(-1, 3)
    return vertices, faces


surface = igeo.Surface.read(sys.argv[1]) if len(sys.argv) > 1 else igeo.Surface.from_mesh(*torus())
top = int(np.argmax(surface.vertices[:, 1]))
distance = igeo.Solver(surface).distance([top])
np.save(sys.argv[2] if len(sys.argv) > 2 else "distance.npy", distance.on_vertices)
print(f"{len(surface.vertices)} vertices, the farthest is {distance.largest:.4f} from vertex {top}")
