#!/usr/bin/env python3
"""Compares the program with others: the same level set, the same seed, one run of each in turn.

usage: scripts/compare.py --models DIR   everything; tables into docs/benchmarks.md and README.md
       scripts/compare.py --models DIR --errors   the tables of errors alone, on a busy machine too
       scripts/compare.py --quick        small exact shapes only, nothing is written into docs

The others are OpenVDB's maskSdf in the same band and, on the mesh that OpenVDB extracts, what
igeo_peer has (cmake --preset release -DIGEO_PEERS=ON; vdb_tool is needed too): heat methods, fast
marching, Dijkstra and exact geodesics. All start from the same point, the vertex of the extracted
mesh that is nearest to the seed asked for, so that no method pays for a seed between vertices. The
reference is the exact solution of a shape, or the exact polyhedral distance on the mesh that a level
set was made from. Times are medians of rounds in which every method runs once; what takes long runs once only.
At the end the claims of the documents are compared with the results.
"""
import argparse
import json
import pathlib
import shutil
import statistics
import sys

import compare_tables
import measure

MODELS = {"bunny": "bunny.obj", "knot": "knot.obj", "blub": "blub.obj", "cad-anchor": "cad-anchor.obj",
          "brain": "brain-pial-left.ply"}
SHAPES = {"sphere": "radius=0.4", "torus": "major=0.3 minor=0.12",
          "box": "half-size=0.303,0.257,0.352"}  # as igeo_bench exact has them
SHAPE_SEEDS = {"sphere": (0.6256, 0.7108, 0.8158),
               "torus": (0.782, 0.711, 0.572), "box": (0.8, 0.6, 0.55)}  # near the surface will do
SEED_SHARES = {"A": 0, "B": 0.5}  # of a mesh file's vertices: the first, and the one in the middle
LONG = 10  # seconds; a run that takes longer is not repeated

OURS = ("jet", "jet-2", "jet-points", "godunov2", "godunov1", "sweep")  # igeo_bench; jet-2: two threads
QUICK_PEERS = ("marching", "dijkstra")  # linear but for a logarithm
PEERS = ("heat", "heat-id", "heat-10", *QUICK_PEERS)
ALL_PEERS = (*PEERS, "exact")  # igeo_peer


class Tools:
    """The programs of a build."""

    def __init__(self, build):
        self.bench = build / "tests" / "igeo_bench"
        self.peer = build / "tests" / "igeo_peer"
        self.make_shape = build / "bin" / "make_shape"
        for program in (self.bench, self.make_shape):
            if not program.exists():
                sys.exit(f"{program} is not there: run scripts/build.sh release first")

    def peers(self):
        """The methods of igeo_peer; none where it is not built."""
        return self.say(self.peer, "--method", "list")["methods"] if self.peer.exists() else []

    @staticmethod
    def say(*command):
        """What a program prints, one line of JSON."""
        return json.loads(measure.run(command).stdout)

    def vertex(self, *of):
        """A vertex of a mesh, as x,y,z."""
        return ",".join(f"{x:.12g}" for x in self.say(self.bench, "vertex", *of)["at"])


def point(p):
    return ",".join(f"{x:.12g}" for x in p)


def solve(tools, method, sdf, seed, points="", samples=0):
    """One run of one method."""
    common = ["--sdf", sdf, "--seed", seed, "--samples", samples]
    if points:
        common += ["--points", points]
    if method in ALL_PEERS:
        return tools.say(tools.peer, "--method", method, *common, "--further", int(method != "exact"))
    threads = 2 if method == "jet-2" else 1
    return tools.say(tools.bench, "solve", "--method", method.removesuffix("-2"), *common,
                     "--threads", threads)


def read_points(file):
    """(positions as text, distances) of a file x,y,z,distance."""
    places, distances = [], []
    for line in pathlib.Path(file).read_text().splitlines():
        place, _, distance = line.rpartition(",")
        places.append(place)
        distances.append(float(distance))
    return places, distances


def errors(distances, truth):
    """In % of the largest distance; what either does not reach is counted and left out."""
    pairs = [(d, t) for d, t in zip(distances, truth, strict=True) if max(d, t) < float("inf")]
    percent = 100 / max(t for _, t in pairs)
    sizes = sorted(abs(d - t) * percent for d, t in pairs)
    return {"mean": statistics.fmean(sizes), "p99": sizes[int(0.99 * (len(sizes) - 1))],
            "max": sizes[-1], "bias": percent * statistics.fmean(d - t for d, t in pairs),
            "samples": len(sizes), "unreached": len(distances) - len(pairs)}


def grade(files, exact):
    """Errors of each method. `exact` is given files with all places there are, foot points and
    vertices, and writes FILE.exact; methods of one kind share their places."""
    read = {method: read_points(file) for method, file in files.items()}
    first = {}  # of each kind: the file whose places stand for all
    for method in files:
        first.setdefault(tuple(read[method][0][:3]), method)
    exact([files[method] for method in first.values()])
    truth = {key: read_points(f"{files[method]}.exact")[1] for key, method in first.items()}
    for method, (places, _) in read.items():
        if places != read[first[tuple(places[:3])]][0]:
            raise RuntimeError(f"{files[method]}: other places than those the truth was computed at")
    return {method: errors(distances, truth[tuple(places[:3])])
            for method, (places, distances) in read.items()}


def median_stages(runs):
    """Medians, stage by stage, of runs of one method."""
    result = {key: value for key, value in runs[0].items() if not isinstance(value, dict)}
    for stage in (key for key, value in runs[0].items() if isinstance(value, dict)):
        result[stage] = {clock: statistics.median(run[stage][clock] for run in runs)
                         for clock in ("wall", "cpu")}
    result["peakBytes"] = statistics.median(run["peakBytes"] for run in runs)
    result["runs"] = len(runs)
    return result


def total(run, clock):
    """From the file to distances from the first seed."""
    return sum(run[stage][clock] for stage in ("read", "check", "surface", "band", "setup", "first")
               if stage in run)


def compare(tools, folder, sdf, seed, exact, methods, rounds, samples):
    """{method: stages and errors} on one level set from one seed."""
    runs, files = {method: [] for method in methods}, {}
    for turn in range(rounds):
        for method in methods:
            done = runs[method]
            if turn > 0 and total(done[0], "wall") > LONG:
                continue
            file = folder / f"{method}.csv"
            done.append(solve(tools, method, sdf, seed, "" if turn else file, samples))
            files[method] = file
    graded = grade(files, exact)
    result = {}
    for method in methods:
        stages = median_stages(runs[method])
        stages["total"] = {clock: total(stages, clock) for clock in ("wall", "cpu")}
        result[method] = {**stages, "errors": graded[method]}
    return result


def shape(tools, folder, name, n):
    """A level set, the seed on it, and what writes exact distances beside files of points."""
    sdf = folder / f"{name}{n}.vdb"
    parameters = [word for p in ["center=0.5,0.5,0.5", *SHAPES[name].split()] for word in ("--param", p)]
    measure.run([tools.make_shape, name, "-o", sdf, "--voxel-size", 1 / n, *parameters])
    seed = tools.vertex("--sdf", sdf, "--seed", point(SHAPE_SEEDS[name]))

    def exact(files):
        for file in files:
            tools.say(tools.bench, "exact", "--shape", name, "--seed", seed, "--points", file,
                      "--out", f"{file}.exact")
    return sdf, seed, exact


def model(tools, folder, name, mesh, n, seed_name):
    """The same of a mesh file."""
    sdf = folder / f"{name}{n}.vdb"
    if not sdf.exists():
        measure.run(["vdb_tool", "-quiet", "-read", mesh, "-mesh2ls", f"dim={n}", "width=3", "name=psi",
                 "-write", sdf])
    asked = tools.vertex("--mesh", mesh, "--share", SEED_SHARES[seed_name])
    seed = tools.vertex("--sdf", sdf, "--seed", asked)

    def exact(files):
        tools.say(tools.peer, "--method", "oracle", "--mesh", mesh, "--seed", seed, "--points",
                  ",".join(map(str, files)))
    return sdf, seed, exact


def picture(tools, folder, sdf, seed, exact, name, *options):
    """docs/images/accuracy/NAME.png: the error of jet as colors."""
    file = folder / "picture.csv"
    solve(tools, "jet", sdf, seed, file)
    exact([file])
    tools.say(tools.bench, "picture", "--sdf", sdf, "--seed", seed, "--exact", f"{file}.exact",
              "--image", compare_tables.IMAGES / f"{name}.png", *options)


def pictures(tools, folder, models):
    """Of what jet is weak at."""
    picture(tools, folder, *shape(tools, folder, "box", 100), "box", "--most", 0.2,
            "--camera", "-1.3,1.9,-1.1")
    for name, *options in (("cad-anchor", "--most", 1), ("brain", "--most", 10, "--up", "0,0,1")):
        picture(tools, folder, *model(tools, folder, name, models / MODELS[name], 128, "A"), name, *options)


def plan(options, peers):
    """[(case, what measures it)] in the order of the tables."""
    tools, folder = options.tools, options.folder
    cases = []

    def add(name, surface, arguments, methods, rounds, samples):
        methods = [m for m in methods if m in OURS or m in peers]

        def case():
            return compare(tools, folder, *surface(tools, folder, *arguments), methods, rounds, samples)
        if not options.only or any(name.startswith(word) for word in options.only.split(",")):
            cases.append((name, case))

    def methods_at(n):
        if n == 400 and not options.full:
            return [*(m for m in OURS if m != "sweep"), *QUICK_PEERS]
        with_exact = not options.quick and n <= (200 if options.full else 100)
        return [*OURS, *(ALL_PEERS if with_exact else PEERS)]

    rounds = 1 if options.quick or options.errors else options.rounds
    sizes = (50, 100) if options.quick else (50, 100, 200, 400)
    for name, samples in (("sphere", 0), ("torus", 4000)):  # a distance on the torus takes 2 ms
        for n in sizes if name == "sphere" else sizes[:3]:
            add(f"{name}-{n}", shape, (name, n), methods_at(n), rounds, samples)
    if options.models and not options.quick:
        for name, file in MODELS.items():
            for n in (128, 256):
                for seed in SEED_SHARES:
                    # The second seed is for the errors.
                    methods = OURS + PEERS if seed == "A" else ("jet", "godunov2", *PEERS)
                    add(f"{name}-{n}-{seed}", model, (name, options.models / file, n, seed), methods,
                        rounds if seed == "A" else 1, 20000)
    return cases


def growth(tools, sizes):
    """Time and memory of the march of jet against the number of nodes: the quickest of three runs."""
    return [min((tools.say(tools.bench, "march", "--n", n, "--runs", 1) for _ in range(3)),
                key=lambda run: run["marchSeconds"]) for n in sizes]


def compare_all(options):
    peers = options.tools.peers()
    if not peers:
        print("igeo_peer is not built (IGEO_PEERS): without the methods on meshes")
    elif missing := set(ALL_PEERS) - set(peers):
        print(f"igeo_peer was built without {', '.join(sorted(missing))}")
    if options.models and not options.quick and not (peers and shutil.which("vdb_tool")):
        sys.exit("--models needs igeo_peer (cmake --preset release -DIGEO_PEERS=ON) and vdb_tool")
    results = {"cases": {}}
    for name, case in plan(options, peers):
        done = results["cases"][name] = case()
        best = ", ".join(f"{method} {measure.number(run['errors']['mean'])} % {run['total']['cpu']:.2f} s"
                         for method, run in done.items())
        print(f"{name}: {best}", flush=True)
        measure.save(results, options.saved)
    if not (options.quick or options.only or options.errors):
        results["growth"] = growth(options.tools, (100, 200, 400, 800) + ((1700,) if options.full else ()))
    return results


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", type=pathlib.Path, metavar="DIR", help="folder of the models")
    parser.add_argument("--quick", action="store_true", help="small shapes only, not into docs/")
    parser.add_argument("--full", action="store_true",
                        help="with what takes minutes: everything at N = 400, exact at N = 200")
    parser.add_argument("--errors", action="store_true",
                        help="of the tables those of errors alone; each method runs once")
    parser.add_argument("--only", metavar="CASES", help="cases that begin so, with commas between; "
                        "not into docs/")
    parser.add_argument("--rounds", type=int, default=3, help="of which times are medians [3]")
    parser.add_argument("--build", type=pathlib.Path, default=measure.ROOT / "build" / "release",
                        help="build folder [build/release]")
    parser.add_argument("--from", type=pathlib.Path, metavar="FILE", dest="again",
                        help="measure nothing: tables and plots of saved results")
    options = parser.parse_args()
    if not options.again:
        part = "-quick" if options.quick else "-part" if options.only else ""
        options.saved = options.build / f"comparison{part}.json"
        options.tools = Tools(options.build)
        options.folder = options.saved.with_suffix("")
        shutil.rmtree(options.folder, ignore_errors=True)
        options.folder.mkdir()
        measure.save(compare_all(options), options.saved)
        print(f"results: {options.saved}")
    results = json.loads((options.again or options.saved).read_text())
    compare_tables.derive(results)
    if options.quick or options.only:
        print(compare_tables.overview(results))
    elif options.models or options.again:
        if options.errors:
            compare_tables.write_errors(results)
        else:
            compare_tables.write_documents(results)
            compare_tables.draw(results)
        if options.models and not options.again:
            pictures(options.tools, options.folder, options.models)
    sys.exit(not measure.check(results, "scripts/compare.py"))


if __name__ == "__main__":
    main()
