"""Who may include whom. Reads every #include of the project, then plants violations to see that it would find them."""
import posixpath
import re
import sys
import tempfile
from pathlib import Path

from sources import ROOT, sources

# Folder -> component, innermost first.
COMPONENTS = {
    "lib/scenes": "scenes", "lib/io": "io", "lib/sparse": "sparse", "lib": "core",
    "contact/dense": "contact_dense", "contact": "contact",
    "integrators/sundials": "integrators_sundials", "integrators": "integrators",
    "rom/model": "rom", "rom/bases": "rom_bases", "rom/error": "rom_error", "rom/file": "rom_file", "rom/greedy": "rom_greedy",
    "door": "tact", "tact.hpp": "tact", "bench": "bench", "tests": "tests", "python": "python", "examples": "examples",
}
LIB = {"core", "scenes", "io", "sparse"}
# What a component may include of the project. Its CMakeLists.txt may narrow this, not widen it.
MAY_INCLUDE = {
    "core": {"core"}, "scenes": {"core", "scenes"}, "io": {"core", "io"}, "sparse": {"core", "sparse"},
    "contact_dense": {"core", "contact_dense"}, "contact": LIB | {"contact", "contact_dense"},
    "integrators": LIB | {"integrators"}, "integrators_sundials": LIB | {"integrators", "integrators_sundials"},
    "rom": LIB | {"rom"}, "rom_bases": LIB | {"rom", "rom_bases"}, "rom_error": LIB | {"rom", "rom_error"},
    "rom_file": LIB | {"rom", "rom_file"}, "rom_greedy": LIB | {"rom", "rom_bases", "rom_error", "rom_greedy"},
    "tact": LIB | {"contact_dense", "contact", "integrators", "integrators_sundials", "rom", "rom_bases", "rom_error", "rom_file",
                   "rom_greedy", "tact"},
}
OUTER = {"bench", "python", "examples"}

# Library -> (its headers, the files that may include them). Tests may include any.
OWNERS = {
    "SUNDIALS": (r"(sundials|nvector|sunmatrix|sunlinsol|sunnonlinsol|sunmemory|idas?|cvodes?|arkode|kinsol)/",
                 r"integrators/sundials/[^/]+$"),
    "SuiteSparse": (r"(suitesparse/|(klu|cholmod|amd|camd|colamd|ccolamd|btf|umfpack|spqr|ldl|cs|RBio|SuiteSparse)\w*\.h"
                    r"|Eigen/(KLU|Cholmod|UmfPack|SPQR)Support)", r"lib/sparse/[^/]+\.cpp$"),
    "BLAS": (r"(cblas|lapacke|openblas\w*)\.h", r"lib/sparse/[^/]+\.cpp$"),
    "GSL": (r"gsl/", r"(rom/greedy/[^/]+|bench/.+)\.cpp$"),
    "HDF5": (r"(hdf5\w*|H5\w*)\.h", r"(lib/io/[^/]+\.cpp$|bench/)"),
    "nlohmann-json": (r"nlohmann/", r"(lib/io/[^/]+\.cpp$|bench/)"),
    "CLI11": (r"CLI/", r"bench/"),
    "IPOPT": (r"(coin/|Ip\w+\.hp?p?$)", r"bench/"),
    "Google Benchmark": (r"benchmark/", r"bench/"),
    "GoogleTest": (r"(gtest|gmock)/", r"tests/"),
}
STANDARD_OR_EIGEN = r"([a-z_]+|(unsupported/)?Eigen/\w+)$"
FREE_OF_RULES = {"bench", "tests", "python", "examples"}  # may include any system header

INCLUDE = re.compile(r"^[ \t]*#[ \t]*include\b[ \t]*(.*)$", re.MULTILINE)
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)


def component(path):
    return next((name for folder, name in COMPONENTS.items() if path == folder or path.startswith(folder + "/")), None)


def declared_uses(root):
    """What each CMakeLists.txt says in USES, closed over the components used."""
    uses = {}
    for folder in COMPONENTS:
        lists = root / folder / "CMakeLists.txt"
        for name, body in re.findall(r"tact_component\((\w+)(.*?)\)", lists.read_text() if lists.exists() else "", re.DOTALL):
            found = re.search(r"\bUSES\b((?:\s+[a-z_]+)*)", body)
            uses[name] = {name} | set(found.group(1).split() if found else ())
    for _ in uses:
        for name, used in uses.items():
            uses[name] = used.union(*(uses.get(other, set()) for other in used))
    return uses


def check_project_include(path, included, uses, root):
    mine, theirs = component(path), component(included)
    if not (root / included).is_file():
        return "no such file"
    if theirs is None:
        return "not in a room"
    if theirs in OUTER and mine != theirs and not (theirs == "bench" and path.startswith("tests/bench/")):
        return f"nothing includes {theirs}"
    if theirs == "tests" and mine != "tests":
        return "only tests include tests"
    if mine in MAY_INCLUDE and theirs not in MAY_INCLUDE[mine]:
        return f"{mine} must not include {theirs}"
    if mine in uses and mine in MAY_INCLUDE and theirs not in uses[mine]:
        return f"{mine} does not name {theirs} in USES"
    return None


def check_system_include(path, included):
    mine = component(path)
    for library, (headers, allowed) in OWNERS.items():
        if re.match(headers, included):
            return None if mine == "tests" or re.match(allowed, path) else f"{library} header outside its owner"
    if mine in FREE_OF_RULES or re.match(STANDARD_OR_EIGEN, included):
        return None
    return "neither standard, Eigen nor a library this component owns"


def check_include(path, text, uses, root):
    match = re.match(r'(?:<([^>]+)>|"([^"]+)")', text)
    if not match:
        return "not a literal path"
    system, quoted = match.groups()
    name = system or quoted
    if quoted:
        included = posixpath.normpath(posixpath.join(posixpath.dirname(path), name))
        return check_project_include(path, included, uses, root)
    if name.startswith("tact/"):
        return "a file of the project is included in quotes, by its path from the including file"
    return check_system_include(path, name)


def violations(root):
    root, found = Path(root), []
    uses = declared_uses(root)
    for file in sources(root):
        path = file.relative_to(root).as_posix()
        if path.startswith("tests/packaging/"):
            continue  # a project of its own
        text = COMMENT.sub(lambda comment: "\n" * comment.group().count("\n"), file.read_text())
        for include in INCLUDE.finditer(text):
            reason = check_include(path, include.group(1), uses, root)
            if reason:
                line = text.count("\n", 0, include.start()) + 1
                found.append(f"{path}:{line}: {include.group().strip()}: {reason}")
    return found


ALLOWED = [
    ("lib/a.hpp", "<vector>"), ("lib/a.hpp", "<Eigen/Dense>"), ("lib/a.cpp", '"a.hpp"'),
    ("lib/scenes/a.hpp", '"../a.hpp"'), ("lib/sparse/a.cpp", "<klu.h>"), ("lib/io/a.cpp", "<nlohmann/json.hpp>"),
    ("contact/a.hpp", '"dense/a.hpp"'), ("contact/a.cpp", '"../lib/sparse/a.hpp"'),
    ("integrators/sundials/a.hpp", "<sundials/sundials_context.h>"),
    ("integrators/sundials/a.cpp", '"../a.hpp"'),
    ("rom/greedy/a.cpp", "<gsl/gsl_qrng.h>"), ("rom/greedy/a.hpp", '"../model/a.hpp"'),
    ("rom/greedy/a.cpp", '"../bases/a.hpp"'),
    ("bench/a.cpp", "<CLI/CLI.hpp>"), ("bench/a.cpp", '"../rom/greedy/a.hpp"'), ("bench/a.cpp", "<coin/IpTNLP.hpp>"),
    ("tests/contact/a.cpp", "<gtest/gtest.h>"), ("tests/bench/a.cpp", '"../../bench/a.hpp"'),
    ("door/a.cpp", '"../contact/a.hpp"'), ("tact.hpp", '"door/a.hpp"'), ("tact.hpp", '"integrators/a.hpp"'),
    ("lib/b.cpp", "/* was */ // nothing"),
]
PLANTED = [
    ("lib/a.hpp", '"sparse/a.hpp"'), ("lib/a.hpp", "<klu.h>"), ("lib/a.cpp", "<nlohmann/json.hpp>"),
    ("lib/a.cpp", "<Eigen/KLUSupport>"), ("lib/a.cpp", "<unistd.h>"), ("lib/a.cpp", "<tact/lib/a.hpp>"),
    ("lib/a.cpp", '"tact/lib/a.hpp"'), ("lib/a.cpp", '"missing.hpp"'), ("lib/a.cpp", "HEADER"),
    ("lib/scenes/a.cpp", '"../io/a.hpp"'), ("lib/io/a.cpp", '"../../contact/a.hpp"'),
    ("lib/io/a.hpp", "<nlohmann/json.hpp>"), ("lib/sparse/a.hpp", "<cholmod.h>"), ("lib/sparse/a.cpp", "<hdf5.h>"),
    ("contact/a.cpp", '"../rom/model/a.hpp"'), ("contact/a.cpp", '"../integrators/a.hpp"'), ("contact/a.cpp", "<klu.h>"),
    ("contact/a.cpp", '"../lib/io/a.hpp"'),  # lib, but not in its USES below
    ("contact/dense/a.cpp", '"../a.hpp"'), ("contact/dense/a.cpp", '"../../lib/sparse/a.hpp"'),
    ("integrators/a.cpp", '"../contact/a.hpp"'), ("integrators/a.cpp", "<nvector/nvector_serial.h>"),
    ("integrators/a.hpp", '"sundials/a.hpp"'), ("integrators/a.cpp", '"sundials/a.hpp"'),
    ("rom/model/a.cpp", '"../greedy/a.hpp"'), ("rom/model/a.cpp", '"../file/a.hpp"'), ("rom/file/a.cpp", "<hdf5.h>"),
    ("rom/model/a.cpp", '"../../contact/dense/a.hpp"'), ("rom/bases/a.cpp", "<gsl/gsl_qrng.h>"),
    ("rom/bases/a.cpp", '"../error/a.hpp"'), ("rom/greedy/a.hpp", "<gsl/gsl_qrng.h>"),
    ("rom/greedy/a.cpp", '"../../integrators/a.hpp"'),
    ("rom/model/a.cpp", '"../../bench/a.hpp"'), ("tests/contact/a.cpp", '"../../bench/a.hpp"'),
    ("bench/a.cpp", '"../examples/a.hpp"'), ("lib/a.cpp", '"../door/a.hpp"'), ("rom/model/a.cpp", '"../../door/a.hpp"'),
    ("door/a.cpp", '"../bench/a.hpp"'),
    ("contact/a.hpp", "<CLI/CLI.hpp>"), ("integrators/sundials/a.cpp", "<klu.h>"), ("lib/a.hpp", '"../tests/contact/a.hpp"'),
]
FOLDERS = [*(folder for folder in COMPONENTS if "." not in folder), "tests/contact", "tests/bench"]
LISTS = {"contact": "tact_component(contact\n  SOURCES a.cpp\n  USES core sparse contact_dense)\n"}


def self_check():
    """Problems of this checker: allowed includes it refuses and planted ones it lets pass."""
    problems = []
    for expected, cases in ((0, ALLOWED), (1, PLANTED)):
        for path, include in cases:
            with tempfile.TemporaryDirectory() as folder:
                root = Path(folder)
                for room in FOLDERS:
                    (root / room).mkdir(parents=True, exist_ok=True)
                    (root / room / "a.hpp").write_text("#pragma once\n")
                for room, text in LISTS.items():
                    (root / room / "CMakeLists.txt").write_text(text)
                prefix = "" if include.startswith("/*") else "#include "
                (root / path).write_text(f"// a comment\n{prefix}{include}\n")
                found = violations(root)
                if len(found) != expected:
                    problems.append(f"self-check: {path} with {include}: {found or 'not found'}")
    return problems


if __name__ == "__main__":
    failures = self_check() + violations(ROOT)
    print("\n".join(failures) or "every include is within the rule")
    sys.exit(bool(failures))
