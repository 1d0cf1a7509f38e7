"""Errors and warnings, with names of the library replaced by those of this package."""

from __future__ import annotations

import warnings
from collections.abc import Iterable


class Error(Exception):
    """An error of the library. `remedy` says how to avoid it; it may be empty."""

    def __init__(self, what: str, remedy: str = "") -> None:
        super().__init__(f"{what}\n  {remedy}" if remedy else what)
        self.remedy = remedy


class InputError(Error, ValueError):
    """An argument, or a surface made from it, that is not usable."""


class FileError(Error, OSError):
    """A file that cannot be read or written."""


class SurfaceWarning(UserWarning):
    """A cause of less accurate results, with the share of the surface that it affects."""


# Longer names come before their prefixes.
WORDS = (
    ("the iso of rebuilt()", "iso"),
    ("the iso of volumeMesh()", "iso"),
    ("rebuilt(psi, D)", "Surface.read(file, rebuild=True, iso=D)"),
    ("rebuilt()", "Surface.read(file, rebuild=True)"),
    ("readPointCloud", "Surface.from_points, or Surface.read(file, kind='points')"),
    ("readLevelSetGrid", "Surface.read(file, kind='level set')"),
    ("TriangleMesh", "a mesh (Surface.from_mesh)"),
    ("Scheme::Jet", "scheme='jet'"),
    ("Space::Index", "give world coordinates"),
    ("Space::World", "give world coordinates"),
    ("SolverOptions::band", "band"),
    ("MetricDefinition::obstacles", "obstacles"),
    ("maxDistance", "max_distance"),
    ("memoryLimit", "memory_limit"),
    ("joinGaps", "join_gaps"),
    ("maxSnap", "snap"),
    ("isSigned", "signed=True"),
)

# Error::Kind of the library, by number.
INVALID_ARGUMENT, BAD_INPUT, IO = 0, 1, 2


def in_python_words(text: str) -> str:
    """The text with the names of the library's arguments replaced by those of this package."""
    for name, word in WORDS:
        text = text.replace(name, word)
    return text


def error_for(kind: int, what: str, remedy: str) -> Error:
    """The exception for an error of the library."""
    made = FileError if kind == IO else InputError if kind in (INVALID_ARGUMENT, BAD_INPUT) else Error
    return made(in_python_words(what), in_python_words(remedy))


def warn(sentences: Iterable[str], level: int) -> None:
    """Warns at the code `level` calls up, so that a user sees the line that is concerned."""
    for sentence in sentences:
        warnings.warn(in_python_words(sentence), SurfaceWarning, stacklevel=level)
