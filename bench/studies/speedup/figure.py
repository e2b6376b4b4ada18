"""speedup.json -> speedup.svg: the speed-ups of each scene against each full solver, and the paper's."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

BARS = [
    ("speedup", "fastest full solver", "#1b6ca8"),
    ("speedup_vs_klu_refactor", "KLU refactorisation", "#6aaed6"),
    ("speedup_vs_interior_point", "interior point (the paper's kind)", "#e08214"),
    ("paper_speedup", "the paper, its interior point", "#7f7f7f"),
]


def in_norm(squared_percent):
    """100 |e| / |u| of 100 |e|^2 / |u|^2, which is what eqs. 16 and 17 print."""
    return 10 * squared_percent**0.5


def main(data_file, figure_file):
    with open(data_file) as file:
        data = json.load(file)
    rows = data["rows"]
    matplotlib.rcParams.update({"svg.hashsalt": "tact", "font.size": 11, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(figsize=(13, 5.2), constrained_layout=True)
    width = 0.8 / len(BARS)
    for k, (field, label, colour) in enumerate(BARS):
        at = [i + (k - (len(BARS) - 1) / 2) * width for i in range(len(rows))]
        values = [row[field] for row in rows]
        present = [(x, v) for x, v in zip(at, values) if v is not None]
        axes.bar([x for x, _ in present], [v for _, v in present], 0.92 * width, color=colour, label="against " + label if k < 3 else label)
        for x, value in present:
            axes.annotate(f"{value:,.0f}".replace(",", " ") if value >= 10 else f"{value:.1f}", (x, value), xytext=(0, 2),
                          textcoords="offset points", ha="center", va="bottom", fontsize=7.5)
    axes.set_yscale("log")
    largest = max(row[field] for row in rows for field, _, _ in BARS if row[field] is not None)
    axes.set_ylim(1, 60 * largest)
    axes.set_ylabel("online speed-up")
    axes.set_xticks(range(len(rows)))
    axes.set_xticklabels(
        [f"{row['scene']}, {row['method']}\n{row['unknowns']} unknowns → p = {row['p']}\nerror {in_norm(row['relative_error_percent']):.2g} %" for row in rows],
        fontsize=8.5)
    axes.set_xlabel("bases by our method and by the paper's; error: worst relative error of u in the norm against the full run of the same grid "
                    "and steps", fontsize=9)
    axes.grid(axis="y", which="major", alpha=0.3)
    axes.set_axisbelow(True)
    axes.legend(loc="upper center", ncol=2, frameon=False)
    title = "Reduced against full contact problems"
    axes.set_title(title if data["size"] == "full" else f"{title} ({data['size']} size)")
    figure.savefig(figure_file, format="svg", metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
