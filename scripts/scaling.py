#!/usr/bin/env python3
"""What a march of `jet` over many machines would work and send, and what that would bring.

usage: scripts/scaling.py            counts, model, tables and plot into docs/scaling.md and
                                     docs/distributed.md: five minutes
       scripts/scaling.py --quick    small, nothing is written into docs

`igeo_bench domains` counts; the counts are the same on every machine. A model turns them into times:
a superstep takes as long as its busiest domain works, sends and receives, and then all agree on the
next one. The inputs of the model are the constants below. Needs python3-matplotlib for the plot.
"""
import argparse
import json
import math
import pathlib
import sys

import measure

SCALING = measure.ROOT / "docs" / "scaling.md"
DISTRIBUTED = measure.ROOT / "docs" / "distributed.md"
PLOT = measure.ROOT / "docs" / "images" / "scaling" / "speed.svg"

SIZES, PARTS, PIECES, SEEDS = (100, 200, 400, 800, 1600), (4, 16, 64, 256, 1024), (1, 16, 64), (1, 100)
SHAPES = ("sphere", "torus", "trefoil")
BEYOND = (3800, 24000)  # N of spheres that are extrapolated; more nodes than 24,000 no band can number

# On one core at 2.5 GHz (docs/accuracy.md): a core node of the march; per node of the band, what
# needs no supersteps, the rest of the march and making the band.
CORE_SECONDS, REST_SECONDS = 600e-9, 140e-9
RECORD_BYTES = {1: 24, 100: 28}  # number, value, gradient; with several seeds the label
NETWORKS = {  # latency, work per message, bytes per second
    "InfiniBand": (2e-6, 0.5e-6, 10e9),
    "Ethernet": (30e-6, 5e-6, 1e9)}
# Counts of the model, and the power of N they grow with: measured up to N = 1600, taken for granted beyond.
GROWTH = {"bandNodes": 2, "nodes": 2, "mostWork": 2, "largestShare": 2, "steps": 1, "mostRecords": 1,
          "mostMessages": 1}


def simulate(bench, quick):
    """[what igeo_bench domains counts], with its shape and N."""
    sizes, parts, pieces = ((40, 80), (2, 8), (1, 4)) if quick else (SIZES, PARTS, PIECES)
    runs = []
    for shape in SHAPES[:1] if quick else SHAPES:
        for n in sizes if shape == "sphere" else (800,):
            for seeds in SEEDS:
                done = measure.run([bench, "domains", "--shape", shape, "--n", n, "--seeds", seeds, "--parts",
                                ",".join(map(str, parts)), "--pieces", ",".join(map(str, pieces))])
                runs += [{"shape": shape, "n": n, **json.loads(line)} for line in done.stdout.splitlines()]
                print(f"{shape}, N = {n}, {seeds} seeds: {runs[-1]['nodes']} core nodes, "
                      f"{runs[-1]['steps']} supersteps", flush=True)
    return runs


def counts(run):
    """The counts that the model is about, flat."""
    return {key: {**run, **run["links"]}[key] for key in GROWTH}


def speedup(c, parts, seeds, network, cores=1):
    """Of a run with these counts over one domain. `cores`: how many times as fast as a core each is."""
    latency, message, speed = NETWORKS[network]
    # The rest is what domains do by themselves.
    alone = (CORE_SECONDS * c["nodes"] + REST_SECONDS * c["bandNodes"]) / cores
    together = (CORE_SECONDS * c["mostWork"]
                + REST_SECONDS * c["bandNodes"] * c["largestShare"] / c["nodes"]) / cores
    together += c["steps"] * latency * (1 + math.ceil(math.log2(parts)))
    together += c["mostMessages"] * message + c["mostRecords"] * RECORD_BYTES[seeds] / speed
    return alone / together


class Runs:
    """Looks runs up, and goes beyond the largest."""

    def __init__(self, runs):
        self.all = {(r["shape"], r["n"], r["seeds"], r["parts"], r["pieces"]): r for r in runs}
        self.sizes, self.parts, self.pieces = (
            sorted({key[k] for key in self.all if key[0] == "sphere"}) for k in (1, 3, 4))

    def counts(self, n, seeds, parts, pieces):
        """Of a sphere; beyond the largest N by GROWTH."""
        largest = counts(self.all["sphere", min(n, self.sizes[-1]), seeds, parts, pieces])
        beyond = max(1, n / self.sizes[-1])
        return {key: largest[key] * beyond ** power for key, power in GROWTH.items()}

    def best(self, n, seeds, parts, network, cores=1):
        """The speed-up with the best number of pieces."""
        return max(speedup(self.counts(n, seeds, parts, k), parts, seeds, network, cores)
                   for k in self.pieces)


def efficiency(run):
    """The share of the time in which domains work, if nothing but the slowest holds them up."""
    return run["nodes"] / (run["parts"] * run["mostWork"])


def percent(x):
    return f"{measure.number(100 * x, 2)} %"


def growth(runs):
    """What grows how with N, in 64 patches."""
    parts = 64 if 64 in runs.parts else runs.parts[-1]
    picked = [runs.all["sphere", n, 1, parts, 1] for n in runs.sizes]
    columns = {"band nodes": lambda r: r["bandNodes"], "core nodes": lambda r: r["nodes"],
               "supersteps": lambda r: r["steps"], "work of the busiest": lambda r: r["mostWork"],
               "records, links": lambda r: r["links"]["records"],
               "records, leaves": lambda r: r["halo"]["records"]}
    rows = [[r["n"], *(f"{value(r):,}" for value in columns.values())] for r in picked]
    powers = [math.log(value(picked[-1]) / value(picked[-2])) / math.log(picked[-1]["n"] / picked[-2]["n"])
              for value in columns.values()]
    return measure.table(["N", *columns], [*rows, ["grows as N to", *(f"{p:.2f}" for p in powers)]])


def balance(runs):
    """Efficiency, and records in % of the core, on the largest sphere."""
    columns = [(1, k) for k in runs.pieces] + [(100, 1)]
    head = [f"{'one seed' if seeds == 1 else f'{seeds} seeds'}, {'patches' if k == 1 else f'{k} pieces'}"
            for seeds, k in columns]
    def cell(parts, seeds, k):
        run = runs.all["sphere", runs.sizes[-1], seeds, parts, k]
        return " / ".join(percent(x) for x in (efficiency(run), run["links"]["records"] / run["nodes"],
                                               run["halo"]["records"] / run["nodes"]))
    return measure.table(["P", *head], [[p, *(cell(p, *c) for c in columns)] for p in runs.parts])


def shapes(runs):
    """Efficiency of one front on shapes with long and short ones."""
    columns = [(seeds, k) for seeds in SEEDS for k in (1, 64)]
    rows = []
    for shape in SHAPES:
        front = runs.all[shape, 800, 1, 64, 1]
        rows.append([shape, measure.number(front["nodes"] / front["steps"])]
                    + [percent(efficiency(runs.all[shape, 800, seeds, 64, k])) for seeds, k in columns])
    return measure.table(["N = 800, P = 64", "nodes per superstep", "one seed, patches", "64 pieces",
                      "100 seeds, patches", "64 pieces"], rows)


def speed(runs, beyond):
    """Speed-up by the model, InfiniBand / Ethernet, of the better number of pieces."""
    def row(n, seeds):
        name = f"{n}" + (", extrapolated" if n not in runs.sizes else "") + (
            "" if seeds == 1 else f", {seeds} seeds")
        return [name, *(" / ".join(measure.number(runs.best(n, seeds, p, network), 2) for network in NETWORKS)
                        for p in runs.parts)]
    return measure.table(["N", *(f"P = {p}" for p in runs.parts)],
                     [*(row(n, 1) for n in (*runs.sizes, *beyond)), row(runs.sizes[-1], 100)])


def derive(results):
    """What the claims are about."""
    runs = Runs(results["runs"])
    results["late"] = max(r["late"] for r in results["runs"])
    results["bucketsBeside"] = max(abs(r["buckets"] - r["steps"]) for r in results["runs"])
    if runs.sizes[-1] == SIZES[-1]:
        results["efficiency"] = {f"pieces{k}": efficiency(runs.all["sphere", 1600, 1, 64, k]) for k in PIECES}
        results["speed"] = {network: {str(n): runs.best(n, 1, 64, network) for n in SIZES + BEYOND}
                            for network in NETWORKS}
        results["patches"] = speedup(runs.counts(BEYOND[-1], 1, 64, 1), 64, 1, "InfiniBand")
        results["machines"] = {network: runs.best(1600, 1, 64, network, cores=16) for network in NETWORKS}
        patches = runs.all["sphere", 1600, 1, 64, 1]
        results["busy"] = patches["busy"] / patches["steps"]
        results["bytes"] = max(24 * r["links"]["mostRecords"] / r["steps"] for r in results["runs"]
                               if r["seeds"] == 1)
    return runs


def draw(runs):
    """Speed-up against P, one front."""
    try:
        import compare_plots
        from matplotlib import pyplot
    except ImportError as error:
        print(f"{error}: the plot stays as it is (apt-get install python3-matplotlib)")
        return
    compare_plots.setup()
    figure, panes = pyplot.subplots(1, 2, figsize=(9.2, 4.2), sharey=True)
    for axes, network in zip(panes, NETWORKS):
        for n, color in zip(runs.sizes, ("#c6dbef", "#9ecae1", "#6baed6", "#3182bd", "#08519c")):
            axes.loglog(runs.parts, [runs.best(n, 1, p, network) for p in runs.parts], "o-", color=color,
                        markersize=5, label=f"N = {n}")
        axes.loglog(runs.parts, [runs.best(runs.sizes[-1], 100, p, network) for p in runs.parts], "s--",
                    color="#c8553d", markersize=5, label=f"N = {runs.sizes[-1]}, 100 seeds")
        axes.loglog(runs.parts, runs.parts, ":", color="#777777", label="as many as cores")
        compare_plots.ticks(axes, runs.parts)
        axes.set_title(network)
        axes.set_xlabel("cores, each a domain")
    panes[0].set_ylabel("times as fast as one core, by the model")
    panes[0].set_ylim(0.1, 1500)
    compare_plots.legend_below(figure, panes[0], 0.18)
    compare_plots.save(figure, PLOT, creator="scripts/scaling.py")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="two small spheres, not into docs/")
    parser.add_argument("--build", type=pathlib.Path, default=measure.ROOT / "build" / "release",
                        help="build folder [build/release]")
    parser.add_argument("--from", type=pathlib.Path, metavar="FILE", dest="again",
                        help="count nothing: tables and plot of saved results")
    options = parser.parse_args()
    saved = options.again or options.build / f"scaling{'-quick' if options.quick else ''}.json"
    if not options.again:
        bench = options.build / "tests" / "igeo_bench"
        if not bench.exists():
            sys.exit(f"{bench} is not there: run scripts/build.sh release first")
        measure.save({"runs": simulate(bench, options.quick)}, saved)
        print(f"results: {saved}")
    results = json.loads(saved.read_text())
    runs = derive(results)
    if options.quick:
        print("\n\n".join((growth(runs), balance(runs), speed(runs, ()))))
    else:
        for name, make in (("growth", growth), ("balance", balance), ("shapes", shapes)):
            measure.rewrite(DISTRIBUTED, f"scaling-{name}", make(runs))
        measure.rewrite(SCALING, "scaling-speed", speed(runs, BEYOND))
        draw(runs)
    sys.exit(not measure.check(results, "scripts/scaling.py"))


if __name__ == "__main__":
    main()
