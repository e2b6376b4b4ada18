"""stability.json -> stability.svg: every integrator on every case, coloured by its judgement, and what impacts do."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.colors import BoundaryNorm, ListedColormap  # noqa: E402
from matplotlib.patches import Patch  # noqa: E402

COLOURS = {
    "right": "#a6d8b4",
    "honest failure": "#ffe08a",
    "penetrates": "#9ecae1",
    "gains energy": "#ef8a62",
    "out of time": "#b39ddb",
    "wrong": "#b2182b",
}


def in_norm(squared_percent):
    """100 |e| / |u| of 100 |e|^2 / |u|^2, which is what eqs. 16 and 17 print."""
    return 10 * squared_percent**0.5


def distinct(rows, field):
    return list(dict.fromkeys(row[field] for row in rows))


def judgement_panel(axes, rows):
    cases, integrators = distinct(rows, "case"), distinct(rows, "integrator")
    names = list(COLOURS)
    grid = [[float("nan")] * len(integrators) for _ in cases]
    for row in rows:
        grid[cases.index(row["case"])][integrators.index(row["integrator"])] = names.index(row["judgement"])
    axes.imshow(grid, cmap=ListedColormap(list(COLOURS.values())), norm=BoundaryNorm([k - 0.5 for k in range(len(names) + 1)], len(names)),
                aspect="auto", interpolation="nearest")
    for row in rows:
        if row["judgement"] == "gains energy" and row["energy_ratio_max"] is not None:
            ratio = row["energy_ratio_max"]
            text = f"e{len(str(int(ratio))) - 1}" if ratio >= 10 else f"{ratio:.1f}" if ratio >= 1.05 else "1+"
            axes.text(integrators.index(row["integrator"]), cases.index(row["case"]), text, ha="center", va="center", fontsize=5.5)
    axes.set_xticks(range(len(integrators)))
    axes.set_xticklabels(integrators, rotation=60, ha="right", rotation_mode="anchor", fontsize=8)
    axes.set_yticks(range(len(cases)))
    axes.set_yticklabels(cases, fontsize=7.5)
    axes.set_xticks([k - 0.5 for k in range(1, len(integrators))], minor=True)
    axes.set_yticks([k - 0.5 for k in range(1, len(cases))], minor=True)
    axes.grid(which="minor", color="white", linewidth=0.8)
    axes.tick_params(which="both", length=0)
    groups = {row["case"]: row["group"] for row in rows}
    for k in range(1, len(cases)):
        if groups[cases[k]] != groups[cases[k - 1]]:
            axes.axhline(k - 0.5, color="#555555", linewidth=1)
    used = set(row["judgement"] for row in rows)
    axes.legend(handles=[Patch(color=COLOURS[name], label=name) for name in names if name in used], loc="lower left",
                bbox_to_anchor=(0, 1.0), ncol=6, frameon=False, fontsize=8.5)


def restitution_panel(axes, rows):
    rows = [row for row in rows if row["scene"] == "mass" and row["e_min"] is not None]
    for y, row in enumerate(rows):
        axes.plot([row["e_min"], row["e_max"]], [y, y], "-|", color="#0b3c5d", linewidth=2.5, markersize=8)
    axes.set_yticks(range(len(rows)))
    axes.set_yticklabels([row["integrator"] for row in rows], fontsize=7.5)
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.axvline(1, color="#b2182b", linewidth=0.8, linestyle="--")
    axes.set_xlabel("restitution of a single mass, all phases of its impact", fontsize=8)
    axes.set_xscale("symlog", linthresh=2, linscale=3)
    axes.set_xticks([0, 0.5, 1, 1.5, 2, 4, 8])
    axes.set_xticklabels(["0", "0.5", "1", "1.5", "2", "4", "8"])
    axes.grid(axis="x", alpha=0.3)


def reduced_panel(axes, rows):
    for row, colour, marker in zip(rows, ["#d95f0e", "#0b3c5d", "#2ca25f"], "osD"):
        axes.semilogy(row["p"], [in_norm(each) for each in row["percent"]], "-" + marker, color=colour, markersize=4.5,
                      label=f"{row['integrator']}: {row['over_bdf2'] ** 0.5:.2f} of BDF2's")
    axes.set_xlabel("modes p of the reduced plates", fontsize=8.5)
    axes.set_ylabel("relative error of u in the norm, %, against its own full run", fontsize=8.5)
    axes.set_xticks(rows[0]["p"])
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** 0.2)  # room for the legend
    axes.grid(alpha=0.3, which="both")
    axes.legend(frameon=False, fontsize=8.5)


def main(data_file, figure_file):
    with open(data_file) as file:
        data = json.load(file)
    matplotlib.rcParams.update({"svg.hashsalt": "tact", "font.size": 9})
    cases = len(distinct(data["rows"], "case"))
    figure = plt.figure(figsize=(13, 1.5 + 0.17 * max(cases, 20)), constrained_layout=True)
    more = bool(data["restitution"]) and bool(data["reduced_error"])
    if more:
        grid = figure.add_gridspec(2, 2, width_ratios=[1.5, 1])
        judgement_panel(figure.add_subplot(grid[:, 0]), data["rows"])
        restitution_panel(figure.add_subplot(grid[0, 1]), data["restitution"])
        reduced_panel(figure.add_subplot(grid[1, 1]), data["reduced_error"])
    else:
        judgement_panel(figure.add_subplot(), data["rows"])
    figure.text(0.995, 0.003, "numbers: energy over that at first, eN for 10^N and more", ha="right", fontsize=7.5)
    title = "Integrators on hard cases"
    figure.suptitle(title if data["size"] == "full" else f"{title} ({data['size']} size)")
    figure.savefig(figure_file, format="svg", metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
