"""growth.json -> growth.svg: a panel a series, time against what it grows with, and the fitted slope."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def main(data_file, figure_file):
    with open(data_file) as file:
        data = json.load(file)
    matplotlib.rcParams.update({"svg.hashsalt": "tact", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    rows = data["rows"]
    lines = -(-len(rows) // 4)
    figure, grid = plt.subplots(lines, 4, figsize=(13, 3.1 * lines + 0.4), squeeze=False)
    for axes in grid.flat[len(rows):]:
        axes.set_visible(False)
    for axes, row in zip(grid.flat, rows):
        points = [(point["x"], point["seconds"]) for point in row["points"] if point["seconds"] is not None]
        axes.loglog(*zip(*points), "o-", color="#1b6ca8", markersize=4.5, linewidth=1.2)
        axes.set_title(row["of"], fontsize=8.5)
        axes.set_xlabel(row["with"])
        axes.set_ylabel("seconds, " + row["unit"], fontsize=8)
        low, high = axes.get_ylim()
        middle = (low * high) ** 0.5
        axes.set_ylim(min(low, middle / 4), max(high, middle * 4))
        axes.grid(which="major", alpha=0.3)
        if row["exponent"] is not None:
            axes.text(0.05, 0.92, f"slope {row['exponent']:.2f}", transform=axes.transAxes, fontsize=9)
    if data["size"] != "full":
        figure.suptitle(f"{data['size']} size", fontsize=9)
    figure.tight_layout()
    figure.savefig(figure_file, format="svg", metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
