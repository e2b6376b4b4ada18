"""results/*.json and *.svg -> index.html: one page without a network, read from the json files alone."""
import json
import re
import sys
from pathlib import Path

from page_format import between, escape, in_norm, number, percent, root, seconds, share, table, times  # noqa: F401

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
th { font-weight: 600; text-align: right; color: var(--soft); white-space: normal; min-width: 4.2rem; vertical-align: bottom; }
th:first-child, td:first-child { text-align: left; }
td.text { text-align: left; white-space: normal; min-width: 14rem; }
.yes { color: #17803d; font-weight: 600; } .no { color: #b2182b; font-weight: 600; } .differs { color: #a15c00; font-weight: 600; }
@media print { body { max-width: none; font-size: 9.5pt; } details { display: none; } h2 { break-after: avoid; } figure { break-inside: avoid; } nav { display: none; } }
@media (max-width: 40rem) { body { padding: 1rem .8rem 3rem; } .figure { overflow-x: auto; } .figure svg { min-width: 36rem; } }
"""


SQUARED = "squared, as the paper prints it, %"
# What a field of a json file says of an error: of what, in which norm. All against the full run of the same grid and steps, but
# tradeoff's, which are against a finer reference.
HEADINGS = {
    "relative_error_percent": f"worst error of u, {SQUARED}", "median_relative_error_percent": f"median error of u, {SQUARED}",
    "relative_error_norm": "worst error of u in the norm, a fraction", "worst_error_norm": "worst error of u in the norm, a fraction",
    "worst_error_percent": f"worst error of u, {SQUARED}", "median_error_percent": f"median error of u, {SQUARED}",
    "singular_vectors_error_percent": f"error of u by singular vectors, {SQUARED}",
    "error_percent": f"error of u, {SQUARED}", "error_min": f"least error, {SQUARED}", "error_max": f"largest error, {SQUARED}",
    "error_median": f"median error, {SQUARED}", "error_norm_percent": "error of u in the norm, %",
    "own_error_percent": f"distance of u to a reference half as fine, {SQUARED}",
    "distance_percent": f"distance of u to the nearest, {SQUARED}", "change_percent": f"change of u, {SQUARED}",
    "percent": f"errors of u, {SQUARED}", "geometric_mean_percent": f"geometric mean of the errors, {SQUARED}",
    "over_bdf2": "over BDF2's, squared, as the paper prints it",
}
HEADINGS_OF = {("online", "error_percent"): "largest error of u at a step, in the norm, %",
               ("omission", "over_percent"): "CPU time over the baseline's, %", ("omission", "asked_percent"): "asked for at most, %"}


def all_fields(study, rows):
    fields = list(dict.fromkeys(field for row in rows for field in row))
    heading = {field: HEADINGS_OF.get((study, field), HEADINGS.get(field, field.replace("_", " "))) for field in fields}
    return [(heading[field], lambda row, field=field: row.get(field)) for field in fields]


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
            out.append(table(value, all_fields(study, value)))
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


OURS, PAPERS = "ours", "the paper's"
ERROR = "worst relative error of u in the Euclidean norm over all nodes and steps, against the full run on the same grid with the same steps"


def speedups(results, method):
    return [row for row in results.rows("speedup") if row["method"] == method]


def reduced_answer(results):
    rows = speedups(results, OURS) or speedups(results, PAPERS)
    if not rows:
        return None
    parts = [f"{row['scene']}: {seconds(row['reduced_seconds_per_step'])} {'a query' if row['steps'] == 1 else 'a step'}, "
             f"{share(row['relative_error_norm'])}{' of the run it was trained on' if not row['worst_parameter'] else ''}" for row in rows]
    ipopt = [row["speedup_vs_interior_point"] for row in rows if row["speedup_vs_interior_point"]]
    against = f"{between(ipopt, times)} times faster than interior point, " if ipopt else ""
    return (f"<b>Reduced models answer in microseconds</b> ({'; '.join(parts)}; {ERROR}): {against}"
            f"{between([row['speedup'] for row in rows], times)} times faster than our own fastest full solver on the same grid.")


def named(row):
    """A model of the trade-off study in words."""
    steps = f" with {row['integrator']}, dt = {number(row['dt'])}" if row["dt"] else ""
    return f"{row['n']} × {row['n']} nodes{steps}"


def rival_answer(results):
    """A coarse full model that is as good for about the time of the reduced one."""
    parts = []
    for rival in results.rows("tradeoff", "rivals"):
        full, reduced = rival["full"], rival["reduced"]
        if not full or full["seconds"] > 2 * reduced["seconds"]:
            continue
        parts.append(f"{rival['scene']}: the full model on {named(full)} takes {seconds(full['seconds'])} and is "
                     f"{percent(full['error_norm_percent'])} off; the reduced one (p = {reduced['p']}, {reduced['integrator']}) takes "
                     f"{seconds(reduced['seconds'])} and is {percent(reduced['error_norm_percent'])} off, and the full run that it learnt from "
                     f"{percent(rival['training_model']['error_norm_percent'])}")
    if not parts:
        return None
    return (f"<b>A coarse full run can be as good for the same time</b>: {'; '.join(parts)} (relative errors of u in the Euclidean norm "
            "over common nodes and times, against a finer full run).")


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


def is_silent(row):
    """It gains energy or penetrates by more than the study's measures, and ended well without a message."""
    return row["judgement"] in ("gains energy", "penetrates") and row["outcome"] == "converged" and not row["message"]


def stability_answer(results):
    rows = results.rows("stability")
    if not rows:
        return None
    count = {}
    for row in rows:
        count[row["judgement"]] = count.get(row["judgement"], 0) + 1
    said = ", ".join(f"{n} {name}" for name, n in sorted(count.items(), key=lambda item: -item[1]))
    silent = derived(results)["stability", "silent_runs"]
    return (f"<b>Stability</b>: {len(rows)} runs of {len({row['integrator'] for row in rows})} integrators on "
            f"{len({row['case'] for row in rows})} hard cases: {said} (right: ended, finite, every step certified, no energy gained, no penetration). {silent} of them gain more energy than 1e-6 of its scale or penetrate by "
            "more than 1e-9 of |B||u| + |c|, and end <code>converged</code> without a message.")


def derived(results):
    """Figures that are counted in a study, not written in it, by study and name: for this page and for README."""
    rows = results.rows("stability")
    return {("stability", "runs"): len(rows), ("stability", "silent_runs"): sum(map(is_silent, rows))}


def omission_answer(results):
    costs = results.rows("omission", "costs")
    if not costs:
        return None
    return "<b>CPU time that a scene pays for parts it does not use</b>: " + "; ".join(
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
            rows.append({"claim": f"Table I, {row['scene']}, bases by {'our' if row['method'] == OURS else PAPERS} method: online "
                                  "speed-up against an interior-point full model",
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
               "our figure is more than a factor of two from the paper's. Errors and ratios of errors in this table are as the paper prints them, "
               "squared (eqs. 16 and 17).</p>")
    return "".join(out)


def speedup_table(results):
    load = results.data.get("speedup", {}).get("load_average")
    note = "" if load is None else f" Load average of the machine at the end: {number(load, 2)}" + (
        ": other processes ran beside it." if load > 1.5 else ".")
    return table(results.rows("speedup"), [
        ("scene", lambda row: row["scene"]),
        ("method", lambda row: row["method"]),
        ("unknowns", lambda row: row["unknowns"]),
        ("p / p_lambda", lambda row: f"{row['p']} / {row['p_lambda']}"),
        ("full run", lambda row: seconds(row["full_seconds"])),
        ("interior point", lambda row: seconds(row["interior_point_seconds"])),
        ("reduced run", lambda row: seconds(row["reduced_seconds"])),
        ("against interior point", lambda row: times(row["speedup_vs_interior_point"])),
        ("the paper prints", lambda row: row["paper_speedup"]),
        ("against our fastest", lambda row: times(row["speedup"])),
        ("worst error in the norm", lambda row: share(row["relative_error_norm"])),
        ("squared, as the paper prints it", lambda row: percent(row["relative_error_percent"]))]) + (
            f"<p class=soft>Method: <i>the paper's</i> has its bases at its sizes (POD and NNMF, p = p_lambda; in statics the snapshots "
            f"themselves), <i>ours</i> contact at selected rows and more modes. Error in the norm: {ERROR}, at parameters outside the training "
            f"sets (two plates: of the run they were trained on). Its square is eq. 16 or 17. CPU times of one thread.{note}</p>")


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
    answers = [line for line in (reduced_answer(results), rival_answer(results), full_answer(results), precision_answer(results), stability_answer(results),
                                 omission_answer(results)) if line]
    small = [study for study, data in results.data.items() if data.get("size") != "full"]
    note = f"<p class=soft>Not at full size: {', '.join(small)}.</p>" if small else ""
    figure = results.figure
    precision = table(precision_rows(results), [
        ("scene", lambda row: row["scene"]), ("BDF2's least error of u, norm of M, a fraction of the reference", lambda row: row["error"]), ("BDF2", lambda row: seconds(row["bdf2"])),
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
         figure("tradeoff", "Full models over grid and step, reduced models over p: relative error of u in the norm against one finer full run.") +
         precision + figure("work-precision", "Every integrator, over its steps or tolerances.") +
         figure("bases", "Every dual basis: worst relative error of u in the norm against the full run of the same grid and steps; dotted the front.") +
         figure("online", "Stored models: what a query costs, and error estimate and bound over the true error.") +
         figure("training", "What training costs, and from how many queries on it pays.")),
        ("stability", "Stability on stiff and extreme cases",
         figure("stability", "Every integrator on every case: right, ended with a message, or what goes wrong. Right: ended, finite, every step certified, no "
                "energy gained, no penetration, by the measures in stability.md.")),
        ("left-out", "What is left out",
         figure("omission", "What each scene uses and leaves out, and what the parts left out would have cost.") +
         figure("growth", "Time and memory as the problem grows.") +
         figure("solvers", "Every contact strategy and its peers on the same matrices.")),
        ("paper", "The paper's figures and claims", claims_table(claims(results)) +
         figure("greedy", "Figures 3 and 6: worst relative error of u in the norm, against full runs, over greedy iterations.") +
         figure("histories", "Figures 4, 5, 7, 8, 9, 11 and 12: full, reduced, and a dual basis by singular vectors.") +
         figure("downsampling", "Figure 13: relative error of u in the norm, against the training run, over the share of snapshots kept.")),
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
