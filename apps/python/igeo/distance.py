"""Results of a solver."""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments as arguments
from . import _igeo
from ._arguments import Floats, Path, Progress
from ._errors import Error, InputError, warn
from .surface import Surface

Labels = NDArray[np.int32]
_MOST_PIXELS = 16384


class Isoline(NamedTuple):
    """A line on which the distance is `level`."""

    level: float  # negative where signed seeds enclose it
    points: Floats  # (n, 3); no repeats
    closed: bool  # the last point is joined to the first


class Mesh(NamedTuple):
    """The surface as triangles that carry the distance."""

    vertices: Floats  # (n, 3)
    faces: NDArray[np.uint32]  # (m, 3), counter-clockwise seen from outside
    distance: Floats  # (n,), infinite where unreached
    labels: Labels  # (n,), -1 where unreached; all -1 where Distance.labels raises InputError
    gradient: NDArray[np.float32]  # (n, 3), of the distance along the surface
    normals: NDArray[np.float32]  # (n, 3), unit


class LogMap:
    """The logarithmic map: the position of points relative to the nearest seed, as vectors (u, v) in
    its tangent plane.

    The length is the distance; the direction is that in which the shortest path leaves the seed.
    """

    def __init__(self, made: _igeo.LogMap, surface: Surface) -> None:
        self._made = made
        self.surface = surface

    @cached_property
    def on_vertices(self) -> NDArray[np.float32]:
        """(n, 2), numbered as the mesh; NaN where unreached, 0 at vertices that are seeds. Read-only."""
        return arguments.read_only(self.at(np.arange(len(self.surface.vertices))))

    def at(self, points: ArrayLike, *, progress: Progress = None) -> NDArray[np.float32]:
        """(n, 2), at the points of the surface nearest to points (n, 3), or at vertices; world units times
        weight, NaN where unreached.

        Raises InputError for a point farther from the surface than Solver.snap.
        """
        return self._made.at(self.surface._positions(points, "points"), progress)

    @property
    def axes(self) -> Floats:
        """(k, 2, 3): for each seed the unit vectors along u and v; u x v is its normal."""
        return self._made.axes


def _picture(color_map: str, spacing: Optional[float], up: ArrayLike) -> _igeo.Picture:
    options = _igeo.Picture()
    options.color_map = arguments.one_of(color_map, "color_map", _igeo.color_maps)
    if spacing is not None:
        asked = arguments.real(spacing, "spacing")
        options.spacing = -1.0 if asked == 0 else arguments.number(spacing, "spacing")
    options.up(arguments.vector(up, "up"))
    return options


class Distance:
    """The distance from the seeds of Solver.distance, in world units times weight.

    Infinite where unreached. Properties are computed once, so their arrays are read-only; copy() can be
    written.
    """

    def __init__(self, made: _igeo.Distance, surface: Surface) -> None:
        self._made = made
        self.surface = surface

    @cached_property
    def _on_vertices(self) -> tuple[Floats, Labels]:
        if self.surface.kind != "mesh":
            raise InputError(
                f"{self.surface.name} is of kind {self.surface.kind}, and values at vertices need a mesh",
                "use at(points), or mesh(), which has triangles with distances",
            )
        distance, labels = self._made.at_vertices(None)
        return arguments.read_only(distance), arguments.read_only(labels)

    def _require_labels(self) -> None:
        if not self._made.labeled:
            raise InputError(
                "labels need scheme='jet'", "leave scheme out: godunov does not know which seed a front comes from"
            )

    @property
    def on_vertices(self) -> Floats:
        """(n,), numbered as the mesh; NaN at vertices without a face."""
        return self._on_vertices[0]

    @property
    def labels(self) -> Labels:
        """(n,), the nearest seed of each vertex, from 0; -1 where unreached or without a face. Raises
        InputError for several seeds with the scheme "godunov"."""
        self._require_labels()
        return self._on_vertices[1]

    @cached_property
    def gradient(self) -> Floats:
        """(n, 3), of the distance along the surface at the vertices, as long as the weight there; 0
        where unreached and at seeds, NaN at vertices without a face."""
        used = ~np.isnan(self.on_vertices)
        gradient = np.full((len(used), 3), np.nan)
        gradient[used] = self.gradient_at(self.surface.vertices[used])
        return arguments.read_only(gradient)

    def at(self, points: ArrayLike, *, progress: Progress = None) -> Floats:
        """(n,), at the points of the surface nearest to points (n, 3), or at vertices.

        Raises InputError for a point farther from the surface than Solver.snap.
        """
        return self._values_at(points, progress)[0]

    def gradient_at(self, points: ArrayLike, *, progress: Progress = None) -> Floats:
        """(n, 3), as `gradient`, at the points of the surface nearest to points (n, 3), or at vertices."""
        return self._values_at(points, progress)[1]

    def labels_at(self, points: ArrayLike, *, progress: Progress = None) -> Labels:
        """(n,), as `labels`, at the points of the surface nearest to points (n, 3), or at vertices."""
        self._require_labels()
        return self._values_at(points, progress)[2]

    def _values_at(self, points: ArrayLike, progress: Progress) -> tuple[Floats, Floats, Labels]:
        return self._made.values_at(self.surface._positions(points, "points"), progress)

    def path(self, target: ArrayLike, *, straighten: bool = False) -> Floats:
        """(n, 3), the geodesic from a point or a vertex to the nearest seed; (0, 3) where there
        is none.

        straighten: relax it to a locally shortest curve, free of the error of the distance.
        """
        points = self.surface._positions(target, "target")
        if len(points) != 1:
            raise InputError(f"target holds {len(points)} points; allowed is one", "use paths for several")
        return self._paths(points, straighten, None)[0]

    def paths(
        self, targets: ArrayLike, *, straighten: bool = False, progress: Progress = None
    ) -> list[Floats]:
        """The same for points (n, 3) or vertices, on all cores."""
        return self._paths(self.surface._positions(targets, "targets"), straighten, progress)

    def _paths(self, targets: Floats, straighten: bool, progress: Progress) -> list[Floats]:
        found, doubts = self._made.paths(targets, arguments.flag(straighten, "straighten"), progress)
        warn(doubts, 4)
        for k, (status, _) in enumerate(found):
            if status not in ("reached", "unreachable"):
                raise Error(f"the path of target {k} is {status}", "use smaller voxels, or move the target")
        return [points for _, points in found]

    def log_map(self, reference: Optional[ArrayLike] = None, *, progress: Progress = None) -> LogMap:
        """The logarithmic map around the seeds; each point belongs to its nearest seed.

        reference: (3,), u is its part along the surface at each seed; None, and at seeds where it is
        normal to the surface: the coordinate axis farthest from the normal. Raises InputError for the
        scheme "godunov", for tensors, and for seeds that are curves, regions or groups.
        """
        along = None if reference is None else arguments.vector(reference, "reference")
        if along is not None and not along.any():
            raise InputError("reference is zero; allowed are directions", "leave it out for a coordinate axis")
        return LogMap(self._made.log_map(along, progress), self.surface)

    def isolines(self, levels: Any, *, progress: Progress = None) -> list[Isoline]:
        """Lines of equal distance, by ascending level.

        levels: distances, with seeds that are `signed` of any sign, else 0 or more; or an integer, that
        many levels that divide the range equally, on both sides of seeds that are signed.
        """
        if arguments.is_integer(levels):
            if levels < 1:
                raise InputError(f"levels is {levels}; allowed are 1 and more, or an array of distances")
            values = self.largest * np.arange(1, levels + 1) / (levels + 1)
            if self._made.signed:
                values = np.concatenate([-values, values])
        else:
            values = np.atleast_1d(arguments.numbers(levels, "levels"))
            arguments.shaped(values, "levels", None)
            arguments.finite(values, "levels")
            if (values < 0).any() and not self._made.signed:
                raise InputError(f"levels has {values.min():g}; allowed are 0 and more")
        found = self._made.isolines([float(level) for level in np.sort(values)], progress)
        return [Isoline(level, points, closed) for level, closed, points in found]

    def mesh(self, *, progress: Progress = None) -> Mesh:
        """The surface as triangles: those of the mesh, refined, or the level set's."""
        mesh = Mesh(*self._made.mesh(progress))
        return mesh if self._made.labeled else mesh._replace(labels=np.full_like(mesh.labels, -1))

    def to_vdb(self, path: Path, *, name: str = "") -> None:
        """Writes a .vdb file with a grid of the distances, active where they are known.

        name: of the grid; by default the name of the surface with "_geodesic". Raises FileError.
        """
        self._made.write_grid(arguments.output(path, "path", ".vdb"), arguments.text(name, "name"))

    def image(
        self,
        path: Optional[Path] = None,
        *,
        width: int = 1280,
        height: int = 960,
        color_map: str = "viridis",
        spacing: Optional[float] = None,
        legend: bool = True,
        eye: Optional[ArrayLike] = None,
        look_at: Optional[ArrayLike] = None,
        up: ArrayLike = (0.0, 1.0, 0.0),
        paths_from: Optional[ArrayLike] = None,
        progress: Progress = None,
    ) -> bytes:
        """A picture as the bytes of a PNG file, which is written if `path`, with the ending .png, is given.

        width, height: pixels. color_map: one of igeo.color_maps. spacing: of isolines, world units
        times weight; 0: none; None: a round one. eye, look_at: (3,), the camera and its target. up:
        (3,). paths_from: points or vertices whose paths are drawn.
        """
        file = None if path is None else arguments.output(path, "path", ".png")
        options = _picture(color_map, spacing, up)
        options.width = arguments.integer(width, "width", _MOST_PIXELS)
        options.height = arguments.integer(height, "height", _MOST_PIXELS)
        options.legend = arguments.flag(legend, "legend")
        if eye is not None:
            options.eye(arguments.vector(eye, "eye"))
        if look_at is not None:
            options.look_at(arguments.vector(look_at, "look_at"))
        png = self._made.picture(options, self._ends(paths_from), progress)
        if file is not None:
            _igeo.write_file(file, png)
        return png

    def view(
        self,
        path: Path,
        *,
        color_map: str = "viridis",
        spacing: Optional[float] = None,
        up: ArrayLike = (0.0, 1.0, 0.0),
        paths_from: Optional[ArrayLike] = None,
        progress: Progress = None,
    ) -> None:
        """An interactive page of HTML for a browser, in one .html file that needs no network.

        Options as of `image`. Raises Error where the library was built without three.js, FileError.
        """
        file = arguments.output(path, "path", ".html")
        page = self._made.page(_picture(color_map, spacing, up), self._ends(paths_from), progress)
        _igeo.write_file(file, page)

    def _ends(self, paths_from: Optional[ArrayLike]) -> Floats:
        return np.empty((0, 3)) if paths_from is None else self.surface._positions(paths_from, "paths_from")

    @property
    def seeds(self) -> Floats:
        """(k, 3), the seeds on the surface."""
        return self._made.seeds

    @property
    def largest(self) -> float:
        """The largest distance reached."""
        return self._made.largest

    @property
    def reached(self) -> float:
        """The share of the band that was reached, 0 to 1."""
        return self._made.reached

    def __repr__(self) -> str:
        return (
            f"<igeo.Distance on {self.surface.name}: {len(self.seeds)} seeds, largest {self.largest:.6g}, "
            f"{100 * self.reached:.3g} % reached>"
        )

    def _repr_png_(self) -> bytes:
        return self.image(width=640, height=480)
