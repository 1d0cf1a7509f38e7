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
        for name in ("B64BIN.surf.gii", "lh.pial", "a.gii.gz"):
            np.testing.assert_array_equal(self.per_vertex(name), first, name)
        # Text has seven digits.
        np.testing.assert_allclose(self.per_vertex("ASCII.surf.gii"), first, atol=1e-5)

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
        for name, says in (("times.nii.gz", "holds 2 volumes"), ("nan.nii", "is nan"), ("cut.nii.gz", "cut off"),
                           ("ramp.nii.gz", "--iso")):
            options = [] if name == "ramp.nii.gz" else ["--iso", "2.5"]
            refused = geodesic("--volume", self.path(name), *options, "--seed", "0,0,0", code=3)
            self.assertIn(says, refused.stderr)
            self.assertIn(name, refused.stderr)


if __name__ == "__main__":
    unittest.main()
