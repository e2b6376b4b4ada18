#!/bin/sh
# The installation of the README, used from outside, and the laws of contact under another instruction set than the tests'.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)

if [ $# -gt 0 ]; then
  echo "usage: tests/portable.sh"
  echo "Builds the portable preset, installs it into build/portable/outside/prefix, builds the programs of tests/packaging against"
  echo "it as a project of their own and runs them; then builds and runs the laws of contact as that preset compiles them."
  exit
fi

export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
processors=$(getconf _NPROCESSORS_ONLN)
. "$root/cmake/progress.sh"
"$root/cmake/install-packages.sh"
cd "$root"
with_progress "Configuring" cmake --preset portable
cmake --build --preset portable --parallel "$processors"

echo "Programs outside the project, against the installed library"
components=$(sed -n 's/^set(_tact_components "\([^"]*\)").*/\1/p' build/portable/tactConfig.cmake | tr ';' ',')
with_progress "Building and running them" cmake "-DBUILD=$root/build/portable" "-DFOLDER=$root/build/portable/outside" -DCOMPILER=c++ -DGENERATOR=Ninja \
  "-DCOMPONENTS=$components" -P tests/packaging/run.cmake

echo "The laws of contact as the portable preset compiles them"
with_progress "Configuring" cmake --preset portable -DTACT_BUILD_TESTS=ON
cmake --build build/portable --parallel "$processors" --target test_laws
build/portable/tests/test_laws --gtest_brief=1
