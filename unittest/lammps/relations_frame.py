"""The numbers of an input with what they are, so that the whole of it can be shifted, turned, mirrored, renumbered or
told in other units, and its output brought back (for relations.py).

A line of a scene holds marks such as <F 0 0 -1>, a force along -z. `write` puts the words of one frame in their place:

    <KIND a>            a number of the kind (KINDS)        <KIND a b c>        a vector; kinds W, Q and turn are axial
    <at z 1.5>          a coordinate                        <side zlo -8.3>     a face with its place: zlo -8.3
    <face zlo>, <axis z>                                    <each p p f>        a word for each axis
    <block 0 1 INF INF 2 3>                                 <planes x 0 NULL>   xplane 0 NULL
    <corners -1 1 ...>  lo x y z hi x y z
    <ids 1 4>           IDs of atoms                        <one P f>           a formula in X, Y, Z, TIME, as a number
                                                            of the kind
    <field u V f g h>   a whole line: variables ux, uy, uz of atom style, a vector of formulas"""
import re

import numpy as np

# powers of length, time, mass
KINDS = {"1": (0, 0, 0), "turn": (0, 0, 0), "L": (1, 0, 0), "p": (1, 0, 0), "area": (2, 0, 0), "t": (0, 1, 0),
         "rate": (0, -1, 0), "m": (0, 0, 1), "V": (1, -1, 0), "V2": (2, -2, 0), "A": (1, -2, 0), "W": (0, -1, 0),
         "nu": (2, -1, 0), "F": (1, -2, 1), "Q": (2, -2, 1),
         "k": (0, -2, 1), "E": (2, -2, 1), "power": (2, -3, 1), "slope": (-2, -2, 1), "curvature": (-1, 0, 0),
         "rho": (-3, 0, 1), "P": (-1, -2, 1), "stress": (-1, -2, 1), "eta": (-1, -1, 1), "drho": (-3, -1, 1),
         # in two dimensions
         "rho2": (-2, 0, 1), "P2": (0, -2, 1), "stress2": (0, -2, 1), "eta2": (0, -1, 1), "drho2": (-2, -1, 1)}
AXIAL = ("W", "Q", "turn")
AXES, SIDES = "xyz", ("lo", "hi")


def turned(*axes):
    """The matrix that takes x, y, z to the axes named: turned("y", "-x", "z") is a quarter turn about z."""
    R = np.zeros((3, 3))
    for k, name in enumerate(axes):
        R[AXES.index(name[-1]), k] = -1.0 if name[0] == "-" else 1.0
    return R


class Frame:
    """x' = size (R x + shift); scale: how much larger the numbers of lengths, times and masses are; order: who is atom
    1, 2, ..."""

    def __init__(self, R=None, shift=(0.0, 0.0, 0.0), scale=(1.0, 1.0, 1.0), order=None):
        self.R, self.shift, self.scale, self.order = np.eye(3) if R is None else R, np.array(shift, float), scale, order
        self.where = [int(np.nonzero(self.R[:, k])[0][0]) for k in range(3)]       # old axis -> new axis
        self.sign = [float(self.R[self.where[k], k]) for k in range(3)]

    def factor(self, kind):
        return float(np.prod([s**p for s, p in zip(self.scale, KINDS[kind])]))

    # --- forth
    def vector(self, kind, v):
        v = self.R @ np.asarray(v, float) * (np.linalg.det(self.R) if kind in AXIAL else 1.0)
        return (v + self.shift if kind == "p" else v) * self.factor(kind)

    def coordinate(self, axis, value):
        k = AXES.index(axis)
        return (self.sign[k] * value + self.shift[self.where[k]]) * self.scale[0]

    def spans(self, words):
        """lo hi of each axis, in the new order"""
        new = [None] * 3
        for k in range(3):
            pair = [w if w in ("INF", "NULL", "EDGE") else repr(float(self.coordinate(AXES[k], float(w))))
                    for w in words[2 * k:2 * k + 2]]
            new[self.where[k]] = pair if self.sign[k] > 0 else pair[::-1]
        return new

    def face(self, name):
        k, side = AXES.index(name[0]), SIDES.index(name[1:])
        return AXES[self.where[k]] + SIDES[side if self.sign[k] > 0 else 1 - side]

    def formula(self, kind, text):
        for k, name in enumerate("XYZ"):
            new, L = self.where[k], self.scale[0]
            text = re.sub(rf"\b{name}\b",
                          f"({self.sign[k] / L!r}*{AXES[new]}-({float(self.sign[k] * self.shift[new])!r}))", text)
        text = re.sub(r"\bTIME\b", f"({1 / self.scale[1]!r}*step*dt)", text)
        return f"{self.factor(kind)!r}*({text})"

    def field(self, name, kind, formulas):
        lines = []
        for j in range(3):
            k = self.where.index(j)
            sign = self.sign[k] * (np.linalg.det(self.R) if kind in AXIAL else 1.0)
            lines.append(f"variable {name}{AXES[j]} atom {float(sign)!r}*{self.formula(kind, formulas[k])}")
        return "\n".join(lines)

    def mark(self, match):
        kind, *words = match.group(1).split()
        if kind in KINDS:
            values = [float(w) for w in words]
            new = self.vector(kind, values) if len(values) == 3 else [v * self.factor(kind) for v in values]
            return " ".join(repr(float(v)) for v in new)
        if kind == "at":
            return repr(float(self.coordinate(words[0], float(words[1]))))
        if kind == "side":
            return self.face(words[0]) + " " + repr(float(self.coordinate(words[0][0], float(words[1]))))
        if kind == "face":
            return self.face(words[0])
        if kind == "axis":
            return AXES[self.where[AXES.index(words[0])]]
        if kind == "each":
            return " ".join(words[self.where.index(j)] for j in range(3))
        if kind == "block":
            return " ".join(w for pair in self.spans(words) for w in pair)
        if kind == "corners":
            (a, b), (c, d), (e, f) = self.spans(words)
            return f"lo {a} {c} {e} hi {b} {d} {f}"
        if kind == "planes":
            k = AXES.index(words[0])
            all_six = ["NULL"] * 6
            all_six[2 * k:2 * k + 2] = words[1:3]
            return AXES[self.where[k]] + "plane " + " ".join(self.spans(all_six)[self.where[k]])
        if kind == "ids":
            return " ".join(str(self.new_id(int(w))) for w in words)
        if kind == "one":
            return self.formula(words[0], words[1])
        assert kind == "field", match.group(0)
        return self.field(words[0], words[1], words[2:5])

    def write(self, line):
        return re.sub(r"<(\w+ [^<>]*)>", self.mark, line)

    def new_id(self, old):
        return old if self.order is None else self.order.index(old) + 1

    # --- back
    def back(self, kind, values):
        """Rows of numbers or vectors of the kind, in the new frame, as they are in the old one."""
        values = np.asarray(values, float) / self.factor(kind)
        if kind.startswith("stress") and values.shape[-1] == 6:
            index = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])
            S = self.R.T @ values[..., index] @ self.R
            return np.stack([S[..., 0, 0], S[..., 1, 1], S[..., 2, 2], S[..., 0, 1], S[..., 0, 2], S[..., 1, 2]],
                            axis=-1)
        if values.ndim == 0 or values.shape[-1] != 3:
            return values
        if kind == "p":
            values = values - self.shift
        return values @ self.R * (np.linalg.det(self.R) if kind in AXIAL else 1.0)

    def back_grid(self, values):
        """Velocities [nz, ny, nx, 3] at the nodes of a grid that moved along: [nx, ny, nz, 3] of the old frame."""
        values = np.transpose(values, (2, 1, 0, 3))
        values = np.transpose(values, self.where + [3])
        for k in range(3):
            if self.sign[k] < 0:
                values = np.flip(values, k)
        return self.back("V", values)
