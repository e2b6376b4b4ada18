"""downsampling.json -> downsampling.svg: error of the reduced plates against the share of snapshots (the paper's Figure 13)."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import LogFormatter  # noqa: E402

STYLES = {"every k-th step": ("#b2182b", "o"), "every k-th step, all multipliers": ("#1b6ca8", "s"), "tolerance": ("#1b9e77", "D")}


def in_norm(squared_percent):
    """100 |e| / |u| of 100 |e|^2 / |u|^2, which is what eqs. 16 and 17 print."""
    return 10 * squared_percent**0.5


def main(data_file, figure_file):
    with open(data_file) as file:
        data = json.load(file)
    matplotlib.rcParams.update({"svg.hashsalt": "tact", "font.size": 10, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(figsize=(8.5, 5), constrained_layout=True)
    for selection, (colour, marker) in STYLES.items():
        groups = {}
        for row in data["rows"]:
            if row["selection"] == selection:
                groups.setdefault(row["share_percent"], []).append(in_norm(row["relative_error_percent"]))
        shares = sorted(groups)
        errors = [sorted(groups[share]) for share in shares]
        axes.plot(shares, [values[len(values) // 2] for values in errors], color=colour, marker=marker, markersize=5, label=selection)
        axes.fill_between(shares, [values[0] for values in errors], [values[-1] for values in errors], color=colour, alpha=0.15,
                          linewidth=0)
    share = min(row["share_percent"] for row in data["rows"] if row["stride"])
    axes.plot([share], [in_norm(52.8)], "x", color="black", markersize=8, markeredgewidth=2, label="the paper with 25 snapshots (52.8 %, squared as it prints it)")
    axes.axvline(10, color="#7f7f7f", linestyle=":", linewidth=1)
    axes.annotate("10 %", (10, 1), xycoords=("data", "axes fraction"), xytext=(3, -10), textcoords="offset points", fontsize=8.5)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xticks([1, 2, 5, 10, 20, 50, 100])
    axes.set_xticklabels(["1", "2", "5", "10", "20", "50", "100"])
    axes.set_xlabel("share of the steps whose snapshots are kept, %")
    axes.yaxis.set_minor_formatter(LogFormatter(labelOnlyBase=False, minor_thresholds=(2, 0.5)))  # two decades have few tens
    axes.set_ylabel("relative error of u in the norm, %, against the training run")
    axes.grid(which="major", alpha=0.3)
    axes.legend(frameon=False, fontsize=9)
    title = "Reduced plates from fewer snapshots; bands: neighbouring p (paper: Figure 13)"
    axes.set_title(title if data["size"] == "full" else f"{title} ({data['size']} size)", fontsize=11)
    figure.savefig(figure_file, format="svg", metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
