"""greedy.json -> greedy.svg: worst test error against iterations, static and dynamic (the paper's Figures 3 and 6)."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import LogFormatter  # noqa: E402

STYLES = {
    "(1,0,0)": ("#b2182b", "o"), "(0,1,0)": ("#1b6ca8", "s"), "(0,0,1)": ("#1b9e77", "D"), "(1,1,0)": ("#e08214", "v"),
    "(1,0,1)": ("#8c6bb1", "^"), "(0,1,1)": ("#6aaed6", "<"), "(1,1,1)": ("#b8860b", ">"), "true error": ("#000000", "*"),
    "(1,0,0), closed grid": ("#ef8a8a", "P"),
}


def in_norm(squared_percent):
    """100 |e| / |u| of 100 |e|^2 / |u|^2, which is what eqs. 16 and 17 print."""
    return 10 * squared_percent**0.5


def curves(axes, rows):
    for selection, (colour, marker) in STYLES.items():
        points = [(row["iteration"], in_norm(row["worst_error_percent"])) for row in rows if row["selection"] == selection]
        if not points:
            continue
        papers = selection == "(1,0,0)"  # several weights often choose alike: it lies on top of them
        axes.plot(*zip(*points), color=colour, marker=marker, markersize=4, linewidth=1.9 if papers else 1.1, zorder=3 if papers else 2,
                  linestyle="--" if selection in ("true error", "(1,0,0), closed grid") else "-",
                  label=selection if selection == "true error" else "α = " + selection)
    axes.set_yscale("log")
    axes.grid(which="major", alpha=0.3)
    axes.set_xlabel("iterations of the greedy search")


def random_bars(axes, rows):
    """All repeats as a bar from best to worst, with the middle half thick and the median marked."""
    for k, samples in enumerate(dict.fromkeys(row["samples"] for row in rows)):
        errors = sorted(in_norm(row["worst_error_percent"]) for row in rows if row["samples"] == samples)
        count = len(errors)
        axes.plot([samples, samples], [errors[0], errors[-1]], color="#2b5fd9", linewidth=1.2)
        axes.plot([samples, samples], [errors[count // 4], errors[(3 * count) // 4]], color="#2b5fd9", linewidth=5, alpha=0.5,
                  solid_capstyle="butt")
        axes.plot([samples], [errors[count // 2]], "_", color="#2b5fd9", markersize=12, markeredgewidth=2,
                  label=f"{count} Latin hypercubes" if k == 0 else None)


def main(data_file, figure_file):
    with open(data_file) as file:
        data = json.load(file)
    matplotlib.rcParams.update({"svg.hashsalt": "tact", "font.size": 10, "axes.spines.top": False, "axes.spines.right": False})
    scenes = list(dict.fromkeys(row["scene"] for row in data["rows"]))
    figure, panels = plt.subplots(1, len(scenes), figsize=(6 * len(scenes), 5), constrained_layout=True, squeeze=False)
    shown = {}
    for axes, scene in zip(panels[0], scenes):
        rows = [row for row in data["rows"] if row["scene"] == scene]
        iterations = [row for row in rows if "iteration" in row]
        curves(axes, iterations)
        random_bars(axes, [row for row in rows if "samples" in row])
        sizes = {row["iteration"]: row["p"] for row in iterations}
        ticks = sorted(sizes)[::2] if len(sizes) > 10 else sorted(sizes)
        axes.set_xticks(ticks)
        axes.set_xticklabels([f"{k}\np={sizes[k]}" for k in ticks], fontsize=8)
        axes.set_title(f"{scene}: worst of {rows[0]['test_parameters']} parameters that are no candidates", fontsize=10)
        squared = axes.secondary_yaxis("right", functions=(lambda e: e**2 / 100, in_norm))
        squared.set_ylabel("squared, as the paper prints it, %")
        axes.yaxis.set_minor_formatter(LogFormatter(labelOnlyBase=False, minor_thresholds=(2, 0.5)))  # two decades have few tens
        axes.set_ylabel("worst relative error of u in the norm, %,\nagainst the full run of the same grid and steps")
        shown |= {label: handle for handle, label in zip(*axes.get_legend_handles_labels())}
    figure.legend(shown.values(), shown, loc="lower center", ncol=5, frameon=False, fontsize=8.5)
    figure.get_layout_engine().set(rect=(0, 0.11, 1, 0.89))
    title = "Greedy search by the contact indicator (paper: Figures 3 and 6)"
    figure.suptitle(title if data["size"] == "full" else f"{title} ({data['size']} size)", fontsize=11)
    figure.savefig(figure_file, format="svg", metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
