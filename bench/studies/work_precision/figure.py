"""work-precision.json -> work-precision.svg: error of u and of the contact impulse against run time, a column a scene."""
import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

STYLE = {
    "bdf2": ("#0b3c5d", "o"), "bdf2-without-jump": ("#1b9e77", "s"), "trapezoid": ("#d95f0e", "D"),
    "central-difference": ("#e6194b", "h"), "trapezoid:rho=0.3": ("#fdae6b", "d"), "moreau-jean": ("#7f7f7f", "X"), "ida-fixed": ("#6aaed6", "."), "ida": ("#2171b5", "^"),
    "sdirk2": ("#dd1c77", "v"), "tr-bdf2": ("#8c6bb1", "<"), "esdirk32": ("#b8860b", ">"), "sdirk54": ("#000000", "p"),
    "GSL msbdf": ("#4d9221", "1"), "GSL msadams": ("#7fbc41", "2"), "GSL rk8pd": ("#c51b7d", "3"),
    "Siconos moreau-jean": ("#7f7f7f", "4"),
}


def style_of(integrator):
    base = integrator.replace(", adaptive", "").replace(":e=0", "")
    colour, marker = STYLE.get(base, ("#444444", "*"))
    dashed = "adaptive" in integrator or base == "ida" or base.startswith(("GSL", "Siconos"))
    line = (":" if dashed else "-.") if ":e=0" in integrator else "--" if dashed else "-"
    return {"color": colour, "marker": marker, "linestyle": line, "markersize": 4.5, "linewidth": 1.1,
            "markerfacecolor": "white" if dashed else colour}


def curves(axes, rows, field, shown):
    for integrator in dict.fromkeys(row["integrator"] for row in rows):
        points = [(row["seconds"], row[field]) for row in rows
                  if row["integrator"] == integrator and row["seconds"] is not None and row[field] is not None and row[field] > 0]
        if points:
            shown.setdefault(integrator, axes.plot(*zip(*points), **style_of(integrator))[0])
    values = [row[field] for row in rows if row["seconds"] is not None and row[field] is not None and row[field] > 0]
    if not values:
        axes.set_visible(False)
        return
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(min(values) / 2, min(2 * max(values), 10))  # what gains energy without end leaves the picture
    axes.grid(which="major", alpha=0.3)


def main(data_file, figure_file):
    with open(data_file) as file:
        data = json.load(file)
    matplotlib.rcParams.update({"svg.hashsalt": "tact", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    scenes = data["scenes"]
    half = (len(scenes) + 1) // 2 if len(scenes) > 4 else len(scenes)
    bands = 2 if len(scenes) > 4 else 1
    figure, grid = plt.subplots(2 * bands, half, figsize=(max(3.6 * half, 9), 5.6 * bands + 1.4), squeeze=False)
    shown = {}
    for axes in grid.flat[:]:
        axes.set_visible(False)
    for k, scene in enumerate(scenes):
        band, column = divmod(k, half)
        rows = [row for row in data["rows"] if row["scene"] == scene["scene"]]
        for offset, (field, label) in enumerate([("error_u", "error of u"), ("error_lambda", "error of the impulse")]):
            axes = grid[2 * band + offset][column]
            axes.set_visible(True)
            curves(axes, rows, field, shown)
            if column == 0:
                axes.set_ylabel(label)
            if offset == 0:
                axes.set_title(f"{scene['scene']}\n{scene['unknowns']} unknowns", fontsize=9.5)
            if offset == 1 or scene["constraints"] == 0:
                axes.set_xlabel("CPU s")
    figure.tight_layout(rect=(0, 0.09 if bands == 2 else 0.16, 1, 0.97))
    figure.legend(list(shown.values()), list(shown), loc="lower center", ncol=6, frameon=False, fontsize=9)
    title = "Error against run time; solid: fixed steps, dashed: adaptive; dotted: with an impact law"
    figure.suptitle(title if data["size"] == "full" else f"{title} ({data['size']} size)", fontsize=11)
    figure.savefig(figure_file, format="svg", metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
