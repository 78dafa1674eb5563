#!/usr/bin/env bash
# Installs what this example needs beside the plugin (OpenFOAM, VTK for python), sets up, runs it. Options go to openfoam_step.py.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
STOKESDYN_PACKAGES="openfoam python3-vtk9" "$here/../../cmake/setup.sh"
. "$here/../../build/env.sh"
exec /usr/bin/python3 "$here/openfoam_step.py" "$@"
