#!/bin/sh
# From a fresh checkout to the table of speed-ups.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)

usage() {
  cat <<END
usage: bench/run.sh [--size full|small] [--repeats N] [--out DIR] [--help] [other options of tact-bench speedup...]

Installs the system packages that are missing, builds into build/release, runs the three contact problems in full
and reduced, and leaves speedup.json, .md and .svg in DIR (default: results/ of the project).
END
}

out=default
for argument; do
  case "$argument" in
    -h | --help) usage; exit ;;
    --out | --out=*) out=given ;;
  esac
done
[ $out = given ] || set -- "$@" --out "$root/results"

export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
. "$root/cmake/progress.sh"
"$root/cmake/install-packages.sh"
(
  cd "$root"
  with_progress "Configuring" cmake --preset release
  # nproc counts OMP_NUM_THREADS instead of processors.
  cmake --build --preset release --parallel "$(getconf _NPROCESSORS_ONLN)" --target tact-bench
)
exec "$root/build/release/bench/tact-bench" speedup "$@"
