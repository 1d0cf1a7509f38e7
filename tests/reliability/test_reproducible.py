#!/usr/bin/env python3
"""The same input and options give the same bytes: at another time, in another folder, on other threads.

usage: IGEO_PROGRAM=build/release/bin/implicit-geodesic tests/reliability/test_reproducible.py
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.path.abspath(os.environ.get("IGEO_PROGRAM", ROOT / "build/release/bin/implicit-geodesic"))
RESULTS = ("-o out.vdb --grids surface,gradient,label,color,curvature,engraved,weight --extend --paths paths.json "
           "--isolines lines.ply --mesh-out mesh.ply --matrix matrix.npy --image picture.png --image-size 200x150")
RUNS = {
    "volume": ("trefoil.vdb", "--sdf trefoil.vdb --seed 0,-1.02,0 --sample 3 --target 0.5,0.73,0.237 --snap 0.5 "
               "--weight-curvature valley " + RESULTS),
    "reference scheme": ("torus.vdb", "--sdf torus.vdb --seed 1.4,0,0 --target -1.4,0,0 --scheme godunov "
                         "-o out.vdb --grids surface,gradient --paths paths.obj --straighten"),
    "mesh": ("mesh.obj", "--mesh mesh.obj --resolution 48 --seed 0,0,1 -o out.vdb --mesh-out mesh.ply"),
    "points": ("cloud.xyz", "--points cloud.xyz --seed 0,0,1 -o out.vdb --isolines lines.json"),
}


def outputs(source: pathlib.Path, line: str, threads: int) -> dict[str, bytes]:
    """The files that a run in a new folder writes."""
    with tempfile.TemporaryDirectory(prefix=f"igeo-{threads}-") as name:
        folder = pathlib.Path(name)
        shutil.copy(source, folder)
        subprocess.run([PROGRAM, *line.split(), "-q", "--threads", str(threads)], cwd=folder, check=True,
                       env={**os.environ, "TZ": f"UTC{threads}", "LC_ALL": "C", "SOURCE_DATE_EPOCH": "0"})
        return {f.name: f.read_bytes() for f in folder.iterdir() if f.name != source.name}


def main() -> int:
    sys.path.insert(0, str(pathlib.Path(__file__).parent))
    import corpus
    made = {s.name: s.content for s in corpus.mesh_files() + corpus.list_files()}
    failed = 0
    with tempfile.TemporaryDirectory() as name:
        for kind, (file, line) in RUNS.items():
            source = ROOT / "data" / file
            if not source.exists():
                source = pathlib.Path(name) / file
                source.write_bytes(made["ball.obj" if file == "mesh.obj" else file])
            first = outputs(source, line, 1)
            time.sleep(1.1)  # another second, for a program that writes the time
            for threads in (1, 2, 7):
                again = outputs(source, line, threads)
                differ = sorted(f for f in first.keys() | again.keys() if first.get(f) != again.get(f))
                failed += bool(differ)
                print(f"{kind}, {threads} threads: {len(again)} files, "
                      + (f"{', '.join(differ)} differ" if differ else "the same bytes"))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
