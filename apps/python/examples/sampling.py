"""Farthest-point sampling of a level set, and the cell of each sample."""

import numpy as np

import igeo

axis = np.linspace(-1.3, 1.3, 72)
x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
values = np.sqrt(x**2 + y**2 + z**2) - 1
surface = igeo.Surface.from_level_set(values, spacing=axis[1] - axis[0], origin=[axis[0]] * 3)
solver = igeo.Solver(surface)

samples = solver.sample(32)
nearest = np.linalg.norm(samples[:, None] - samples, axis=2) + 9 * np.eye(32)
mesh = solver.distance(samples).mesh()
sizes = np.bincount(mesh.labels, minlength=32)
print(f"samples at least {nearest.min():.3f} apart; cells of {sizes.min()} to {sizes.max()} vertices")
assert (sizes > 0).all()
