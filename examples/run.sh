#!/usr/bin/env bash
# Command 1 of the README: set-up (packages, LAMMPS, plugin), then examples. From any folder, with
# nothing set beforehand.
#   run.sh              examples/sedimentation; tables and pictures go to build/examples/sedimentation
#                       (STOKESDYN_BUILD/examples if that names another folder for the build)
#   run.sh --update     also refreshes those that are kept in examples/sedimentation
#   run.sh all          every example, one after the other, and a table of their figures at the end; exits with 1 when
#                       one is missed
#   run.sh NAME ...     these examples, with the same table; first_look and clump_resistance need no LAMMPS
set -euo pipefail
# sbin: dpkg looks for its tools there
export PATH=${PATH:-/usr/local/bin:/usr/bin:/bin}:/usr/local/sbin:/usr/sbin:/sbin
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
here=$top/examples

usage() { echo "usage: examples/run.sh [--update | all | NAME ...]" >&2; exit 2; }
names=()
case "${1:-}" in
  "" | --update) [ $# -le 1 ] || usage ;;
  all)
    [ $# = 1 ] || usage
    for script in "$here"/*/run.py; do names+=("$(basename "$(dirname "$script")")"); done ;;
  *)
    for name; do [ -f "$here/$name/run.py" ] || { echo "run.sh: there is no example $name" >&2; usage; }; done
    names=("$@") ;;
esac

# Some need the core only, which is there in a minute.
what=core
[ ${#names[@]} != 0 ] || what=all
for name in "${names[@]}"; do
  case $name in first_look | clump_resistance) ;; *) what=all ;; esac
done
"$top/cmake/setup.sh" $what
STOKESDYN_BUILD=$(cd "${STOKESDYN_BUILD:-$top/build}" && pwd)    # the examples write there
export STOKESDYN_BUILD
. "$STOKESDYN_BUILD/env.sh"

# The pictures that an example has made: those that it keeps beside its README have the same names.
look_at() {
  local picture found=""
  for picture in "$here/$1"/*.png "$here/$1"/*.gif; do
    picture=$STOKESDYN_BUILD/examples/$1/$(basename "$picture")
    if [ -f "$picture" ]; then found="$found ${picture#"$PWD"/}"; fi
  done
  if [ -n "$found" ]; then echo "Look at:$found"; fi
}

# The python of the ready LAMMPS is the first on the PATH now. Otherwise Debian's has what the set-up installed.
python=python3
[ -x "$(dirname "$(command -v lmp || echo none)")/python3" ] || python=/usr/bin/python3
"$python" -c "import numpy, matplotlib" 2> /dev/null || python=python3
if [ ${#names[@]} = 0 ]; then
  echo "[sedimentation] rigid clumps fall in a viscous fluid"
  status=0
  "$python" "$here/sedimentation/run.py" "$@" || status=$?
  look_at sedimentation
  exit $status
fi

# Each run.py ends with lines "ok" and "MISSED" (checks.py) and exits with 1 when a figure is missed, with 1 as well
# when it fails.
mkdir -p "$STOKESDYN_BUILD/examples"
table="" bad=0
for name in "${names[@]}"; do
  log=$STOKESDYN_BUILD/examples/$name.log began=$SECONDS status=0
  echo "[$name]"
  "$python" "$here/$name/run.py" 2>&1 < /dev/null | tee "$log" || status=1
  ok=$(grep -c "^ok  " "$log" || true) missed=$(grep -c "^MISSED  " "$log" || true) remark=""
  if [ "$missed" = 0 ] && [ $status != 0 ]; then remark="FAILED, see $log"; fi
  if [ $((ok + missed)) = 0 ]; then remark="FAILED: no figure was looked at, see $log"; fi
  [ $status = 0 ] && [ $((ok + missed)) != 0 ] || bad=1
  table+=$(printf '%-18s %5d %7d %8d  %s' "$name" "$ok" "$missed" $((SECONDS - began)) "$remark")$'\n'
done
printf '\n%-18s %5s %7s %8s\n%s' example ok missed seconds "$table"
for name in "${names[@]}"; do look_at "$name"; done
exit $bad
