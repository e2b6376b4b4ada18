#!/bin/sh
# The installation of the README, used from outside, and the laws of contact under another instruction set than the tests'.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)

case "${1:-}" in
  "") ;;
  *)
    echo "usage: tests/portable.sh"
    echo "Builds the portable preset, installs it into build/portable/prefix, builds a program against it in a folder of its own"
    echo "and runs it; then builds and runs the laws of contact as that preset compiles them."
    exit ;;
esac

export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
processors=$(getconf _NPROCESSORS_ONLN)
"$root/cmake/install-packages.sh"
cd "$root"
prefix="$root/build/portable/prefix"
rm -rf "$prefix" "$root/build/portable/outside"
cmake --preset portable --log-level=WARNING
cmake --build --preset portable --parallel "$processors"
cmake --install build/portable --prefix "$prefix" >/dev/null

echo "A program outside the project, against the installed library"
cmake -S tests/packaging -B build/portable/outside -DCMAKE_PREFIX_PATH="$prefix" \
  "-DCOMPONENTS=$(sed -n 's/^set(_tact_components "\(.*\)").*/\1/p' build/portable/tactConfig.cmake)" \
  -DCMAKE_BUILD_TYPE=Release --log-level=WARNING
cmake --build build/portable/outside --parallel "$processors"
build/portable/outside/first_use

echo "The laws of contact as the portable preset compiles them"
cmake --preset portable -B build/portable-laws -DTACT_BUILD_TESTS=ON --log-level=WARNING
cmake --build build/portable-laws --parallel "$processors" --target test_laws
build/portable-laws/tests/test_laws --gtest_brief=1
