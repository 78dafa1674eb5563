"""A scene of relations.py: atoms, and the lines of an input with marks (relations_frame.py), by what a restart needs of
them."""
import numpy as np


def until_settled(rules):
    """lawful(o) of rules(o, no): a copy of the options o, changed by no(condition, option=value ...) until nothing
    changes any more."""
    def lawful(o):
        o, was = dict(o), None

        def no(condition, **instead):
            if condition:
                o.update(instead)

        while o != was:
            was = dict(o)
            rules(o, no)
        return o

    return lawful


class Scene:
    def __init__(self, model, options, seed):
        self.model, self.options, self.seed = model, options, seed
        self.atoms, self.head, self.make, self.after = [], [], [], []
        self.groups, self.define, self.pair, self.fixes = [], [], [], []
        self.late = []                                  # after the fixes, not again after a restart
        self.columns, self.globals = [], []             # (kind, words of dump or thermo)
        self.other = None                               # words of another pair style for the same scene
        self.output_between = ""                        # a number of ours that is asked for between two pair styles
        self.repeats = ""                               # 2 along an axis along which it is periodic, and 1 1
        self.drift = np.zeros(3)                        # the same scene in a frame that moves
        self.types = 0                                  # of ours, where there is one more, of strangers
        self.spacing = 1.0                              # of the order of the distances of neighbours
        self.length = 1.0                               # that differences of places are measured in
        self.grid = None                                # nodes, lo, hi of fix stokes_dynamics/field
        self.dt, self.steps, self.tolerance = 1.0, 2, 1e-8
        self.floor = 1e-2                             # what is smaller than this, in units of the scene, counts as this

    def atom(self, x, v=(0, 0, 0), type=1, **values):
        self.atoms.append(dict(x=tuple(map(float, x)), v=tuple(map(float, v)), type=type, **values))

    def at_rest(self, kind, step, rows):
        """Rows of atoms in the frame that does not move, and in the box that this one repeats"""
        if kind == "p":
            wrapped = np.array([np.subtract(a.get("from_box", a["x"]), a["x"]) for a in self.atoms])
            return rows + wrapped - self.drift * step * self.dt
        return rows - self.drift if kind == "V" else rows

    # --- as an input
    def create(self, frame):
        """create_atoms and set, in the order of the frame: the IDs follow"""
        lines = []
        for new, old in enumerate(frame.order or range(1, len(self.atoms) + 1), 1):
            a = self.atoms[old - 1]
            lines.append(f"create_atoms {a['type']} single <p {a['x'][0]!r} {a['x'][1]!r} {a['x'][2]!r}> units box")
            words = []
            if "diameter" in a:
                words += [f"diameter <L {a['diameter']!r}> density <rho {a['density']!r}>"]
            if a.get("molecule"):
                words.append(f"mol {a['molecule']}")
            if any(a["v"]) or self.drift.any():
                v = frame.vector("V", a["v"] + self.drift)
                words.append("vx {!r} vy {!r} vz {!r}".format(*map(float, v)))
            if "mu" in a:
                mu = frame.vector("1", a["mu"])
                words.append("dipole {!r} {!r} {!r}".format(*map(float, mu)))
            if "rho" in a:
                words.append(f"sph/rho <{a['kind']} {a['rho']!r}>" + f" mass <m {a.get('mass')!r}>" * ("mass" in a))
            if words:
                lines.append(f"set atom {new} " + " ".join(words))
        return [frame.write(line) for line in lines]

    def strangers(self):
        """Atoms among the others that have nothing to do with them"""
        flat = self.model.endswith("2-D")
        return [f"create_atoms {self.types + 1} single <p {x + 0.37!r} {y - 0.21!r} {z + 0.3 * (not flat)!r}> units box"
                for x, y, z in (a["x"] for a in self.atoms[::7])]

    def pair_lines(self, hybrid, words=None):
        """hybrid: none, "hybrid", "before" or "after": hybrid/overlay with pair_style zero there; "strangers": for
        them. words: others for our style"""
        styles = [(n, w if words is None or n != self.pair[-1][0] else words, c) for n, w, c in self.pair]
        if hybrid == "strangers":
            ours = f"1*{self.types} 1*{self.types}"
            styles = [(n, w, [(ours, c)] if isinstance(c, str) else c) for n, w, c in styles]
        if len(styles) == 1 and not hybrid:
            (name, style, coeff), = styles
            return [f"pair_style {name} {style}", f"pair_coeff * * {coeff}"]
        zero = ("zero", "<L 0.01>", "")
        if hybrid == "before":
            styles = [zero] + styles
        if hybrid in ("after", "strangers"):
            styles = styles + [zero]
        first = "hybrid" if len(styles) == 1 else "hybrid/overlay"
        coefficients = [f"pair_coeff {types} {n} {words}" for n, _,
                        c in styles for types, words in ([("* *", c)] if isinstance(c, str) else c)]
        return [f"pair_style {first} " + " ".join(f"{n} {w}" for n, w, _ in styles)] + coefficients

    def output(self, of_atoms=False):
        names = " ".join(words for _, words in self.columns)
        more = ["thermo_style custom step " + " ".join(words for _, words in self.globals if not of_atoms),
                "thermo_modify format float %.17g norm no"]
        if self.grid:
            n, lo, hi = self.grid
            ends = [str(v) for pair in zip(lo, hi) for v in pair]
            more.append(f"fix flow all stokes_dynamics/field {self.steps} flow.*.vti <each {n[0]} {n[1]} {n[2]}>"
                        f" <corners {' '.join(ends)}>")
        return more + [f"thermo {self.steps}", f"dump out all custom {self.steps} out id {names}",
                       "dump_modify out sort id format float %.17g"]
