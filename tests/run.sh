#!/bin/sh
# From a fresh checkout to ctest's closing line.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)

usage() {
  cat <<END
usage: tests/run.sh [--size full|small] [--help] [arguments of ctest...]

Installs the system packages that are missing, builds into build/release and runs every test.
  --size small   leave out the tests at full problem size
END
}

leave_out=""
case "${1:-}" in
  -h | --help) usage; exit ;;
  --size | --size=*)
    if [ "$1" = --size ]; then size=${2:-}; shift; else size=${1#--size=}; fi
    [ $# -eq 0 ] || shift
    case "$size" in
      full) ;;
      small) leave_out="-E FullSize" ;;
      *) echo "tests/run.sh: --size is full or small, not '$size'" >&2; exit 2 ;;
    esac ;;
esac

export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
. "$root/cmake/progress.sh"
"$root/cmake/install-packages.sh"
cd "$root"
with_progress "Configuring" cmake --preset release
# nproc counts OMP_NUM_THREADS instead of processors.
cmake --build --preset release --parallel "$(getconf _NPROCESSORS_ONLN)"
exec ctest --test-dir build/release --output-on-failure -j2 $leave_out "$@"
