"""A torus as a mesh, and the numbers of a run on it."""
import csv
import math
import pathlib

MAJOR, MINOR = 1.0, 0.4
AROUND, ACROSS = 48, 24


def write_torus(file: pathlib.Path) -> int:
    """Quads, with a vertex before all others that no face uses and the last a copy of the first corner.

    Returns the number of vertices.
    """
    lines = ["v 9 9 9"]
    for i in range(AROUND):
        for j in range(ACROSS):
            u, v = 2 * math.pi * i / AROUND, 2 * math.pi * j / ACROSS
            r = MAJOR + MINOR * math.cos(v)
            lines.append(f"v {r * math.cos(u)!r} {r * math.sin(u)!r} {MINOR * math.sin(v)!r}")
    first, copy = 2, AROUND * ACROSS + 2
    lines.append("v" + lines[1][1:])

    def number(i: int, j: int) -> int:
        return first + i % AROUND * ACROSS + j % ACROSS

    for i in range(AROUND):
        for j in range(ACROSS):
            corners = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]
            lines.append("f " + " ".join(str(copy if c == first and (i, j) == (0, 0) else c) for c in corners))
    file.write_text("\n".join(lines) + "\n")
    return copy


def read_csv(file: pathlib.Path) -> dict[str, list[float]]:
    """The columns by their names."""
    with open(file, newline="") as table:
        rows = list(csv.reader(table))
    return {name: [float(row[k]) for row in rows[1:]] for k, name in enumerate(rows[0])}
