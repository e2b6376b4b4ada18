"""omission.json -> omission.svg: which scene uses which part, and what parts left out would cost."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def main(data_file, figure_file):
    with open(data_file) as file:
        data = json.load(file)
    matplotlib.rcParams.update({"svg.hashsalt": "tact", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    scenes = list(dict.fromkeys(row["scene"] for row in data["rows"]))
    parts = list(dict.fromkeys(row["part"] for row in data["rows"]))
    figure, (left, right) = plt.subplots(1, 2, figsize=(12.5, max(4.5, 1.6 + 0.27 * len(scenes))), gridspec_kw={"width_ratios": [1.5, 1]})
    for row in data["rows"]:
        x, y = parts.index(row["part"]), scenes.index(row["scene"])
        left.scatter(x, y, s=75, color="#1b6ca8" if row["used"] else "white", edgecolor="#1b6ca8" if row["used"] else "#c9ced4", linewidth=1)
    left.set_xticks(range(len(parts)))
    left.set_xticklabels(parts, rotation=40, ha="right", rotation_mode="anchor")
    left.set_yticks(range(len(scenes)))
    left.set_yticklabels(scenes)
    left.set_ylim(len(scenes) - 0.5, -0.5)
    left.tick_params(length=0)
    left.spines[:].set_visible(False)
    left.set_title("used (full) and left out (empty)", fontsize=10)
    rows = data["costs"]
    for k, row in enumerate(rows):
        right.barh(k, row["over_percent"], color="#1b6ca8" if row["over_percent"] <= row["asked_percent"] else "#e08214", height=0.45)
        right.plot([row["asked_percent"]] * 2, [k - 0.35, k + 0.35], color="#7f7f7f", linewidth=1.5)
        right.text(0.02, k - 0.37, f"{row['what']}, against {row['baseline']}: {row['over_percent']:.2g} %",
                   va="bottom", fontsize=7.5, transform=right.get_yaxis_transform())
    right.set_ylim(len(rows) - 0.4, -1)
    right.set_yticks([])
    right.set_xlabel("time over the baseline, %; grey: asked for at most")
    right.set_title("what is paid for parts not used", fontsize=10)
    if data["size"] != "full":
        figure.suptitle(f"{data['size']} size", fontsize=9)
    figure.tight_layout()
    figure.savefig(figure_file, format="svg", metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
