"""The error on a sphere over the voxel size, with matplotlib: second order."""

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

import igeo  # noqa: E402

points = np.random.default_rng(1).normal(size=(2000, 3))
points /= np.linalg.norm(points, axis=1, keepdims=True)
exact = np.arccos(points[:, 2])

sizes, errors = [], []
for n in (24, 48, 96):
    axis = np.linspace(-1.3, 1.3, n)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    values = np.sqrt(x**2 + y**2 + z**2) - 1
    surface = igeo.Surface.from_level_set(values, spacing=axis[1] - axis[0], origin=[axis[0]] * 3)
    found = igeo.Solver(surface).distance([0, 0, 1.0]).at(points)
    sizes.append(surface.voxel_size)
    errors.append(np.abs(found - exact).mean())

rate = np.log(errors[0] / errors[-1]) / np.log(sizes[0] / sizes[-1])
print(f"mean errors {', '.join(f'{e:.2e}' for e in errors)}: order {rate:.2f}")
assert rate > 1.7
plt.loglog(sizes, errors, "o-", label=f"order {rate:.2f}")
plt.xlabel("voxel size")
plt.ylabel("mean error")
plt.legend()
plt.savefig("convergence.png")
