"""Surfaces, volumes and values per vertex that nibabel writes, as the program reads them."""
import gzip
import json
import pathlib
import unittest

from consumers import geodesic, temporary, use_debian_python

use_debian_python("nibabel", "numpy")

import nibabel as nib  # noqa: E402
import numpy as np  # noqa: E402
from nibabel.freesurfer import io as freesurfer  # noqa: E402


def sphere(rounds: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """An icosahedron whose triangles are cut in four, on the unit sphere."""
    t = (1 + 5**0.5) / 2
    points = [(-1, t, 0), (1, t, 0), (-1, -t, 0), (1, -t, 0), (0, -1, t), (0, 1, t), (0, -1, -t), (0, 1, -t),
              (t, 0, -1), (t, 0, 1), (-t, 0, -1), (-t, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
             (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
             (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    points = [np.array(p) / np.linalg.norm(p) for p in points]
    for _ in range(rounds):
        middles, cut = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(points)
                m = points[a] + points[b]
                points.append(m / np.linalg.norm(m))
            return middles[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            cut += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = cut
    return np.array(points, dtype=np.float32), np.array(faces, dtype=np.int32)


POINTS, FACES = sphere()


def write_gifti(file, arrays) -> None:
    image = nib.gifti.GiftiImage()
    for data, intent, encoding in arrays:
        image.add_gifti_data_array(nib.gifti.GiftiDataArray(data, intent=intent, encoding=encoding))
    nib.save(image, file)


def write_gifti_surface(file, encoding="B64GZ") -> None:
    write_gifti(file, [(POINTS, "NIFTI_INTENT_POINTSET", encoding), (FACES, "NIFTI_INTENT_TRIANGLE", encoding)])


def text_of(p) -> str:
    return ",".join(repr(float(x)) for x in p)


class InFolder(unittest.TestCase):
    def setUp(self):
        holder = temporary()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def path(self, name: str) -> str:
        return str(self.folder / name)

    def per_vertex(self, mesh: str, *options: str) -> np.ndarray:
        """The distance from vertex 5 at every vertex."""
        geodesic("--mesh", self.path(mesh), "--seed", "vertex:5", "--resolution", "60", "-q",
                 "--per-vertex", self.path("d.npy"), "-o", self.path("o.vdb"), *options)
        return np.load(self.path("d.npy"))

    def matrix(self, *options: str) -> np.ndarray:
        geodesic(*options, "--matrix", self.path("m.npy"), "-o", self.path("o.vdb"), "-q")
        return np.load(self.path("m.npy"))


class Meshes(InFolder):
    """The same numbers of vertices, and so the same distances, from every format."""

    def test_surfaces(self):
        exact = np.arccos(np.clip(POINTS @ POINTS[5], -1, 1))
        for encoding in ("ASCII", "B64BIN", "B64GZ"):
            write_gifti_surface(self.path(f"{encoding}.surf.gii"), encoding)
        freesurfer.write_geometry(self.path("lh.pial"), POINTS, FACES, create_stamp="by a test", volume_info={
            "head": np.array([2, 0, 20]), "valid": "1  # volume info valid", "filename": "x.mgz",
            "volume": np.array([256, 256, 256]), "voxelsize": np.ones(3), "xras": np.array([-1.0, 0, 0]),
            "yras": np.array([0, 0, -1.0]), "zras": np.array([0, 1.0, 0]), "cras": np.array([5.0, 6, 7])})
        with gzip.open(self.path("a.gii.gz"), "wb") as file:
            file.write((self.folder / "B64BIN.surf.gii").read_bytes())
        first = self.per_vertex("B64GZ.surf.gii")
        self.assertEqual(first.shape, (len(POINTS),))
        self.assertLess(np.abs(first - exact).max(), 0.0025)  # measured 0.0016
        self.check_quadrangles()
        for name in ("B64BIN.surf.gii", "lh.pial", "a.gii.gz"):
            np.testing.assert_array_equal(self.per_vertex(name), first, name)
        # Text has seven digits. Opposite the seed, where all fronts meet, they can tip a threshold.
        text, opposite = self.per_vertex("ASCII.surf.gii"), exact > 3
        np.testing.assert_allclose(text[~opposite], first[~opposite], atol=1e-5)
        np.testing.assert_allclose(text, first, atol=8.5e-5)  # measured 5.6e-5

    def check_quadrangles(self):
        """A box of FreeSurfer's older files, as nibabel reads it."""
        def int24(values):
            return b"".join(int(v).to_bytes(3, "big") for v in np.ravel(values))

        corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 2) for x in (0, 3)])
        quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        head, faces = int24([8, 6]), int24(quads)
        (self.folder / "lh.new").write_bytes(b"\xff\xff\xfd" + head + corners.astype(">f4").tobytes() + faces)
        (self.folder / "lh.old").write_bytes(b"\xff\xff\xff" + head + (100 * corners).astype(">i2").tobytes() + faces)
        for name in ("lh.new", "lh.old"):
            np.testing.assert_array_equal(freesurfer.read_geometry(self.path(name))[0], corners)
            geodesic(self.path(name), "--seed", "vertex:0", "--resolution", "60", "-q", "--per-vertex",
                     self.path("q.csv"), "--target", "vertex:7", "--straighten", "--report", self.path("r.json"))
            rows = np.loadtxt(self.path("q.csv"), delimiter=",", skiprows=1)
            np.testing.assert_allclose(rows[[1, 2, 4], 1], [3, 2, 1], rtol=1e-12)  # measured 0
            length = json.loads((self.folder / "r.json").read_text())["targets"][0]["length"]
            self.assertAlmostEqual(length, 18**0.5, delta=1e-6)

    def test_masks_and_weights_per_vertex(self):
        write_gifti_surface(self.path("a.surf.gii"))
        free = self.per_vertex("a.surf.gii")
        wall = POINTS @ POINTS[5] < -0.5
        write_gifti(self.path("wall.label.gii"), [(wall.astype(np.int32), "NIFTI_INTENT_LABEL", "B64GZ")])
        write_gifti(self.path("cortex.shape.gii"), [((~wall).astype(np.float32), "NIFTI_INTENT_SHAPE", "B64BIN")])
        freesurfer.write_morph_data(self.path("lh.wall"), wall.astype(np.float32))
        np.save(self.path("wall.npy"), wall)
        with open(self.path("lh.wall.label"), "w", encoding="utf-8") as file:
            file.write(f"#!ascii label, from a test\n{wall.sum()}\n")
            for v in np.flatnonzero(wall):
                file.write("%d  %f %f %f 0.0\n" % (v, *POINTS[v]))
        np.testing.assert_array_equal(freesurfer.read_label(self.path("lh.wall.label")), np.flatnonzero(wall))
        for given in ("wall.label.gii", "cortex.shape.gii:0", "lh.wall", "wall.npy", "wall.npy:1", "lh.wall.label"):
            with self.subTest(given):
                seen = self.per_vertex("a.surf.gii", "--obstacle", self.path(given))
                self.assertTrue(np.isinf(seen[wall]).all())
                near = POINTS @ POINTS[5] > -0.4
                np.testing.assert_allclose(seen[near], free[near], atol=1e-5)  # measured 6.5e-6
        weight = np.full(len(POINTS), 2.0)
        np.save(self.path("weight.npy"), weight)
        np.savetxt(self.path("weight.csv"), weight)
        for given in ("weight.npy", "weight.csv"):
            seen = self.per_vertex("a.surf.gii", "--weight", self.path(given))
            np.testing.assert_allclose(seen, 2 * free, rtol=4e-8)  # measured 2.6e-8
        # All vertices of a label are one seed.
        seen = self.per_vertex("a.surf.gii", "--seed-mask", self.path("lh.wall.label"))
        self.assertTrue((seen[wall] == 0).all())


class Regions(InFolder):
    """FreeSurfer's annotations: groups of seeds, masks and obstacles."""

    def setUp(self):
        super().setUp()
        write_gifti_surface(self.path("a.surf.gii"))
        # Three caps about axes, one region without a vertex, and vertices in none.
        self.names = ["nowhere", "top", "front", "side"]
        self.labels = np.full(len(POINTS), -1)
        for number, axis in ((1, 2), (2, 1), (3, 0)):
            self.labels[POINTS[:, axis] > 0.9] = number
        colors = np.array([[1, 2, 3, 0, 0], [250, 0, 0, 0, 0], [0, 250, 7, 0, 0], [9, 0, 250, 0, 0]])
        freesurfer.write_annot(self.path("lh.caps.annot"), self.labels, colors, self.names, fill_ctab=True)
        labels, _, names = freesurfer.read_annot(self.path("lh.caps.annot"))
        np.testing.assert_array_equal(labels, self.labels)
        self.assertEqual([n.decode() for n in names], self.names)

    def test_each_region_is_a_seed(self):
        mesh = ("--mesh", self.path("a.surf.gii"), "--resolution", "60")
        geodesic(*mesh, "--seeds", self.path("lh.caps.annot"), "--per-seed", "--per-vertex", self.path("d.npy"), "-q")
        seen = np.load(self.path("d.npy"))
        self.assertEqual(seen.shape, (len(POINTS), 3))
        groups = {"groups": {n: np.flatnonzero(self.labels == k).tolist() for k, n in enumerate(self.names) if k}}
        (self.folder / "g.json").write_text(json.dumps(groups))
        geodesic(*mesh, "--seeds", self.path("g.json"), "--per-seed", "--per-vertex", self.path("e.npy"), "-q")
        np.testing.assert_array_equal(seen, np.load(self.path("e.npy")))
        matrix = self.matrix(*mesh, "--seeds", self.path("lh.caps.annot"))
        nearest = [min(np.arccos(np.clip(POINTS[self.labels == i] @ POINTS[self.labels == j].T, -1, 1)).ravel())
                   for i, j in ((1, 2), (1, 3), (2, 3))]
        np.testing.assert_allclose(matrix[[0, 0, 1], [1, 2, 2]], nearest, rtol=0.00054)  # measured 0.00036
        self.assertEqual(geodesic(*mesh, "--seeds", self.path("lh.caps.annot"), "--per-vertex", "-", "--per-seed",
                                  "-q").stdout.split()[0],
                         "vertex,distance,label,distance_top,distance_front,distance_side")

    def test_a_region_is_a_mask(self):
        region = self.path("lh.caps.annot") + ":side"
        seen = self.per_vertex("a.surf.gii", "--obstacle", region)
        self.assertTrue(np.isinf(seen[self.labels == 3]).all())
        self.assertTrue(np.isfinite(seen[POINTS[:, 0] < 0.8]).all())
        self.assertTrue((self.per_vertex("a.surf.gii", "--seed-mask", region)[self.labels == 3] == 0).all())

    def test_refusals(self):
        mesh = ("--mesh", self.path("a.surf.gii"), "--seed", "vertex:5", "-o", self.path("o.vdb"))
        for given, code, says in ((":sode", 2, "did you mean 'side'"), ("", 2, "none is named")):
            refused = geodesic(*mesh, "--obstacle", self.path("lh.caps.annot") + given, code=code)
            self.assertIn(says, refused.stderr)
            self.assertIn("top, front, side", refused.stderr)
        freesurfer.write_annot(self.path("small.annot"), self.labels[:100] * 0 + 1, np.array([[1, 2, 3, 0, 0]] * 2)
                               + [[0] * 5, [9, 0, 0, 0, 0]], ["a", "b"], fill_ctab=True)
        for option in ("--seeds", "--obstacle"):
            given = self.path("small.annot") + ("" if option == "--seeds" else ":b")
            self.assertIn("is for 100 vertices, and the mesh has 2562",
                          geodesic(*mesh, option, given, code=3).stderr)


class Volumes(InFolder):
    """Balls in volumes of any affine: the surface is where nibabel says the voxels are."""

    N = 33

    def world(self, affine: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distances of the voxels from the middle one, and where that is."""
        index = np.indices((self.N,) * 3).reshape(3, -1).T
        world = nib.affines.apply_affine(affine, index)
        middle = nib.affines.apply_affine(affine, [(self.N - 1) / 2] * 3)
        return np.linalg.norm(world - middle, axis=1).reshape((self.N,) * 3), middle

    def check(self, file: str, middle: np.ndarray, radius: float, within: float, *options: str) -> None:
        angles = (0.7, 1.5, 2.9)
        targets = [middle + radius * np.array([0.6 * np.sin(a), 0.8 * np.sin(a), np.cos(a)]) for a in angles]
        asked = [word for p in targets for word in ("--target", text_of(p))]
        seen = self.matrix("--volume", self.path(file), *options, "--seed", text_of(middle + [0, 0, radius]), *asked)
        np.testing.assert_allclose(seen[0] / radius, angles, rtol=within)

    def test_affines(self):
        c, s = np.cos(0.5), np.sin(0.5)
        axes = {
            "plain": np.eye(3),
            "mirrored": np.diag([-1.0, 1, 1]),
            "anisotropic": np.diag([1.0, 1.2, 2]),
            "rotated": 1.3 * np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
            "sheared": np.array([[1, 0.4, 0.1], [0, 1, 0.3], [0, 0, 1.2]]),
        }
        for name, matrix in axes.items():
            with self.subTest(name):
                affine = np.eye(4)
                affine[:3, :3] = matrix
                affine[:3, 3] = [40, -25, 7]
                distance, middle = self.world(affine)
                radius = 11.0
                image = nib.Nifti1Image((100 - distance).astype(np.float32), affine)
                if name != "sheared":  # has no quaternion
                    image.set_qform(affine, 1)
                    image.set_sform(None, 0)
                nib.save(image, self.path("a.nii"))
                self.check("a.nii", middle, radius, 0.0093, "--iso", repr(100 - radius))  # measured 0.62 %
                # Integers with a scale, NIfTI-2, compressed.
                image = nib.Nifti2Image((100 - distance).astype(np.float64), affine)
                image.set_data_dtype(np.int16)
                nib.save(image, self.path("b.nii.gz"))
                self.check("b.nii.gz", middle, radius, 0.0093, "--iso", repr(100 - radius))
                nib.save(nib.Nifti1Pair((100 - distance).astype(">f4"), affine), self.path("c.img"))
                self.check("c.hdr", middle, radius, 0.0093, "--iso", repr(100 - radius))
                if name == "sheared":
                    continue  # MGH has no shears
                for ending, kind in (("mgh", np.float32), ("mgz", np.int16)):
                    nib.save(nib.MGHImage((100 * (100 - distance)).astype(kind), affine), self.path("d." + ending))
                    with open(self.path("d." + ending), "rb") as file:
                        read = nib.MGHImage.from_stream(gzip.open(file) if ending == "mgz" else file)
                        np.testing.assert_allclose(read.affine, affine, atol=1e-5)
                    self.check("d." + ending, middle, radius, 0.01, "--iso",
                               repr(100 * (100 - radius)))  # measured 0.67 %

    def test_mask(self):
        distance, middle = self.world(np.eye(4))
        nib.save(nib.Nifti1Image((distance < 12.3).astype(np.uint8), np.eye(4)), self.path("mask.nii.gz"))
        self.check("mask.nii.gz", middle, 12.3, 0.0145)  # measured 0.96 %: the radius is known to half a voxel
        survey = json.loads(geodesic("info", self.path("mask.nii.gz"), "--json").stdout)
        self.assertEqual(survey["voxels"], {"kind": "NIfTI-1, uint8", "size": [33, 33, 33], "spacing": [1.0, 1.0, 1.0],
                                            "least": 0.0, "largest": 1.0, "mask": True})
        self.assertEqual(len(survey["surface"]["components"]), 1)

    def test_refusals(self):
        ramp = np.broadcast_to(np.arange(6.0), (6, 6, 6))
        nib.save(nib.Nifti1Image(np.stack([ramp, ramp], 3), np.eye(4)), self.path("times.nii.gz"))
        nib.save(nib.Nifti1Image(np.where(ramp == 3, np.nan, ramp), np.eye(4)), self.path("nan.nii"))
        nib.save(nib.Nifti1Image(ramp, np.eye(4)), self.path("ramp.nii.gz"))
        bytes_ = (self.folder / "ramp.nii.gz").read_bytes()
        (self.folder / "cut.nii.gz").write_bytes(bytes_[: len(bytes_) // 2])
        nib.save(nib.MGHImage(np.stack([ramp, ramp], 3).astype(np.float32), np.eye(4)), self.path("times.mgz"))
        nib.save(nib.MGHImage(np.where(ramp == 3, np.nan, ramp).astype(np.float32), np.eye(4)), self.path("nan.mgh"))
        nib.save(nib.MGHImage(ramp.astype(np.float32), np.eye(4)), self.path("ramp.mgz"))
        bytes_ = (self.folder / "ramp.mgz").read_bytes()
        (self.folder / "cut.mgz").write_bytes(bytes_[: len(bytes_) // 2])
        for name, says in (("times.mgz", "holds 2 volumes"), ("nan.mgh", "is nan"), ("cut.mgz", "cut off"),
                           ("times.nii.gz", "holds 2 volumes"), ("nan.nii", "is nan"), ("cut.nii.gz", "cut off"),
                           ("ramp.nii.gz", "--iso")):
            options = [] if name == "ramp.nii.gz" else ["--iso", "2.5"]
            refused = geodesic("--volume", self.path(name), *options, "--seed", "0,0,0", "-o", self.path("o.vdb"), code=3)
            self.assertIn(says, refused.stderr)
            self.assertIn(name, refused.stderr)


if __name__ == "__main__":
    unittest.main()
