"""The metric of a solver, from its arguments."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _arguments as arguments
from . import _igeo
from ._arguments import Bending, Box, CurvatureWeight, Floats, OfPoints, Path, Progress, SlopeWeight, Sphere
from ._errors import InputError, warn
from .surface import Surface

_CURVATURES = ("valley", "crest", "mean", "gaussian", "principal")

# How often the intervals that hold the rim of an obstacle are halved: it is then right to 1/64 voxel.
_HALVINGS = 5

# An array per vertex, a function of foot points, or FILE[:GRID] of a .vdb file.
Cost = Union[ArrayLike, OfPoints, Path]


def _is_file(value: Any) -> bool:
    return isinstance(value, (str, bytes, os.PathLike))


class MetricReader:
    """Makes a metric from the arguments of a solver."""

    def __init__(self, plain: _igeo.Solver, surface: Surface, progress: Progress) -> None:
        self._plain, self._surface, self._progress = plain, surface, progress
        self._feet: Optional[Floats] = None
        self.metric = _igeo.Metric(plain)

    def _at_feet(self, function: Callable[[Floats], ArrayLike]) -> Any:
        """The values of a function at all foot points; it is called once, and may change its array."""
        if self._feet is None:
            self._feet = _igeo.foot_points(self._plain, self._progress)
        return function(self._feet.copy())

    def _nodes(self) -> int:
        return 0 if self._feet is None else len(self._feet)

    def _vertices(self, name: str) -> int:
        if self._surface.kind != "mesh":
            raise InputError(
                f"{name} is an array, and {self._surface.name} is no mesh",
                f"give {name} as a function of points (n, 3), or as a grid in a .vdb file",
            )
        return len(self._surface.vertices)

    def weight(self, value: Cost) -> None:
        if _is_file(value):
            warn(self.metric.weight_by_grid(arguments.path(value, "weight")), 6)
        elif callable(value):
            found = self._at_feet(value)
            found = arguments.costs(found, "what weight returns", self._nodes(), "point")
            self.metric.weight_by_node(found.astype(np.float32))
        else:
            count = self._vertices("weight")
            self.metric.weight_by_vertex(arguments.costs(value, "weight", count, "vertex"))

    def tensor(self, value: Cost) -> None:
        if _is_file(value):
            warn(self.metric.tensor_by_grid(arguments.path(value, "tensor")), 6)
        elif callable(value):
            found = self._at_feet(value)
            found = arguments.tensors(found, "what tensor returns", self._nodes(), "point")
            self.metric.tensor_by_node(found)
        else:
            count = self._vertices("tensor")
            found = arguments.tensors(value, "tensor", count, "vertex")
            self.metric.tensor_by_vertex(found, self._progress)

    def weight_curvature(self, value: Union[CurvatureWeight, str]) -> None:
        given = arguments.made_of(value, CurvatureWeight, "weight_curvature")
        kind = arguments.one_of(given.kind, "weight_curvature", _CURVATURES)
        self.metric.weight_by_curvature(
            kind, arguments.number(given.eps, "weight_curvature.eps"), arguments.number(given.p, "weight_curvature.p")
        )

    def weight_slope(self, value: Union[SlopeWeight, float]) -> None:
        given = arguments.made_of(value, SlopeWeight, "weight_slope")
        up = np.eye(3)["xyz".index(arguments.one_of(given.up, "weight_slope.up", ("x", "y", "z")))]
        steepest = arguments.number(given.max, "weight_slope.max")
        if steepest >= 90:
            raise InputError(f"weight_slope.max is {steepest:g} degrees; allowed are degrees below 90")
        self.metric.weight_by_slope(up, math.radians(steepest), arguments.number(given.power, "weight_slope.power"))

    def metric_curvature(self, value: Union[Bending, str]) -> None:
        given = arguments.made_of(value, Bending, "metric_curvature")
        kind = arguments.one_of(given.kind, "metric_curvature", ("avoid", "prefer"))
        self.metric.tensor_by_curvature(kind, arguments.above_zero_or_none(given.length, "metric_curvature.length"))

    def obstacle(self, value: Any, name: str) -> None:
        if isinstance(value, Sphere):
            center = arguments.vector(value.center, f"{name}.center")
            self.metric.block_sphere(center, arguments.number(value.radius, f"{name}.radius"))
        elif isinstance(value, Box):
            low, high = arguments.vector(value.low, f"{name}.low"), arguments.vector(value.high, f"{name}.high")
            if not (low <= high).all():
                raise InputError(f"{name}.low is {low}; allowed is up to high, {high}")
            self.metric.block_box(low, high)
        elif _is_file(value):
            warn(self.metric.block_grid(arguments.path(value, name)), 6)
        elif callable(value):
            self._obstacle_of_points(value, name)
        else:
            count = self._vertices(name)
            blocked = arguments.mask(value, name, count, "vertex")
            if blocked.any():
                self.metric.block_vertices(blocked)

    def _obstacle_of_points(self, function: Callable[[Floats], ArrayLike], name: str) -> None:
        """An obstacle whose rim is where the function changes, found by halving."""

        def checked(found: ArrayLike, points: int) -> Any:
            return arguments.mask(found, f"what {name} returns", points, "point")

        blocked = checked(self._at_feet(function), self._nodes())
        if not blocked.any():
            return
        rim = _igeo.ObstacleRim(self._plain, blocked)
        for _ in range(_HALVINGS):
            middles = rim.middles()
            if len(middles) > 0:
                rim.halve(checked(function(middles), len(middles)))
        self.metric.block_inside(rim, name)
