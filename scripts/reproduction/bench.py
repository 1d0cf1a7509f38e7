"""What the experiments share: models, runs of the program, geometry, pictures and plots."""
import dataclasses
import json
import math
import os
import pathlib
import re
import struct
import sys

import measure


@dataclasses.dataclass(frozen=True)
class Model:
    file: str  # a mesh in --models, or a level set in data/
    voxels: int  # along its longest side, for as many voxels of area as in the paper
    seed: str
    target: str = ""
    fine: int = 0  # voxels along its longest side in pictures
    views: tuple = ("",)  # cameras; empty: the program's choice
    side: str = ""  # the camera that sees the path
    up: str = "y"
    ball: tuple = ()  # the obstacle of Fig. 11: x, y, z, radius
    past: str = ""  # the target behind it
    valley: str = "eps=100,p=3"  # the cost of Fig. 10
    is_open: bool = False  # its holes are closed for its level set


MODELS = {
    "brain": Model("brain-pial-left.ply", 139, "-40,12,48", "-38,45,5", 256, side="-380,-20,120",
                   up="z"),
    "bunny": Model("bunny.obj", 68, "-0.770217,0.134972,0.221349", "0.779508,-0.46204,0.133255", 128,
                   ("-3.2,1.2,2.3", "-1.2,1.2,3.7", "2.9,1.4,-2.5"), side="-1.2,1.2,3.7",
                   ball=(0.1, -0.2, 0.55, 0.3), past="0.6,-0.35,0.4"),
    "knot": Model("knot.obj", 58, "0.157691,0.5,0.0726438", fine=128, up="z"),
    "teapot": Model("teapot.obj", 74, "3.434,2.4729,0", fine=200, is_open=True,
                    views=("3.6,5.8,9.6,0.2,1.5,0", "-8,6,7,0.2,1.5,0", "8,5,-6,0.2,1.5,0")),
}
# In place of all of them with --quick.
STAND_IN = Model("trefoil.vdb", 120, "0,-1.02,0", "0.5,0.73,0.237", 120, side="0,-2.5,3.5", up="z",
                 ball=(-0.05, 0.26, 0.07, 0.05), past="0.5,0.73,0.237", valley="eps=0.1,p=3")
# Shapes with as many voxels of area as in the paper, in voxels of size 1: (parameters, seed, views).
SHAPES = {
    "sphere": (("radius=16.4",), "7,9,11.77",
               ("34,43,56,0,0,0", "60,-24,-48,0,0,0", "-34,-43,-56,0,0,0")),
    "torus": (("major=25.06", "minor=6.27"), "31.33,0,0",
              ("105,0,65,0,0,0", "33,100,65,0,0,0", "-100,0,70,0,0,0")),
}


class Missing(Exception):
    """A model that was not given."""


@dataclasses.dataclass(frozen=True)
class Bench:
    build: pathlib.Path
    models: pathlib.Path | None
    out: pathlib.Path  # where the document is, and its pictures in images/reproduction
    work: pathlib.Path  # temporary files
    quick: bool

    @property
    def images(self):
        return self.out / "images" / "reproduction"

    def solve(self, *words):
        """The report of a run."""
        program = self.build / "bin" / "implicit-geodesic"
        # Exit code 4: a target is unreached, which the report says as well.
        done = measure.run([program, *words, "-q", "-o", "/dev/null", "--report", "-"], expect=(0, 4))
        return json.loads(done.stdout)

    def model(self, name):
        model = STAND_IN if self.quick else MODELS[name]
        file = self.file(model)
        if not file or not file.exists():
            raise Missing(model.file)
        return model

    def file(self, model):
        """None if no folder of models was given."""
        if model.file.endswith(".vdb"):
            return measure.ROOT / "data" / model.file
        return self.models / model.file if self.models else None

    def level_set(self, model, voxels):
        """The level set of a model, as words for the program."""
        file = self.file(model)
        if file.suffix == ".vdb":
            return ["--sdf", file]
        to = self.work / f"{file.stem}{voxels}.vdb"
        if not to.exists():
            if model.is_open:
                closed = self.work / file.name
                measure.run([sys.executable, measure.ROOT / "scripts" / "mesh_tool.py", "close", file, closed])
                file = closed
            # Its dim counts the band of three voxels on both sides.
            measure.run(["vdb_tool", "-quiet", "-read", file, "-mesh2ls", f"dim={voxels + 6}", "width=3",
                     "name=psi", "-write", to])
        return ["--sdf", to]

    def mesh(self, model):
        """The mesh file of a model."""
        file = self.file(model)
        if file.suffix != ".vdb":
            return file
        to = self.work / f"{file.stem}.obj"
        if not to.exists():
            self.solve("--sdf", file, "--seed", model.seed, "--mesh-out", to)
        return to

    def shape(self, name, voxel, half_width, *parameters):
        """The level set of a shape whose distance is known exactly."""
        key = "_".join([name, f"{voxel:.6g}", f"{half_width:.3g}", *parameters])
        to = self.work / f"{key}.vdb"
        words = [word for parameter in parameters for word in ("--param", parameter)]
        if not to.exists():
            measure.run([self.build / "bin" / "make_shape", name, "--voxel-size", repr(voxel),
                     "--half-width", half_width, *words, "-o", to])
        return ["--sdf", to]

    def picture(self, name, *words, size="360x270"):
        """Makes images/reproduction/NAME.png; the report of the run."""
        self.images.mkdir(parents=True, exist_ok=True)
        size = "160x120" if self.quick else size
        return self.solve(*words, "--image", self.images / f"{name}.png", "--image-size", size)


def image(name, alt):
    return f"![{alt}](images/reproduction/{name})"


def left_out(file):
    return f"*Left out: `{file}` was not there (`--models`).*"


def side_by_side(images, heads=None):
    heads = heads or [""] * len(images)
    return "\n".join(("| " + " | ".join(heads) + " |", "|" + ":---:|" * len(images),
                      "| " + " | ".join(images) + " |"))


def plot(draw, file):
    """Lets draw(figure) fill a figure of matplotlib and saves it; false without matplotlib."""
    try:
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import figure
    except ImportError:
        print(f"{file.name}: skipped, needs python3-matplotlib", file=sys.stderr)
        return False
    matplotlib.rcParams.update({"svg.hashsalt": "reproduction", "font.size": 8})
    canvas = figure.Figure(layout="constrained")
    draw(canvas)
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(f".{os.getpid()}{file.name}")
    # Without a date: the same figures give the same file.
    canvas.savefig(part, dpi=90, metadata={"Date": None} if file.suffix == ".svg" else {})
    os.replace(part, file)
    return True


def difference(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def surface_values(ply):
    """(x, y, z, distance) of every vertex of --mesh-out: d where S crosses the edges of the grid."""
    header, _, body = ply.read_bytes().partition(b"end_header\n")
    count = int(header.partition(b"element vertex ")[2].split()[0])
    properties = re.findall(rb"^property (float|uchar|int) (\w+)$", header, re.MULTILINE)
    row = struct.Struct("<" + "".join({b"float": "f", b"uchar": "B", b"int": "i"}[kind] for kind, _ in properties))
    wanted = [[name for _, name in properties].index(name) for name in (b"x", b"y", b"z", b"distance")]
    for values in row.iter_unpack(body[:count * row.size]):
        yield tuple(values[k] for k in wanted)


def mesh_points(file, count):
    """About so many vertices of an .obj file, evenly spread over its list."""
    with open(file) as lines:
        points = [tuple(map(float, line.split()[1:4])) for line in lines if line.startswith("v ")]
    return points[::max(1, len(points) // count)]


def at_points(bench, points, *words):
    """Distances at points, and the largest of the surface. A few thousand points at most: a path is
    traced from each."""
    file = bench.work / "points.csv"
    file.write_text("".join("{!r},{!r},{!r}\n".format(*p) for p in points))
    report = bench.solve(*words, "--targets", file)
    return [target["distance"] for target in report["targets"]], report["distance"]["max"]


# The sphere of Table 2 and Fig. 12, in the unit cube.
RADIUS = 0.4
MIDDLE = (0.5, 0.5, 0.5)
SEEDS = {"axis": (0, 0, 1), "general": (0.314106, 0.52711, 0.789615)}


def on_sphere(direction, radius=RADIUS):
    length = math.hypot(*direction)
    return [c + radius * x / length for c, x in zip(MIDDLE, direction)]


def slope(pairs):
    """Least-squares slope of log y over log x."""
    logs = [(math.log(x), math.log(y)) for x, y in pairs]
    mx, my = (sum(values) / len(logs) for values in zip(*logs))
    return sum((x - mx) * (y - my) for x, y in logs) / sum((x - mx) ** 2 for x, _ in logs)
