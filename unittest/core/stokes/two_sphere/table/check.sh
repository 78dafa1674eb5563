#!/usr/bin/env bash
# Are the series for two spheres, which make the plugin's table, right?
#   check.sh BUILD   tests them with that build folder, in some seconds, against other computations, and notes in
#                    tested.sha256 what was tested
#   check.sh         whether the series and their tests are what was noted: a test of every build
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
[ $# = 0 ] || build=$(cd "$1" && pwd)
cd "$here/.."
files=(table/sd_two_sphere_* test_two_sphere_exact.c ../../../data/two_sphere/*)
if [ $# = 0 ]; then
  diff table/tested.sha256 <(sha256sum "${files[@]}") && exit
  echo "check.sh: the series for two spheres, or their tests, are not what was tested: run $here/check.sh BUILD" >&2
  exit 1
fi
cmake --build "$build" --target test_two_sphere_exact
"$build/test_two_sphere_exact"
sha256sum "${files[@]}" > table/tested.sha256
