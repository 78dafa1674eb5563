#!/usr/bin/env python3
"""Runs the ported input and compares it with the kept log. After: . build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402

c = S.Checks()
_, t = S.lmp(folder, "liggghts", 1)
kept = S.thermo(os.path.join(folder, "log.liggghts.1"))
for k in (1, 2):    # later the splashing water depends on rounding
    c.near("kinetic energy at t = %g" % t["Time"][k], t["c_kinetic"][k], kept["c_kinetic"][k],
           1e-3 * kept["c_kinetic"][k])
    c.near("load on the floor over weight at t = %g" % t["Time"][k], t["v_load"][k], kept["v_load"][k],
           1e-3 * kept["v_load"][k])
c.below("time step over its limit", t["f_limit"].max(), 0.3)
sys.exit(c.finish())
