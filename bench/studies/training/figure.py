"""training.json -> training.svg: CPU seconds of training by part against the full solves, and the peak of memory by part."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

PARTS = [
    ("full_run", "full runs", "#0b3c5d"), ("pod", "POD", "#6aaed6"), ("dual_basis", "dual bases", "#d95f0e"),
    ("projection", "projection", "#fdae6b"), ("candidates", "candidates", "#1b9e77"),
]


def main(data_file, figure_file):
    with open(data_file) as file:
        data = json.load(file)
    matplotlib.rcParams.update({"svg.hashsalt": "tact", "font.size": 9.5, "axes.spines.top": False, "axes.spines.right": False})
    scenes = data["scenes"]
    figure, panels = plt.subplots(1, len(scenes) + 1, figsize=(4.2 * (len(scenes) + 1), 4.6), constrained_layout=True)
    for axes, scene in zip(panels, scenes):
        rows = [row for row in data["rows"] if row["scene"] == scene["scene"]]
        solves = [row["full_solves"] for row in rows]
        bottom = [0.0] * len(rows)
        for field, label, colour in PARTS:
            values = [row[field + "_seconds"] for row in rows]
            axes.bar(solves, values, 0.85, bottom=bottom, color=colour, label=label)
            bottom = [a + b for a, b in zip(bottom, values)]
        axes.set_xticks(solves if len(solves) <= 10 else solves[::2])
        axes.set_xlim(0.3, max(len(solves), 2) + 0.7)
        axes.set_xlabel("full solves")
        axes.set_title(f"{scene['scene']}\npays after {scene['break_even_queries']:.3g} queries", fontsize=10)
    panels[0].set_ylabel("CPU s up to here")
    panels[0].legend(frameon=False, fontsize=8.5, loc="upper left")
    memory = panels[-1]
    width = 0.8 / len(scenes)
    measured = {part for scene in scenes for part in (scene["peak_megabytes"] or {})}
    parts = [part for part in ("full_run", "pod", "dual_basis", "candidates") if part in measured]
    for k, scene in enumerate(scenes):
        peaks = scene["peak_megabytes"] or {}
        memory.bar([i + (k - (len(scenes) - 1) / 2) * width for i in range(len(parts))], [peaks.get(part, 0) for part in parts], 0.92 * width,
                   label=scene["scene"], color=["#7f7f7f", "#1b6ca8", "#e08214"][k % 3])
    memory.set_xticks(range(len(parts)))
    memory.set_xticklabels([part.replace("_", " ") for part in parts], fontsize=8.5)
    memory.set_title("peak of memory by part, MB", fontsize=10)
    memory.set_ylim(0, 1.3 * memory.get_ylim()[1])
    memory.legend(frameon=False, fontsize=8.5)
    title = "Training by part"
    figure.suptitle(title if data["size"] == "full" else f"{title} ({data['size']} size)", fontsize=11)
    figure.savefig(figure_file, format="svg", metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
