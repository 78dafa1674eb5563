#!/usr/bin/env bash
# Set-up for both commands of the README: Debian packages, LAMMPS, the plugin. Quick when all is there already.
#   setup.sh [test]      test: also what unittest/run.sh needs
# STOKESDYN_PACKAGES: more Debian packages, for an example that needs them.
# Leaves build/stokesdynplugin.so, with build/stokesdynstyles.so that belongs to it, and build/env.sh.
set -euo pipefail
export PATH HOME=${HOME:-$(getent passwd "$(id -u)" | cut -d: -f6)}    # a bare shell may have neither
top=$(cd "$(dirname "$0")/.." && pwd)

packages="build-essential cmake ninja-build dpkg-dev libopenmpi-dev openmpi-bin libpng-dev libopenblas-serial-dev libfftw3-dev python3 python3-numpy python3-matplotlib"
[ "${1:-}" = test ] && packages="$packages python3-pytest python3-pytest-xdist libcmocka-dev valgrind"
packages="$packages ${STOKESDYN_PACKAGES:-}"

missing=""
for p in $packages; do
  dpkg-query -W -f '${db:Status-Abbrev}' "$p" 2> /dev/null | grep -q '^ii' || missing="$missing $p"
done
if [ -n "$missing" ]; then
  echo "[set-up] installing Debian packages:$missing"
  if [ "$(id -u)" = 0 ]; then as_root=""
  elif command -v sudo > /dev/null && { sudo -n true 2> /dev/null || [ -t 0 ]; }; then as_root="sudo"
  else
    echo "setup: this needs root or sudo once, for packages that are missing. Ask for:  apt-get install$missing" >&2
    exit 1
  fi
  log=$(mktemp)
  $as_root env DEBIAN_FRONTEND=noninteractive sh -c \
    "apt-get -q update; apt-get -q -y --no-install-recommends install $missing" > "$log" 2>&1 || {
    tail -n 20 "$log" >&2
    echo "setup: the packages could not be installed (see above). Is the package registry reachable? Needed: $missing" >&2
    exit 1
  }
  rm -f "$log"
fi

lammps=$("$top/cmake/provide_lammps.sh" | tail -n 1)

log=$top/build/build.log
echo "[set-up] building the plugin (a minute on two cores; tail -f ${log#"$PWD"/})"
mkdir -p "$top/build"
{ cmake -S "$top/cmake" -B "$top/build" -G Ninja -D LAMMPS_SOURCE_DIR="$lammps/src" -D LAMMPS_INSTALL_DIR="$lammps" \
    -D STOKESDYN_TESTS="$([ "${1:-}" = test ] && echo ON || echo OFF)" &&
  cmake --build "$top/build" -j "$(env -u OMP_NUM_THREADS nproc)"; } > "$log" 2>&1 || { tail -n 40 "$log" >&2; echo "setup: the plugin could not be built; whole log: $log" >&2; exit 1; }
echo "[set-up] ready: build/stokesdynplugin.so; '. build/env.sh' puts lmp on the PATH"
