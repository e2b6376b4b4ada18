"""histories.json -> histories.svg: slices, time histories and surfaces of full and reduced runs, as the paper's figures."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

FULL, REDUCED, SINGULAR, OBSTACLE = "#0b3c5d", "#d95f0e", "#9aa0a6", "#6aaed6"


def of_gamma(item):
    return f"γ = ({', '.join(f'{x:g}' for x in item['gamma'])})" if item["gamma"] else ""


def slice_panel(axes, item):
    axes.fill_between(item["x"], item["obstacle"], -1.05, color=OBSTACLE, alpha=0.35, linewidth=0, label="obstacle")
    axes.plot(item["x"], item["full"], color=FULL, linewidth=2.4, label="full")
    axes.plot(item["x"], item["reduced"], color=REDUCED, linewidth=1.2, linestyle="--", label="reduced")
    axes.set_ylim(-1.05, 0.02)
    axes.set_xlabel("x, on y = 1/2")
    axes.set_title(f"Figure {item['figures']}: {item['scene']}, {of_gamma(item)}", fontsize=9.5)
    axes.legend(frameon=False, fontsize=8, loc="upper center", ncol=3)


def history_panel(axes, item, point):
    t = item["t"]
    reach = max(point["full"]) - min(point["full"])
    low, high = min(point["full"]) - 0.35 * reach, max(point["full"]) + 0.35 * reach
    if point["singular_vectors"]:
        axes.plot(t, point["singular_vectors"], color=SINGULAR, linewidth=1, label="reduced, singular vectors")
    axes.plot(t, point["full"], color=FULL, linewidth=2.2, label="full")
    axes.plot(t, point["reduced"], color=REDUCED, linewidth=1.1, linestyle="--", label="reduced")
    axes.set_ylim(low, high)
    body = {0: "", 1: ""} if item["gamma"] else {0: "lower plate, ", 1: "upper plate, "}
    axes.set_title(f"Figure {item['figures'].split(',')[0]}: {of_gamma(item)} {body[point['body']]}u({point['x']:g}, {point['y']:g})",
                   fontsize=9.5)
    axes.set_xlabel("t, s" if not item["gamma"] else "t")


def surface_row(figure, axes, item):
    side = item["side"]
    fields = [[values[k * side:(k + 1) * side] for k in range(side)] for values in (item["full"], item["reduced"])]
    fields.append([[b - a for a, b in zip(*rows)] for rows in zip(*fields)])
    low, high = min(item["full"]), max(item["full"])
    reach = max(abs(x) for row in fields[2] for x in row) or 1
    body = "" if item["gamma"] else ("lower plate" if item["body"] == 0 else "upper plate")
    when = f" t = {item['t']:g}" if item["t"] else ""
    number = item["figures"].split(", ")[-1]
    for panel, field, name in zip(axes, fields, ("full", "reduced", "reduced minus full")):
        limits = (-reach, reach) if name.endswith("minus full") else (low, high)
        picture = panel.imshow(field, origin="lower", extent=(0, 1, 0, 1), vmin=limits[0], vmax=limits[1],
                               cmap="RdBu_r" if name.endswith("minus full") else "viridis")
        figure.colorbar(picture, ax=panel, shrink=0.85)
        panel.set_title(f"Figure {number}: {body}{of_gamma(item)}{when}\n{name}", fontsize=9.5)
        panel.set_xticks([0, 0.5, 1])
        panel.set_yticks([0, 0.5, 1])


def main(data_file, figure_file):
    with open(data_file) as file:
        data = json.load(file)
    matplotlib.rcParams.update({"svg.hashsalt": "tact", "font.size": 9})
    surfaces, histories, slices = data["surfaces"], data["histories"], data["slices"]
    first = 1 if slices else 0
    rows = first + len(histories) + len(surfaces)
    heights = [2.9] * (first + len(histories)) + [3.3] * len(surfaces)
    figure = plt.figure(figsize=(13, sum(heights)), constrained_layout=True)
    parts = figure.subfigures(rows, 1, height_ratios=heights, squeeze=False)[:, 0]
    if slices:
        for axes, item in zip(parts[0].subplots(1, len(slices)), slices):
            slice_panel(axes, item)
    for part, item in zip(parts[first:], histories):
        for k, (axes, point) in enumerate(zip(part.subplots(1, len(item["points"])), item["points"])):
            history_panel(axes, item, point)
            if k == 0:
                axes.legend(frameon=False, fontsize=7.5, loc="best")
    for part, item in zip(parts[first + len(histories):], surfaces):
        surface_row(part, part.subplots(1, 3), item)
    title = "Full and reduced runs, as in the paper's Figures 4, 5, 7, 8, 9, 11 and 12"
    figure.suptitle(title if data["size"] == "full" else f"{title} ({data['size']} size)", fontsize=11)
    figure.savefig(figure_file, format="svg", metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
