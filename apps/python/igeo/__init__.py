"""Geodesic distances and paths on level sets, meshes and points.

    surface = igeo.Surface.read("bunny.obj")
    solver = igeo.Solver(surface)
    distance = solver.distance([0])      # from vertex 0
    distance.on_vertices                 # one number per vertex of the file
    distance.path([0.1, 0.2, 0.3])       # the geodesic from there, (n, 3)

Positions and lengths are in world units: those of the file or the arrays. Distances are world units
times weight, where there is a weight.
"""

from ._arguments import Bending, Box, CurvatureWeight, SlopeWeight, Sphere
from ._errors import Error, FileError, InputError, SurfaceWarning
from ._igeo import __version__, color_maps
from ._threads import threads
from .distance import Distance, Isoline, LogMap, Mesh
from .solver import Solver
from .surface import Surface

__all__ = [
    "Bending",
    "Box",
    "CurvatureWeight",
    "Distance",
    "Error",
    "FileError",
    "InputError",
    "Isoline",
    "LogMap",
    "Mesh",
    "SlopeWeight",
    "Solver",
    "Sphere",
    "Surface",
    "SurfaceWarning",
    "__version__",
    "color_maps",
    "threads",
]

