#!/usr/bin/env bash
# Command 2 of the README: set-up and every test. From any folder; nothing needs to be set.
#   1. set-up (cmake/setup.sh test)             4. the same through LAMMPS (pytest, unittest/lammps)
#   2. tests of the core (ctest)                5. a small LAMMPS run under valgrind
#   3. the same with address and undefined-behaviour sanitizers
# Ends with a line "N passed, N failed"; exits 0 if nothing failed.
set -uo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$top" || exit 1
export PATH=${PATH:-/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin}
export HOME=${HOME:-$(getent passwd "$(id -u)" | cut -d: -f6)}
cores=$(env -u OMP_NUM_THREADS nproc)    # which takes that variable for a limit
export OMP_NUM_THREADS=1
if [ "$(id -u)" = 0 ]; then export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; fi

began=$SECONDS passed=0 failed=0
say() { printf '[%3d s] %s\n' $((SECONDS - began)) "$*"; }
finish() {
  say "done"
  echo "$passed passed, $failed failed"
  [ "$failed" = 0 ] && [ "$passed" -gt 0 ]
  exit
}
# A step that should have run tests and did not counts as one failure.
broken() { say "FAILED: $*"; failed=$((failed + 1)); }

# ctest FOLDER: adds up its tests. Its summary reads "91% tests passed, 1 tests failed out of 11".
core_tests() {
  local log=$1/ctest.log
  ctest --test-dir "$1" -j "$cores" --output-on-failure 2>&1 | tee "$log"
  local counts
  counts=$(sed -n 's/^.* \([0-9]*\) tests failed out of \([0-9]*\)$/\1 \2/p' "$log")
  if [ -z "$counts" ] || [ "${counts#* }" = 0 ]; then broken "no core tests in $1"; return; fi
  failed=$((failed + ${counts% *}))
  passed=$((passed + ${counts#* } - ${counts% *}))
}

say "1/5 set-up"
cmake/setup.sh test || { broken "set-up"; finish; }
. build/env.sh
. cmake/progress.sh

say "2/5 tests of the core"
core_tests build

say "3/5 tests of the core with sanitizers (address, undefined)"
lammps=$(sed -n 's/^LAMMPS_SOURCE_DIR:[A-Z]*=//p' build/CMakeCache.txt)
log=build/sanitize.log
with_sanitizers() {
  cmake -S cmake -B build/sanitize -G Ninja -D LAMMPS_SOURCE_DIR="$lammps" -D STOKESDYN_TESTS=ON \
    -D CMAKE_BUILD_TYPE=RelWithDebInfo -D STOKESDYN_SANITIZE=address,undefined &&
    cmake --build build/sanitize -j "$cores" --target core_tests
}
if with_progress sanitizers $log ninja_percent with_sanitizers; then
  core_tests build/sanitize
else
  tail -n 30 $log
  broken "sanitizers: the tests could not be built; whole log: $log"
fi

say "4/5 tests through LAMMPS"
# numpy and pytest are Debian's, so its python comes first. The files are handed out to as many processes as there are cores.
python=""
for p in /usr/bin/python3 python3; do
  if command -v $p > /dev/null && $p -c "import numpy, pytest, xdist" 2> /dev/null; then python=$p; break; fi
done
if [ -z "$python" ]; then
  broken "no python3 with numpy, pytest and pytest-xdist"
else
  report=build/pytest.xml
  rm -f $report
  $python -m pytest -p no:cacheprovider -q --tb=short --durations=10 -n "$cores" --dist loadfile --junitxml=$report \
    unittest/lammps
  counts=$($python - $report << 'END'
import sys, xml.etree.ElementTree as tree
suite = tree.parse(sys.argv[1]).getroot().find("testsuite")
total, bad = int(suite.get("tests")), sum(int(suite.get(k)) for k in ("failures", "errors", "skipped"))
print(total - bad, bad)
END
  )
  if [ -z "$counts" ]; then broken "pytest did not finish"; else
    passed=$((passed + ${counts% *}))
    failed=$((failed + ${counts#* }))
  fi
fi

say "5/5 a small LAMMPS run under valgrind"
if [ -n "$python" ] && $python unittest/lammps/valgrind_run.py build; then passed=$((passed + 1)); else broken "valgrind"; fi

finish
