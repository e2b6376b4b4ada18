#!/usr/bin/env python3
"""README.md: its first use is the program that tests/packaging builds and runs, and its links point at files."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def main():
    text = (ROOT / "README.md").read_text()
    program = (ROOT / "tests/packaging/first_use.cpp").read_text()
    body = program[program.index("    // Three masses"):program.rindex("    return")]
    shown = "\n".join(line[4:] for line in body.rstrip().splitlines())
    wrong = []
    if shown not in text:
        wrong.append("README.md: the first use is not that of tests/packaging/first_use.cpp")
    for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text) + re.findall(r'src="([^":]+)"', text):
        if not (ROOT / target).exists():
            wrong.append(f"README.md: no such file: {target}")
    print("\n".join(wrong), end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
