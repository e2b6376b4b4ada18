"""cmake/public_headers.txt names the headers that are installed: each is there, and includes none that is not."""
import posixpath
import re
import sys

from sources import ROOT

LIST = "cmake/public_headers.txt"


def problems(public, text_of):
    found = [f"{LIST}: the names are not in order"] if public != sorted(set(public)) else []
    for header in public:
        text = text_of(header)
        if text is None:
            found.append(f"{LIST}: {header}: no such file")
            continue
        for name in re.findall(r'^[ \t]*#[ \t]*include[ \t]*"([^"]+)"', text, re.MULTILINE):
            included = posixpath.normpath(posixpath.join(posixpath.dirname(header), name))
            if included not in public:
                found.append(f"{header} is installed and includes {included}, which is not")
    return found


def self_check():
    files = {"lib/a.hpp": '#include "b.hpp"\n', "lib/b.hpp": ""}
    right, wrong = ["lib/a.hpp", "lib/b.hpp"], (["lib/a.hpp"], ["lib/b.hpp", "lib/c.hpp"], ["lib/b.hpp", "lib/a.hpp"])
    return problems(right, files.get) or [f"self-check: {w} was let pass" for w in wrong if not problems(w, files.get)]


def read(header):
    file = ROOT / header
    return file.read_text() if file.is_file() else None


if __name__ == "__main__":
    public = (ROOT / LIST).read_text().split()
    failures = self_check() + problems(public, read)
    print("\n".join(failures), end="\n" if failures else "")
    sys.exit(bool(failures))
