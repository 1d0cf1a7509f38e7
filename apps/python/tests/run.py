"""Runs a file of this folder by pytest; ends with 77 where it, or one of its tests, lacks something.

usage: run.py FILE
"""

import pathlib
import sys

try:
    import numpy  # noqa: F401
    import pytest
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)


class CountSkips:
    """The number of tests that pytest has skipped."""

    def __init__(self):
        self.count = 0

    def pytest_runtest_logreport(self, report):
        self.count += report.skipped


skips = CountSkips()
file = str(pathlib.Path(__file__).parent / sys.argv[1])
code = pytest.main(["-q", "-rs", "--tb=short", "-p", "no:cacheprovider", file], plugins=[skips])
sys.exit(77 if code == 0 and skips.count else int(code))
