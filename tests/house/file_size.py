"""A file that has outgrown its one subject is split."""
import sys

from sources import ROOT, sources

LIMIT = 450

if __name__ == "__main__":
    sizes = {file: len(file.read_text().splitlines()) for file in sources(suffixes=(".hpp", ".cpp", ".py"))}
    long = [f"{file.relative_to(ROOT)}: {lines} lines, at most {LIMIT}" for file, lines in sizes.items() if lines > LIMIT]
    print("\n".join(long) or f"{len(sizes)} files, none over {LIMIT} lines")
    sys.exit(bool(long))
