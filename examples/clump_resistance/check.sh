#!/usr/bin/env bash
# check.sh [PROGRAM]: runs the example and compares its numbers. Exits 1 if one is off.
#   row of four       values published in the test-suite of PyGRPY (github.com/RadostW/PyGRPY, tests), to the digits printed
#   touching pair     exact drag and Jeffery period, within what the shell promises
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
program=${1:-$here/clump_resistance.sh}
bad=0

# compare WHAT VALUE EXPECTED TOLERANCE(relative)
compare() {
  if awk -v v="$2" -v e="$3" -v t="$4" 'BEGIN { d = v / e - 1; exit !(v != "" && d <= t && -d <= t) }'; then
    printf '  %-34s %14s   expected %-14s\n' "$1" "$2" "$3"
  else
    printf '  %-34s %14s   expected %-14s OFF by more than %s\n' "$1" "$2" "$3" "$4"
    bad=1
  fi
}
# entry ROW COLUMN of the matrix with this title, from standard input
entry() { awk -v m="$1" -v r="$2" -v c="$3" '$1 == m { at = NR } at && NR == at + r { print $c }'; }
in_stokes() { awk '{ printf "%.6f", $1 / 18.849555921538759 }'; }

echo "Row of four spheres, shell 1 with rotation, against PyGRPY"
out=$("$program" "$here/row4.txt" shell 1)
compare "hydrodynamic radius"        "$(awk '$1 == "radius" { print $2 }' <<< "$out")" 1.5409546371938094   1e-9
compare "mobility across"            "$(entry mobility 1 1 <<< "$out")"                0.03225999460266797  5e-8
compare "mobility along"             "$(entry mobility 3 3 <<< "$out")"                0.03876335168633891  5e-8
compare "rotational mobility across" "$(entry mobility 4 4 <<< "$out")"                0.006590020934028927 5e-8
compare "rotational mobility along"  "$(entry mobility 6 6 <<< "$out")"                0.017665748920274064 5e-8

for n in 12 42 162; do
  case $n in 12) drag=0.006 period=0.01 ;; 42) drag=0.0035 period=0.005 ;; 162) drag=0.0015 period=0.0025 ;; esac
  echo "Touching pair, shell $n, against exact values"
  out=$(printf '0 0 0 1\n0 0 2 1\n' | "$program" - shell $n)
  compare "drag along / 6 pi eta a"  "$(entry resistance 3 3 <<< "$out" | in_stokes)" 1.290283 $drag
  compare "drag across / 6 pi eta a" "$(entry resistance 1 1 <<< "$out" | in_stokes)" 1.449322 $drag
  compare "Jeffery period x shear rate" "$(sed -n 's/.*Jeffery period \([^ ]*\).*/\1/p' <<< "$out")" 15.621755 $period
done
exit $bad
