#!/usr/bin/env python3
"""Repeats the experiments of Memoli and Sapiro (2001) with the program, as a user would.

Writes the tables of docs/reproduction.md, the pictures in docs/images/reproduction and all figures as
JSON in build/release/reproduction.json, and holds the claims of scripts/claims.json against them.
Needs vdb_tool, and the models that docs/reproduction.md names in --models DIR; what is not there is
left out. Plots need python3-matplotlib.

With --quick: small grids and data/trefoil.vdb in place of every model, under a minute; nothing but
the program and make_shape is needed, and everything is written to build/release/reproduction.
"""
import argparse
import os
import pathlib
import sys
import tempfile

import measure
from reproduction import figures, tables
from reproduction.bench import Bench, Missing, left_out

SCRIPT = "scripts/reproduce.py"

EXPERIMENTS = {
    "table1": tables.table1, "table2": tables.table2, "fig4": figures.fig4, "fig5": figures.fig5,
    "fig6": figures.fig6, "fig7": figures.fig7, "fig8": figures.fig8, "fig9": figures.fig9,
    "fig10": figures.fig10, "fig11": figures.fig11, "fig12": figures.fig12,
}

# What --quick has to find on its small grids and its stand-in, besides the claims that it measures:
# (figure, least, largest).
QUICK = (
    ("fig6.along", 0.2, 1),  # strands of the trefoil that pass each other
    ("fig7.trefoil.godunov 1.max", 0.1, 5),  # %; more than 0: the two are different computations
    ("fig7.trefoil.jet.max", 0.001, 0.5),
    ("fig9.trefoil.jet.distance", -0.2, 0.2),  # %
    ("fig9.trefoil.jet.length", -0.5, 0.5),
    ("fig9.trefoil.godunov.length", -0.5, 1),
    ("fig9.trefoil.jet.apart", 0, 1),  # voxels
    ("fig10.trefoil.longer", 1.01, 3),  # it leaves the path that is shortest without weights
    ("fig11.trefoil.natural.clear", -20, 0),  # it goes through the ball, so
    ("fig11.trefoil.around.clear", -0.5, 5),  # this one has to go around it
    ("fig12.narrowest.50 %", 0.95, 1.05),
    ("fig12.widest.5 %", 0.62, 0.72),  # 1 - h/R = 0.667: straight up from the inner sphere
)


def quick_holds(results):
    holds = True
    for figure, least, largest in QUICK:
        value = measure.look_up(results, figure)
        if value is None:
            continue
        good = least <= value <= largest
        holds = holds and good
        print(f"{'holds' if good else 'DOES NOT HOLD'}: {figure} is {value:.6g}, "
              f"from {least:g} to {largest:g}")
    return holds


def arguments():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small grids, no models, not into docs/")
    parser.add_argument("--models", type=pathlib.Path, metavar="DIR", help="folder of the models")
    parser.add_argument("--only", default=",".join(EXPERIMENTS), metavar="NAMES",
                        help="some of " + ",".join(EXPERIMENTS))
    parser.add_argument("--build", type=pathlib.Path, help="build folder [build/release]")
    options = parser.parse_args()
    options.only = options.only.split(",")
    if unknown := set(options.only) - set(EXPERIMENTS):
        parser.error("no such experiment: " + ", ".join(sorted(unknown)))
    if not options.build:
        program = os.environ.get("IGEO_PROGRAM")
        options.build = pathlib.Path(program).resolve().parents[1] if program else \
            measure.ROOT / "build" / "release"
    options.build = options.build.resolve()
    if not (options.build / "bin" / "implicit-geodesic").exists():
        sys.exit(f"{options.build}/bin/implicit-geodesic is not there: run scripts/build.sh release")
    return options


def main():
    options = arguments()
    out = options.build / "reproduction" if options.quick else measure.ROOT / "docs"
    document = out / "reproduction.md"
    if options.quick:
        measure.write(document, (measure.ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8"))

    results = {}
    with tempfile.TemporaryDirectory(dir=options.build) as work:
        bench = Bench(options.build, options.models, out, pathlib.Path(work), options.quick)
        for name in options.only:
            try:
                results[name], text = EXPERIMENTS[name](bench)
            except Missing as missing:
                text = left_out(missing)
            measure.rewrite(document, name, text)
            print(f"{name}: {'done' if name in results else text}", flush=True)
    if "table1" in results:
        measure.rewrite(document, "machine", f"Times: {measure.machine()}; one thread, least of five runs.")
    measure.save(results, options.build / f"reproduction{'-quick' if options.quick else ''}.json")
    holds = measure.check(results, SCRIPT)
    if options.quick:
        holds = quick_holds(results) and holds
    sys.exit(0 if holds else 1)


if __name__ == "__main__":
    main()
