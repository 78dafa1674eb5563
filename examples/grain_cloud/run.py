#!/usr/bin/env python3
"""One grain falls, and a cloud of grains: speeds beside the law of drag and the flow of Stokes's equation averaged over
h. After: . build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402

c, plt = S.Checks(), S.pyplot()


def drag(d, mu, U):
    """Brown & Lawler's law, as a force."""
    Re = U * d / mu
    return np.pi / 8 * d * d * U * U * (24 / Re * (1 + 0.15 * Re**0.681) + 0.407 / (1 + 8710 / Re))


def averages(h, k):
    """Of waves k: what is left of them in the mean over Wendland's kernel, W, and the part S of mu k^2 that the
    friction of SPH has (its integral over the kernel, in 1 - sin x/x and its like)."""
    r = np.linspace(0, 2, 801)[1:]
    dr, kh = r[1] - r[0], np.maximum(k * h, 1e-6)[:, None]
    kernel, slope = (1 - r / 2) ** 4 * (2 * r + 1) * 21 / (16 * np.pi), 5 * r * (1 - r / 2) ** 3 * 21 / (16 * np.pi)
    x = kh * r
    along = np.where(x > 0.02, (np.sin(x) / x - np.cos(x)) / x**2, 1 / 3 - x * x / 30)
    return (4 * np.pi * dr * (r * r * kernel * np.sinc(x / np.pi)).sum(1),
            40 * np.pi * dr * (r * slope * (1 / 3 - along)).sum(1) / kh[:, 0] ** 2)


def speed_of_all(places, L, h, mu, F):
    """Mean velocity of grains in the flow of each other and of all images, in water at rest in the mean: Stokes's
    equation, wave by wave; h None: not averaged."""
    n = np.stack(np.meshgrid(*[np.arange(-12, 13)] * 3, indexing="ij"), -1).reshape(-1, 3) * 2 * np.pi / L
    n = n[(n != 0).any(1)]
    k = np.linalg.norm(n, axis=1)
    W, friction = averages(h, k) if h else (1.0, 1.0)
    others = (np.abs(np.exp(1j * n @ places.T).sum(1)) ** 2 - len(places)) / len(places)
    return F / (mu * L**3) * ((1 - (n[:, 2] / k) ** 2) * W**2 / (k**2 * friction) * others).sum()


# --- one grain --------------------------------------------------------------------------------------------------------

rows, U = [], 0.5
for Re, h_over_d in ((10, 2), (10, 4), (200, 2), (200, 4)) if not S.QUICK else ((200, 2), (200, 4)):
    d = 2 / h_over_d
    mu = U * d / Re
    out, run = S.lmp(folder, "grain_cloud", "one", grains=1, L=12, radius=1, diameter=d, mu=mu, force=drag(d, mu, U),
                     start=U, c=5, dt=0.06, steps=200)
    rows.append((Re, h_over_d, run["v_speed"][-1] / U))
    c.near("Re = %d, h = %d d: speed of a grain over that of the law" % (Re, h_over_d), rows[-1][2], 1.0,
           0.02 if Re == 10 else 0.012)

# --- a cloud ----------------------------------------------------------------------------------------------------------

N, R, L, F, mu, d = 150, 4.0, 20.0, 0.02, 1.0, 0.5
out, run = S.lmp(folder, "grain_cloud", "cloud", steps=80 if S.QUICK else 400)
shots = S.dump(os.path.join(out, "grain_cloud.dump"))
places = np.stack([shots[-1][name][shots[-1]["type"] == 2] for name in ("x", "y", "zu")], 1)
alone, speed = F / (3 * np.pi * mu * d), run["v_speed"][-1]
averaged, points = [alone + speed_of_all(places, L, h, mu, F) for h in (2.0, None)]
drop = alone + N * F / (5 * np.pi * mu * R)
print("  cloud %.5f; averaged over h %.5f; not averaged %.5f; a drop without images %.5f; a lone grain %.5f" %
      (speed, averaged, points, drop, alone))
c.holds("the cloud falls more than four times as fast as a lone grain", speed > 4 * alone)
c.below("it stays together: its height at last over that at first",
        (run["c_high"] - run["c_low"])[-1] / (run["c_high"] - run["c_low"])[0], 1.1)
c.below("phi of the water, largest", shots[-1]["f_coupling[1]"].max(), 0.2)
if not S.QUICK:
    c.near("speed of the cloud over that of Stokes's equation averaged over h", speed / averaged, 1.0, 0.02)

figure, axes = plt.subplots(1, 3, figsize=(10.5, 3.8), gridspec_kw={"width_ratios": (1, 1, 1.2)})
for a, shot, name in zip(axes, (shots[0], shots[-1]), ("at first", "at last")):
    g, w = shot["type"] == 2, (shot["type"] == 1) & (np.abs(shot["y"] - L / 2) < 0.8)
    a.quiver(shot["x"][w], shot["zu"][w] % L, shot["vx"][w], shot["vz"][w], color="tab:blue", width=0.005, scale=0.25)
    a.scatter(shot["x"][g], shot["zu"][g] % L, s=8, c="saddlebrown", lw=0)
    a.set(aspect="equal", xlim=(0, L), ylim=(0, L), xticks=[], yticks=[], title="the cloud " + name)
    a.grid(False)
axes[2].plot(run["Time"], run["v_speed"], label="cloud of %d grains" % N)
axes[2].axhline(averaged, color="k", ls="--", lw=1, label="Stokes, averaged over h")
axes[2].axhline(points, color="k", ls=":", lw=1, label="Stokes, not averaged")
axes[2].axhline(alone, color="tab:orange", lw=1, label="one grain")
axes[2].set(xlabel="time", ylabel="speed", ylim=(0, None))
axes[2].legend(frameon=False, fontsize=8)
figure.tight_layout()
figure.savefig(os.path.join(out, "grain_cloud.png"), bbox_inches="tight")
table = "| Re | h/d | speed over that of the law |\n|---|---|---|\n" + "".join("| %d | %d | %.3f |\n" % row
                                                                               for row in rows)
table += ("\n| | speed |\n|---|---|\n| cloud of 150 grains, h = R/2 | %.4f |\n"
          "| Stokes's equation, averaged over h | %.4f |\n" % (speed, averaged))
table += "| not averaged | %.4f |\n| a drop without images | %.4f |\n| a lone grain | %.4f |\n" % (points, drop, alone)
S.keep(folder, out, "grain_cloud.png", table)
sys.exit(c.finish())
