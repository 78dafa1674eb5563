#!/usr/bin/env bash
# Installs what this example needs beside the plugin (OpenFOAM, VTK for python), sets up, runs it. Options go to
# openfoam_step.py.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# Debian's python has these, and Debian's MPI with them.
STOKESDYN_PACKAGES="openfoam python3-vtk9" STOKESDYN_BUILD="$here/../../build/openmpi" \
  "$here/../../cmake/setup.sh" openmpi
. "$here/../../build/openmpi/env.sh"
exec /usr/bin/python3 "$here/openfoam_step.py" "$@"
