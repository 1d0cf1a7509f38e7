"""Surfaces, from arrays and files."""

from __future__ import annotations

import html
import tempfile
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments as arguments
from . import _igeo
from ._arguments import Floats, Path, Progress
from ._errors import InputError, warn

_KINDS = ("mesh", "points", "volume", "level set")
_SCHEMES = ("jet", "godunov")


def _voxels(size: Optional[float], resolution: Optional[int], scheme: str, join_gaps: Optional[float]) -> Any:
    """The voxel size of a surface."""
    if size is not None and resolution is not None:
        raise InputError("voxel_size is given beside resolution", "leave out one of them")
    return _igeo.Voxels(
        arguments.above_zero_or_none(size, "voxel_size"),
        0 if resolution is None else arguments.integer(resolution, "resolution"),
        arguments.one_of(scheme, "scheme", _SCHEMES),
        arguments.above_zero_or_none(join_gaps, "join_gaps"),
    )


class Surface:
    """A surface that was read and checked. Made by `read` and by the functions `from_...`.

    Several solvers and threads may share one.
    """

    def __init__(self, made: _igeo.Surface, joins_gaps: bool = False) -> None:
        if not isinstance(made, _igeo.Surface):
            raise TypeError("a Surface is made by Surface.read, .from_mesh, .from_points, .from_volume, ...")
        self._made = made
        self._joins_gaps = joins_gaps
        warn(made.warnings, 4)

    @classmethod
    def read(
        cls,
        file: Path,
        *,
        kind: Optional[str] = None,
        grid: str = "",
        iso: Optional[float] = None,
        rebuild: bool = False,
        voxel_size: Optional[float] = None,
        resolution: Optional[int] = None,
        join_gaps: Optional[float] = None,
        scheme: str = "jet",
        progress: Progress = None,
    ) -> Surface:
        """A surface from a file of any format that the library reads.

        kind: "mesh", "points", "volume" (voxels of an image) or "level set" (.vdb); None: by the
            ending of the file. A .ply without faces needs "points".
        grid: of a .vdb file, the name of the grid; may be left out where only one is usable.
        iso: of a volume, the value at the surface; may be left out for a mask. With `rebuild`, of
            the grid.
        rebuild: compute a signed distance from a .vdb grid of other values.
        voxel_size, resolution: as `from_mesh` and `from_points`; a level set has its own voxels.
        join_gaps: of a mesh. scheme: of points.
        Raises FileError where the file cannot be read, InputError where it holds no such surface.
        """
        name = arguments.path(file, "file")
        kind = _igeo.kind_of(name) if kind is None else arguments.one_of(kind, "kind", _KINDS)
        if arguments.text(grid, "grid") and kind != "level set":
            raise InputError(f"grid is given, and {name} is read as {kind}", "leave out grid")
        rebuild = arguments.flag(rebuild, "rebuild")
        if iso is not None and kind != "volume" and not rebuild:
            raise InputError(f"iso is given, and {name} is read as {kind}", "leave out iso, or add rebuild=True")
        if rebuild and kind != "level set":
            raise InputError(f"rebuild is given, and {name} is read as {kind}", "leave out rebuild")
        if kind == "level set" and (voxel_size is not None or resolution is not None):
            given = "resolution" if voxel_size is None else "voxel_size"
            raise InputError(
                f"{given} is given, and {name} is read as {kind}", f"leave out {given}: a level set has its own voxels"
            )
        if join_gaps is not None and kind != "mesh":
            raise InputError(f"join_gaps is given, and {name} is read as {kind}", "leave out join_gaps")
        voxels = _voxels(voxel_size, resolution, scheme, join_gaps)
        if scheme != "jet" and kind != "points":
            raise InputError(
                f"scheme is given, and {name} is read as {kind}", f"leave it out, and give scheme={scheme!r} to Solver"
            )
        level = None if iso is None else arguments.real(iso, "iso")
        made = _igeo.Surface.from_file(name, kind, grid, rebuild, level, voxels, progress)
        return cls(made, join_gaps is not None)

    @classmethod
    def from_mesh(
        cls,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        voxel_size: Optional[float] = None,
        resolution: Optional[int] = None,
        join_gaps: Optional[float] = None,
        name: str = "mesh",
        progress: Progress = None,
    ) -> Surface:
        """A triangle mesh, open or closed.

        vertices: (n, 3), world units. faces: (m, 3), integers from 0 to n - 1.
        voxel_size: world units; resolution: voxels along the longest side, 256 where neither is given.
        join_gaps: world units; paths may cross gaps of up to this between pieces of the mesh. For the
            scheme "jet".
        name: its name in messages and results.
        """
        points = arguments.points(vertices, "vertices")
        corners = arguments.integers(faces, "faces", len(points))
        arguments.shaped(corners, "faces", None, 3)
        corners = np.ascontiguousarray(corners, dtype=np.uint32)
        voxels = _voxels(voxel_size, resolution, "jet", join_gaps)
        made = _igeo.Surface.from_mesh(points, corners, arguments.text(name, "name"), voxels, progress)
        return cls(made, join_gaps is not None)

    @classmethod
    def from_points(
        cls,
        points: ArrayLike,
        normals: Optional[ArrayLike] = None,
        *,
        voxel_size: Optional[float] = None,
        resolution: Optional[int] = None,
        scheme: str = "jet",
        name: str = "points",
        progress: Progress = None,
    ) -> Surface:
        """Points on or near a surface.

        points: (n, 3), world units. normals: (n, 3), of any length but 0.
        voxel_size, resolution: as `from_mesh`; else half the spacing of the points.
        scheme: of the solver that the surface is for.
        """
        cloud = arguments.points(points, "points")
        across = None if normals is None else arguments.points(normals, "normals")
        if across is not None and across.shape != cloud.shape:
            raise InputError(f"normals has shape {across.shape}; allowed is {cloud.shape}, that of points")
        voxels = _voxels(voxel_size, resolution, scheme, None)
        return cls(_igeo.Surface.from_points(cloud, across, arguments.text(name, "name"), voxels, progress))

    @classmethod
    def from_volume(
        cls,
        values: ArrayLike,
        iso: Optional[float] = None,
        *,
        spacing: Optional[ArrayLike] = None,
        origin: Optional[ArrayLike] = None,
        affine: Optional[ArrayLike] = None,
        voxel_size: Optional[float] = None,
        resolution: Optional[int] = None,
        name: str = "volume",
        progress: Progress = None,
    ) -> Surface:
        """The surface where a dense array has the value `iso`, as triangles.

        values: (i, j, k), real numbers or bool. iso: may be left out where there are two values.
        spacing: world units between voxels, a number or (3,). origin: (3,), the center of voxel
            0, 0, 0. affine: instead of both, (4, 4), world from indices, as in nibabel; it may
            rotate, mirror and shear.
        voxel_size, resolution: as `from_mesh`; else the least spacing.
        """
        array = arguments.volume(values, "values")
        world = arguments.affine(spacing, origin, affine)
        voxels = _voxels(voxel_size, resolution, "jet", None)
        level = None if iso is None else arguments.real(iso, "iso")
        return cls(_igeo.Surface.from_volume(array, world, level, arguments.text(name, "name"), voxels, progress))

    @classmethod
    def from_level_set(
        cls,
        values: ArrayLike,
        *,
        spacing: Optional[ArrayLike] = None,
        origin: Optional[ArrayLike] = None,
        affine: Optional[ArrayLike] = None,
        half_width: float = 4,
        name: str = "level_set",
        progress: Progress = None,
    ) -> Surface:
        """The surface where a dense array of signed distances is 0, as a level set.

        values: (i, j, k), world units, negative inside. spacing, origin, affine: as `from_volume`,
            with voxels that are cubes.
        half_width: voxels; beyond it only the sign of a value is used.
        For values that are no distances use from_volume(values, 0).
        """
        array = arguments.volume(values, "values")
        world = arguments.affine(spacing, origin, affine)
        width = arguments.number(half_width, "half_width", 1.0) * float(np.linalg.norm(world[:3, 0]))
        return cls(_igeo.Surface.from_level_set(array, world, width, arguments.text(name, "name"), progress))

    @classmethod
    def from_openvdb(cls, grid: Any, *, progress: Progress = None) -> Surface:
        """A level set in a FloatGrid of the module pyopenvdb (or openvdb).

        It is passed through a temporary file, because the modules of OpenVDB share no type with this one.
        """
        module = type(grid).__module__.split(".")[0]
        if module not in ("pyopenvdb", "openvdb"):
            raise InputError(f"grid is of type {type(grid).__name__}; allowed is a FloatGrid of pyopenvdb")
        with tempfile.TemporaryDirectory(prefix="igeo-") as folder:
            file = f"{folder}/grid.vdb"
            __import__(module).write(file, grids=[grid])
            return cls.read(file, kind="level set", progress=progress)

    @property
    def kind(self) -> str:
        """ "mesh", "points" or "level set"; a volume is a mesh."""
        return self._made.kind

    @property
    def name(self) -> str:
        """Its name in messages and results."""
        return self._made.name

    @property
    def voxel_size(self) -> float:
        """World units."""
        return self._made.voxel_size

    @property
    def snap(self) -> float:
        """How far points may be from the surface by default, world units."""
        return self._made.snap

    @property
    def warnings(self) -> list[str]:
        """The warnings when it was made."""
        return list(self._made.warnings)

    @property
    def vertices(self) -> Floats:
        """(n, 3), numbered as the file or the array; of points all of them. A read-only view. Raises
        InputError for a level set."""
        vertices = self._made.vertices
        if vertices is None:
            raise InputError(
                f"{self.name} is a level set, which has no vertices",
                "give positions; Distance.mesh() has a mesh of the surface",
            )
        return vertices

    @property
    def faces(self) -> NDArray[np.uint32]:
        """(m, 3), of a mesh, with the numbers of `vertices`. If it has polygons, the triangles that it
        is solved on, into which these are cut; such as have shrunk to a line are left out. Raises
        InputError for others."""
        faces = self._made.faces
        if faces is None:
            raise InputError(f"{self.name} is no mesh, and has no faces", "Distance.mesh() has some")
        return faces

    def _positions(self, value: Any, name: str) -> Floats:
        """Points, or the positions of vertices."""
        array = arguments.array(value, name)
        if array.dtype.kind in "iu" and array.ndim < 2:
            numbers = arguments.integers(array, name, len(self.vertices)).reshape(-1)
            arguments.shaped(numbers, name, None)
            return np.ascontiguousarray(self.vertices[numbers])
        return arguments.points(array, name)

    def __repr__(self) -> str:
        return f"<igeo.Surface {self.name}: {self.kind}, {self._made.summary}, voxel size {self.voxel_size:.6g}>"

    def _repr_html_(self) -> str:
        rows = {"name": self.name, "kind": self.kind, "summary": self._made.summary}
        rows["voxel size"] = f"{self.voxel_size:.6g}"
        if self.warnings:
            rows["warnings"] = "; ".join(self.warnings)
        cells = "".join(f"<tr><th>{key}</th><td>{html.escape(value)}</td></tr>" for key, value in rows.items())
        return f"<table>{cells}</table>"
