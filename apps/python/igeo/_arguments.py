"""Checks of arguments: each refusal names the argument, what it is, and what it may be."""

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
Path = Union[str, "os.PathLike[str]"]
Progress = Optional[Callable[[str, float], Any]]
# From foot points, shape (n, 3), to a value for each.
OfPoints = Callable[[Floats], ArrayLike]


class Sphere(NamedTuple):
    """A ball that no path may enter; world units."""

    center: ArrayLike
    radius: float


class Box(NamedTuple):
    """A box along the axes that no path may enter; a flat one is a wall. World units."""

    low: ArrayLike
    high: ArrayLike


def numbers(value: Any, name: str) -> Floats:
    """As float64, finite or not."""
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise InputError(f"{name} is no array of numbers: {error}") from None
    if array.dtype.kind not in "iuf":
        raise InputError(f"{name} has dtype {array.dtype}; allowed are real numbers")
    return np.asarray(array, dtype=np.float64, order="C")


def shaped(array: NDArray[Any], name: str, *shape: Optional[int]) -> None:
    """None in `shape` allows any length but 0."""
    fits = array.ndim == len(shape) and all(
        n == wanted or (wanted is None and n > 0) for n, wanted in zip(array.shape, shape)
    )
    if not fits:
        wanted = ", ".join("n" if n is None else str(n) for n in shape) + ("," if len(shape) == 1 else "")
        more = " with n of 1 or more" if None in shape else ""
        raise InputError(f"{name} has shape {array.shape}; allowed is ({wanted}){more}")


def finite(array: Floats, name: str) -> Floats:
    bad = ~np.isfinite(array)
    if bad.any():
        at = tuple(int(k) for k in np.argwhere(bad)[0])
        where = ", ".join(map(str, at))
        raise InputError(f"{name}[{where}] is {array[at]}; allowed are finite numbers ({bad.sum()} are not)")
    return array


def points(value: Any, name: str) -> Floats:
    """Shape (n, 3), n at least 1; one point may have shape (3,)."""
    array = numbers(value, name)
    if array.shape == (3,):
        array = array[np.newaxis]
    shaped(array, name, None, 3)
    return finite(array, name)


def vector(value: Any, name: str) -> Floats:
    array = numbers(value, name)
    shaped(array, name, 3)
    return finite(array, name)


def number(value: Any, name: str, above: float = 0.0) -> float:
    """A finite number above a bound."""
    try:
        x = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{name} is {value!r}; allowed are numbers above {above:g}") from None
    if not (x > above and math.isfinite(x)):
        raise InputError(f"{name} is {x:g}; allowed are finite numbers above {above:g}")
    return x


def above_zero_or_none(value: Optional[float], name: str) -> float:
    """0 stands for None."""
    return 0.0 if value is None else number(value, name)


def integers(value: Any, name: str, count: int, what: str = "vertices") -> NDArray[np.int64]:
    """Numbers from 0 to before `count`, of any shape."""
    array = np.asarray(value)
    if array.dtype.kind not in "iu":
        raise InputError(f"{name} has dtype {array.dtype}; allowed are integers")
    bad = (array < 0) | (array >= count)
    if bad.any():
        at = tuple(int(k) for k in np.argwhere(bad)[0])
        where = f"[{', '.join(map(str, at))}]" if at else ""
        raise InputError(f"{name}{where} is {array[at]}; allowed are 0 to {count - 1}, the {what}")
    return array.astype(np.int64)


def mask(value: Any, name: str, count: int, what: str) -> NDArray[np.bool_]:
    array = np.asarray(value)
    if array.dtype.kind != "b":
        raise InputError(f"{name} has dtype {array.dtype}; allowed is bool")
    if array.shape != (count,):
        raise InputError(f"{name} has shape {array.shape}; allowed is ({count},), one per {what}")
    return np.ascontiguousarray(array)


def costs(value: Any, name: str, count: int, what: str) -> Floats:
    """One finite number above 0 each."""
    array = numbers(value, name)
    if array.shape != (count,):
        raise InputError(f"{name} has shape {array.shape}; allowed is ({count},), one per {what}")
    bad = ~((array > 0) & np.isfinite(array))
    if bad.any():
        k = int(np.argmax(bad))
        raise InputError(
            f"{name}[{k}] is {array[k]}; allowed are finite numbers above 0 ({bad.sum()} are not)",
            "block such places by obstacles, and give them any weight above 0",
        )
    return array


def tensors(value: Any, name: str, count: int, what: str) -> Floats:
    """One symmetric, positive definite 3x3 matrix each."""
    array = numbers(value, name)
    if array.shape != (count, 3, 3):
        raise InputError(f"{name} has shape {array.shape}; allowed is ({count}, 3, 3), one per {what}")
    finite(array, name)
    skew = np.abs(array - array.transpose(0, 2, 1)).max(axis=(1, 2))
    bad = skew > 1e-6 * np.abs(array).max(axis=(1, 2))
    if bad.any():
        raise InputError(f"{name}[{int(np.argmax(bad))}] is not symmetric; allowed are symmetric matrices")
    least = np.linalg.eigvalsh(array)[:, 0]
    if not (least > 0).all():
        k = int(np.argmin(least))
        raise InputError(f"{name}[{k}] has the eigenvalue {least[k]:g}; allowed are eigenvalues above 0")
    return array


def affine(spacing: Any, origin: Any, matrix: Any) -> Floats:
    """World from array indices, 4x4: of `matrix`, else of spacing and origin."""
    if matrix is not None:
        if spacing is not None or origin is not None:
            raise InputError("affine is given beside spacing or origin", "leave out spacing and origin")
        array = finite(numbers(matrix, "affine"), "affine")
        shaped(array, "affine", 4, 4)
        if tuple(array[3]) != (0, 0, 0, 1):
            raise InputError(f"the last row of affine is {array[3]}; allowed is 0, 0, 0, 1")
        if np.linalg.matrix_rank(array[:3, :3]) < 3:
            raise InputError("the columns of affine lie in one plane; allowed are three directions")
        return array
    array = np.eye(4)
    steps = numbers(1.0 if spacing is None else spacing, "spacing")
    if steps.shape not in ((), (3,)):
        raise InputError(f"spacing has shape {steps.shape}; allowed are a number and (3,)")
    if not (np.isfinite(steps) & (steps > 0)).all():
        raise InputError(f"spacing is {steps}; allowed are finite numbers above 0")
    array[:3, :3] *= steps
    if origin is not None:
        array[:3, 3] = vector(origin, "origin")
    return array


def volume(values: Any, name: str) -> NDArray[np.float32]:
    """As float32 with the first index fastest, as the library has it."""
    array = np.asarray(values)
    if array.dtype.kind not in "iufb":
        raise InputError(f"{name} has dtype {array.dtype}; allowed are real numbers and bool")
    if array.ndim != 3 or min(array.shape) < 2:
        raise InputError(f"{name} has shape {array.shape}; allowed are three axes of 2 or more")
    if max(array.shape) >= _igeo.farthest_index:
        raise InputError(f"{name} has shape {array.shape}; allowed are axes below {_igeo.farthest_index}")
    array = np.asfortranarray(array, dtype=np.float32)
    if not np.isfinite(array).all():
        at = tuple(int(k) for k in np.argwhere(~np.isfinite(array))[0])
        raise InputError(f"{name}[{', '.join(map(str, at))}] is {array[at]}; allowed are finite numbers")
    return array


def one_of(value: str, name: str, allowed: Sequence[str]) -> str:
    if value not in allowed:
        raise InputError(f"{name} is {value!r}; allowed are {', '.join(map(repr, allowed))}")
    return value


def path(value: Any, name: str) -> str:
    try:
        return str(os.fspath(value))
    except TypeError:
        raise InputError(f"{name} is {value!r}; allowed are names of files") from None
