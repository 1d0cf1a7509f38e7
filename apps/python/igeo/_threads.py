"""The number of threads that the library uses."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from . import _igeo


@contextmanager
def threads(count: int) -> Iterator[None]:
    """Limits the threads of the process to `count` within a `with` block. Results are the same."""
    if count < 1:
        raise ValueError(f"count is {count}; allowed are 1 and more")
    limit = _igeo.ThreadLimit(count)
    try:
        yield
    finally:
        del limit
