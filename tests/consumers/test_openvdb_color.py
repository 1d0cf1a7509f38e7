#!/usr/bin/env python3
"""The grid of colors is in linear light, as OpenVDB's module for Python reads it.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/consumers/test_openvdb_color.py

Exit code 77 where the module is missing (Debian: python3-openvdb).
"""
import pathlib
import sys

import consumers

try:
    import pyopenvdb
except ImportError:
    try:
        import openvdb as pyopenvdb
    except ImportError:
        consumers.use_debian_python("pyopenvdb")


def linear(srgb: float) -> float:
    return srgb / 12.92 if srgb <= 0.04045 else ((srgb + 0.055) / 1.055) ** 2.4


def main() -> None:
    with consumers.temporary() as name:
        out = pathlib.Path(name) / "out.vdb"
        consumers.geodesic("--sdf", consumers.DATA / "sphere.vdb", "--seed", "0,0,1", "--grids", "color",
                           "--color-map", "gray", "-q", "-o", out)
        distance, color = pyopenvdb.readAll(str(out))[0]
    assert color.name.endswith("_geodesic_color")
    largest, at, count = distance.background, distance.getConstAccessor(), 0
    for item in color.citerOnValues():
        # Gray from black to white in sRGB, by a table.
        expected = linear(at.getValue(item.min) / largest)
        assert max(abs(c - expected) for c in item.value) < 0.002, (item.value, expected)
        count += 1
    assert count > 1000
    print(f"OpenVDB {'.'.join(map(str, pyopenvdb.LIBRARY_VERSION))}")


if __name__ == "__main__":
    sys.exit(main())
