"""solvers.json -> solvers.svg: each problem's times by solver, and how a step and its memory grow."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

OURS = {"chooser": "#0b3c5d", "klu-active-set": "#6aaed6", "schur": "#2ca25f", "projected-cg": "#8c6bb1", "colour-sor": "#d95f0e",
        "multigrid": "#dd1c77"}
PEERS = ["s", "^", "v", "D", "P", "X", "*", "<", ">"]


def solver_panel(axes, data):
    problems = [problem["problem"] for problem in data["problems"]]
    peers = sorted({row["solver"] for row in data["rows"] if row["peer"]})
    shown = {}
    for row in data["rows"]:
        if row["seconds_median"] is None:
            continue
        y, solver, solved = problems.index(row["problem"]), row["solver"], row.get("outcome") == "converged"
        if row["peer"]:
            style = {"marker": PEERS[peers.index(solver) % len(PEERS)], "color": "#7f7f7f", "s": 34}
            y += 0.18
        else:
            chosen = solver == "chooser"
            style = {"marker": "|" if chosen else "o", "color": OURS.get(solver, "black"), "s": 420 if chosen else 42}
            y -= 0.0 if chosen else 0.18
        if not solved:
            style["facecolors"] = "none"
            style["edgecolors"] = style.pop("color")
            if style["marker"] in "|PX":
                style["marker"] = "o"
        handle = axes.scatter(1e3 * row["seconds_median"], y, linewidths=2.5 if style["marker"] == "|" else 1, zorder=3, **style)
        if solved:
            shown.setdefault(solver, handle)
    axes.set_xscale("log")
    axes.set_yticks(range(len(problems)))
    axes.set_yticklabels([problem.replace(", ", ",\n") for problem in problems])
    axes.set_ylim(len(problems) - 0.5, -0.5)
    axes.set_xlabel("CPU time, ms (hollow: did not converge)")
    axes.grid(axis="x", which="major", alpha=0.3)
    for y in range(1, len(problems)):
        axes.axhline(y - 0.5, color="#dddddd", linewidth=0.8)
    order = [solver for solver in OURS if solver in shown] + [solver for solver in shown if solver not in OURS]
    axes.legend([shown[solver] for solver in order], order, loc="upper center", bbox_to_anchor=(0.4, -0.12), ncol=3, frameon=False,
                fontsize=8.5, markerscale=0.8)


def exponent(growth, field):
    return "" if growth[field] is None else f" ~ N$^{{{growth[field]:.2f}}}$"


def growth_panels(time_axes, memory_axes, data):
    colours = ["#0b3c5d", "#d95f0e", "#2ca25f"]
    for growth, colour in zip(data["growth"], colours):
        for field, fit, line, label in [("free_seconds", "free_exponent", "--o", "free step"),
                                        ("contact_seconds", "contact_exponent", "-o", "in contact")]:
            points = [(p["unknowns"], 1e3 * p[field]) for p in growth["points"] if p.get(field) is not None]
            if points:
                time_axes.plot(*zip(*points), line, color=colour, markersize=4.5,
                               markerfacecolor="white" if line.startswith("--") else colour,
                               label=f"{growth['scene']}, {label}{exponent(growth, fit)}")
        points = [(p["unknowns"], p["bytes_per_unknown"]) for p in growth["points"] if p.get("bytes_per_unknown") is not None]
        if points:
            memory_axes.plot(*zip(*points), "-o", color=colour, markersize=4.5, label=growth["scene"])
    time_axes.set_ylabel("ms a step, chooser")
    memory_axes.set_ylabel("peak bytes / unknown")
    memory_axes.set_xlabel("unknowns")
    for axes in (time_axes, memory_axes):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.grid(which="major", alpha=0.3)
        handles = axes.get_legend_handles_labels()[0]
        if handles:
            low, high = axes.get_ylim()
            axes.set_ylim(low, high * 3 ** len(handles))  # room for the legend above the curves
            axes.legend(loc="upper left", frameon=False, fontsize=8.5)


def main(data_file, figure_file):
    with open(data_file) as file:
        data = json.load(file)
    matplotlib.rcParams.update({"svg.hashsalt": "tact", "font.size": 10, "axes.spines.top": False, "axes.spines.right": False})
    figure = plt.figure(figsize=(12, 6.6), constrained_layout=True)
    grid = figure.add_gridspec(2, 2, width_ratios=[1.25, 1], height_ratios=[1.5, 1])
    solver_panel(figure.add_subplot(grid[:, 0]), data)
    growth_panels(figure.add_subplot(grid[0, 1]), figure.add_subplot(grid[1, 1]), data)
    title = "Contact solvers on the paper's problems"
    figure.suptitle(title if data["size"] == "full" else f"{title} ({data['size']} size)")
    figure.savefig(figure_file, format="svg", metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
