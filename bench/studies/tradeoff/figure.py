"""tradeoff.json -> tradeoff.svg: error against run time of full and reduced models, a panel a scene."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import LogFormatter  # noqa: E402

COLOURS = {"none": "#1b6ca8", "bdf2": "#1b6ca8", "trapezoid": "#d95f0e", "bdf2-without-jump": "#1b9e77",
           "central-difference": "#e6194b"}
MARKERS = {"full": "o", "NNMF": "s", "selected rows": "D"}


def in_norm(squared_percent):
    """100 |e| / |u| of 100 |e|^2 / |u|^2, which is what eqs. 16 and 17 print."""
    return 10 * squared_percent**0.5


def main(data_file, figure_file):
    with open(data_file) as file:
        data = json.load(file)
    matplotlib.rcParams.update({"svg.hashsalt": "tact", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    references = data["references"]
    figure, grid = plt.subplots(1, len(references), figsize=(4.6 * len(references), 5), squeeze=False)
    shown = {}
    for axes, reference in zip(grid[0], references):
        rows = [row for row in data["rows"] if row["scene"] == reference["scene"]]
        for row in rows:
            kind = row.get("dual_basis", "full")
            key = (kind, row["integrator"])
            face = COLOURS[row["integrator"]] if row["model"] == "reduced" else "white"
            point, = axes.plot(row["seconds"], row["error_norm_percent"], MARKERS[kind], color=COLOURS[row["integrator"]], markerfacecolor=face,
                               markersize=5, linestyle="none")
            label = "full" if kind == "full" else f"reduced, {kind}"
            shown.setdefault(label if row["integrator"] == "none" else f"{label}, {row['integrator']}", point)
            if row.get("training_model"):
                axes.axhline(row["error_norm_percent"], color=COLOURS[row["integrator"]], linewidth=0.8, linestyle=":")
        axes.axhline(in_norm(reference["own_error_percent"]), color="#7f7f7f", linewidth=0.8, linestyle="--")
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.yaxis.set_minor_formatter(LogFormatter(labelOnlyBase=False, minor_thresholds=(2, 0.5)))  # two decades have few tens
        axes.grid(which="major", alpha=0.3)
        axes.set_title(reference["scene"], fontsize=10)
        axes.set_xlabel("seconds of a query")
    grid[0][0].set_ylabel("relative error of u in the norm, %, against a finer reference")
    title = "Full models over grid and step, reduced models over p; dotted: the training models, dashed: the reference's own error"
    figure.suptitle(title if data["size"] == "full" else f"{title} ({data['size']} size)", fontsize=10)
    figure.tight_layout(rect=(0, 0.13, 1, 0.98))
    order = sorted(shown, key=lambda name: (name.startswith("reduced"), name))
    figure.legend([shown[name] for name in order], order, loc="lower center", ncol=4, frameon=False, fontsize=8)
    figure.savefig(figure_file, format="svg", metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
