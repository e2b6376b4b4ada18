#!/bin/sh
# What takes too long for every change, stage by stage.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)

usage() {
  cat <<END
usage: tests/long.sh STAGE...

  processors   every test under -march=x86-64, x86-64-v3, native and at -O1
  generated    100,000 generated programmes under each of them
  sanitizers   every test with the address and undefined-behaviour sanitizers
  fuzz         an hour of fuzzing the contact strategies (clang)
  chroot       the README's commands in a bare Debian 12 (debootstrap, as root)
END
}

export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
jobs=$(getconf _NPROCESSORS_ONLN)
cd "$root"

# each_processor COMMAND: runs it with $folder, a build configured for one instruction set or optimisation.
each_processor() {
  for kind in x86-64 x86-64-v3 native O1; do
    case $kind in
      O1) flags="-O1" ;;
      *) flags="-O3 -DNDEBUG -march=$kind" ;;
    esac
    folder="build/long-$kind"
    echo "== $kind"
    cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS_RELEASE=$flags" --log-level=WARNING
    "$1"
  done
}
all_tests() {
  cmake --build "$folder" --parallel "$jobs"
  ctest --test-dir "$folder" --output-on-failure -j"$jobs"
}
programmes() {
  cmake --build "$folder" --parallel "$jobs" --target tact-generated
  "$folder/tests/tact-generated" --count 100000 --seed 1
}
in_chroot() {
  bare="$root/build/bare-debian"
  rm -rf "$bare"
  debootstrap --variant=minbase bookworm "$bare"
  chroot "$bare" sh -c 'apt-get -qq update && apt-get -qq install -y git ca-certificates >/dev/null'
  git clone -q . "$bare/root/tact"
  chroot "$bare" sh -c 'cd /root/tact && ./tests/run.sh && ./bench/run.sh --size small && ./tests/portable.sh'
}

[ $# -gt 0 ] || { usage; exit 2; }
for stage; do
  case "$stage" in
    processors) each_processor all_tests ;;
    generated) each_processor programmes ;;
    sanitizers) cmake --preset debug && cmake --build --preset debug --parallel "$jobs" && ctest --preset debug ;;
    fuzz)
      cmake --preset fuzz && cmake --build --preset fuzz --parallel "$jobs"
      build/fuzz/tests/fuzz/qp_fuzz -max_total_time=3600 ;;
    chroot) in_chroot ;;
    -h | --help) usage ;;
    *) usage >&2; exit 2 ;;
  esac
done
