#!/usr/bin/env python3
"""Runs igeo_bench in turns and prints medians as a Markdown table.

usage: scripts/bench.py [--build build/release] [--runs 5] [--n 100,200,400]

Each round runs every case once, so that a machine whose speed drifts slows all of them alike; the
ratios are taken round by round, and their median is what to quote. Use a quiet machine.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys


def bench(program, *arguments):
    """The last line igeo_bench prints, as a dictionary."""
    done = subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, text=True)
    return json.loads(done.stdout.splitlines()[-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build/release", help="build folder [build/release]")
    parser.add_argument("--runs", type=int, default=5, help="rounds [5]")
    parser.add_argument("--n", default="100,200,400", help="voxels per side, several [100,200,400]")
    options = parser.parse_args()
    program = pathlib.Path(options.build) / "tests" / "igeo_bench"
    if not program.exists():
        sys.exit(f"{program} is not there: run scripts/build.sh release first")

    print("| N | band nodes | band, ns/node | jet, ns/node | jet, 2 threads | godunov 2 | "
          "godunov 1 | sweep / godunov 1 | bytes/node at peak |")
    print("|---:|---:|---:|---:|---:|---:|---:|---:|---:|")
    for n in options.n.split(","):
        rounds = []
        for _ in range(options.runs):
            common = ("march", "--n", n, "--runs", 1)
            rounds.append({
                "jet": bench(program, *common),
                "jet2": bench(program, *common, "--threads", 2),
                "godunov2": bench(program, *common, "--scheme", "godunov"),
                "godunov1": bench(program, *common, "--scheme", "godunov", "--order", 1),
                "sweep": bench(program, "sweep", "--n", n),
            })

        def median(value):
            return statistics.median(value(r) for r in rounds)

        ns = {case: median(lambda r, c=case: r[c]["marchNsPerNode"])
              for case in ("jet", "jet2", "godunov2", "godunov1")}
        faster = median(lambda r: r["jet"]["marchNsPerNode"] / r["jet2"]["marchNsPerNode"])
        print(f"| {n} | {rounds[0]['jet']['nodes']:.0f} "
              f"| {median(lambda r: r['jet']['bandNsPerNode']):.0f} | {ns['jet']:.0f} "
              f"| {faster:.2f} times faster | {ns['godunov2']:.0f} | {ns['godunov1']:.0f} "
              f"| {median(lambda r: r['sweep']['ratio']):.1f} "
              f"| {median(lambda r: r['jet']['peakBytesPerNode']):.0f} |", flush=True)


if __name__ == "__main__":
    main()
