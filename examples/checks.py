"""The figures that an example promises, each as a line "ok" or "MISSED", and the exit status of its run.py.

    c = Checks()
    c.near("period of the doublet", value, wanted, tolerance)       |value - wanted| <= tolerance
    c.below("largest overlap", value, limit)                        value <= limit
    c.within("speed of the cloud", value, low, high)                low <= value <= high
    c.holds("twice the grid halves the error", fact)                fact is true
    sys.exit(c.finish())                                            0 if nothing was missed

A value that is not finite is missed, and so is a script that checks nothing. examples/run.sh all counts these lines."""
import math


class Checks:
    def __init__(self):
        self.ok = self.missed = 0

    def near(self, what, value, wanted, tolerance):
        return self._line(abs(value - wanted) <= tolerance,
                          f"{what}: {value:.8g} (wanted {wanted:.8g} +- {tolerance:.2g})", value)

    def below(self, what, value, limit):
        return self._line(value <= limit, f"{what}: {value:.8g} (wanted at most {limit:.8g})", value)

    def within(self, what, value, low, high):
        return self._line(low <= value <= high, f"{what}: {value:.8g} (wanted {low:.8g} to {high:.8g})", value)

    def holds(self, what, fact):
        return self._line(fact, what)

    def _line(self, fact, text, value=0.0):
        fact = bool(fact) and math.isfinite(value)
        print(("ok      " if fact else "MISSED  ") + text, flush=True)
        self.ok += fact
        self.missed += not fact
        return fact

    def finish(self):
        if self.ok + self.missed == 0:
            self.holds("no figure was looked at", False)
        print(f"{self.ok} of {self.ok + self.missed} figures hold" + (f", {self.missed} MISSED" if self.missed else ""),
              flush=True)
        return 1 if self.missed else 0
