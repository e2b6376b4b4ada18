#!/usr/bin/env python3
"""Figures in README.md and docs/*.md are those of docs/results/*.json. With --write they are made so.

A figure stands as <!--= STUDY PATH FORMAT -->text<!--/-->: PATH leads through the json (rows.0.speedup) or names a figure of
derived() in bench/harness/index.py, FORMAT is a function there: number, seconds, times, percent, share (of a fraction),
in_norm (of a squared error), root (of a ratio of squared errors)."""
import functools
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench/harness"))
sys.dont_write_bytecode = True
import index  # noqa: E402

FIGURE = re.compile(r"<!--= (\S+) (\S+) (\S+) -->(.*?)<!--/-->")
FORMATS = {name: getattr(index, name) for name in ("number", "seconds", "times", "percent", "share", "in_norm", "root")}


@functools.cache
def results():
    return index.Results(ROOT / "docs/results")


@functools.cache
def counted():
    return index.derived(results())


def value(study, path):
    if (study, path) in counted():
        return counted()[study, path]
    at = results().data[study]
    for step in path.split("."):
        at = at[int(step)] if isinstance(at, list) else at[step]
    return at


def main(arguments):
    wrong = []
    for file in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        text = file.read_text()

        def made(match):
            study, path, form, shown = match.groups()
            right = FORMATS[form](value(study, path))
            if shown != right:
                wrong.append(f"{file.name}: {study} {path} is {right}, the text says {shown}; tests/house/numbers.py --write")
            return f"<!--= {study} {path} {form} -->{right}<!--/-->"

        new = FIGURE.sub(made, text)
        if "--write" in arguments and new != text:
            file.write_text(new)
    if wrong and "--write" not in arguments:
        print("\n".join(wrong))
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
