"""results/*.json and *.svg -> index.html: one page without a network, read from the json files alone."""
import html
import json
import re
import sys
from pathlib import Path

STYLE = """
:root { --ink: #1c1c1c; --soft: #5d6570; --line: #d9dde2; --mark: #1b6ca8; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 70rem; padding: 1.5rem 1rem 4rem; color: var(--ink); background: #fff;
  font: 1rem/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0 0 .3rem; }
h2 { font-size: 1.25rem; margin: 2.6rem 0 .6rem; padding-top: .6rem; border-top: 2px solid var(--line); }
h3 { font-size: 1.02rem; margin: 1.6rem 0 .3rem; }
p, ol, blockquote { max-width: 48rem; }
blockquote { margin: .8rem 0; padding: .2rem 1rem; border-left: 3px solid var(--mark); }
nav a { margin-right: 1rem; white-space: nowrap; }
a { color: var(--mark); }
figure { margin: .8rem 0; }
figure svg { width: 100%; height: auto; display: block; }
figcaption, .soft { color: var(--soft); font-size: .88rem; }
details { margin: .4rem 0 1rem; }
summary { cursor: pointer; color: var(--mark); font-size: .9rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .84rem; font-variant-numeric: tabular-nums; margin: .5rem 0; }
th, td { text-align: right; padding: .22rem .55rem; border-bottom: 1px solid var(--line); white-space: nowrap; vertical-align: top; }
th { font-weight: 600; text-align: right; color: var(--soft); }
th:first-child, td:first-child { text-align: left; }
td.text { text-align: left; white-space: normal; min-width: 14rem; }
.yes { color: #17803d; font-weight: 600; } .no { color: #b2182b; font-weight: 600; } .differs { color: #a15c00; font-weight: 600; }
@media print { body { max-width: none; font-size: 9.5pt; } details { display: none; } h2 { break-after: avoid; } figure { break-inside: avoid; } nav { display: none; } }
@media (max-width: 40rem) { body { padding: 1rem .8rem 3rem; } .figure { overflow-x: auto; } .figure svg { min-width: 36rem; } }
"""


def number(value, digits=3):
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (list, tuple)):
        return ", ".join(number(each, digits) for each in value)
    if isinstance(value, dict):
        return ", ".join(f"{key}: {number(each, digits)}" for key, each in value.items())
    if not isinstance(value, (int, float)):
        return str(value)
    if isinstance(value, int) or (abs(value) >= 10**digits and abs(value) < 1e8):
        return f"{value:,.0f}".replace(",", "\u2009") if abs(value) >= 1e4 else f"{value:.0f}"
    return f"{value:.{digits}g}"


def seconds(value):
    if value is None:
        return "–"
    for size, unit in ((1, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if value >= size:
            return f"{number(value / size)} {unit}"
    return f"{number(value / 1e-9)} ns"


def times(value):
    """A ratio to two digits."""
    if value is None:
        return "–"
    return number(float(f"{value:.2g}"))


def percent(value):
    return f"{number(value, 2)} %"


def escape(text):
    return html.escape(str(text))


def table(rows, columns):
    """columns: (heading, function of a row); text longer than a number stands to the left."""
    out = ["<div class=wide><table><thead><tr>", *(f"<th>{escape(name)}</th>" for name, _ in columns), "</tr></thead><tbody>"]
    for row in rows:
        out.append("<tr>")
        for _, get in columns:
            cell = get(row)
            text = escape(cell if isinstance(cell, str) else number(cell))
            out.append(f"<td class=text>{text}</td>" if isinstance(cell, str) and len(cell) > 28 else f"<td>{text}</td>")
        out.append("</tr>")
    out.append("</tbody></table></div>")
    return "".join(out)


def all_fields(rows):
    fields = list(dict.fromkeys(field for row in rows for field in row))
    return [(field.replace("_", " "), lambda row, field=field: row.get(field)) for field in fields]


class Results:
    def __init__(self, folder):
        self.folder = Path(folder)
        self.data = {}
        for file in sorted(self.folder.glob("*.json")):
            with open(file) as text:
                data = json.load(text)
            if isinstance(data, dict) and "study" in data:
                self.data[data["study"]] = data

    def rows(self, study, key="rows"):
        return self.data.get(study, {}).get(key, [])

    def figure(self, study, caption):
        """The figure, and one click away its data and the file they came from."""
        if study not in self.data:
            return f"<p class=soft>{study}: not run; <code>tact-bench all --only {study}</code>.</p>"
        data = self.data[study]
        out = [f"<figure id={study}>"]
        svg = self.folder / f"{study}.svg"
        if svg.exists():
            out.append(f"<div class=figure>{inline(svg.read_text(), study)}</div>")
        out.append(f"<figcaption>{caption}</figcaption></figure>")
        tables = [(key, value) for key, value in data.items() if isinstance(value, list) and value and isinstance(value[0], dict)]
        source = f'<a href="{study}.json">{study}.json</a>'
        if (self.folder / f"{study}.md").exists():
            source += f', <a href="{study}.md">{study}.md</a>'
        size = "" if data.get("size") == "full" else f"; {data.get('size')} size"
        out.append(f"<details><summary>The data ({sum(len(value) for _, value in tables)} rows)</summary>")
        out.append(f"<p class=soft>From {source}; {escape(data['machine']['date'])}{size}.</p>")
        for key, value in tables:
            if len(tables) > 1:
                out.append(f"<h3>{escape(key.replace('_', ' '))}</h3>")
            out.append(table(value, all_fields(value)))
        out.append("</details>")
        return "".join(out)


def inline(svg, prefix):
    """The element alone, its ids made the figure's own: several figures share a page."""
    svg = svg[svg.index("<svg"):]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.S)
    svg = re.sub(r'\bid="([^"]+)"', rf'id="{prefix}-\1"', svg)
    svg = re.sub(r'href="#([^"]+)"', rf'href="#{prefix}-\1"', svg)
    svg = re.sub(r"url\(#([^)]+)\)", rf"url(#{prefix}-\1)", svg)
    return re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", svg, count=1), count=1)


def between(values, show):
    low, high = show(min(values)), show(max(values))
    return low if low == high else f"{low} to {high}"


def reduced_answer(results):
    rows = results.rows("speedup")
    if not rows:
        return None
    parts = [f"{row['scene']}: {seconds(row['reduced_seconds_per_step'])} {'a query' if row['steps'] == 1 else 'a step'}, "
             f"worst error {percent(row['relative_error_percent'])}" for row in rows]
    ipopt = [row["speedup_vs_interior_point"] for row in rows if row["speedup_vs_interior_point"]]
    against = f"{between(ipopt, times)} times faster than interior point, " if ipopt else ""
    return (f"<b>Reduced models answer in microseconds</b> ({'; '.join(parts)}): {against}{between([row['speedup'] for row in rows], times)} "
            "times faster than our own fastest full solver.")


def full_answer(results):
    problems = {}
    for row in results.rows("solvers"):
        entry = problems.setdefault(row["problem"], {})
        if row["solver"] == "chooser":
            entry["own"] = row
        elif row["peer"] and row.get("outcome", "converged") == "converged" and row["seconds_median"]:
            if "peer" not in entry or row["seconds_median"] < entry["peer"]["seconds_median"]:
                entry["peer"] = row
    both = [entry for entry in problems.values() if "own" in entry and "peer" in entry]
    if not both:
        return None
    ratios = [entry["peer"]["seconds_median"] / entry["own"]["seconds_median"] for entry in both]
    ahead = sum(ratio < 1 for ratio in ratios)
    kkt = max(entry["own"]["kkt_residual"] for entry in both)
    return (f"<b>Full contact solves</b> are {between(ratios, times)} times faster than the best peer on the same matrices"
            f"{f'; a peer is ahead on {ahead} of {len(both)} problems' if ahead else ''}, each with its KKT residual (worst {number(kkt, 2)}).")


def cheapest(rows, error):
    """Per integrator the least time of a run at least that accurate."""
    best = {}
    for row in rows:
        if row["seconds"] and row["error_u"] is not None and row["error_u"] <= error:
            if row["integrator"] not in best or row["seconds"] < best[row["integrator"]]:
                best[row["integrator"]] = row["seconds"]
    return best


def precision_rows(results):
    out = []
    for scene in results.rows("work-precision", "scenes"):
        rows = [row for row in results.rows("work-precision") if row["scene"] == scene["scene"]]
        errors = [row["error_u"] for row in rows if row["integrator"] == "bdf2" and row["seconds"] and row["error_u"]]
        if not errors:
            continue
        error = min(errors)
        best = cheapest(rows, error)
        first = min(best, key=best.get)
        out.append({"scene": scene["scene"], "error": error, "bdf2": best["bdf2"], "integrator": first, "seconds": best[first],
                    "ratio": best["bdf2"] / best[first]})
    return out


def precision_answer(results):
    rows = precision_rows(results)
    if not rows:
        return None
    winners = {}
    for row in rows:
        winners.setdefault(row["integrator"], []).append(row["scene"])
    named = "; ".join(f"{escape(name)} ({', '.join(scenes)})" for name, scenes in sorted(winners.items(), key=lambda item: -len(item[1])))
    return (f"<b>Error against run time</b>: to the least error plain BDF2 reaches, the fastest integrators are {named}, "
            f"{between([row['ratio'] for row in rows], times)} times faster than it.")


def stability_answer(results):
    rows = results.rows("stability")
    if not rows:
        return None
    count = {}
    for row in rows:
        count[row["judgement"]] = count.get(row["judgement"], 0) + 1
    wrong = count.pop("wrong", 0)
    said = ", ".join(f"{n} {name}" for name, n in sorted(count.items(), key=lambda item: -item[1]))
    return (f"<b>Stability</b>: {len(rows)} runs of {len({row['integrator'] for row in rows})} integrators on "
            f"{len({row['case'] for row in rows})} hard cases: {said}; {wrong} wrong without saying so.")


def omission_answer(results):
    costs = results.rows("omission", "costs")
    if not costs:
        return None
    return "<b>What a scene does not need it does not pay for</b>: " + "; ".join(
        f"{escape(row['what'])}: {escape(row['said'])}" for row in costs[:4]) + "."


def verdict(claim):
    """yes, no, or differs: it holds, but with a figure of ours more than a factor of two from the paper's."""
    if not claim.get("holds"):
        return "no" if claim.get("holds") is False else "differs"
    try:
        ratio = float(claim["figure"]) / float(claim["paper"])
    except (KeyError, TypeError, ValueError, ZeroDivisionError):
        return "yes"  # the paper gives no number
    return "yes" if 0.5 <= ratio <= 2 else "differs"


def claims(results):
    rows = []
    for row in results.rows("speedup"):
        if row["speedup_vs_interior_point"]:
            ours = row["speedup_vs_interior_point"]
            rows.append({"claim": f"Table I, {row['scene']}: online speed-up against an interior-point full model",
                         "paper": number(row["paper_speedup"], 4), "ours": times(ours),
                         "reproduced": "yes" if ours >= row["paper_speedup"] else "no", "study": "speedup"})
    for study, data in results.data.items():
        for claim in data.get("claims", []):
            scene = f"{claim['scene']}: " if "scene" in claim else ""
            rows.append({"claim": scene + claim["claim"], "paper": claim.get("paper"), "ours": claim.get("ours", claim.get("figure")),
                         "reproduced": verdict(claim), "study": study})
    return rows


def claims_table(rows):
    if not rows:
        return "<p class=soft>No study of the paper's figures was run.</p>"
    out = ["<div class=wide><table><thead><tr><th>the paper's claim</th><th>paper</th><th>here</th><th>reproduced</th><th>study</th></tr></thead><tbody>"]
    for row in rows:
        kind = row["reproduced"] if row["reproduced"] in ("yes", "no", "differs") else "differs"
        out.append(f"<tr><td class=text>{escape(row['claim'])}</td><td class=text>{escape(number(row['paper']))}</td>"
                   f"<td class=text>{escape(number(row['ours']))}</td><td class={kind}>{escape(row['reproduced'])}</td>"
                   f'<td><a href="#{row["study"]}">{row["study"]}</a></td></tr>')
    out.append("</tbody></table></div><p class=soft>Judged from the studies' own figures. <i>differs</i>: what is claimed holds, but "
               "our figure is more than a factor of two from the paper's.</p>")
    return "".join(out)


def speedup_table(results):
    return table(results.rows("speedup"), [
        ("scene", lambda row: row["scene"]),
        ("unknowns", lambda row: row["unknowns"]),
        ("p / p_lambda", lambda row: f"{row['p']} / {row['p_lambda']}"),
        ("full run", lambda row: seconds(row["full_seconds"])),
        ("interior point", lambda row: seconds(row["interior_point_seconds"])),
        ("reduced run", lambda row: seconds(row["reduced_seconds"])),
        ("speed-up", lambda row: times(row["speedup"])),
        ("vs interior point", lambda row: times(row["speedup_vs_interior_point"])),
        ("the paper's", lambda row: row["paper_speedup"]),
        ("worst error", lambda row: percent(row["relative_error_percent"])),
        ("KKT, reduced", lambda row: row["max_kkt_residual_reduced"])])


def machine_section(results):
    machines = {}
    for study, data in results.data.items():
        machine = data["machine"]
        key = (machine["cpu"], machine["compiler"], machine["flags"])
        machines.setdefault(key, (machine, []))[1].append(f"{study} ({machine['date'][:10]})")
    out = []
    for machine, studies in machines.values():
        libraries = ", ".join(f"{name} {version}" for name, version in machine["libraries"].items())
        out.append(f"<p>{escape(machine['cpu'])}, {machine['cores']} cores, {machine['threads_used']} used unless said; "
                   f"{escape(machine['compiler'])} <code>{escape(machine['flags'])}</code>; {escape(libraries)}.<br>"
                   f"<span class=soft>{escape(', '.join(studies))}</span></p>")
    return "".join(out)


def page(results):
    answers = [line for line in (reduced_answer(results), full_answer(results), precision_answer(results), stability_answer(results),
                                 omission_answer(results)) if line]
    small = [study for study, data in results.data.items() if data.get("size") != "full"]
    note = f"<p class=soft>Not at full size: {', '.join(small)}.</p>" if small else ""
    figure = results.figure
    precision = table(precision_rows(results), [
        ("scene", lambda row: row["scene"]), ("BDF2's least error", lambda row: row["error"]), ("BDF2", lambda row: seconds(row["bdf2"])),
        ("fastest to it", lambda row: row["integrator"]), ("its time", lambda row: seconds(row["seconds"])),
        ("times faster", lambda row: times(row["ratio"]))])
    sections = [
        ("asked", "What was asked", "<blockquote>Report error against run time, check numerical stability on stiff and extreme cases, and leave "
         "out what a given scene does not need.</blockquote><p>Time-dependent contact, full and reduced, as in M. Balajewicz, D. Amsallem, "
         "C. Farhat, <i>Projection-based model reduction for contact problems</i>. Times are CPU times of one thread unless said.</p>"),
        ("answer", "The answer", "<ol>" + "".join(f"<li>{line}</li>" for line in answers) + "</ol>" + note),
        ("table-1", "Table I: speed-ups of the reduced models", speedup_table(results) +
         figure("speedup", "Online speed-ups against our fastest full solver, KLU refactorisation and interior point, beside the paper's.")),
        ("error-time", "Error against run time",
         figure("tradeoff", "Full models over grid and step, reduced models over p, against one fine reference.") +
         precision + figure("work-precision", "Every integrator, over its steps or tolerances.") +
         figure("bases", "Every dual basis; dotted the front of error against online time.") +
         figure("online", "Stored models: what a query costs and how far it can be trusted.") +
         figure("training", "What training costs, and from how many queries on it pays.")),
        ("stability", "Stability on stiff and extreme cases",
         figure("stability", "Every integrator on every case: right, or honestly ended, or what goes wrong.")),
        ("left-out", "What is left out",
         figure("omission", "What each scene uses and leaves out, and what the parts left out would have cost.") +
         figure("growth", "Time and memory as the problem grows.") +
         figure("solvers", "Every contact strategy and its peers on the same matrices.")),
        ("paper", "The paper's figures and claims", claims_table(claims(results)) +
         figure("greedy", "Figures 3 and 6: worst test error against greedy iterations.") +
         figure("histories", "Figures 4, 5, 7, 8, 9, 11 and 12: full, reduced, and a dual basis by singular vectors.") +
         figure("downsampling", "Figure 13: error against the share of snapshots kept.")),
        ("machine", "Machine and versions", machine_section(results)),
    ]
    navigation = "".join(f'<a href="#{key}-section">{title}</a> ' for key, title, _ in sections)
    body = "".join(f"<section><h2 id={key}-section>{title}</h2>{content}</section>" for key, title, content in sections)
    return (f"<!doctype html><html lang=en><head><meta charset=utf-8><meta name=viewport content='width=device-width, initial-scale=1'>"
            f"<title>tact: results</title><link rel=icon href='data:,'><style>{STYLE}</style></head><body><header><h1>tact: error against run time, "
            f"stability, and what a scene leaves out</h1><nav>{navigation}</nav></header><main>{body}</main></body></html>\n")


def main(folder, file):
    results = Results(folder)
    if not results.data:
        sys.exit(f"{folder}: no studies")
    Path(file).write_text(page(results))


if __name__ == "__main__":
    main(*sys.argv[1:3])
