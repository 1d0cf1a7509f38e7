"""Errors name the argument, its value and the values allowed; remedies use the names of Python."""

import re

import numpy as np
import pytest

import igeo
from conftest import ROOT, sheet
from igeo import _errors

VERTICES, FACES = sheet(5)


def with_value(array, at, value):
    changed = np.array(array, dtype=float)
    changed[at] = value
    return changed


@pytest.mark.parametrize(
    "vertices, faces, message",
    [
        (np.zeros((0, 3)), FACES, r"vertices has shape \(0, 3\); allowed is \(n, 3\) with n of 1 or more"),
        (VERTICES[:, :2], FACES, r"vertices has shape \(25, 2\)"),
        (with_value(VERTICES, (3, 1), np.nan), FACES, r"vertices\[3, 1\] is nan"),
        (with_value(VERTICES, (4, 2), np.inf), FACES, r"vertices\[4, 2\] is inf"),
        (VERTICES.astype(complex), FACES, "vertices has dtype complex128"),
        ([["a", "b", "c"]], FACES, "vertices has dtype"),
        ([[1, 2, 3], [4, 5]], FACES, "vertices is no array of numbers"),
        (np.ma.masked_array(VERTICES, VERTICES > 0.9), FACES, "vertices has 10 masked values; allowed are none"),
        (VERTICES, FACES.astype(float), "faces has dtype float64; allowed are integers"),
        (VERTICES, FACES[:, :2], r"faces has shape \(32, 2\)"),
        (VERTICES, FACES[:0], r"faces has shape \(0, 3\)"),
        (VERTICES, FACES + 1, r"faces\[15, 2\] is 25; allowed are 0 to 24"),
        (VERTICES, FACES - 1, r"faces\[0, 0\] is -1; allowed are 0 to 24"),
    ],
)
def test_meshes(vertices, faces, message):
    with pytest.raises(ValueError, match=message) as refusal:
        igeo.Surface.from_mesh(vertices, faces)
    assert isinstance(refusal.value, igeo.InputError)


@pytest.mark.parametrize(
    "options, message",
    [
        ({"voxel_size": -1}, "voxel_size is -1; allowed are finite numbers above 0"),
        ({"voxel_size": "a"}, "voxel_size is 'a'"),
        ({"voxel_size": True}, "voxel_size is True; allowed are numbers above 0"),
        ({"name": "a\udcff"}, "name is .*, which holds bytes that are no UTF-8"),
        ({"voxel_size": "0.1"}, "voxel_size is '0.1'; allowed are numbers above 0"),
        ({"resolution": 2.5}, "resolution is 2.5"),
        ({"resolution": True}, "resolution is True; allowed are integers of 1 and more"),
        ({"resolution": 2**40}, "resolution is 1099511627776"),
        ({"resolution": 9, "voxel_size": 1}, "voxel_size is given beside resolution"),
        ({"join_gaps": float("nan")}, "join_gaps is nan"),
        ({"join_gaps": 1e6}, "join_gaps is 1e\\+06, which is"),
        ({"voxel_size": 0.9}, "voxels of 0.9"),
    ],
)
def test_voxels(options, message):
    with pytest.raises(igeo.InputError, match=message):
        igeo.Surface.from_mesh(VERTICES, FACES, **options)


def test_volumes_and_points():
    cube = np.zeros((4, 4, 4))
    for call, message in [
        (lambda: igeo.Surface.from_volume(cube[0]), "values has shape"),
        (lambda: igeo.Surface.from_volume(with_value(cube, (1, 2, 3), np.nan), 0), r"values\[1, 2, 3\] is nan"),
        (lambda: igeo.Surface.from_volume(cube, 0, spacing=0), "spacing is 0"),
        (lambda: igeo.Surface.from_volume(cube, 0, affine=np.eye(3)), r"affine has shape \(3, 3\)"),
        (lambda: igeo.Surface.from_volume(cube, 0, affine=np.zeros((4, 4))), "last row of affine"),
        (lambda: igeo.Surface.from_volume(cube, 0, affine=np.diag([1, 0, 1, 1])), "lie in one plane"),
        (lambda: igeo.Surface.from_volume(cube, 0, affine=np.eye(4), origin=[0, 0, 0]), "affine is given beside"),
        (lambda: igeo.Surface.from_volume(cube + np.arange(4)), "iso"),
        (lambda: igeo.Surface.from_level_set(cube + 1), "level_set"),
        (lambda: igeo.Surface.from_points(VERTICES, VERTICES[:3]), r"normals has shape \(3, 3\)"),
        (lambda: igeo.Surface.from_openvdb(cube), "grid is of type ndarray"),
        (lambda: igeo.Surface.read("nowhere.obj"), "nowhere.obj"),
        (lambda: igeo.Surface.read("a.obj", grid="psi"), "grid is given, and a.obj is read as mesh"),
        (lambda: igeo.Surface.read("a.obj", kind="cloud"), "kind is 'cloud'; allowed are 'mesh', 'points'"),
        (lambda: igeo.Surface.read("a.vdb", voxel_size=1), "voxel_size is given, and a.vdb is read as level set"),
        (lambda: igeo.Surface.read("a.vdb", resolution=9), "resolution is given, and a.vdb is read as level set"),
        (lambda: igeo.Surface.read("a.vdb", join_gaps=1), "join_gaps is given, and a.vdb is read as level set"),
        (lambda: igeo.Surface.read("a.xyz", join_gaps=1), "join_gaps is given, and a.xyz is read as points"),
        (lambda: igeo.Surface.read("a.nii", join_gaps=1), "join_gaps is given, and a.nii is read as volume"),
        (lambda: igeo.Surface.read("a.vdb", scheme="godunov"), "scheme is given, and a.vdb is read as level set"),
        (lambda: igeo.Surface.read("a.obj", scheme="godunov"), "scheme is given, and a.obj is read as mesh"),
        (lambda: igeo.Surface.read("a.obj\0b.obj"), r"file is 'a.obj\\x00b.obj'; allowed are names of files"),
        (lambda: igeo.Surface.read(""), "file is ''; allowed are names of files"),
        (lambda: igeo.Surface.read(b"\xff.obj"), r"file is b'\\xff.obj'; allowed are names in UTF-8"),
        (lambda: igeo.Surface.read(5), "file is 5; allowed are names of files"),
        (lambda: igeo.Surface.read("a.vdb", grid=None), "grid is None; allowed are strings"),
        (lambda: igeo.Surface.from_volume(cube, "0"), "iso is '0'; allowed are finite numbers"),
        (lambda: igeo.Surface.from_volume(np.ma.masked_array(cube, cube == 0), 0), "values has 64 masked values"),
        (lambda: igeo.Surface.from_points(VERTICES, scheme=["jet"]), r"scheme is \['jet'\]; allowed are 'jet'"),
        (lambda: igeo.Surface.from_points(VERTICES, scheme=np.array(["jet"])), "scheme is array"),
        (lambda: igeo.Surface.read("a.vdb", rebuild="no"), "rebuild is 'no'; allowed are True and False"),
        (lambda: igeo.Surface.from_volume(cube, np.nan), "iso is nan; allowed are finite numbers"),
        (lambda: igeo.Surface.from_volume(cube, 0, name=5), "name is 5; allowed are strings"),
    ]:
        with pytest.raises(igeo.Error, match=message):
            call()
    with pytest.raises(OSError):
        igeo.Surface.read("nowhere.obj")


def test_seeds(sheet_solver, sphere_solver):
    solver, line = sheet_solver, [[0.0, 0, 0], [1.0, 0, 0]]
    for call, message in [
        (lambda: solver.distance(), "no seed"),
        (lambda: solver.distance([]), r"seeds has shape \(0,\)"),
        (lambda: solver.distance([441]), r"seeds\[0\] is 441; allowed are 0 to 440"),
        (lambda: solver.distance([0, 0, 1]), r"seeds is \[0, 0, 1\], a vertex twice"),
        (lambda: solver.distance([-1]), r"seeds\[0\] is -1"),
        (lambda: solver.distance((np.arange(441) < 50).astype(np.uint8)), "seeds has a 0 or 1 of dtype uint8 "),
        (lambda: solver.distance([0] * 441), "seeds has a 0 or 1 of dtype int64 for each of the 441 vertices"),
        (lambda: solver.matrix({"A": [1] * 441, "B": [7]}), r"seeds\['A'\] has a 0 or 1 of dtype int64"),
        (lambda: solver.distances([[0], np.ones(441, np.int8)]), r"many\[1\] has a 0 or 1 of dtype int8"),
        (lambda: solver.distance([[0, 0, np.nan]]), r"seeds\[0, 2\] is nan"),
        (lambda: solver.distance([[0.5, 0.5, 2.0]]), "seed 0 .* from the surface"),
        (lambda: solver.distance([0], start=[1.0, 2]), r"start has shape \(2,\); allowed is \(1,\)"),
        (lambda: solver.distance([0], start=[-1.0]), "seed 0 starts at -1"),
        (lambda: solver.distance({"A": [0, 1]}, start=[1.0, 2]), r"start has shape \(2,\); .*, one per group"),
        (lambda: solver.distance({"A": [0, 1]}, start=[-1.0]), "a seed of group A starts at -1"),
        (lambda: solver.distance(np.arange(441) < 50, start=[1.0]), "start is given for a region"),
        (lambda: solver.distance(curves=line, start=[1.0]), "start is given without seeds, and curves start at 0"),
        (lambda: solver.distance(np.zeros(441, bool)), "seeds is a region that holds no vertex"),
        (lambda: solver.distances([[0], np.zeros(441, bool)]), r"many\[1\] is a region that holds no vertex"),
        (lambda: solver.distance(curves=[0, 5, 9]), r"curves\[0\] has shape \(\)"),
        (lambda: solver.distance(curves=[[0, 5, 9, 12]]), r"curves has shape \(1, 4\)"),
        (lambda: solver.distance(curves=5), "curves is 5; allowed are polylines"),
        (lambda: solver.distance([0], max_distance=-2), "max_distance is -2"),
        (lambda: solver.distance([0], signed=True), "signed distance"),
        (lambda: solver.distance(np.ones(7, bool)), r"seeds has shape \(7,\); allowed is \(441,\)"),
        (lambda: solver.distance([0], start=np.ma.masked_array([1.0], [True])), "start has 1 masked values"),
        (lambda: solver.distance({"\udcff": [0]}), "the name of seeds.* no UTF-8"),
        (lambda: solver.distance(np.arange(441) < 50, signed="no"), "signed is 'no'; allowed are True and False"),
        (lambda: solver.matrix(np.arange(441) < 50, [7]), "seeds is a region, and a matrix has rows of points"),
        (lambda: solver.pairs([0], [1], skip_off_surface="no"), "skip_off_surface is 'no'"),
        (lambda: solver.pair_paths([0], [1], straighten="no"), "straighten is 'no'"),
        (lambda: solver.via([0, 1], closed="no"), "closed is 'no'"),
        (lambda: solver.distance([0]).path(7, straighten="no"), "straighten is 'no'"),
        (lambda: solver.distance([0]).log_map([0, 0, 0]), "reference is zero; allowed are directions"),
        (lambda: solver.distance([0]).image(spacing=np.array([0.1, 0.2])), "spacing is array"),
        (lambda: solver.distance({"A": [0.5]}), r"seeds\['A'\] has shape"),
        (lambda: solver.distance([0]).at([[0.5, 0.5, 0], [9, 9, 9]]), "point 1 .* from the surface"),
        (lambda: solver.distance([0]).at(np.zeros(2)), r"points has shape \(2,\)"),
        (lambda: solver.distance([0]).at([441]), r"points\[0\] is 441"),
        (lambda: solver.distance([0]).path([[0, 0, 0], [1, 1, 0]]), "target holds 2 points"),
        (lambda: solver.distance([0]).paths([[0.0, 0, 0], [5, 5, 5]]), "target 1: "),
        (lambda: solver.distance([0]).isolines([-1.0]), "levels has -1"),
        (lambda: solver.distance([0]).isolines([]), r"levels has shape \(0,\)"),
        (lambda: solver.distance([0]).image(color_map="jet"), "color_map is 'jet'"),
        (lambda: solver.distance([0]).image(width=0), "width is 0; allowed are integers of 1 to 16384"),
        (lambda: solver.distance([0]).image(height=9.5), "height is 9.5; allowed are integers of 1 to 16384"),
        (lambda: solver.distance([0]).image("a.jpg"), "path is 'a.jpg'; allowed are names that end in .png"),
        (lambda: solver.distance([0]).view("a.htm"), "path is 'a.htm'; allowed are names that end in .html"),
        (lambda: solver.distance([0]).to_vdb("a.obj"), "path is 'a.obj'; allowed are names that end in .vdb"),
        (lambda: solver.distance([0]).to_vdb("a\n.vdb"), r"path is 'a\\n.vdb', which holds a control character"),
        (lambda: solver.distance([0]).to_vdb("a.vdb", name="\x1b"), r"name is '\\x1b', which holds a control"),
        (lambda: solver.distance([0]).to_vdb("no/folder/a.vdb"), "no/folder"),
        (lambda: solver.distances([]), "many is empty"),
        (lambda: solver.distances(5), "many is 5; allowed are a list of seeds"),
        (lambda: solver.distances({"A": [0]}), "many is .*; allowed are a list of seeds"),
        (lambda: solver.distances(np.array([[4, 5, 6], [1, 2, 3]])), r"many is an array \(2, 3\) of integers"),
        (lambda: solver.sample(0), "count is 0"),
        (lambda: solver.sample(2.0), "count is 2.0; allowed are integers of 1 and more"),
        (lambda: igeo.threads(0).__enter__(), "count is 0; allowed are integers of 1 and more"),
        (lambda: igeo.threads(2.5).__enter__(), "count is 2.5; allowed are integers of 1 and more"),
        (lambda: sphere_solver.distance([0]), "has no vertices"),
        (lambda: sphere_solver.distance([0, 0, 1.0]).on_vertices, "values at vertices need a mesh"),
        (lambda: sphere_solver.distances([[0, 0, 1.0]]), "give points by at"),
    ]:
        with pytest.raises(igeo.Error, match=message):
            call()


def test_what_godunov_does_not_do():
    """Results that are marched with jet, and labels, are refused in place of other numbers."""
    surface = igeo.Surface.from_mesh(VERTICES, FACES, resolution=32)
    solver = igeo.Solver(surface, scheme="godunov")
    for call, what in [
        (lambda: solver.matrix([0, 4]), "matrix"),
        (lambda: solver.pairs([0], [4]), "pairs"),
        (lambda: solver.pair_paths([0], [4]), "pair_paths"),
        (lambda: solver.via([0, 4]), "via"),
        (lambda: solver.sample(3), "sample"),
    ]:
        with pytest.raises(igeo.InputError, match=f"{what} is marched with jet, and scheme='godunov' is asked for"):
            call()
    both, one = solver.distance([0, 24]), solver.distance([0])
    for call in (lambda: both.labels, lambda: both.labels_at([7])):
        with pytest.raises(igeo.InputError, match="labels need scheme='jet'"):
            call()
    assert (both.mesh().labels == -1).all() and (one.mesh().labels == 0).all() and (one.labels == 0).all()
    assert (solver.distances([0, 24])[1] == solver.distance([24]).on_vertices).all()


def test_costs():
    surface = igeo.Surface.from_mesh(VERTICES, FACES, resolution=32)
    gaps = igeo.Surface.from_mesh(VERTICES, FACES, resolution=32, join_gaps=0.1)
    level_set = igeo.Surface.from_level_set(np.linalg.norm(np.indices((20, 20, 20)) - 9.5, axis=0) - 6)
    for call, message in [
        (lambda: igeo.Solver(surface, weight=np.ones(3)), r"weight has shape \(3,\); allowed is \(25,\)"),
        (lambda: igeo.Solver(surface, weight=-np.ones(25)), r"weight\[0\] is -1"),
        (lambda: igeo.Solver(surface, weight=lambda p: p), "what weight returns has shape"),
        (lambda: igeo.Solver(surface, weight=lambda p: 0 * p[:, 0]), r"what weight returns\[0\] is 0"),
        (lambda: igeo.Solver(surface, tensor=-np.tile(np.eye(3), (25, 1, 1))), "has the eigenvalue -1"),
        (lambda: igeo.Solver(surface, tensor=np.triu(np.ones((25, 3, 3)))), "is not symmetric"),
        (lambda: igeo.Solver(surface, obstacles=np.zeros(25)), "obstacles has dtype float64; allowed is bool"),
        (lambda: igeo.Solver(surface, obstacles=igeo.Sphere([0, 0, 0], -1)), "obstacles.radius is -1"),
        (lambda: igeo.Solver(surface, obstacles=[igeo.Box([0, 0, 0], [1, 1, -1])]), r"obstacles\[0\].low"),
        (lambda: igeo.Solver(level_set, weight=np.ones(3)), "is no mesh"),
        (lambda: igeo.Solver(surface, scheme="fast"), "scheme is 'fast'"),
        (lambda: igeo.Solver(surface, order=3), "order is 3"),
        (lambda: igeo.Solver(surface, order=1.0, scheme="godunov"), "order is 1.0; allowed are 1 and 2"),
        (lambda: igeo.Solver(gaps, scheme="godunov"), "scheme is 'godunov', and mesh has join_gaps, which is for jet"),
        (lambda: igeo.Solver(surface, obstacles=[[igeo.Sphere((9, 9, 9), 1)]]), r"obstacles\[0\] is no array"),
        (lambda: igeo.Solver(surface, progress=5), "progress is 5; allowed are functions of a stage and a share"),
        (lambda: igeo.Solver(surface, order=1), 'order is 1 and scheme is "jet"'),
        (lambda: igeo.Solver(surface, memory_limit=1.0).distance([0]), "memory"),
    ]:
        with pytest.raises(igeo.InputError, match=message):
            call()


def test_what_a_function_raises_comes_out():
    surface = igeo.Surface.from_mesh(VERTICES, FACES, resolution=32)
    with pytest.raises(ZeroDivisionError):
        igeo.Solver(surface, weight=lambda p: 1 // 0)


def test_remedies_speak_of_arguments(sheet_solver):
    with pytest.raises(igeo.Error) as refusal:
        sheet_solver.distance([[0.5, 0.5, 2.0]])
    assert "raise snap" in refusal.value.remedy and refusal.value.remedy in str(refusal.value)
    with pytest.raises(igeo.Error) as refusal:
        igeo.Solver(sheet_solver.surface, memory_limit=1.0).distance([0])
    assert "max_distance" in refusal.value.remedy and "memory_limit" in refusal.value.remedy


def test_every_word_of_the_library_has_one_of_python():
    """The program's table lists the names that remedies use."""
    table = (ROOT / "apps/implicit-geodesic/option_words.cpp").read_text()
    words = re.findall(r'\{"([^"]+)", "', table)
    assert len(words) > 10
    for word in words:
        text = _errors.in_python_words(f"give {word}.")
        assert word not in text or word.islower(), word
        assert "--" not in text and "::" not in text and not re.search(r"\b[a-z]+[A-Z]", text), text


