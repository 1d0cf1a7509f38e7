#!/usr/bin/env python3
"""The mistakes that users make, and the message that each gets: none passes in silence.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/cli/test_mistakes.py
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.path.abspath(os.environ.get("IGEO_PROGRAM", ROOT / "build/release/bin/implicit-geodesic"))

SPHERE = "--sdf sphere.vdb"
RUN = f"{SPHERE} --seed 0,0,1"
USAGE, UNUSABLE, UNREACHED, DONE = 2, 3, 4, 0
POINT = r"is not a point.*three finite numbers with commas"

# The words, the exit code, and what standard error says, line after line.
MISTAKES = [
    # The surface
    ("", USAGE, r"no surface is given.*--sdf, --mesh, --points or --volume"),
    ("sphere.vdb", USAGE, r"no seed is given.*--seed x,y,z"),
    ("--seed 0,0,1", USAGE, r"no surface is given"),
    ("--sdf spher.vdb --seed 0,0,1", UNUSABLE, r"cannot read 'spher.vdb'.*did you mean 'sphere.vdb'"),
    ("--sdf sphere --seed 0,0,1", UNUSABLE, r"cannot read 'sphere'.*did you mean 'sphere.vdb'"),
    ("--sdf folder --seed 0,0,1", UNUSABLE, r"it is a folder"),
    ("--sdf sphere.vdb:nogrid --seed 0,0,1", UNUSABLE, r"has no grid 'nogrid'.*it holds 'psi'"),
    ("--sdf cube.obj --seed 0,0,1", USAGE, r"ending is that of a mesh.*write --mesh cube.obj"),
    ("--sdf torus_seeds.csv --seed 0,0,1", USAGE, r"ending is that of points.*write --points"),
    ("--mesh sphere.vdb --seed 0,0,1", UNUSABLE, r"no mesh by its name.*--sdf"),
    ("--points sphere.vdb --seed 0,0,1", UNUSABLE, r"holds no point grid"),
    (f"{SPHERE} --mesh cube.obj --seed 0,0,1", USAGE, r"--mesh excludes --sdf"),
    (f"torus.vdb {RUN}", USAGE, r"'torus.vdb' excludes --sdf"),
    (f"{RUN} --resolution 100", USAGE, r"for meshes and points.*fixed voxel size"),
    (f"{RUN} --iso 0.5", USAGE, r"--iso needs --rebuild or --volume"),
    ("--mesh head.nii.gz --seed 0,0,1", USAGE, r"ending is that of a volume.*write --volume head.nii.gz --iso V"),
    ("--volume sphere.vdb --iso 0 --seed 0,0,1", USAGE, r"ending is that of a VDB file.*--sdf sphere.vdb --rebuild"),
    ("head.nii.gz --seed 0,0,1", UNUSABLE, r"cannot read 'head.nii.gz'"),
    (f"{RUN} --join-gaps 1", USAGE, r"--join-gaps is for meshes"),
    ("--mesh cube.obj --seed vertex:0 --rebuild", USAGE, r"--rebuild is for level sets"),
    ("--mesh cube.obj --seed vertex:0 --voxel-size 0.5", USAGE,
     r"larger than an eighth of the surface.*take voxels of up to 0.12"),
    ("--mesh cube.obj --seed vertex:0 --voxel-size 1mm", USAGE, r"--voxel-size: 1mm is no number"),
    ("--mesh cube.obj --seed vertex:0 --resolution 4", USAGE, r"--resolution: 4 is no whole number from 8"),
    (f"{RUN} --band 100", USAGE, r"outside the bounds.*leave --band out"),
    (f"{RUN} --band-voxels 0.5", USAGE, r"outside the bounds"),
    # Points
    (f"{SPHERE} --seed 0 0 1", USAGE, r"'0' belongs to no option.*joined by commas: --seed 0,0,1"),
    (f"{SPHERE} --seed 0,0", USAGE, POINT),
    (f"{SPHERE} --seed 0,0,1,2", USAGE, POINT),
    (f"{SPHERE} --seed 0,0,x", USAGE, POINT),
    (f"{SPHERE} --seed (0,0,1)", USAGE, POINT),
    (f"{SPHERE} --seed 0,5;0;1", USAGE, POINT),
    (f"{SPHERE} --seed nan,0,1", USAGE, POINT),
    (f"{SPHERE} --seed 1e400,0,1", USAGE, POINT),
    (f"{SPHERE} --seed 0,0,0", USAGE, r"is (1|0.99\d*) from the surface.*nearest point.*--snap.*lies between"),
    (f"{SPHERE} --seed 0,0,1000", USAGE, r"times 0.001 it is on the surface: are its units the same"),
    (f"{SPHERE} --seed 20,20,40", USAGE, r"as index coordinates it is on the surface: add --space index"),
    (f"{SPHERE} --seed 0,0,1 --space index", USAGE, r"as a point of the world.*leave out --space index"),
    (f"{RUN} --target 9,9,9", USAGE, r"target 0 \(9,9,9\) is 14.* from the surface"),
    (f"{SPHERE} --seed vertex:1", USAGE, r"is a vertex, and psi is a level set"),
    (f"{SPHERE} --seed +z", USAGE, r"'\+z' is a vertex, and psi is a level set"),
    ("--mesh cube.obj --seed vertex:8", USAGE, r"vertex 8 of cube, which has 8.*from 0 to 7"),
    (f"{SPHERE} --seeds none.json", UNUSABLE, r"cannot read 'none.json'"),
    (f"{SPHERE} --seeds torus_seed.csv", UNUSABLE, r"did you mean 'torus_seeds.csv'"),
    (f"{SPHERE} --pairs far.csv", USAGE, r"target of pair 1 \(9,9,9\).*nearest point.*--snap"),
    (f"{RUN} --snap -1", USAGE, r"--snap: -1 is no number at least 0"),
    (f"{SPHERE} --sample 0", USAGE, r"--sample: 0 is no whole number from 1"),
    (f"{SPHERE} --sample 2.5", USAGE, r"--sample: 2.5 is no whole number"),
    (f"{SPHERE} --shoot 0,0,1,0,0,1,1", USAGE, r"within 0.6 degrees of the surface's normal"),
    (f"{SPHERE} --shoot 0,0,1,1,0,0", USAGE, r"is not x,y,z,dx,dy,dz,length"),
    (f"{SPHERE} --shoot 0,0,1,0,0,0,1", USAGE, r"goes in no direction"),
    # Words
    (f"{SPHERE} --sed 0,0,1", USAGE, r"unknown option --sed, did you mean '--seed'"),
    (f"{RUN} --colormap gray", USAGE, r"did you mean '--color-map'"),
    (f"{RUN} --scheme jets", USAGE, r"did you mean 'jet'"),
    (f"{RUN} --grids lable", USAGE, r"did you mean 'label'"),
    (f"{RUN} --color-map viridi --image x.png", USAGE, r"did you mean 'viridis'"),
    (f"{RUN} --up w --image x.png", USAGE, r"'w'.*x, y, z, -x, -y, -z"),
    (f"{RUN} --background beige --image x.png", USAGE, r"'beige'.*white, black, transparent"),
    (f"{RUN} --unit '丈' --image x.png", USAGE, r"is not 1 to 16 characters of Latin-1"),
    (f"{RUN} --unit hundredweights-per-foot --image x.png", USAGE, r"is not 1 to 16 characters"),
    ("inf sphere.vdb", USAGE, r"'inf' is no command, did you mean 'info'"),
    ("help", USAGE, r"did you mean '--help'"),
    ("info", USAGE, r"FILE is required"),
    ("info --seed 0,0,1", USAGE, r"unknown option --seed"),
    ("batch", USAGE, r"no manifest is given"),
    ("batch none.json", UNUSABLE, r"cannot read 'none.json'"),
    (f"{RUN} --max-distance", USAGE, r"its value D is missing"),
    (f"{RUN} --max-distance -1", USAGE, r"--max-distance: -1 is no number above 0"),
    (f"{RUN} --threads 9999", USAGE, r"from 0 to 4096"),
    (f"{RUN} --memory-limit lots", USAGE, r"no amount of memory.*500MB or 4GiB"),
    (f"{RUN} --memory-limit 1MB", USAGE, r"needs about .* GiB of memory.*raise --memory-limit"),
    (f"{RUN} -q -v", USAGE, r"--quiet excludes --verbose"),
    (f"{RUN} --seed", USAGE, r"its value X,Y,Z is missing"),
    # Options that change nothing
    (f"{RUN} --stop-at-targets", USAGE, r"no effect without --target"),
    (f"{RUN} --straighten", USAGE, r"no effect without --target"),
    (f"{RUN} --paths p.json", USAGE, r"no effect without --target"),
    (f"{RUN} --levels 5", USAGE, r"no effect without --isolines"),
    (f"{RUN} --spacing 0.1", USAGE, r"no effect without --isolines"),
    (f"{RUN} --background black", USAGE, r"no effect without --image"),
    (f"{RUN} --unit mm", USAGE, r"no effect without --image"),
    (f"{RUN} --camera 1,2,3", USAGE, r"no effect without --image"),
    (f"{RUN} --image-size 10x10", USAGE, r"no effect without --image"),
    (f"{RUN} --up z", USAGE, r"no effect without --image"),
    (f"{RUN} --order 1", USAGE, r"no effect without --scheme godunov"),
    (f"{RUN} --curvature-scale 4", USAGE, r"no effect without --weight-curvature"),
    (f"{RUN} --obstacle-sphere 9,9,9,0.1", DONE, r"warning: no obstacle meets the surface"),
    (f"{RUN} --obstacle-box 0,0,1.2,0.2,0.2,1.3", DONE, r"warning: no obstacle meets the surface"),
    # Costs
    (f"{RUN} --weight none.vdb", UNUSABLE, r"cannot read 'none.vdb'"),
    (f"{RUN} --weight sphere.vdb", UNUSABLE, r"the weight is 0 there.*--obstacle"),
    (f"{RUN} --weight-curvature vale", USAGE, r"none of valley.*did you mean 'valley'"),
    (f"{RUN} --weight-curvature valley,eps=x", USAGE, r"neither eps=E nor p=P"),
    (f"{RUN} --weight-slope 30", USAGE, r"none of up=AXIS, max=ANGLE.*up=z,max=30deg,power=2"),
    (f"{RUN} --obstacle far.csv", USAGE, r"'far.csv' holds values per vertex, and the surface is no mesh"),
    ("--mesh cube.obj --seed vertex:0 --obstacle far.csv", UNUSABLE, r"far.csv, line 1: .* is neither a value nor a vertex and a value"),
    # Results
    (f"{RUN} -o x.obj", USAGE, r"the ending is none of .vdb"),
    (f"{RUN} -o none/x.vdb", USAGE, r"there is no folder 'none'"),
    (f"{RUN} -o sphere.vdb", USAGE, r"would overwrite the input"),
    (f"{RUN} --target 0,0,-1 --paths x.xyz", USAGE, r"the ending is none of .json .csv .obj"),
    (f"{RUN} --paths p.json --via 0,0,1", USAGE, r"is one point.*with blanks between"),
    (f"{RUN} --paths p.json --via points.csv", UNUSABLE, r"cannot read 'points.csv'"),
    (f"{RUN} --via 0,0,1;9,9,9", USAGE, r"point 1 \(9,9,9\) is .* from the surface"),
    (f"{RUN} --path-step 0.1", USAGE, r"--path-step has no effect without --paths"),
    (f"{RUN} --image x.jpg", USAGE, r"the ending is none of .png"),
    (f"{RUN} --image x.png --image-size big", USAGE, r"not WIDTHxHEIGHT.*1280x960"),
    (f"{RUN} --target 0,0,-1 --matrix m.txt", USAGE, r"the ending is none of .csv"),
    (f"{RUN} --per-vertex v.csv", USAGE, r"needs the vertices of a mesh"),
    (f"{RUN} --target 0,0,-1 --max-distance 0.5", UNREACHED, r"target 0 is unreachable.*beyond the distance"),
    (f"{SPHERE} --paths p.json", USAGE, r"no seed is given"),
]

CUBE = ("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
        "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n")


def main() -> int:
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        desk = pathlib.Path(folder)
        for name in ("sphere.vdb", "torus.vdb", "torus_seeds.csv"):
            (desk / name).symlink_to(ROOT / "data" / name)
        (desk / "folder").mkdir()
        (desk / "cube.obj").write_text(CUBE)
        (desk / "far.csv").write_text("0,0,1,1,0,0\n0,0,1,9,9,9\n")
        for line, code, pattern in MISTAKES:
            before = set(desk.iterdir())
            done = subprocess.run([PROGRAM, *line.split()], cwd=desk, stdin=subprocess.DEVNULL,
                                  capture_output=True, text=True, check=False)
            wrong = done.returncode != code or not re.search(pattern, done.stderr, re.DOTALL)
            left = set(desk.iterdir()) - before
            if wrong or (left and code in (USAGE, UNUSABLE)):
                failures.append(f"{line}: exit {done.returncode}, {[p.name for p in left]}\n{done.stderr}")
            for path in left:
                path.unlink()
    print("\n".join(failures) if failures else f"{len(MISTAKES)} mistakes")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
