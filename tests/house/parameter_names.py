#!/usr/bin/env python3
"""Tests with parameters print them by name: a struct of ours in TestWithParam<...> has a PrintTo, else ctest shows its bytes."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def main():
    text = "".join(path.read_text() for path in sorted((ROOT / "tests").rglob("*.[ch]pp")))
    used = set(re.findall(r"\b(?:TestWithParam|WithParamInterface)<(?:\w+::)*([A-Z]\w*)>", text))
    printed = set(re.findall(r"\bPrintTo\(const (?:\w+::)*(\w+)&", text))
    wrong = [f"tests: {name} is a test's parameter and has no PrintTo" for name in sorted(used - printed)]
    if not used:
        wrong.append("tests: no tests with parameters found: this check reads nothing")
    print("\n".join(wrong), end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
