"""What the words of a command may be, how they are written, damaged and read again (for fuzz.py).

A kind of word (Number, Choice, ...) has good values, values on the border, and judges any word. A grammar gives each
keyword the kinds of its values. A Case is one command in a scene: drawn, damaged, then read as the pages say it must
be."""
import math
import random
import re

GOOD, ODD, LOUD, BAD = "good", "odd", "loud", "bad"
LATE = "bad, but perhaps seen only when all words are read, so that other faults may come first"

# --- words: what may stand for a value, and what the pages say of it --------------------------------------------------

NONSENSE = """nan inf -inf INF 1e400 -1e400 1e-400 0x10 0x1p3 abc "" NULL yes no 1.5.2 1,5 1d3 --1 + - 5x 1e v_
v_missing v_text v_nan v_index -1 0 -0.0 1e3 3.7 007 +2 .5 5. 2147483647 2147483648 -2147483648 4294967297
9223372036854775808 * all 1e300 1e-300 c_1 f_2[3]""".split() + ["9" * 25, "x" * 300]
DECIMAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$")
EXTREME = 1e10


def decimal(word):
    """The number that a user would read there, or None. 1e400 is no number of a computer: infinite."""
    return float(word) if DECIMAL.match(word) else None


class Number:
    def __init__(self, allowed, good, border=(), odd=lambda v: False, loud=lambda v: False):
        self.allowed, self.good, self.border, self.odd, self.loud = allowed, good, list(border), odd, loud

    def judge(self, word, case):
        value = decimal(word)
        if value is None or math.isinf(value):
            return BAD
        if not self.allowed(value):
            return ODD if self.odd(value) else LATE
        if self.loud(value):
            return LOUD
        if self.odd(value):
            return ODD
        if value == 0.0 and re.search("[1-9]", word.lower().split("e")[0]):      # 1e-400
            return ODD
        if value and not 1 / EXTREME < abs(value) < EXTREME:
            case.extreme = True
        return GOOD


class Integer(Number):
    def judge(self, word, case):
        if not re.match(r"[+-]?\d+$", word):
            return BAD
        value = int(word)
        if not self.allowed(value):
            return ODD if self.odd(value) else LATE
        if value >= 2**31 or re.match(r"\+|0\d", word) or self.odd(value):
            return ODD
        return GOOD


class Choice:
    border = ()

    def __init__(self, *options):
        self.good = list(options)

    def judge(self, word, case):
        return GOOD if word in self.good else BAD


class Name(Choice):
    """Of a group or region: those that exist and those that do not."""
    border = ("missing", "ALL")

    def judge(self, word, case):
        return GOOD if word in self.good else LATE


# what a field may name, for the scenes
VARIABLES = """variable eta equal 1.5
variable zero equal 0
variable minus equal -1
variable nan equal 1e308*10-1e308*10
variable text string hello
variable index index 3 4
variable place atom 1.2+0.01*x"""


class Field(Number):
    """A number, or v_name: an equal-style variable, an atom-style one too where that is allowed."""

    def __init__(self, allowed, good, border=(), atom=True):
        super().__init__(allowed, good + ["v_eta"] + ["v_place"] * atom,
                         [*border, "v_zero", "v_minus", "v_nan", "v_text", "v_index"] + ["v_place"] * (not atom))
        self.atom = atom

    def judge(self, word, case):
        if not word.startswith("v_"):
            return super().judge(word, case)
        if word == "v_place":
            return GOOD if self.atom else LATE
        values = {"v_eta": 1.5, "v_zero": 0.0, "v_minus": -1.0}
        case.variables.add(word)
        return GOOD if word in values and self.allowed(values[word]) else LATE


class File:
    """good: files that fit a mesh of CELLS slices."""

    def __init__(self, good):
        self.good, self.border = [good], ["short.txt", "words.txt", "empty.txt", "missing.txt", ".", "full.txt"]

    def judge(self, word, case):
        return GOOD if word in self.good else LATE


class Or:
    """The first word decides what follows; otherwise: what to do if it is none of them."""

    def __init__(self, otherwise=None, **ways):
        self.ways, self.otherwise = ways, otherwise

    def write(self, draw):
        ways = list(self.ways.items()) + ([(None, self.otherwise)] if self.otherwise else [])
        word, kinds = draw.choice(ways)
        return ([word] if word else []) + [w for kind in kinds for w in write(kind, draw)]

    def read(self, case):
        word = case.look()
        if word in self.ways:
            case.at += 1
            kinds = self.ways[word]
        elif self.otherwise:
            kinds = self.otherwise
        else:
            raise Wrong()
        return [w for kind in kinds for w in read(kind, case)] if word not in self.ways else [word] + [
            w for kind in kinds for w in read(kind, case)]


class Maybe:
    """One of these words, or none."""

    def __init__(self, *options):
        self.options = options

    def write(self, draw):
        return draw.choice([[]] + [[word] for word in self.options])

    def read(self, case):
        if case.at == len(case.words) or case.words[case.at] not in self.options:
            return []
        case.at += 1
        return [case.words[case.at - 1]]


class MaybeNumber:
    """A number of this kind, or none."""

    def __init__(self, kind):
        self.kind = kind

    def write(self, draw):
        return draw.choice([[], write(self.kind, draw)])

    def read(self, case):
        if case.at == len(case.words) or decimal(case.words[case.at]) is None:
            return []
        return read(self.kind, case)


class Counted:
    """n, then n values."""

    def __init__(self, most, kind):
        self.most, self.kind = most, kind

    def write(self, draw):
        n = draw.choice([1, 1, 2, 3])
        return [str(n)] + [w for _ in range(n) for w in write(self.kind, draw)]

    def read(self, case):
        most = self.most
        n = read(Integer(lambda v: 1 <= v <= most, ["1"]), case)[0]
        if not 1 <= int(n) <= most:
            raise Wrong()
        return [n] + [w for _ in range(int(n)) for w in read(self.kind, case)]


class Wrong(Exception):
    """The word at hand is wrong, whatever follows."""


def write(kind, draw):
    if hasattr(kind, "write"):
        return kind.write(draw)
    return [draw.choice(kind.border) if kind.border and draw.random() < 0.06 else draw.choice(kind.good)]


def read(kind, case):
    if hasattr(kind, "read"):
        return kind.read(case)
    word = case.look()
    level = kind.judge("" if word == '""' else word, case)
    if level == BAD:
        raise Wrong()
    if level == LATE:
        level = BAD
    if level != GOOD:
        case.says(level, case.keyword)
    case.at += 1
    return [word]


# --- a case -----------------------------------------------------------------------------------------------------------

class Case:
    """One command in a scene. lines: the script, of which line number `tried` is the command; the others are right."""

    def __init__(self, seed, number, makers):
        """makers: (function that fills in the case, weight)"""
        self.draw = random.Random(f"{seed}/{number}")
        self.extreme, self.variables, self.faults, self.level = False, set(), [], GOOD
        self.settings, self.given, self.keyword = {}, [], ""
        maker = self.draw.choices([m for m, _ in makers], [w for _, w in makers])[0]
        maker(self)

    # --- writing
    def words_of(self, grammar, required=(), few=6):
        """Keywords with values, the required ones among them."""
        draw = self.draw
        keys = draw.sample(list(grammar), draw.randint(0, few))
        keys += [k for k in required if k not in keys and draw.random() < 0.98]
        draw.shuffle(keys)
        return [w for k in keys for w in [k] + [w for kind in grammar[k] for w in write(kind, draw)]]

    def damaged(self, words):
        draw, words = self.draw, list(words)
        for _ in range(draw.choices([0, 1, 2, 4], [45, 40, 12, 3])[0]):
            how, k = draw.randrange(8), draw.randrange(len(words)) if words else 0
            if how == 0 or not words:
                words.insert(draw.randint(0, len(words)), draw.choice(NONSENSE + ["bogus 1", "unknown"]))
            elif how == 1:
                del words[k]
            elif how == 2:
                words.insert(k, words[k])
            elif how == 3:
                j = draw.randrange(len(words))
                words[j], words[k] = words[k], words[j]
            elif how == 4 and len(words[k]) > 1:
                j = draw.randrange(len(words[k]) - 1)
                w = words[k]
                words[k] = draw.choice([w[:j] + w[j + 1:], w[:j] + w[j + 1] + w[j] + w[j + 2:], w.upper(),
                                        w[:j] + "_" + w[j:]])
            elif how == 5 and len(words) > 2:       # a stretch of words once more, at the end
                words += words[k:k + 2]
            else:
                words[k] = draw.choice(NONSENSE)
        return [w for word in words for w in word.split()] if "" not in words else words

    # --- reading
    def look(self):
        if self.at >= len(self.words):
            raise Wrong()
        return self.words[self.at]

    def says(self, level, *names):
        self.faults += names
        self.level = max(self.level, level, key=[GOOD, ODD, LOUD, BAD].index)

    def judge(self, words, grammar, begin=()):
        """First what must stand there, then keywords with values. False: wrong at some word, the rest is not read."""
        self.words, self.at = words, 0
        try:
            for name, kind in begin:
                self.keyword = name
                self.settings[name] = read(kind, self)
            while self.at < len(words):
                self.keyword = words[self.at]
                if self.keyword not in grammar:
                    raise Wrong()
                self.at += 1
                self.settings[self.keyword] = [w for kind in grammar[self.keyword] for w in read(kind, self)]
                if self.keyword in self.given:
                    self.says(LOUD, self.keyword)
                self.given.append(self.keyword)
        except Wrong:
            self.says(BAD, self.keyword.strip('"'))
            return False
        return True

    def value(self, name, default=None):
        return self.settings[name][0] if name in self.settings else default

    def refuse_if(self, condition, *names):
        if condition:
            self.says(BAD, *names)


class NumberOr:
    def __init__(self, word, number):
        self.word, self.number, self.good, self.border = word, number, number.good + [word], number.border

    def judge(self, word, case):
        return GOOD if word == self.word else self.number.judge(word, case)


def delete_something(case, *settings):
    """Perhaps a region, group or variable that the command names vanishes before the run."""
    if case.draw.random() > 0.04:
        return
    names = {"region": "region {} delete", "group": "group {} delete", "average": "group {} delete"}
    there = [k for k in settings if k in case.settings and case.value(k) != "all" and case.level != BAD]
    if there:
        k = case.draw.choice(there)
        case.lines.append(names[k].format(case.value(k)))
        case.says(BAD, k)
    elif "v_eta" in case.variables and case.level != BAD:
        case.lines.append("variable eta delete")
        case.says(BAD, *[k for k, v in case.settings.items() if "v_eta" in v])


# --- kinds of words that many keywords share

ANY = Number(lambda v: True, ["0", "1", "-2.5", "0.3"])


def positive(*good, border=("0", "-1"), odd=lambda v: False):
    return Number(lambda v: v > 0, list(good), border, odd)


POSITIVE = Number(lambda v: v > 0, ["1", "0.7", "2.5"], ["0", "-1", "1e-300", "1e300", "-0"])
NOT_NEGATIVE = Number(lambda v: v >= 0, ["0", "0.1", "1"], ["-1", "-1e-300", "1e300"])
COUNT = Integer(lambda v: v >= 1, ["1", "2", "7"], ["0", "-1", "2147483647", "2147483648", "1.0", "1e3"])
YES_NO = Choice("yes", "no")
U = Field(lambda v: True, ["0", "0.4", "-1"])
