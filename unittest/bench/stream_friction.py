#!/usr/bin/env python3
"""The friction of a smooth bottom without grains, by each mixing length of fix hydro/vans: the mean speed over that of
Keulegan's law (1938), U_m = u_star (2.5 ln(H u_star/nu) + 3.25). The tables of doc/vans_stream.md, each in a minute.

    . build/env.sh
    unittest/bench/stream_friction.py           # slices of nu/u_star, by depth and slope
    unittest/bench/stream_friction.py slices    # by the height of the slices"""
import math
import subprocess
import sys
import tempfile

NU = 1e-6
STREAMS = ((0.02, 0.005), (0.1, 0.001), (0.1, 0.05))    # depth, slope
LAWS = [law + more for law in ("rousseau", "parabolic", "kz", "li_sawamoto", "ni_capart")
        for more in ("", " sublayer yes")]
INPUT = """plugin load stokesdynplugin.so
units si
atom_style sphere
region box block 0 1 0 1 0 1
create_box 1 box
pair_style zero 0.1
pair_coeff * *
fix vans all hydro/vans 1 mesh {cells} {height:.17g} 0 fluid 1000 0.001 couple fluid gravity {g:.17g} 0 -9.8 &
    turbulence {law} solve 2 0.2
run 1500
print "DISCHARGE $(f_vans[18])"
"""


def speed(law, H, slope, high=1):
    """Mean, over u_star; a slice for each `high` nu/u_star, at most 6000"""
    star = math.sqrt(9.81 * slope * H)
    slices = min(round(H * star / NU / high), 6000)
    with tempfile.NamedTemporaryFile("w", suffix=".in") as f:
        f.write(INPUT.format(cells=slices + 1, height=H / slices, g=9.81 * slope, law=law))
        f.flush()
        out = subprocess.run(["lmp", "-in", f.name, "-log", "none", "-nocite"], capture_output=True, text=True).stdout
    discharge = [line for line in out.splitlines() if line.startswith("DISCHARGE")]
    return float(discharge[0].split()[1]) / H / star


def keulegan(number):
    return 2.5 * math.log(number) + 3.25


def by_stream():
    numbers = [H * math.sqrt(9.81 * slope * H) / NU for H, slope in STREAMS]
    print("H u_star/nu".ljust(28) + "".join(f"{number:9.0f}" for number in numbers))
    for law in LAWS:
        over = [speed(law, *stream) / keulegan(number) for stream, number in zip(STREAMS, numbers)]
        print(law.ljust(28) + "".join(f"{ratio:9.3f}" for ratio in over), flush=True)


def by_slices():
    H, number, heights = 0.1, 3162, (2, 5, 10, 20, 50, 100, 200)
    slope = (number * NU / H) ** 2 / (9.81 * H)
    print("dz u_star/nu".ljust(28) + "".join(f"{high:9d}" for high in heights))
    for law in ("rousseau", "parabolic sublayer yes", "kz sublayer yes"):
        over = [speed(law, H, slope, high) / keulegan(number) for high in heights]
        print(law.ljust(28) + "".join(f"{ratio:9.3f}" for ratio in over), flush=True)


if __name__ == "__main__":
    by_slices() if sys.argv[1:] == ["slices"] else by_stream()
