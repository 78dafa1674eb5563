#!/usr/bin/env python3
"""Standing waves on SPH water beside Lamb's exact frequency and damping: the figures of doc/sph_order.md and, with
surface tension, of doc/fix_sph_tension.md. Half a minute.

    . build/env.sh
    unittest/bench/sph_waves.py"""
import from_tests  # noqa: F401
from sph_water_waves import standing, tension_on_wave

for n, scene in ((16, {}), (32, {}), (64, {}), (32, {"h": 1.5}), (32, {"nu": 0.01}),
                 (32, {"nu": 0.005, "sigma": 0.1}), (48, {"nu": 0.005, "sigma": 0.1})):
    print("%d particles over the wave length, %s: frequency %.3f, damping %.2f" % (n, scene, *standing(n, **scene)),
          flush=True)
for n in (16, 32, 64, 128):
    print("%d particles over the wave length: force of tension %.3f, its work %.3f" % (n, *tension_on_wave(n)))
