#!/usr/bin/env python3
"""Viscous flows of SPH between plates and past cylinders, beside closed forms: figures of doc/sph_viscosity.md. Six
minutes; arguments are numbers of particles.

    . build/env.sh
    unittest/bench/sph_plates.py 10 20"""
import sys

import from_tests  # noqa: F401
from sph_plates import cylinders, swinging_plate, two_viscosities, viscosity_in_couette, viscosity_in_poiseuille

SCENES = [dict(pair="laplacian correction yes", h=1.3, kernel="cubicspline"),
          dict(pair="central correction yes", h=1.5), dict(pair="central correction yes", h=2),
          dict(pair="central shift yes", h=2), dict(pair="central shift yes", h=2.5)]

for n in [int(word) for word in sys.argv[1:]] or [10]:
    for scene in SCENES:
        print("%d across, %s: viscosity %.3f (Poiseuille), %.3f (Couette); two viscosities %.4f; plate, %d a layer: "
              "%.4f; cylinders, %d across: %.3f" % (
                  n, scene, viscosity_in_poiseuille(n, **scene), viscosity_in_couette(n, **scene),
                  two_viscosities(n, ratio=10, jitter=0, **scene), n // 2, swinging_plate(n // 2, **scene),
                  12 * n // 5, cylinders(12 * n // 5, **scene)), flush=True)
