#!/usr/bin/env python3
"""An error in per cent says which norm it is in and what it is against; a square stands only under the words "as the paper prints it".

Reads README.md, docs/*.md and the pages and figures that the studies make. A block is what stands between blank lines; code blocks
and the invisible marks of figures are no text."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SAID_NO_MORE = ("wrong without saying so", "does not need it does not pay")
SQUARED = "as the paper prints it"
# Of a table's heading or an axis: an error, in per cent.
PERCENT_OF_ERROR = re.compile(r"(?=.*\b(errors?|distance|change)\b)(?=.*%)", re.IGNORECASE)


def blocks(text):
    text = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    text = re.sub(r"<!--.*?-->", "", text)
    return [block for block in re.split(r"\n\s*\n", text) if block.strip()]


def faults_of_text(name, text):
    """Written by hand: a block that gives errors in per cent, together with the one that follows or precedes it (a table and
    what is said of it)."""
    faults = []
    parts = blocks(text)
    for k, block in enumerate(parts):
        if not (re.search(r"\d\s*%|in %", block) and re.search(r"\berrors?\b|\boff\b", block)):
            continue
        around = " ".join(parts[max(k - 1, 0):k + 2] if block.lstrip().startswith("|") else [block])
        for word in ("norm", "against"):
            if word not in around:
                faults.append(f"{name}: an error in per cent without '{word}': {' '.join(block.split())[:90]}")
    return faults


def faults_of_tables(name, text):
    """Made by a study: every heading of an error in per cent names its norm or says that it is squared."""
    faults = []
    lines = text.splitlines()
    for heading, rule in zip(lines, lines[1:]):
        if not (heading.startswith("|") and re.fullmatch(r"[|:\- ]+", rule) and "-" in rule):
            continue
        for cell in heading.split("|"):
            if PERCENT_OF_ERROR.match(cell) and "norm" not in cell and SQUARED not in cell:
                faults.append(f"{name}: the heading '{cell.strip()}' names no norm")
    return faults


def faults_of_figure(name, text):
    faults = []
    for label in re.findall(r"set_[xy]label\((.*?)\)\n", text, flags=re.DOTALL):
        if PERCENT_OF_ERROR.match(label.replace("\n", " ")) and not ("norm" in label and "against" in label):
            faults.append(f"{name}: the axis {label[:70]} names no norm, or not what the error is against")
    return faults


def faults(name, text):
    found = [f"{name}: says '{phrase}'" for phrase in SAID_NO_MORE if phrase in text]
    if name.endswith(".py"):
        return found + (faults_of_figure(name, text) if name.endswith("figure.py") else [])
    if name.startswith("docs/results/"):
        return found + (faults_of_tables(name, text) if name.endswith(".md") else [])
    return found + faults_of_text(name, text) + faults_of_tables(name, text)


def planted():
    """Faults that must be found, and texts without one."""
    bad = [("README.md", "The reduced run has 0.03 % error."), ("docs/a.md", "It is 3 % off in the norm."),
           ("docs/a.md", "| p | worst error, % |\n|---|--:|\n| 1 | 2 |"), ("docs/results/a.md", "| error, % | x |\n|--|--|"),
           ("bench/studies/a/figure.py", 'axes.set_ylabel("worst error, % (eqs. 16, 17)")\n'),
           ("docs/results/index.html", "0 wrong without saying so")]
    good = [("README.md", "It is 1.8 % off in the Euclidean norm against the full run."), ("README.md", "It takes 20 % of the time."),
            ("docs/results/a.md", "| error in the norm, % | squared, as the paper prints it, % | error u |\n|--|--|--|"),
            ("bench/studies/a/figure.py", 'axes.set_ylabel("error in the norm, %, against a finer run")\n')]
    return [f"planted fault not found: {text}" for name, text in bad if not faults(name, text)] + [
        f"found where there is none: {text}: {faults(name, text)}" for name, text in good if faults(name, text)]


def main():
    files = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), *sorted((ROOT / "docs/results").glob("*.md")),
             ROOT / "docs/results/index.html", ROOT / "bench/harness/index.py", *sorted((ROOT / "bench/studies").glob("*/figure.py"))]
    wrong = planted()
    for file in files:
        wrong += faults(file.relative_to(ROOT).as_posix(), file.read_text())
    print("\n".join(wrong), end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
