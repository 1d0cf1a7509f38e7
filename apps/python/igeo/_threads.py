"""The number of threads that the library uses."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from . import _arguments as arguments
from . import _igeo


@contextmanager
def threads(count: int) -> Iterator[None]:
    """Limits the threads of the process to `count` within a `with` block. Results are the same."""
    limit = _igeo.ThreadLimit(arguments.integer(count, "count"))
    try:
        yield
    finally:
        del limit
