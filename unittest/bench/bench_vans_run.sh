#!/usr/bin/env bash
# Steps per second of whole two-way runs of fix hydro/vans: 1165 loose and 100 fixed grains, 900 slices, 1000 fluid
# steps every 0.01 s on one core; and a bed of about 100 000 grains (the small one, repeated) on one and two ranks.    .
# build/env.sh; unittest/bench/bench_vans_run.sh
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
input=$here/../../examples/vans_bedload/in.vans_bedload
[ "$(id -u)" = 0 ] && export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# Steps per second of wall clock, and per second of processor time where other work shares the cores.
rate() {
  awk '/^Loop time/ { t = $4; n = $9 } /CPU use/ { c = $1 / 100 }
    END { printf "%.0f steps/s; %.0f steps per processor second ", n / t, n / t / c
          printf "(%d steps in %.1f s, processor use %.0f %%)\n", n, t, 100 * c }' "$1"
}

lmp -in "$input" -screen none -log small -var depth 22.5 -var layers 11.65 -var cells 900 -var dt 4.8e-5 \
  -var fluid_dt 1e-5 -var seconds 0.7
echo "1265 grains, 900 slices, one core: $(rate small)"

{ sed '/^# the stream/,$d' "$input"; echo "write_data bed.data"; } > in.bed
lmp -in in.bed -screen none -log none
cat > in.large <<'EOF'
plugin load stokesdynplugin.so
units si
atom_style sphere
boundary p p f
newton off
comm_modify vel yes
processors * * 1
read_data bed.data
replicate 12 12 1
group mobile type 2
pair_style gran/hooke/history 2000 NULL 1620 NULL 0.4 1
pair_coeff * *
neighbor 0.0015 bin
neigh_modify delay 0 every 1 check yes exclude type 1 1
fix gravity mobile gravity 9.81 vector 0.049979 0 -0.99875
fix vans mobile hydro/vans 250 mesh 301 0.0003 0 fluid 1000 0.001 gravity 0.49029565 0 -9.79774 phi_max 0.61 &
  solve 0.01 1e-4
fix move mobile nve/sphere
timestep 4e-5
thermo 500
thermo_style custom step atoms f_vans[4]
run 50
run 500
EOF
for ranks in 1 2; do
  mpirun -np $ranks lmp -in in.large -screen none -log large.$ranks
  echo "$(awk '/Loop time/ {n = $(NF - 1)} END {print n}' large.$ranks) grains, 301 slices, $ranks rank(s):" \
    "$(rate large.$ranks)"
done
