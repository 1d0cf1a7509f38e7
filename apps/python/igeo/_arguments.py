"""Checks of arguments: each error names the argument, its value, and the values allowed."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from typing import Any, Callable, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _igeo
from ._errors import InputError

Floats = NDArray[np.float64]
Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]
Progress = Optional[Callable[[str, float], Any]]
# A function from foot points, shape (n, 3), to a value for each.
OfPoints = Callable[[Floats], ArrayLike]


class Sphere(NamedTuple):
    """A ball that no path may enter; world units."""

    center: ArrayLike
    radius: float


class Box(NamedTuple):
    """A box along the axes that no path may enter; a flat one is a wall. World units."""

    low: ArrayLike
    high: ArrayLike


class CurvatureWeight(NamedTuple):
    """A cost from curvature: eps + |c|^p, least where |c| is.

    kind: "valley" (c is the mean curvature above its least), "crest" (the same of its negative),
        "mean", "gaussian", or "principal" (the larger principal curvature). eps, p: above 0.
        Curvatures are those per 10 voxels.
    """

    kind: str
    eps: float = 100.0
    p: float = 3.0


class SlopeWeight(NamedTuple):
    """The cost of slopes, for terrain: 1 + (tan a / tan max)^power where the surface is inclined by
    the angle a, and an obstacle where it is steeper than max.

    max: degrees, above 0 and below 90. up: "x", "y" or "z". power: above 0.
    """

    max: float
    up: str = "z"
    power: float = 2.0


class Bending(NamedTuple):
    """A cost by direction: paths that bend with the surface are expensive ("avoid") or cheap ("prefer").

    length: world units, a bend of that radius costs sqrt(2); None: 10 voxels.
    """

    kind: str
    length: Optional[float] = None


def array(value: Any, name: str) -> NDArray[Any]:
    """An array of any type; lists of different lengths are refused, and values that are masked."""
    if isinstance(value, np.ma.MaskedArray) and np.any(value.mask):
        raise InputError(f"{name} has {np.sum(value.mask)} masked values; allowed are none", "fill or remove them")
    try:
        return np.asarray(value)
    except ValueError as error:
        raise InputError(f"{name} is no array of numbers: {error}") from None


def numbers(value: Any, name: str) -> Floats:
    """As float64, finite or not."""
    found = array(value, name)
    if found.dtype.kind not in "iuf":
        raise InputError(f"{name} has dtype {found.dtype}; allowed are real numbers")
    return np.asarray(found, dtype=np.float64, order="C")


def shaped(values: NDArray[Any], name: str, *shape: Optional[int]) -> None:
    """None in `shape` allows any length but 0."""
    fits = values.ndim == len(shape) and all(
        n == wanted or (wanted is None and n > 0) for n, wanted in zip(values.shape, shape)
    )
    if not fits:
        wanted = ", ".join("n" if n is None else str(n) for n in shape) + ("," if len(shape) == 1 else "")
        more = " with n of 1 or more" if None in shape else ""
        raise InputError(f"{name} has shape {values.shape}; allowed is ({wanted}){more}")


def finite(values: Floats, name: str) -> Floats:
    bad = ~np.isfinite(values)
    if bad.any():
        at = tuple(int(k) for k in np.argwhere(bad)[0])
        where = ", ".join(map(str, at))
        raise InputError(f"{name}[{where}] is {values[at]}; allowed are finite numbers ({bad.sum()} are not)")
    return values


def points(value: Any, name: str) -> Floats:
    """Shape (n, 3), n at least 1; one point may have shape (3,)."""
    values = numbers(value, name)
    if values.shape == (3,):
        values = values[np.newaxis]
    shaped(values, name, None, 3)
    return finite(values, name)


def polylines(value: Any, name: str) -> list[Floats]:
    """Of two points or more each; a list of points, as an array (m, 3), is one polyline."""
    try:
        lines = list(value)
    except TypeError:
        raise InputError(f"{name} is {value!r}; allowed are polylines (m, 3)") from None
    if lines and all(array(line, f"{name}[{k}]").ndim == 1 for k, line in enumerate(lines)):
        named = [(name, lines)]
    else:
        named = [(f"{name}[{k}]", line) for k, line in enumerate(lines)]
    found = []
    for one, line in named:
        found.append(points(line, one))
        if len(found[-1]) < 2:
            raise InputError(f"{one} is a single point; allowed are 2 points or more", "give points by seeds")
    return found


def starts(value: Any, count: int, each: str) -> Floats:
    """The distance at each seed; None: 0."""
    if value is None:
        return np.zeros(count)
    found = numbers(value, "start")
    if found.shape != (count,):
        raise InputError(f"start has shape {found.shape}; allowed is ({count},), one per {each}")
    return finite(found, "start")


def read_only(values: NDArray[Any]) -> NDArray[Any]:
    """The same array, not to be written: of results that are kept."""
    values.flags.writeable = False
    return values


def vector(value: Any, name: str) -> Floats:
    values = numbers(value, name)
    shaped(values, name, 3)
    return finite(values, name)


def _as_float(value: Any, name: str, allowed: str) -> float:
    try:
        if not isinstance(value, (str, bytes, bool, np.bool_)):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError(f"{name} is {value!r}; allowed are {allowed}")


def real(value: Any, name: str) -> float:
    """A finite number of any sign."""
    x = _as_float(value, name, "finite numbers")
    if not math.isfinite(x):
        raise InputError(f"{name} is {x:g}; allowed are finite numbers")
    return x


def is_integer(value: Any) -> bool:
    """Whether it is one number without a fraction by its type; True and False are none."""
    if isinstance(value, np.ndarray):
        return value.ndim == 0 and value.dtype.kind in "iu"
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool)


def integer(value: Any, name: str, most: int = 2**31 - 1) -> int:
    """From 1 to `most`."""
    if not is_integer(value) or not 1 <= value <= most:
        large = is_integer(value) and value > most
        allowed = f"1 to {most}" if large or most < 2**31 - 1 else "1 and more"
        raise InputError(f"{name} is {value!r}; allowed are integers of {allowed}")
    return int(value)


def flag(value: Any, name: str) -> bool:
    """True or False, or 1 or 0."""
    if not isinstance(value, (bool, np.bool_)) and not (is_integer(value) and value in (0, 1)):
        raise InputError(f"{name} is {value!r}; allowed are True and False")
    return bool(value)


def made_of(value: Any, kind: Any, name: str) -> Any:
    """A named tuple of type `kind`, from its first element or from all."""
    fields = value if isinstance(value, tuple) else (value,)
    if not 1 <= len(fields) <= len(kind._fields):
        raise InputError(f"{name} is {value!r}; allowed is {kind.__name__}({', '.join(kind._fields)})")
    return kind(*fields)


def limit(value: Any, name: str) -> float:
    """A number above 0, or infinity."""
    return math.inf if isinstance(value, (float, np.floating)) and value == math.inf else number(value, name)


def number(value: Any, name: str, above: float = 0.0) -> float:
    """A finite number above a bound."""
    x = _as_float(value, name, f"numbers above {above:g}")
    if not (x > above and math.isfinite(x)):
        raise InputError(f"{name} is {x:g}; allowed are finite numbers above {above:g}")
    return x


def above_zero_or_none(value: Optional[float], name: str) -> float:
    """0 stands for None."""
    return 0.0 if value is None else number(value, name)


def integers(value: Any, name: str, count: int, what: str = "vertices") -> NDArray[Any]:
    """Numbers from 0 to before `count`, of any shape."""
    values = array(value, name)
    if values.dtype.kind not in "iu":
        raise InputError(f"{name} has dtype {values.dtype}; allowed are integers")
    bad = (values < 0) | (values >= count)
    if bad.any():
        at = tuple(int(k) for k in np.argwhere(bad)[0])
        where = f"[{', '.join(map(str, at))}]" if at else ""
        raise InputError(f"{name}{where} is {values[at]}; allowed are 0 to {count - 1}, the {what}")
    return values


def mask(value: Any, name: str, count: int, what: str) -> NDArray[np.bool_]:
    values = array(value, name)
    if values.dtype.kind != "b":
        raise InputError(f"{name} has dtype {values.dtype}; allowed is bool")
    if values.shape != (count,):
        raise InputError(f"{name} has shape {values.shape}; allowed is ({count},), one per {what}")
    return np.ascontiguousarray(values)


def costs(value: Any, name: str, count: int, what: str) -> Floats:
    """One finite number above 0 each."""
    values = numbers(value, name)
    if values.shape != (count,):
        raise InputError(f"{name} has shape {values.shape}; allowed is ({count},), one per {what}")
    bad = ~((values > 0) & np.isfinite(values))
    if bad.any():
        k = int(np.argmax(bad))
        raise InputError(
            f"{name}[{k}] is {values[k]}; allowed are finite numbers above 0 ({bad.sum()} are not)",
            "block such places by obstacles, and give them any weight above 0",
        )
    return values


def tensors(value: Any, name: str, count: int, what: str) -> Floats:
    """One symmetric, positive definite 3x3 matrix each."""
    values = numbers(value, name)
    if values.shape != (count, 3, 3):
        raise InputError(f"{name} has shape {values.shape}; allowed is ({count}, 3, 3), one per {what}")
    finite(values, name)
    skew = np.abs(values - values.transpose(0, 2, 1)).max(axis=(1, 2))
    bad = skew > 1e-6 * np.abs(values).max(axis=(1, 2))
    if bad.any():
        raise InputError(f"{name}[{int(np.argmax(bad))}] is not symmetric; allowed are symmetric matrices")
    least = np.linalg.eigvalsh(values)[:, 0]
    if not (least > 0).all():
        k = int(np.argmin(least))
        raise InputError(f"{name}[{k}] has the eigenvalue {least[k]:g}; allowed are eigenvalues above 0")
    return values


def affine(spacing: Any, origin: Any, matrix: Any) -> Floats:
    """World from array indices, 4x4: of `matrix`, else of spacing and origin."""
    if matrix is not None:
        if spacing is not None or origin is not None:
            raise InputError("affine is given beside spacing or origin", "leave out spacing and origin")
        values = finite(numbers(matrix, "affine"), "affine")
        shaped(values, "affine", 4, 4)
        if tuple(values[3]) != (0, 0, 0, 1):
            raise InputError(f"the last row of affine is {values[3]}; allowed is 0, 0, 0, 1")
        if np.linalg.matrix_rank(values[:3, :3]) < 3:
            raise InputError("the columns of affine lie in one plane; allowed are three directions")
        return values
    values = np.eye(4)
    steps = numbers(1.0 if spacing is None else spacing, "spacing")
    if steps.shape not in ((), (3,)):
        raise InputError(f"spacing has shape {steps.shape}; allowed are a number and (3,)")
    if not (np.isfinite(steps) & (steps > 0)).all():
        raise InputError(f"spacing is {steps}; allowed are finite numbers above 0")
    values[:3, :3] *= steps
    if origin is not None:
        values[:3, 3] = vector(origin, "origin")
    return values


def volume(values: Any, name: str) -> NDArray[np.float32]:
    """As float32 with the first index fastest, as the library has it."""
    given = array(values, name)
    if given.dtype.kind not in "iufb":
        raise InputError(f"{name} has dtype {given.dtype}; allowed are real numbers and bool")
    if given.ndim != 3 or min(given.shape) < 2:
        raise InputError(f"{name} has shape {given.shape}; allowed are three axes of 2 or more")
    if max(given.shape) >= _igeo.farthest_index:
        raise InputError(f"{name} has shape {given.shape}; allowed are axes below {_igeo.farthest_index}")
    found = np.asfortranarray(given, dtype=np.float32)
    if not np.isfinite(found).all():
        at = tuple(int(k) for k in np.argwhere(~np.isfinite(found))[0])
        raise InputError(f"{name}[{', '.join(map(str, at))}] is {found[at]}; allowed are finite numbers")
    return found


def one_of(value: str, name: str, allowed: Sequence[str]) -> str:
    if not isinstance(value, str) or value not in allowed:
        raise InputError(f"{name} is {value!r}; allowed are {', '.join(map(repr, allowed))}")
    return value


def text(value: Any, name: str) -> str:
    """A name in a result or a message."""
    if not isinstance(value, str):
        raise InputError(f"{name} is {value!r}; allowed are strings")
    if any(0xD800 <= ord(c) < 0xE000 for c in value):
        raise InputError(f"{name} is {value!r}, which holds bytes that are no UTF-8", "take them out")
    if _has_controls(value):
        raise InputError(f"{name} is {value!r}, which holds a control character", "take it out")
    return value


def _has_controls(value: str) -> bool:
    return any(ord(c) < 32 or ord(c) == 127 for c in value)


def path(value: Any, name: str) -> str:
    """The name of a file: str, bytes or os.PathLike."""
    try:
        found = os.fsdecode(value)
        found.encode()
    except TypeError:
        raise InputError(f"{name} is {value!r}; allowed are names of files") from None
    except UnicodeError:
        raise InputError(f"{name} is {value!r}; allowed are names in UTF-8", "rename the file") from None
    if not found or "\0" in found:
        raise InputError(f"{name} is {value!r}; allowed are names of files")
    return found


def output(value: Any, name: str, ending: str) -> str:
    """The name of a file to write, with its ending; a device or a pipe may have any name."""
    found = text(path(value, name), name)
    plain = os.path.isfile(found) or not os.path.exists(found)
    if plain and not found.endswith(ending):
        raise InputError(f"{name} is {found!r}; allowed are names that end in {ending}")
    return found
