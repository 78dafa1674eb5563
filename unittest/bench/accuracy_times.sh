#!/usr/bin/env bash
# All times on the page on accuracy but those of 10^5 and 10^6 spheres, on a quiet machine: products of 10^3 and 10^4
# spheres, ours and other programs', with the picture; and what a step costs with each model. Five minutes at most, and
# the first time some more for pip, which brings the other programs to ~/.cache/stokesdyn/peers.
#     cmake --build build --target bench_speed_error
#     . build/env.sh; unittest/bench/accuracy_times.sh [BUILD]
# speed_error.csv, peers.csv and speed_error.png are made anew; the last lines are the table of models.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
build=${1:-$here/../../build}
peers=${XDG_CACHE_HOME:-$HOME/.cache}/stokesdyn/peers
export OPENBLAS_NUM_THREADS=1
if [ ! -e "$peers/complete" ]; then
  python3 -m venv "$peers"
  "$peers/bin/pip" install numpy scipy cython setuptools wheel pytest matplotlib fmm3dpy
  "$peers/bin/pip" install --no-build-isolation pystokes
  "$peers/bin/pip" install jfsd
  "$peers/bin/pip" install "jax==0.4.38" "jaxlib==0.4.38"    # jfsd's own jax is gone
  touch "$peers/complete"
fi
"$peers/bin/python" "$here/speed_error.py" --build "$build" --spheres 1000 10000
"$here/multiblob.py" models
