#!/usr/bin/env python3
"""Small jobs on triangle meshes for scripts/quickstart.sh and scripts/reproduce.py.

  mesh_tool.py to-obj MODEL FILE.obj     MODEL: an .off file, or index.js of the npm package bunny
  mesh_tool.py close FILE.obj TO.obj     closes holes, each by a cap with one more vertex in its middle
  mesh_tool.py farthest FILE.obj X,Y,Z   prints the vertex farthest in a direction as x,y,z
  mesh_tool.py camera FILE.obj X,Y,Z     prints a place in that direction from which to see it all
"""
import json
import math
import os
import re
import sys


def read_off(path):
    """Vertices and faces of an ASCII .off file."""
    with open(path) as file:
        words = " ".join(line.split("#")[0] for line in file).split()
    if words[0] != "OFF":
        raise ValueError(f"{path}: not an OFF file")
    vertex_count, face_count = int(words[1]), int(words[2])
    at = 4
    vertices = [words[at + 3 * i : at + 3 * i + 3] for i in range(vertex_count)]
    at += 3 * vertex_count
    faces = []
    for _ in range(face_count):
        size = int(words[at])
        faces.append([int(word) for word in words[at + 1 : at + 1 + size]])
        at += 1 + size
    return vertices, faces


def read_js(path):
    """Vertices and faces of a script that assigns `positions` and `cells`."""
    with open(path) as file:
        text = file.read()

    def array(name):
        found = re.search(name + r"\s*=\s*(\[\[.*?\]\])", text, re.DOTALL)
        if not found:
            raise ValueError(f"{path}: no array '{name}'")
        return json.loads(found.group(1))

    return array("positions"), array("cells")


def write_obj(vertices, faces, obj):
    with open(obj + ".part", "w") as file:
        for vertex in vertices:
            file.write("v {} {} {}\n".format(*vertex))
        for face in faces:
            file.write("f " + " ".join(str(index + 1) for index in face) + "\n")
    os.replace(obj + ".part", obj)


def to_obj(model, obj):
    write_obj(*(read_off(model) if model.endswith(".off") else read_js(model)), obj)


def read_obj(obj):
    """Vertices and faces; vertices at one place, to six digits, become one."""
    vertices, faces, number, places = [], [], {}, []
    with open(obj) as file:
        for kind, *words in filter(None, map(str.split, file)):
            if kind == "v":
                place = tuple(round(float(word), 6) + 0.0 for word in words[:3])
                if place not in number:
                    number[place] = len(vertices)
                    vertices.append(place)
                places.append(number[place])
            elif kind == "f":
                corners = [int(word.split("/")[0]) for word in words]  # from 1, or back from -1
                face = [places[n - (n > 0)] for n in corners]
                face = [v for k, v in enumerate(face) if v != face[k - 1]]
                if len(face) > 2:
                    faces.append(face)
    return vertices, faces


def close(obj, closed):
    vertices, faces = read_obj(obj)
    edges = {edge for face in faces for edge in zip(face, face[1:] + face[:1])}
    following = {b: a for a, b in edges if (b, a) not in edges}  # around each hole
    while following:
        rim = [next(iter(following))]
        while (vertex := following.pop(rim[-1])) != rim[0]:
            rim.append(vertex)
        faces += [[a, b, len(vertices)] for a, b in zip(rim, rim[1:] + rim[:1])]
        vertices.append([sum(vertices[v][k] for v in rim) / len(rim) for k in range(3)])
    write_obj(vertices, faces, closed)


def read_obj_vertices(obj):
    with open(obj) as file:
        vertices = [line.split()[1:4] for line in file if line.startswith("v ")]
    if not vertices:
        raise ValueError(f"{obj}: no vertices")
    return [[float(word) for word in vertex] for vertex in vertices]


def read_point(text):
    return [float(word) for word in text.split(",")]


def show_point(point):
    print(",".join(f"{x:.9g}" for x in point))


def farthest(obj, direction):
    direction = read_point(direction)
    show_point(
        max(read_obj_vertices(obj), key=lambda p: sum(a * b for a, b in zip(direction, p)))
    )


def camera(obj, direction):
    direction = read_point(direction)
    ranges = [(min(axis), max(axis)) for axis in zip(*read_obj_vertices(obj))]
    distance = 1.75 * math.dist(*zip(*ranges)) / math.hypot(*direction)
    show_point((low + high) / 2 + distance * x for (low, high), x in zip(ranges, direction))


def main(args):
    jobs = {"to-obj": to_obj, "close": close, "farthest": farthest, "camera": camera}
    if len(args) != 3 or args[0] not in jobs:
        sys.exit(__doc__)
    try:
        jobs[args[0]](*args[1:])
    except (OSError, ValueError, LookupError) as error:
        sys.exit(f"mesh_tool.py: error: {error}")


if __name__ == "__main__":
    main(sys.argv[1:])
