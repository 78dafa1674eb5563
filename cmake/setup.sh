#!/usr/bin/env bash
# Set-up for both commands of the README: Debian packages, LAMMPS, the plugin. Quick when all is there already.
#   setup.sh             everything that a run needs
#   setup.sh test        also what unittest/run.sh needs
#   setup.sh core        the core only, for Python and clump_resistance: without LAMMPS, in about a minute
# STOKESDYN_PACKAGES: more Debian packages, for an example that needs them. STOKESDYN_CACHE: where LAMMPS goes (provide_lammps.sh).
# Leaves build/stokesdynplugin.so, with build/stokesdynstyles.so that belongs to it, and build/env.sh; core: the latter only.
set -euo pipefail
export PATH HOME=${HOME:-$(getent passwd "$(id -u)" | cut -d: -f6)}    # a bare shell may have neither
top=$(cd "$(dirname "$0")/.." && pwd)
. "$top/cmake/progress.sh"
what=${1:-all}
case $what in all | test | core) ;; *) echo "usage: setup.sh [test | core]" >&2; exit 2 ;; esac

packages="build-essential cmake ninja-build libopenblas-serial-dev libfftw3-dev python3 python3-numpy python3-matplotlib"
[ "$what" = core ] || packages="$packages dpkg-dev libopenmpi-dev openmpi-bin libpng-dev"
[ "$what" = test ] && packages="$packages python3-pytest python3-pytest-xdist libcmocka-dev valgrind"
packages="$packages ${STOKESDYN_PACKAGES:-}"

missing=""
for p in $packages; do
  dpkg-query -W -f '${db:Status-Abbrev}' "$p" 2> /dev/null | grep -q '^ii' || missing="$missing $p"
done
if [ -n "$missing" ]; then
  echo "[packages] installing from Debian:$missing"
  if [ "$(id -u)" = 0 ]; then as_root=""
  elif command -v sudo > /dev/null && { sudo -n true 2> /dev/null || [ -t 0 ]; }; then as_root="sudo"; $as_root true
  else
    echo "setup: this needs root or sudo once, for packages that are missing. Ask for:  apt-get install$missing" >&2
    exit 1
  fi
  log=$(mktemp) apt_status=$(mktemp)
  with_progress packages "$log" apt_percent $as_root env DEBIAN_FRONTEND=noninteractive sh -c \
    "apt-get -q update; exec apt-get -q -y --no-install-recommends -o APT::Status-Fd=3 install $missing 3> $apt_status" || {
    tail -n 20 "$log" >&2
    echo "setup: the packages could not be installed (see above). Is the package registry reachable? Needed: $missing" >&2
    exit 1
  }
  rm -f "$log" "$apt_status"
fi

# A folder that has the plugin keeps it when only the core is asked for.
if [ "$what" = core ] && [ ! -f "$top/build/stokesdynplugin.so" ]; then
  settings=(-D STOKESDYN_PLUGIN=OFF)
elif [ "$what" = core ]; then
  settings=()
else
  lammps=$("$top/cmake/provide_lammps.sh" | tail -n 1)
  settings=(-D STOKESDYN_PLUGIN=ON -D LAMMPS_SOURCE_DIR="$lammps/src" -D LAMMPS_INSTALL_DIR="$lammps"
            -D STOKESDYN_TESTS="$([ "$what" = test ] && echo ON || echo OFF)")
fi
targets=()
[ "$what" = core ] && targets=(--target stokesdyn_python clump_resistance)

log=$top/build/build.log
mkdir -p "$top/build"
build() {
  cmake -S "$top/cmake" -B "$top/build" -G Ninja "${settings[@]}" &&
    cmake --build "$top/build" -j "$(env -u OMP_NUM_THREADS nproc)" "${targets[@]}"
}
name=$([ "$what" = core ] && echo core || echo plugin)
echo "[$name] building; a minute on two free cores"
with_progress "$name" "$log" ninja_percent build ||
  { tail -n 40 "$log" >&2; echo "setup: the $name could not be built; whole log: $log" >&2; exit 1; }
if [ "$what" = core ]; then
  echo "[set-up] ready: build/clump_resistance; after '. build/env.sh' python3 can 'import stokesdyn'"
else
  echo "[set-up] ready: build/stokesdynplugin.so; '. build/env.sh' puts lmp on the PATH"
fi
