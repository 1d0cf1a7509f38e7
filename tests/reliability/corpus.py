"""Broken inputs, made from sound ones: the same number gives the same input.

`sound_files()` makes one small sound file per format and method of writing it; `case(seed, number)` spoils one
of them. What is done depends on the seed and the number alone, so any case can be made again.
"""
import base64
import json
import math
import pathlib
import random
import struct
import subprocess
from dataclasses import dataclass, field

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Command lines; FILE is the broken input, SURFACE a sound level set. Seeds are taken from anywhere, so
# that nothing but the file can be refused.
MARCH = "--seed 1,0,0 --snap 1e6 -q -o out.vdb"
ON_SURFACE = "--sdf SURFACE -q -o out.vdb"
USES = {
    "vdb": [f"--sdf FILE {MARCH}"] * 4 + [
        f"--sdf - {MARCH}", f"--sdf FILE --rebuild {MARCH}", "info FILE -q",
        f"--weight FILE --seed 0,0,1 {ON_SURFACE}", f"--obstacle FILE --seed 0,0,1 {ON_SURFACE}",
        f"--seed-mask FILE {ON_SURFACE}", f"--metric FILE --seed 0,0,1 {ON_SURFACE}"],
    "vdb-points": [f"--points FILE {MARCH}"] * 3 + [f"--sdf FILE {MARCH}", f"--obstacle FILE --seed 0,0,1 {ON_SURFACE}"],
    "mesh": [f"--mesh FILE --resolution 16 {MARCH}"],
    "points": [f"--points FILE {MARCH}"],
    "points-or-mesh": [f"--points FILE {MARCH}", f"--mesh FILE --resolution 16 {MARCH}"],
    "seeds": [f"--seeds FILE --snap 1e6 {ON_SURFACE}", f"--seed 0,0,1 --targets FILE --snap 1e6 {ON_SURFACE}"],
    "curve": [f"--seed-curve FILE --snap 1e6 {ON_SURFACE}"],
    "pairs": ["--sdf SURFACE --pairs FILE --snap 1e6 -q --pairs-out out.csv"],
}


@dataclass
class Sound:
    name: str
    kind: str  # of USES
    content: bytes
    text: bool = False


@dataclass
class Case:
    number: int
    file: str
    content: bytes
    line: str
    how: list[str] = field(default_factory=list)

    @property
    def from_stdin(self) -> bool:
        return "--sdf - " in self.line


# ---- sound files ----

def octahedron() -> tuple[list[tuple], list[tuple]]:
    """A sphere of 66 points and 128 triangles: an octahedron cut up twice."""
    points = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    for _ in range(2):
        middle: dict[tuple, int] = {}

        def between(a: int, b: int) -> int:
            key = (min(a, b), max(a, b))
            if key not in middle:
                p = [points[a][k] + points[b][k] for k in range(3)]
                size = math.sqrt(sum(c * c for c in p))
                points.append(tuple(c / size for c in p))
                middle[key] = len(points) - 1
            return middle[key]

        faces = [t for a, b, c in faces for ab, bc, ca in [(between(a, b), between(b, c), between(c, a))]
                 for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
    return points, faces


def row(numbers, separator=" ") -> str:
    return separator.join(f"{c:.9g}" for c in numbers)


def gltf(points: list[tuple], faces: list[tuple]) -> tuple[dict, bytes]:
    data = b"".join(struct.pack("<3f", *p) for p in points)
    indices = b"".join(struct.pack("<3H", *f) for f in faces)
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1]}, {"mesh": 0, "translation": [0, 0, 0.5]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(data) + len(indices)}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(data), "target": 34962},
                        {"buffer": 0, "byteOffset": len(data), "byteLength": len(indices), "target": 34963}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3",
                       "min": [-1, -1, -1], "max": [1, 1, 1]},
                      {"bufferView": 1, "componentType": 5123, "count": 3 * len(faces), "type": "SCALAR"}]}
    return document, data + indices


def glb(document: dict, data: bytes) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def mesh_files() -> list[Sound]:
    points, faces = octahedron()
    obj = "".join(f"v {row(p)}\n" for p in points) + "".join(f"vn {row(p)}\n" for p in points)
    obj += "o ball\n" + "".join("f " + " ".join(f"{i + 1}//{i + 1}" for i in f) + "\n" for f in faces)
    off = f"OFF\n{len(points)} {len(faces)} 0\n" + "".join(row(p) + "\n" for p in points)
    off += "".join(f"3 {a} {b} {c}\n" for a, b, c in faces)
    stl = struct.pack("<80sI", b"ball", len(faces))
    stl_text = "solid ball\n"
    for f in faces:
        corners = [points[i] for i in f]
        stl += struct.pack("<12fH", 0, 0, 0, *(c for p in corners for c in p), 0)
        stl_text += " facet normal 0 0 0\n  outer loop\n" + "".join(f"   vertex {row(p)}\n" for p in corners)
        stl_text += "  endloop\n endfacet\n"
    stl_text += "endsolid ball\n"
    document, data = gltf(points, faces)
    binary = glb(document, data)
    document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return [Sound("ball.obj", "points-or-mesh", obj.encode(), True), Sound("ball.off", "mesh", off.encode(), True),
            Sound("ball.stl", "mesh", stl), Sound("text.stl", "mesh", stl_text.encode(), True),
            Sound("ball.gltf", "mesh", json.dumps(document).encode(), True), Sound("ball.glb", "mesh", binary)]


def ply_files() -> list[Sound]:
    points, faces = octahedron()

    def header(form: str) -> bytes:
        return (f"ply\nformat {form} 1.0\ncomment sound\nelement vertex {len(points)}\n"
                + "".join(f"property float {c}\n" for c in ("x", "y", "z", "nx", "ny", "nz"))
                + f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n").encode()

    made = []
    for form, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
        body = b"".join(struct.pack(order + "6f", *p, *p) for p in points)
        body += b"".join(struct.pack(order + "B3i", 3, *f) for f in faces)
        made.append(Sound(f"{form}.ply", "points-or-mesh", header(form) + body))
    text = "".join(f"{row(p)} {row(p)}\n" for p in points) + "".join(f"3 {a} {b} {c}\n" for a, b, c in faces)
    made.append(Sound("text.ply", "points-or-mesh", header("ascii") + text.encode(), True))
    return made


def list_files() -> list[Sound]:
    points, _ = octahedron()
    ring = [(math.cos(a), math.sin(a), 0.0) for a in (k * math.pi / 16 for k in range(32))]
    dump = json.dumps
    made = [
        ("cloud.xyz", "points", "# a ball\n" + "".join(row(p) + "\n" for p in points)),
        ("cloud.csv", "points", "x,y,z,nx,ny,nz\n" + "".join(row(p + p, ",") + "\n" for p in points)),
        ("seeds.csv", "seeds", "x,y,z,start\n" + "".join(row(p + (0.1,), ",") + "\n" for p in points[:8])),
        ("seeds.json", "seeds", dump([list(points[0]), {"position": list(points[1]), "start": 0.5}])),
        ("curve.csv", "curve", "".join(row(p, ",") + "\n" for p in ring)),
        ("curve.json", "curve", dump([{"position": ring, "closed": True, "start": 0.25}])),
        ("isolines.json", "curve", dump({"schema": 2, "type": "isolines", "isolines": [
            {"level": 1.0, "closed": True, "position": ring}]})),
        ("pairs.csv", "pairs", "".join(row(a + b, ",") + "\n" for a, b in zip(points[:4], points[2:]))),
        ("pairs.json", "pairs", dump([a + b for a, b in zip(points[:4], points[2:])])),
    ]
    return [Sound(name, kind, content.encode(), True) for name, kind, content in made]


def vdb_files(folder: pathlib.Path) -> list[Sound]:
    """Those of data/, and other ways to write a sphere, by vdb_tool."""
    made = [Sound(f.name, "vdb", f.read_bytes()) for f in sorted((ROOT / "data").glob("*.vdb"))
            if f.stat().st_size < 200_000]
    ball = "-sphere dim=16 radius=1 name=psi"
    variants = {f"{codec}{bits}.vdb": ("vdb", f"{ball} -write codec={codec} bits={bits}")
                for codec in ("zip", "blosc", "active") for bits in (16, 32)}
    variants |= {"fog.vdb": ("vdb", f"{ball} -ls2fog -write"),
                 "gradient.vdb": ("vdb", f"{ball} -grad -write"),
                 "several.vdb": ("vdb", f"{ball} {ball} -ls2fog -write vdb=*"),
                 "points.vdb": ("vdb-points", f"{ball} -ls2mesh -points2vdb bits=32 -write")}
    for name, (kind, line) in variants.items():
        words = line.split()
        at = words.index("-write") + 1
        done = subprocess.run(["vdb_tool", "-quiet", *words[:at], str(folder / name), *words[at:]],
                              capture_output=True, check=False)
        if done.returncode == 0 and (folder / name).exists():
            made.append(Sound(name, kind, (folder / name).read_bytes()))
    return made


def sound_files(folder: pathlib.Path) -> list[Sound]:
    return vdb_files(folder) + mesh_files() + ply_files() + list_files()


# ---- how to spoil them ----

WORDS = [0, 1, 2, 0x7f, 0x80, 0xff, 0x7fff, 0x8000, 0xffff, 0x7fffffff, 0x80000000, 0xffffffff, 0x10000000,
         0x3fffffff, 0x40000001, 1 << 40, (1 << 62) + 1, (1 << 63) - 1, 1 << 63, (1 << 64) - 1]
TOKENS = ["nan", "inf", "-inf", "1e999", "-1e308", "1e-320", "-1", "0", "-0.0", "4294967295", "4294967296",
          "2147483647", "18446744073709551616", "99999999", "0x10", "1e", "+", "-", ".", "", "null", "true", "[]",
          "{}", "\"x\"", "\u00e4\u00f6", "\0", "1,2", "1;2", "# 1", "1//-9", "1e5" * 50]


def place(r: random.Random, size: int) -> int:
    """Anywhere; half of the time near the start, where headers are."""
    return r.randrange(min(size, 2000) if r.random() < 0.5 else size) if size else 0


def flip_bits(r, b: bytearray, _others):
    for _ in range(r.choice([1, 1, 2, 4, 16]) if b else 0):
        b[place(r, len(b))] ^= 1 << r.randrange(8)


def set_word(r, b: bytearray, _others):
    size = r.choice([1, 2, 4, 4, 4, 8, 8])
    at = place(r, len(b))
    word = r.choice(WORDS) if r.random() < 0.8 else r.getrandbits(64)
    b[at:at + size] = (word & ((1 << 8 * size) - 1)).to_bytes(size, r.choice(["little", "little", "big"]))


def set_float(r, b: bytearray, _others):
    value = r.choice([math.nan, math.inf, -math.inf, 1e38, -1e38, 1e-40, 0.0, 1e10])
    at = place(r, len(b))
    number = struct.pack(*r.choice([("<f", value), ("<d", value)]))
    b[at:at + len(number)] = number


def cut_off(r, b: bytearray, _others):
    del b[place(r, len(b)):]


def cut_end(r, b: bytearray, _others):
    del b[-r.choice([1, 2, 4, 8, 100]):]


def cut_out(r, b: bytearray, _others):
    at = place(r, len(b))
    del b[at:at + r.choice([1, 4, 8, 57, 512, 4096])]


def repeat_piece(r, b: bytearray, _others):
    at = place(r, len(b))
    b[at:at] = b[at:at + r.choice([1, 8, 64, 1024])] * r.choice([1, 2, 100])


def insert_noise(r, b: bytearray, _others):
    at = place(r, len(b))
    b[at:at] = r.randbytes(r.choice([1, 4, 16, 300]))


def overwrite(r, b: bytearray, _others):
    at, size = place(r, len(b)), r.choice([4, 16, 64, 1024])
    b[at:at + size] = r.choice([bytes(size), b"\xff" * size, r.randbytes(size)])


def splice(r, b: bytearray, others):
    other = r.choice(others).content
    at, start = place(r, len(b)), place(r, len(other))
    if r.random() < 0.5:
        b[at:] = other[start:]
    else:
        piece = other[start:start + r.choice([16, 256, 4096])]
        b[at:at + len(piece)] = piece


def spoil_token(r, b: bytearray, _others):
    """Replaces, repeats or removes a piece between blanks, commas and brackets."""
    text = b.decode("utf-8", "replace")
    ends = " \t\n,;[]{}:/"
    at = place(r, len(text))
    first = at
    while first > 0 and text[first - 1] not in ends:
        first -= 1
    last = at
    while last < len(text) and text[last] not in ends:
        last += 1
    b[:] = (text[:first] + r.choice(TOKENS) + text[last:]).encode("utf-8", "replace")


def spoil_line(r, b: bytearray, _others):
    lines = b.split(b"\n")
    k = r.randrange(len(lines))
    what = r.randrange(4)
    if what == 0:
        del lines[k]
    elif what == 1:
        lines[k:k] = [lines[k]] * r.choice([1, 3, 1000])
    elif what == 2:
        other = r.randrange(len(lines))
        lines[k], lines[other] = lines[other], lines[k]
    else:
        lines[k] = lines[k].replace(b"\r", b"") + b"\r" + lines[k] * r.choice([0, 1, 50])
    b[:] = b"\n".join(lines)


ANY = [flip_bits, set_word, set_word, set_float, cut_off, cut_end, cut_out, repeat_piece, insert_noise, overwrite, splice]
TEXT = ANY + [spoil_token] * 8 + [spoil_line] * 4


def spoil(r: random.Random, sound: Sound, others: list[Sound], how: list[str]) -> bytes:
    content = bytearray(sound.content)
    for _ in range(r.choice([1, 1, 1, 2, 4])):
        way = r.choice(TEXT if sound.text else ANY)
        how.append(way.__name__)
        way(r, content, others)
    return bytes(content)


# ---- made by hand: sizes and depths that no accident has ----

def crafted() -> list[tuple[str, str, bytes]]:
    """(file, kind of USES, content)"""
    deep = 200_000
    made = []

    def add(file: str, kind: str, content):
        made.append((file, kind, content if isinstance(content, bytes) else content.encode()))

    for kind in ("seeds", "curve", "pairs"):
        add("deep.json", kind, "[" * deep + "]" * deep)
        add("deep.json", kind, "[" * deep)
        add("deep.json", kind, "[[" + "[" * deep + "]" * deep + ",1,2,3,4,5]]")
        add("objects.json", kind, '{"position":' * deep + "1" + "}" * deep)
        add("wide.json", kind, "[" + "0," * 300_000 + "0]")
        add("string.json", kind, '["' + "x" * 3_000_000 + '"]')
        add("number.json", kind, "[[" + "9" * 100_000 + ",0,0]]")
        add("line.csv", kind, "1," * 1_000_000)
        add("number.csv", kind, "9" * 1_000_000 + ",0,0\n")
        add("zeros.csv", kind, b"\0" * 100_000)
        add("empty.csv", kind, b"")
        add("empty.json", kind, b"")
    add("deep.json", "curve", '{"isolines":' + "[" * deep + "]" * deep + "}")
    add("deep.json", "curve", '{"paths":' * 1000 + "[]" + "}" * 1000)
    add("deep.json", "curve", '[{"vertices":' * deep + "[]" + "}]" * deep)
    for count in ("4294967295", "9223372036854775807", "1000000000000", "-1", "1e9"):
        for form in ("ascii", "binary_little_endian"):
            head = f"ply\nformat {form} 1.0\nelement vertex {count}\n"
            add("count.ply", "points-or-mesh", head + "property float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n")
            add("bare.ply", "points-or-mesh", head + "end_header\n")
            add("list.ply", "points-or-mesh", head + "property list uint double x\nend_header\n" + "\xff" * 64)
        add("count.off", "mesh", f"OFF\n{count} {count} 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        add("corners.off", "mesh", f"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n{count} 0 1 2\n")
        add("index.obj", "points-or-mesh", f"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {count}\n")
    add("count.stl", "mesh", struct.pack("<80sI", b"x", 0xffffffff) + bytes(50))
    add("lists.ply", "points-or-mesh", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n100000 "
        + "0 1 2 " * 40_000)
    points, faces = octahedron()
    polygon = len(points) * 200
    add("polygon.obj", "mesh", "".join(f"v {math.cos(k)} {math.sin(k)} 0\n" for k in range(polygon))
        + "f " + " ".join(str(k + 1) for k in range(polygon)) + "\n")
    document, data = gltf(points, faces)
    for change in ({"count": 4294967295}, {"count": -1}, {"byteOffset": 1 << 40}, {"bufferView": 99},
                   {"type": "MAT4"}, {"componentType": 0}):
        spoilt = json.loads(json.dumps(document))
        spoilt["accessors"][0].update(change)
        add("accessor.glb", "mesh", glb(spoilt, data))
    for change in ({"byteLength": 1 << 40}, {"byteOffset": -4}, {"byteStride": 1}, {"buffer": 7}):
        spoilt = json.loads(json.dumps(document))
        spoilt["bufferViews"][0].update(change)
        add("view.glb", "mesh", glb(spoilt, data))
    spoilt = json.loads(json.dumps(document))
    spoilt["nodes"] = [{"children": [1]}, {"children": [0], "mesh": 0}]
    add("circle.glb", "mesh", glb(spoilt, data))
    chain = [{"children": [k + 1]} for k in range(20_000)] + [{"mesh": 0}]
    spoilt["nodes"] = chain
    add("chain.glb", "mesh", glb(spoilt, data))
    add("deep.gltf", "mesh", '{"a":' * deep + "1" + "}" * deep)
    add("far.gltf", "mesh", json.dumps({**document, "buffers": [{"byteLength": 1 << 40, "uri": "/dev/zero"}]}))
    add("self.gltf", "mesh", json.dumps({**document, "buffers": [{"byteLength": 4, "uri": "self.gltf"}]}))
    for text in ("1 2\n", "1 2 3\n1 2 3 4 5 6\n", "nan 0 0\n", "1e200 0 0\n2e200 1 0\n3e200 0 1\n", "0 0 0\n" * 1000,
                 "1e-310 0 0\n0 1e-310 0\n", "x\n" * 100, "1 2 3"):
        add("cloud.xyz", "points", text)
    return made


def cases(seed: int, count: int, sounds: list[Sound]):
    """The first `count` cases; those made by hand come first."""
    number = 0
    for file, kind, content in crafted():
        for line in sorted(set(USES[kind])):
            if number < count:
                yield Case(number, file, content, line, ["crafted"])
            number += 1
    while number < count:
        yield random_case(seed, number, sounds)
        number += 1


def random_case(seed: int, number: int, sounds: list[Sound]) -> Case:
    r = random.Random(f"{seed}/{number}")
    # Each kind as often as another, however many files it has.
    kind = r.choice(["vdb", "vdb", "vdb", "vdb-points", "mesh", "mesh", "points-or-mesh", "points", "seeds", "curve", "pairs"])
    alike = [s for s in sounds if s.kind == kind] or sounds
    sound = r.choice(alike)
    how: list[str] = [sound.name]
    content = spoil(r, sound, alike, how)
    line = r.choice(USES[sound.kind])
    ending = pathlib.Path(sound.name).suffix
    return Case(number, "in" + ending, content, line, how)
