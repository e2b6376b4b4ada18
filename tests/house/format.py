"""Every C++ file is as clang-format leaves it. With --fix it is made so. Nothing to do where there is no clang-format."""
import shutil
import subprocess
import sys

from sources import sources

if __name__ == "__main__":
    tool, files = shutil.which("clang-format"), [str(file) for file in sources()]
    if not tool or not files:
        sys.exit(0)
    how = ["-i"] if "--fix" in sys.argv else ["--dry-run", "-Werror", "--ferror-limit=5"]
    sys.exit(subprocess.run([tool, *how, *files]).returncode)
