"""The project's own C++ and Python files."""
import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("lib", "contact", "integrators", "rom", "door", "bench", "tests", "python", "examples")


def sources(root=ROOT, suffixes=(".hpp", ".cpp")):
    if ".hpp" in suffixes and (Path(root) / "tact.hpp").exists():
        yield Path(root) / "tact.hpp"
    for room in ROOMS:
        for folder, subfolders, names in os.walk(Path(root) / room):
            subfolders[:] = sorted(s for s in subfolders if s != "__pycache__")
            for name in sorted(names):
                if name.endswith(suffixes):
                    yield Path(folder) / name
