"""A matrix of distances between regions of a mesh, given as a label per vertex."""

import numpy as np

import igeo

# A bumpy sheet, and the label 0 to 3 of each vertex: its quarter, or -1 near the border between them.
n = 41
x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
vertices = np.column_stack([x.ravel(), y.ravel(), 0.1 * np.sin(6 * x.ravel()) * np.cos(6 * y.ravel())])
k = np.arange(n * n).reshape(n, n)
a, b, c, d = k[:-1, :-1].ravel(), k[1:, :-1].ravel(), k[1:, 1:].ravel(), k[:-1, 1:].ravel()
faces = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
labels = 2 * (vertices[:, 0] > 0.5) + (vertices[:, 1] > 0.5)
labels[(np.abs(vertices[:, :2] - 0.5) < 0.1).any(axis=1)] = -1

solver = igeo.Solver(igeo.Surface.from_mesh(vertices, faces, resolution=96))
regions = {f"region {label}": np.flatnonzero(labels == label) for label in range(4)}
matrix = solver.matrix(regions)
assert np.allclose(matrix, matrix.T) and (np.diag(matrix) == 0).all()
print(np.array2string(matrix, precision=4))
