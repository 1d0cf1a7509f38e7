"""A path over terrain that avoids steep ground and a lake, drawn as a picture."""

import numpy as np

import igeo

# Heights on a grid of 1000 by 1000 m.
n = 81
x, y = np.meshgrid(np.linspace(0, 1000, n), np.linspace(0, 1000, n), indexing="ij")
height = 150 * np.exp(-((x - 500) ** 2 + (y - 450) ** 2) / 30000) + 20 * np.sin(x / 120) * np.cos(y / 150)
vertices = np.column_stack([x.ravel(), y.ravel(), height.ravel()])
k = np.arange(n * n).reshape(n, n)
a, b, c, d = k[:-1, :-1].ravel(), k[1:, :-1].ravel(), k[1:, 1:].ravel(), k[:-1, 1:].ravel()
faces = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])

# The cost of a meter, by the slope at each vertex: 2 at 30 degrees.
along_x, along_y = np.gradient(height, 1000 / (n - 1))
slope = np.hypot(along_x, along_y).ravel()
weight = 1 + (slope / np.tan(np.radians(30))) ** 2
lake = igeo.Sphere([300, 700, height[24, 56]], 90)

surface = igeo.Surface.from_mesh(vertices, faces, resolution=160, name="terrain")
solver = igeo.Solver(surface, weight=weight, obstacles=lake)
distance = solver.distance([[50.0, 450, height[4, 36]]])
goal = int(k[76, 36])
path = distance.path(goal)
length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
print(f"{length:.0f} m of path cost {distance.on_vertices[goal]:.0f}; the straight line is {900} m")
distance.image("terrain.png", width=640, height=480, eye=[500, -900, 1100], up=[0, 0, 1], paths_from=[goal])
