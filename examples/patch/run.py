#!/usr/bin/env python3
"""Runs patch with and without tensCorr; table and picture: do particles clump? After: . build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402

WANTED = {0: (0.05, 0.19, 0.60), 0.2: (0.59, 0.68, 0.89)}
plt, c = S.pyplot(), S.Checks()
figure, axes = plt.subplots(1, 2, figsize=(10, 4.6))
table = ("| tensCorr | distance of the nearest neighbour over dx: smallest | 5 % are below | median |\n"
         "|---|---|---|---|\n")
for epsilon, axis in ((0, axes[0]), (0.2, axes[1])):
    out, t = S.lmp(folder, "patch", "epsilon%s" % epsilon, epsilon=epsilon)
    shot = S.dump(os.path.join(out, "patch.%s.dump" % epsilon))[-1]
    x = np.stack([shot["x"], shot["y"]], axis=1)
    r = np.sqrt(((x[:, None] - x[None]) ** 2).sum(-1))
    np.fill_diagonal(r, 9)
    q = r.min(1) * 40
    table += "| %s | %.2f | %.2f | %.2f |\n" % ("epsilon 0.2" if epsilon else "without", q.min(), np.quantile(q, 0.05),
                                                np.median(q))
    for what, value, wanted in zip(("smallest", "5 % are below", "median"),
                                   (q.min(), np.quantile(q, 0.05), np.median(q)), WANTED[epsilon]):
        c.near("epsilon %s, nearest neighbour over dx, %s" % (epsilon, what), value, wanted, 0.05)
    colours = axis.scatter(x[:, 0], x[:, 1], c=shot["f_eos"], s=8, cmap="coolwarm", vmin=-0.3, vmax=0.3)
    axis.set(aspect="equal", title="with tensCorr 0.2" if epsilon else "without tensCorr")
    axis.grid(False)
figure.colorbar(colours, ax=axes, label="pressure")
figure.savefig(os.path.join(out, "patch.png"), bbox_inches="tight")
S.keep(folder, out, "patch.png", table)
sys.exit(c.finish())
