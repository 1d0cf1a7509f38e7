"""Errors and warnings, and the words of the library in those of this package."""

from __future__ import annotations

import warnings
from collections.abc import Iterable


class Error(Exception):
    """What the library refuses, or could not do. `remedy` says what to do about it; it may be empty."""

    def __init__(self, what: str, remedy: str = "") -> None:
        super().__init__(f"{what}\n  {remedy}" if remedy else what)
        self.remedy = remedy


class InputError(Error, ValueError):
    """An argument, or the surface it makes, that cannot be used."""


class FileError(Error, OSError):
    """A file that cannot be read or written."""


class SurfaceWarning(UserWarning):
    """What makes results less accurate, with its share of the surface."""


# The longer of two that begin alike goes first.
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
    """The words of the library for its arguments, as this package calls them."""
    for name, word in WORDS:
        text = text.replace(name, word)
    return text


def error_for(kind: int, what: str, remedy: str) -> Error:
    """The exception for an error of the library."""
    made = FileError if kind == IO else InputError if kind in (INVALID_ARGUMENT, BAD_INPUT) else Error
    return made(in_python_words(what), in_python_words(remedy))


def warn(sentences: Iterable[str], level: int) -> None:
    """Warns in the name of the code `level` calls up, so that a user sees the line that is meant."""
    for sentence in sentences:
        warnings.warn(in_python_words(sentence), SurfaceWarning, stacklevel=level)
