"""Distances on a surface: one solver, many seeds."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _arguments as arguments
from . import _igeo
from ._arguments import Bending, Box, CurvatureWeight, Floats, Progress, SlopeWeight, Sphere
from ._errors import Error, InputError, warn
from ._metric import Cost, MetricReader
from .distance import Distance
from .surface import _SCHEMES, Surface


def _machine_memory() -> float:
    """Bytes; infinity where the system does not report it."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, OSError, ValueError):
        return math.inf


class Solver:
    """Everything that does not depend on the seeds: the band of voxels and the metric on it.

    Several threads may use it at once. It copies arrays and calls functions when it is made.
    """

    def __init__(
        self,
        surface: Surface,
        *,
        weight: Optional[Cost] = None,
        tensor: Optional[Cost] = None,
        obstacles: Any = None,
        weight_curvature: Union[CurvatureWeight, str, None] = None,
        weight_slope: Union[SlopeWeight, float, None] = None,
        metric_curvature: Union[Bending, str, None] = None,
        curvature_scale: Optional[float] = None,
        scheme: str = "jet",
        order: Optional[int] = None,
        band: Optional[float] = None,
        snap: Optional[float] = None,
        memory_limit: Optional[float] = None,
        progress: Progress = None,
    ) -> None:
        """
        weight: cost per unit length, above 0. Of a mesh an array (n_vertices,), linear over each
            triangle; of any surface a function that is called once with points of the surface, (n, 3),
            and returns (n,); or "FILE.vdb:GRID".
        tensor: the square of a cost per unit length, symmetric and positive definite, in world axes:
            as `weight` with (n, 3, 3). Instead of or beside a weight.
        obstacles: where no path may go. A Sphere, a Box, bool of shape (n_vertices,) of a mesh, a
            function of points (n, 3) that returns bool (n,), "FILE.vdb:GRID", or a list of these.
        weight_curvature: a CurvatureWeight, or its kind: "valley", "crest", "mean", "gaussian",
            "principal". All weights multiply.
        weight_slope: a SlopeWeight, or the steepest slope in degrees above z; steeper is an obstacle.
        metric_curvature: a Bending, "avoid" or "prefer": costs by direction, instead of a tensor.
        curvature_scale: radius over which curvature is averaged, 1 to 16 voxels; None: 2.
        scheme: "jet", second order, or "godunov" of `order` 1 or 2 (None: 2), Fast Marching in the band.
        band: half the thickness of the band, world units; None: the best one.
        snap: how far points may be from the surface, world units; None: Surface.snap.
        memory_limit: bytes that the band may take; None: the memory of the machine.
        progress: called with the name of a stage and the share done, 0 to 1, in this thread.
            An exception in it ends the work, as Ctrl-C does.
        """
        if not isinstance(surface, Surface):
            raise TypeError(f"surface is of type {type(surface).__name__}; allowed is Surface (Surface.read)")
        if order is not None and not (arguments.is_integer(order) and order in (1, 2)):
            raise InputError(f"order is {order!r}; allowed are 1 and 2")
        if order is not None and scheme == "jet":
            raise InputError(f'order is {order!r} and scheme is "jet", which has no order; take scheme="godunov"')
        if isinstance(obstacles, (list, tuple)) and len(obstacles) == 0:
            obstacles = None
        if surface._joins_gaps and scheme == "godunov":
            raise InputError(
                f"scheme is 'godunov', and {surface.name} has join_gaps, which is for jet", "leave out one of the two"
            )
        self.surface = surface
        plain = _igeo.plain_solver(
            surface._made,
            arguments.one_of(scheme, "scheme", _SCHEMES),
            order or 2,
            arguments.above_zero_or_none(band, "band"),
            -1.0 if snap is None else arguments.number(snap, "snap"),
            _machine_memory() if memory_limit is None else arguments.number(memory_limit, "memory_limit"),
            progress,
        )
        self._made = plain
        self._scheme = scheme
        curved = {
            "weight_curvature": weight_curvature,
            "weight_slope": weight_slope,
            "metric_curvature": metric_curvature,
        }
        self._require_curved(curved, tensor, curvature_scale)
        curved = {name: value for name, value in curved.items() if value is not None}
        if weight is not None or tensor is not None or obstacles is not None or curved:
            reader = MetricReader(plain, surface, progress)
            if curvature_scale is not None:
                reader.metric.curvature_scale(float(curvature_scale))
            for name, value in curved.items():
                getattr(reader, name)(value)
            self._made = self._with_metric(reader, weight, tensor, obstacles, progress)
        self._warned: set[str] = set()
        self._warned_of_surface = False
        self._warned_of_lost = False
        self._has_obstacles = obstacles is not None

    @staticmethod
    def _require_curved(curved: Mapping[str, Any], tensor: Any, scale: Optional[float]) -> None:
        """Refuses costs from curvature that have no effect or exclude each other."""
        if curved["metric_curvature"] is not None and tensor is not None:
            raise InputError("metric_curvature is given beside tensor", "leave one out: each is a cost by direction")
        if scale is None:
            return
        if curved["weight_curvature"] is None and curved["metric_curvature"] is None:
            raise InputError("curvature_scale is given without weight_curvature or metric_curvature", "leave it out")
        if not 1 <= arguments.number(scale, "curvature_scale") <= 16:
            raise InputError(f"curvature_scale is {scale:g}; allowed are 1 to 16 voxels")

    def _with_metric(
        self, reader: MetricReader, weight: Any, tensor: Any, obstacles: Any, progress: Progress
    ) -> _igeo.Solver:
        if weight is not None:
            reader.weight(weight)
        if tensor is not None:
            reader.tensor(tensor)
        several = isinstance(obstacles, (list, tuple)) and not isinstance(obstacles, (Sphere, Box))
        if several and not all(isinstance(o, (bool, np.bool_)) for o in obstacles):
            for k, one in enumerate(obstacles):
                reader.obstacle(one, f"obstacles[{k}]")
        elif obstacles is not None:
            reader.obstacle(obstacles, "obstacles")
        return reader.metric.solver(progress)

    @property
    def snap(self) -> float:
        """How far points may be from the surface, world units."""
        return self._made.snap

    def _add_seeds(self, seeds: _igeo.Seeds, value: Any, start: Any, name: str) -> None:
        """Adds one argument `seeds`: groups by name, a region, vertices or points."""
        if isinstance(value, Mapping):
            starts = arguments.starts(start, len(value), "group")
            for (group, members), begin in zip(value.items(), starts):
                self._refuse_mask_of_integers(arguments.array(members, f"{name}[{group!r}]"), f"{name}[{group!r}]")
                positions = self.surface._positions(members, f"{name}[{group!r}]")
                group = arguments.text(str(group), f"the name of {name}[{group!r}]")
                seeds.add_group(group, positions, np.full(len(positions), begin))
            return
        array = arguments.array(value, name)
        self._refuse_mask_of_integers(array, name)
        if array.dtype.kind in "iu" and array.shape == (3,) and len(set(array.tolist())) < 3:
            raise InputError(
                f"{name} is {array.tolist()}, a vertex twice",
                "write a point with floats, [0.0, 0.0, 1.0], and each vertex once",
            )
        if array.dtype.kind == "b":
            count = len(self.surface.vertices)
            inside = arguments.mask(array, name, count, "vertex")
            if not inside.any():
                raise InputError(f"{name} is a region that holds no vertex", "make it true at one vertex or more")
            if start is not None:
                raise InputError("start is given for a region, which starts at 0", "leave it out")
            seeds.add_region(self._made, inside)
            return
        positions = self.surface._positions(value, name)
        seeds.add_points(positions, arguments.starts(start, len(positions), "seed"))

    def _refuse_mask_of_integers(self, array: Any, name: str) -> None:
        """A region as 0 and 1 would be read as the vertices 0 and 1."""
        vertices = self.surface._made.vertices
        if vertices is None or array.dtype.kind not in "iu" or array.shape != (len(vertices),) or len(array) < 3:
            return
        if (array < 2).all() and (array >= 0).all():
            raise InputError(
                f"{name} has a 0 or 1 of dtype {array.dtype} for each of the {len(array)} vertices",
                "give a region as bool, by astype(bool); give vertices by number, each once",
            )

    def distance(
        self,
        seeds: Any = None,
        *,
        start: Optional[ArrayLike] = None,
        curves: Union[ArrayLike, Iterable[ArrayLike]] = (),
        signed: bool = False,
        max_distance: float = math.inf,
        targets: Optional[ArrayLike] = None,
        progress: Progress = None,
    ) -> Distance:
        """The distance from seeds.

        seeds: points of floats, (k, 3) or (3,); vertices by number, integers of shape (k,) or one; a
            region, bool (n_vertices,); or groups of points by name, {"A": [0, 1, 2], ...}, each one
            source.
        start: (k,), the distance at each point, vertex or group, 0 or more; regions and curves start at
            0. SurfaceWarning where the front of another seed arrives earlier, so that a seed has no
            effect.
        curves: polylines (m, 3) on the surface, m of 2 or more; one whose last point is its first is
            closed. One array (m, 3) is one polyline.
        signed: negative inside a region, or on the smaller side of closed curves.
        max_distance: world units times weight; farther away the distance is infinite.
        targets: points or vertices; the march stops once it has reached all of them.
        progress: as Solver.
        Raises InputError for a point farther from the surface than `snap`, KeyboardInterrupt for
        Ctrl-C. Labels count groups, points, curves and regions in this order.
        """
        asked = _igeo.Seeds()
        if seeds is not None:
            self._add_seeds(asked, seeds, start, "seeds")
        elif start is not None:
            raise InputError("start is given without seeds, and curves start at 0", "leave it out")
        for vertices in arguments.polylines(curves, "curves"):
            closed = len(vertices) > 2 and bool((vertices[0] == vertices[-1]).all())
            asked.add_curve(vertices[:-1] if closed else vertices, closed)
        asked.signed = arguments.flag(signed, "signed")
        max_distance = arguments.limit(max_distance, "max_distance")
        ends = np.empty((0, 3)) if targets is None else self.surface._positions(targets, "targets")
        made = self._made.distance(asked, max_distance, ends, targets is not None, progress)
        self._warn(made.warnings, self._lost(made))
        return Distance(made, self.surface)

    def distances(
        self,
        many: Iterable[Any],
        *,
        at: Optional[ArrayLike] = None,
        max_distance: float = math.inf,
        progress: Progress = None,
    ) -> Floats:
        """The distance from each of many seeds by itself, on all cores: row k is that of many[k].

        many: of each element what `distance` takes as seeds: [0, 5, 7] are three vertices, an array
            (k, 3) has k points.
        at: points (m, 3) or vertices, the columns; None: the vertices of the mesh.
        Shape (k, m); infinite where unreached. Memory: m numbers per row, and one march per thread.
        """
        if not isinstance(many, Iterable) or isinstance(many, (str, bytes, Mapping)):
            raise InputError(f"many is {many!r}; allowed are a list of seeds and an array (k, 3) of points")
        if isinstance(many, np.ndarray) and many.ndim == 2 and many.dtype.kind in "iu":
            raise InputError(
                f"many is an array {many.shape} of integers, which are points or vertices",
                "write points with floats; give the vertices of each row as a list of lists, by tolist()",
            )
        all_seeds = []
        for k, value in enumerate(many):
            all_seeds.append(_igeo.Seeds())
            self._add_seeds(all_seeds[-1], value, None, f"many[{k}]")
        if not all_seeds:
            raise InputError("many is empty", "give one seed or more")
        if at is None:
            self._require_mesh("distances")
        points = None if at is None else self.surface._positions(at, "at")
        max_distance = arguments.limit(max_distance, "max_distance")
        look = not self._warned_of_lost
        rows, found, lost = self._made.distances(all_seeds, points, max_distance, look, progress)
        self._warn(found, lost)
        return rows

    def matrix(self, seeds: Any, targets: Optional[ArrayLike] = None, *, progress: Progress = None) -> Floats:
        """Distances between seeds, (k, k), or from each to each target, (k, m); on all cores.

        seeds: points, vertices or groups, as `distance` takes them; between groups it is the
            distance of their nearest points. targets: points or vertices.
        Between seeds each number is the mean of both directions. For the scheme "jet".
        """
        self._require_jet("matrix")
        if not isinstance(seeds, Mapping) and arguments.array(seeds, "seeds").dtype.kind == "b":
            raise InputError(
                "seeds is a region, and a matrix has rows of points, vertices and groups",
                "take distances([seeds], at=targets), or give the vertices of the region as a group",
            )
        asked = _igeo.Seeds()
        self._add_seeds(asked, seeds, None, "seeds")
        ends = np.empty((0, 3)) if targets is None else self.surface._positions(targets, "targets")
        found = self._made.distance(asked, math.inf, ends, False, progress)
        look = not self._warned_of_lost
        values, lost = found.matrix(look, progress)
        self._warn(found.warnings, [*self._lost(found), *lost])
        return values

    def _pairs(
        self, sources: ArrayLike, targets: ArrayLike, paths: bool, straighten: bool, skip: bool, progress: Progress
    ) -> tuple[Floats, list[tuple[str, Floats]]]:
        skip = arguments.flag(skip, "skip_off_surface")
        starts = self.surface._positions(sources, "sources")
        ends = self.surface._positions(targets, "targets")
        if len(starts) != len(ends):
            raise InputError(f"sources has {len(starts)} points and targets {len(ends)}; allowed are as many of both")
        look = not self._warned_of_lost
        distance, lines, found, lost = self._made.pairs(starts, ends, paths, straighten, skip, look, progress)
        self._warn(found, lost, 5)
        return distance, lines

    def pairs(
        self,
        sources: ArrayLike,
        targets: ArrayLike,
        *,
        skip_off_surface: bool = False,
        progress: Progress = None,
    ) -> Floats:
        """The distance from sources[k] to targets[k], (k,), world units times weight; on all cores.

        sources, targets: points (k, 3) or vertices (k,), equally many. Each pair is solved on the part
        of the surface around it, and pairs of one source share a march. Infinite where no path
        joins them. For the scheme "jet".
        skip_off_surface: NaN for a pair with a point farther from the surface than `snap`, which
            raises InputError otherwise.
        """
        self._require_jet("pairs")
        return self._pairs(sources, targets, False, False, skip_off_surface, progress)[0]

    def pair_paths(
        self,
        sources: ArrayLike,
        targets: ArrayLike,
        *,
        straighten: bool = False,
        skip_off_surface: bool = False,
        progress: Progress = None,
    ) -> list[Floats]:
        """The geodesic from sources[k] to targets[k], (n, 3) each; (0, 3) where none joins them.

        straighten: relax them to locally shortest curves, free of the error of the distance. All else
        as `pairs`.
        """
        self._require_jet("pair_paths")
        straighten = arguments.flag(straighten, "straighten")
        _, found = self._pairs(sources, targets, True, straighten, skip_off_surface, progress)
        for k, (status, _) in enumerate(found):
            if status == "stalled":
                raise Error(f"the path of pair {k} is stalled", "use smaller voxels, or move its points")
        return [points for _, points in found]

    def via(
        self, points: ArrayLike, *, closed: bool = False, straighten: bool = False, progress: Progress = None
    ) -> Floats:
        """The geodesic through points in their order, (n, 3).

        points: (k, 3) or vertices (k,), k of 2 or more, of a closed curve 3. Each leg between two of
        them is a straightened geodesic of the scheme "jet".
        closed: a leg leads back to the first point; the last vertex repeats the first.
        straighten: relax the curve as a whole: the points in between then only select how it winds
            around the surface, and a closed curve becomes a closed geodesic that passes none of them.
        Shape (0, 3) where no path joins two consecutive points, and where a closed curve contracts to
        a point. Raises InputError for a point farther from the surface than `snap`.
        """
        self._require_jet("via")
        closed, straighten = arguments.flag(closed, "closed"), arguments.flag(straighten, "straighten")
        line = self._made.via(self.surface._positions(points, "points"), closed, straighten, progress)
        self._warn()
        return line

    def sample(self, count: int, seeds: Any = None, *, progress: Progress = None) -> Floats:
        """Farthest-point sampling: `count` points, (count, 3), each as far as possible from those
        before it and from `seeds`. For the scheme "jet"."""
        self._require_jet("sample")
        wanted = arguments.integer(count, "count", 2**63 - 1)
        asked = _igeo.Seeds()
        if seeds is not None:
            self._add_seeds(asked, seeds, None, "seeds")
        asked.samples = wanted
        found = self._made.distance(asked, math.inf, np.empty((0, 3)), False, progress)
        self._warn(found.warnings, self._lost(found))
        return found.seeds[-wanted:]

    def shoot(
        self, start: ArrayLike, direction: ArrayLike, length: float, *, progress: Progress = None
    ) -> Floats:
        """The geodesic that starts at a point in a direction, (n, 3).

        start: a point or a vertex. direction: (3,), only its part along the surface is used. length:
        world units.
        """
        points = self.surface._positions(start, "start")
        if len(points) != 1:
            raise InputError(f"start holds {len(points)} points; allowed is one")
        along = arguments.vector(direction, "direction")
        line, found = self._made.shoot(points[0], along, arguments.number(length, "length"), progress)
        self._warn(found)
        return line

    def _require_mesh(self, what: str) -> None:
        if self.surface.kind != "mesh":
            raise InputError(
                f"{what} at vertices needs a mesh, and {self.surface.name} is of kind {self.surface.kind}",
                "give points by at",
            )

    def _require_jet(self, what: str) -> None:
        if self._scheme != "jet":
            raise InputError(
                f"{what} is marched with jet, and scheme={self._scheme!r} is asked for",
                "leave scheme out; for distances by godunov take distance or distances",
            )

    def _lost(self, made: _igeo.Distance) -> list[str]:
        """Warnings of lost points, until one has been given."""
        return [] if self._warned_of_lost else made.lost

    def _of_surface(self) -> list[str]:
        """Warnings of the band, and once of the whole surface, when its band has been made."""
        if self._warned_of_surface:
            return []
        self._warned_of_surface = self._made.has_whole_band
        found = self._made.warnings()
        if self._warned_of_surface and self._has_obstacles and not _igeo.blocks_any(self._made):
            found.append("no obstacle meets the surface, so nothing is blocked")
        found = [w for w in found if w not in self._warned]
        self._warned.update(found)
        return found

    def _warn(self, found: Iterable[str] = (), lost: Iterable[str] = (), level: int = 4) -> None:
        """Warns at the line that calls a method: of the surface and of lost points once."""
        of_surface = self._of_surface()
        found = [w for w in found if w not in self._warned]
        lost = [w for w in lost if w]
        self._warned_of_lost = self._warned_of_lost or bool(lost)
        warn([*of_surface, *found, *lost], level)

    def __repr__(self) -> str:
        return f"<igeo.Solver on {self.surface.name}: band {self._made.band:.4g} voxels, snap {self.snap:.4g}>"
