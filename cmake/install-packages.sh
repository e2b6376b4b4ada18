#!/bin/sh
# Installs the Debian packages tact is built from; says and does nothing when they are all there.
set -eu

packages="build-essential cmake ninja-build pkg-config git
  libeigen3-dev libsuitesparse-dev libopenblas-serial-dev libsundials-dev libgsl-dev libhdf5-dev
  nlohmann-json3-dev libcli11-dev libbenchmark-dev libgtest-dev coinor-libipopt-dev
  python3 python3-matplotlib"

case "${1:-}" in
  "") ;;
  -h | --help)
    echo "usage: $0 [--list]"
    echo "Installs, with apt-get and sudo where needed, the system packages that are missing; --list prints them all."
    echo "With TACT_SKIP_INSTALL=1 in the environment nothing is installed."
    exit ;;
  --list) printf '%s\n' $packages; exit ;;
  *) echo "$0: unknown argument $1 (see --help)" >&2; exit 2 ;;
esac
[ "${TACT_SKIP_INSTALL:-}" != 1 ] || exit 0

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "$0: this is not a Debian-like system (no apt-get). Install what these packages hold, then set TACT_SKIP_INSTALL=1:" >&2
  echo $packages >&2
  exit 1
fi

missing=""
for package in $packages; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=""
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "$0: run as root, or install sudo; missing:$missing" >&2
    exit 1
  fi
  as_root="sudo"
fi
# apt-get writes how far it is to its standard output, among the rest.
apt() {
  exec $as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get -q -o APT::Status-Fd=1 -o Dpkg::Use-Pty=0 -o Acquire::Retries=3 "$@"
}
. "$(dirname "$0")/progress.sh"

# A password is asked for before the output goes to a log.
[ -z "$as_root" ] || sudo -v
echo "Installing $(echo $missing | wc -w) system packages:$missing"
with_progress "Lists of packages" apt update || { echo "$0: could not update the lists of packages" >&2; exit 1; }
if ! with_progress "Packages" apt install -y --no-install-recommends $missing; then
  echo "$0: could not install:$missing" >&2
  exit 1
fi
