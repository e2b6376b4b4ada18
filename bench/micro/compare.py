#!/usr/bin/env python3
"""Two runs of tact-micro, as `tact-micro --benchmark_format=json --benchmark_repetitions=5 > FILE` writes them: times and their ratio.

usage: bench/micro/compare.py BEFORE.json AFTER.json [--least]

By medians over the repetitions, or with --least by the least of them, which a loaded machine disturbs less. Ratios between .77 and
1.3 are ties."""
import json
import statistics
import sys


def times(file):
    with open(file) as text:
        runs = json.load(text)["benchmarks"]
    found = {}
    for run in runs:
        if run.get("run_type", "iteration") != "iteration" or run.get("error_occurred"):
            continue
        unit = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1}[run["time_unit"]]
        found.setdefault(run["run_name"], []).append(run["cpu_time"] * unit)
    return found


def shown(seconds):
    for size, unit in ((1, "s"), (1e-3, "ms"), (1e-6, "us")):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def main(arguments):
    files = [argument for argument in arguments if not argument.startswith("-")]
    if len(files) != 2 or set(arguments) - set(files) - {"--least"}:
        print(__doc__, file=sys.stderr)
        return 1
    best = min if "--least" in arguments else statistics.median
    before, after = times(files[0]), times(files[1])
    width = max((len(name) for name in before | after), default=4)
    print(f"{'':{width}} {'before':>10} {'after':>10}  ratio")
    for name in dict.fromkeys([*before, *after]):
        pair = [best(found[name]) if name in found else None for found in (before, after)]
        cells = [shown(value) if value is not None else "-" for value in pair]
        ratio = "" if None in pair else f"{pair[1] / pair[0]:6.2f}"
        print(f"{name:{width}} {cells[0]:>10} {cells[1]:>10} {ratio}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
