"""online.json -> online.svg: effectivities of estimates and bounds, and what a query costs."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def main(data_file, figure_file):
    with open(data_file) as file:
        data = json.load(file)
    rows = data["rows"]
    matplotlib.rcParams.update({"svg.hashsalt": "tact", "font.size": 11, "axes.spines.top": False, "axes.spines.right": False})
    figure, (trust, cost) = plt.subplots(1, 2, figsize=(11.5, 4.8), constrained_layout=True)
    names = [f"{row['scene'].split('-')[0]}\np = {row['p']}" for row in rows]
    for field, label, colour, shift in [("estimate", "estimate (calibrated)", "#e08214", -0.12), ("bound", "bound (proven)", "#1b6ca8", 0.12)]:
        at = [(i + shift, row[field]) for i, row in enumerate(rows) if row[field] is not None]
        for x, ratios in at:
            trust.plot([x, x], [ratios["least"], ratios["largest"]], color=colour, linewidth=2)
        trust.plot([x for x, _ in at], [ratios["median"] for _, ratios in at], "o", color=colour, label=label)
    trust.axhline(1, color="#7f7f7f", linewidth=1)
    trust.set_yscale("log")
    trust.set_ylabel("over the true error: least, median, largest")
    trust.legend(frameon=False)
    for k, (field, label, colour) in enumerate([("us_problem", "the problem at γ", "#6aaed6"), ("us_query", "the answer", "#1b6ca8"),
                                                ("us_query_checked", "with its check", "#e08214")]):
        cost.bar([i + 0.27 * (k - 1) for i in range(len(rows))], [row[field] for row in rows], 0.25, color=colour, label=label)
    cost.set_yscale("log")
    cost.set_ylabel("µs a query")
    cost.legend(frameon=False)
    for axes in (trust, cost):
        axes.set_xticks(range(len(rows)))
        axes.set_xticklabels(names)
        axes.grid(axis="y", which="major", alpha=0.3)
        axes.set_axisbelow(True)
    title = "Stored models: trust and cost"
    figure.suptitle(title if data["size"] == "full" else f"{title} ({data['size']} size)")
    figure.savefig(figure_file, format="svg", metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
