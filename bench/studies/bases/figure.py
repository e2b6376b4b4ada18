"""bases.json -> bases.svg: worst error against online time of a step, a panel a scene and integrator, the front as a line."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import LogFormatter  # noqa: E402

STYLE = {
    "NNMF": ("#1b6ca8", "o"), "NNMF, random starts": ("#6aaed6", "o"), "NNMF, multiplicative": ("#6aaed6", "v"),
    "NNMF, alternating least squares": ("#6aaed6", "^"), "NNMF, supremizers": ("#1b6ca8", "P"), "NNMF, compliance": ("#1b6ca8", "X"),
    "cone-projected greedy": ("#8c6bb1", "s"), "snapshots": ("#7f7f7f", "D"), "all snapshots": ("#000000", "D"),
    "selected rows": ("#d95f0e", "o"), "selected rows, supremizers": ("#d95f0e", "P"), "selected rows, compliance": ("#d95f0e", "X"),
    "touched rows": ("#1b9e77", "h"), "singular vectors": ("#c51b7d", "x"),
}


def in_norm(squared_percent):
    """100 |e| / |u| of 100 |e|^2 / |u|^2, which is what eqs. 16 and 17 print."""
    return 10 * squared_percent**0.5


def main(data_file, figure_file):
    with open(data_file) as file:
        data = json.load(file)
    matplotlib.rcParams.update({"svg.hashsalt": "tact", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    panels = list(dict.fromkeys((row["scene"], row["integrator"]) for row in data["rows"]))
    columns = min(len(panels), 3)
    lines = -(-len(panels) // columns)
    figure, grid = plt.subplots(lines, columns, figsize=(4.2 * columns + 0.6, 3.6 * lines + 1.6), squeeze=False)
    shown = {}
    for axes in grid.flat[len(panels):]:
        axes.set_visible(False)
    for axes, (scene, integrator) in zip(grid.flat, panels):
        rows = [row for row in data["rows"] if (row["scene"], row["integrator"]) == (scene, integrator) and row["error_percent"]]
        for row in rows:
            colour, marker = STYLE.get(row["dual_basis"], ("#444444", "*"))
            axes.plot([row["us_per_step"]] * 2, [in_norm(row["error_min"]), in_norm(row["error_max"])], color=colour, linewidth=0.8, alpha=0.5)
            point, = axes.plot(row["us_per_step"], in_norm(row["error_percent"]), color=colour, marker=marker, linestyle="none", markersize=5)
            shown.setdefault(row["dual_basis"], point)
        front = sorted((row["us_per_step"], in_norm(row["error_percent"])) for row in rows if row["pareto"])
        if front:
            axes.step(*zip(*front), where="post", color="black", linewidth=0.8, linestyle=":")
        axes.set_xscale("log")
        axes.set_yscale("log")
        errors = [in_norm(row["error_percent"]) for row in rows]
        axes.set_ylim(min(errors) / 2, min(2 * max(errors), 50 * min(errors)))  # what diverges leaves the picture
        middle = (min(row["us_per_step"] for row in rows) * max(row["us_per_step"] for row in rows)) ** 0.5
        low, high = axes.get_xlim()
        axes.set_xlim(min(low, middle / 3), max(high, middle * 3))
        axes.grid(which="major", alpha=0.3)
        axes.yaxis.set_minor_formatter(LogFormatter(labelOnlyBase=False, minor_thresholds=(2, 0.5)))  # two decades have few tens
        axes.set_title(scene if integrator == "none" else f"{scene}, {integrator}", fontsize=9)
        axes.set_xlabel("µs a query" if integrator == "none" else "µs a step")
    for line in grid:
        line[0].set_ylabel("worst relative error in the norm, %\nagainst the full run of the same grid and steps")
    height = figure.get_figheight()
    figure.tight_layout(rect=(0, 1.1 / height, 1, 1 - 0.3 / height))
    figure.legend(shown.values(), shown.keys(), loc="lower center", ncol=4, frameon=False, fontsize=8)
    title = "Reduced bases: error against online time; dotted: the front"
    figure.suptitle(title if data["size"] == "full" else f"{title} ({data['size']} size)", fontsize=11)
    figure.savefig(figure_file, format="svg", metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
