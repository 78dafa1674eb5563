#!/usr/bin/env bash
# Installs what this example needs beside the plugin (FEniCSx), sets up, runs it. Options go to fenics_tank.py.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# Debian's python has these, and Debian's MPI with them.
STOKESDYN_PACKAGES="python3-dolfinx python3-scipy" STOKESDYN_BUILD="$here/../../build/openmpi" \
  "$here/../../cmake/setup.sh" openmpi
. "$here/../../build/openmpi/env.sh"
export OMP_NUM_THREADS=1
exec /usr/bin/python3 "$here/fenics_tank.py" "$@"
