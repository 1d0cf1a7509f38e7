"""What scripts/compare.py says of its results: tables, sentences, plots."""
import measure

BENCHMARKS = measure.ROOT / "docs" / "benchmarks.md"
README = measure.ROOT / "README.md"
IMAGES = measure.ROOT / "docs" / "images" / "accuracy"

NAMES = {"jet": "`jet`", "jet-2": "`jet`, 2 threads",
         "jet-points": "`jet`, values at 1,000 points", "godunov2": "`godunov`, order 2",
         "godunov1": "`godunov`, order 1", "sweep": "maskSdf", "heat": "heat",
         "heat-id": "heat, Delaunay", "heat-10": "heat, t = 10 h^2", "marching": "fast marching",
         "dijkstra": "Dijkstra", "exact": "exact on the mesh"}
ON_MESH = ("heat", "heat-id", "heat-10", "marching", "dijkstra")
OTHERS = ("sweep", *ON_MESH, "exact")
MEASURES = ("mean", "p99", "max")
FURTHER = "processor time of a further seed"
AT_POINTS = f"{FURTHER}, against `jet` with values at 1,000 points"


def title(case):
    """sphere-100: sphere, N = 100; bunny-128-A: bunny, 128, seed A."""
    name, n, *seed = case.rsplit("-", 2) if case[-1] in "AB" else case.rsplit("-", 1)
    return f"{name}, {n}, seed {seed[0]}" if seed else f"{name}, N = {n}"


def is_shape(case):
    return case.startswith(("sphere", "torus"))


def derive(results):
    """Adds what claims are about: errors and time to the first seed over those of jet, time per node."""
    for case in results["cases"].values():
        for method, run in case.items():
            if "nodes" in run and "band" in run:
                run["nsPerNode"] = {stage: 1e9 * run[stage]["cpu"] / run["nodes"]
                                    for stage in ("band", "first")}
            if "jet" in case:
                run["timesJet"] = run["total"]["cpu"] / case["jet"]["total"]["cpu"]
                for key in MEASURES:
                    run[f"{key}OfJet"] = run["errors"][key] / case["jet"]["errors"][key]
    heat = [results["cases"].get(f"sphere-{n}", {}).get("heat") for n in (100, 200)]
    if all(heat):
        results["sphereHeat200By100"] = heat[1]["errors"]["mean"] / heat[0]["errors"]["mean"]


def bold_least(values, show):
    """Texts of values, the least (as shown) in bold; None gives a dash."""
    known = [float(show(v)) for v in values if v is not None]
    return ["-" if v is None else f"**{show(v)}**" if float(show(v)) == min(known) else show(v)
            for v in values]


def errors_of(case, methods):
    """A cell `mean / 99 % / max` per method, the least of each in bold."""
    columns = [bold_least([case[m]["errors"][key] if m in case else None for m in methods],
                          lambda v: measure.number(v, 2)) for key in MEASURES]
    return ["-" if cell[0] == "-" else " / ".join(cell) for cell in zip(*columns)]


def shape_errors(results):
    methods = ("jet", "godunov2", "godunov1", *OTHERS)
    cases = {name: case for name, case in results["cases"].items() if is_shape(name)}
    columns = [errors_of(case, methods) for case in cases.values()]
    return measure.table(["method", *map(title, cases)],
                     [[NAMES[m], *(column[k] for column in columns)] for k, m in enumerate(methods)])


def model_errors(results):
    methods = ("jet", "godunov2", "sweep", *ON_MESH)
    return measure.table(["model, voxels, seed", *(NAMES[m] for m in methods)],
                     [[title(name), *errors_of(case, methods)]
                      for name, case in results["cases"].items() if not is_shape(name)])


def timed(results):
    """Cases with medians of times: not those of the second seed, nor spheres for the plots only."""
    return {name: case for name, case in results["cases"].items()
            if not name.endswith(("-B", "-50"))}


def figures(results, value, show, *fewer):
    """A row per case, a column per method, the least in bold. Then, never in bold, those with fewer
    values."""
    methods = [m for m in NAMES if m != "jet-points"]

    def shown(case, of):
        return [value(case[m]) if m in case else None for m in of]
    return measure.table(["", *(NAMES[m] for m in (*methods, *fewer))],
                     [[title(name), *bold_least(shown(case, methods), show),
                       *("-" if v is None else show(v) for v in shown(case, fewer))]
                      for name, case in timed(results).items()])


def seconds(x):
    return measure.number(x, 2)


def times(results):
    return figures(results, lambda run: run["total"]["cpu"], seconds)


def walls(results):
    return figures(results, lambda run: run["total"]["wall"], seconds)


def further(results):
    return figures(results, further_seed, seconds, "jet-points")


def further_seed(run):
    return run.get("further", run["first"])["cpu"]


def memory(results):
    return figures(results, lambda run: run["peakBytes"], lambda v: f"{v / 1e6:.0f}")


def stages(results, name):
    """What each stage of each method takes on one case, processor / wall time."""
    def cell(run, keys):
        known = [run[key] for key in keys if key in run]
        return " / ".join(seconds(sum(s[clock] for s in known)) for clock in ("cpu", "wall")) \
            if known else "-"
    columns = {"read": ["read"], "check and band, or extraction": ["check", "band", "surface"],
               "set-up": ["setup"], "first seed": ["first"], "all": ["total"],
               "further seed": ["further"]}
    return measure.table(["method", *columns, "peak, MB"],
                     [[NAMES[m], *(cell(run, keys) for keys in columns.values()),
                       f"{run['peakBytes'] / 1e6:.0f}"]
                      for m, run in ((m, results["cases"][name][m]) for m in NAMES
                                     if m in results["cases"][name])])


def ahead_in_error(results):
    return ahead(results, {f"{label} error": (lambda run, k=key: run["errors"][k], "%")
                           for key, label in zip(MEASURES, ("mean", "99th percentile of the", "largest"))})


def ahead_in_time(results):
    return ahead(results, {
        "processor time to the first seed": (lambda run: run["total"]["cpu"], "s"),
        FURTHER: (further_seed, "s"), AT_POINTS: (further_seed, "s"),
        "peak memory": (lambda run: run["peakBytes"] / 1e6, "MB")})


def ahead(results, measures):
    """Where others are ahead of jet on one thread: a sentence per measure and method. Further seeds
    are compared with jet on the whole band, and with its values at points."""
    lines = []
    for quantity, (value, unit) in measures.items():
        ours = "jet-points" if quantity == AT_POINTS else "jet"
        cases = {name: case for name, case in
                 (timed(results) if unit != "%" else results["cases"]).items() if ours in case}
        for method in OTHERS:
            where = [f"{title(name)} ({measure.number(value(case[method]), 2)} against "
                     f"{measure.number(value(case[ours]), 2)} {unit})"
                     for name, case in cases.items()
                     if method in case and value(case[method]) < value(case[ours])]
            if where:
                lines.append(f"- *{quantity}*, {NAMES[method]}: {'; '.join(where)}.")
    return "\n".join(lines) or "Nowhere in these cases."


def readme(results):
    """The few figures of the README."""
    methods = ("jet", "godunov2", "heat", "marching", "exact")
    rows = []
    for name in ("sphere-100", "torus-200", "bunny-256-A", "cad-anchor-256-A", "brain-256-A"):
        case = results["cases"].get(name)
        if case is None:
            continue
        spent = [f"{seconds(case[m]['total']['cpu'])} s" for m in ("jet", "heat", "marching")
                 if m in case]
        rows.append([title(name).removesuffix(", seed A"), *errors_of(case, methods),
                     " / ".join(spent)])
    return measure.table(["", *(NAMES[m] for m in methods), "time of `jet` / heat / fast marching"],
                         rows)


def overview(results):
    cases = results["cases"]
    parts = [shape_errors(results) if any(map(is_shape, cases)) else "",
             model_errors(results) if not all(map(is_shape, cases)) else "", times(results)]
    return "\n\n".join(part for part in parts if part)


def write_errors(results):
    """What is the same on every machine."""
    write_parts(results, {"shapes": shape_errors, "models": model_errors,
                          "ahead-errors": ahead_in_error,
                          "commit": lambda r: f"Errors: {r['machine'].rsplit(', ', 1)[1]}. "
                                              "They are the same on every machine."})


def write_documents(results):
    write_errors(results)
    write_parts(results, {
        "times": times, "walls": walls, "further": further, "memory": memory,
        "ahead-times": ahead_in_time,
        "stages-sphere": lambda r: stages(r, "sphere-200"),
        "stages-bunny": lambda r: stages(r, "bunny-256-A"),
        "machine": lambda r: f"Times and memory: {r['machine']}; command: `{r['command']}`."})
    measure.rewrite(README, "compare", readme(results))


def write_parts(results, parts):
    for name, make in parts.items():
        measure.rewrite(BENCHMARKS, f"compare-{name}", make(results))


def draw(results):
    """Plots, where matplotlib is there."""
    try:
        import compare_plots
    except ImportError as error:
        print(f"{error}: docs/images/accuracy stays as it is (apt-get install python3-matplotlib)")
        return
    compare_plots.draw(results, IMAGES)
