#!/usr/bin/env python3
"""A standing sound wave at c dt/h = 0.2 without viscosity: energy over 10^5 steps with fix nve/sph, and over 2000 with
LAMMPS's fix sph.

    . build/env.sh
    unittest/bench/sph_sound_wave.py
"""
import os
import tempfile

from from_tests import np
from sph_wave import wave

with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "wave.data")
    t, energy, _ = wave(path, "nve/sph", 0.2, 100000, 1000)
    ratio = energy / energy[0]
    print("fix nve/sph: %d periods; energy over that at the start" % t[-1])
    for k in range(10):
        part = ratio[1 + 100 * k:101 + 100 * k]
        print("  steps %6d to %6d: mean %.6f, least %.6f, most %.6f" % (10000 * k, 10000 * (k + 1), part.mean(),
                                                                        part.min(), part.max()))
    print("  slope of the mean: %.1e per 10^5 steps" % (np.polyfit(np.linspace(0, 1, 1000), ratio[1:], 1)[0]))
    t, energy, _ = wave(path, "sph", 0.2, 2000, 10)
    print("fix sph: %.1f periods; energy over that at the start: %s" %
          (t[-1], " ".join("%.3f" % e for e in energy / energy[0])))
