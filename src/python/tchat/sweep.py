"""What `tchat sweep` writes: attractors over parameters or initial states."""

import os
import re

import numpy as np

from .branch import output_of
from .orbit import _axes, read_signature
from .program import Error, execute
from .tables import as_frame


class Sweep:
    """The table O.sweep: sweep["gamma"], sweep["attractor"], sweep["kind"], ... one value a row.

    over         the names of what is swept
    attractors   a dictionary for each: number, kind, signature, period, impacts, state, ... as the heading has them
    """

    def __init__(self, path, screen=""):
        self.path, self.screen = path, screen
        try:
            with open(path, encoding="utf-8") as file:
                lines = file.read().splitlines()
        except OSError as error:
            raise Error("%s: cannot be read (what tchat sweep writes): %s" % (path, error.strerror)) from None
        heading = [line for line in lines if line.startswith("#")]
        rows = [line.split() for line in lines if line and not line.startswith("#")]
        if not heading or not heading[0].startswith("# tchat sweep") or not rows:
            raise Error("%s: no heading # tchat sweep; give a NAME.sweep of tchat sweep" % path)
        self.columns = {name: self._column(name, [row[k] for row in rows[1:]]) for k, name in enumerate(rows[0])}
        self.over = [match[1] + ("(0)" if "initial state" in line else "") for line in heading
                     for match in [re.match(r"# over (\S+) from ", line)] if match]
        self.attractors = [self._attractor(match) for line in heading
                           for match in [re.match(r"# attractor (\d+): ([a-z-]+)(.*)", line)] if match]

    @staticmethod
    def _column(name, words):
        if name == "kind":
            return np.array(words, dtype=object)
        values = np.array(words, dtype=float)
        whole = name in ("index", "start", "attractor", "event")
        return values.astype(int) if whole and np.all(np.isfinite(values)) else values

    @staticmethod
    def _attractor(match):
        rest = match[3]
        found = {"number": int(match[1]), "kind": match[2]}
        signature = read_signature(re.split(", (?:impacts|period|index) ", rest)[0])
        if signature:
            found["signature"] = signature
        for name, value in re.findall(r"(impacts|period|index|mode|state) ([^ ]+?)(?:, |$)", rest):
            found[name] = value if name == "mode" else [float(x) for x in value.split(",")] if name == "state" \
                else float(value)
        return found

    def __getitem__(self, name):
        if name not in self.columns:
            raise Error("%s: no column %r; there are %s" % (self.path, name, ", ".join(self.columns)))
        return self.columns[name]

    def __len__(self):
        return len(self.columns["index"])

    def frame(self):
        """The table as a pandas.DataFrame."""
        return as_frame(self.columns)

    def plot(self, ax=None, x=None, y=None, **style):
        """Dots over what is swept, with matplotlib; y is by default the first state that was recorded."""
        ax = ax if ax is not None else _axes()
        x = x or self.over[0]
        names = list(self.columns)
        y = y or names[-1]
        ax.plot(self[x], self[y], **{"linestyle": "none", "marker": ",", "color": "black", **style})
        ax.set_xlabel(x)
        ax.set_ylabel(y)
        return ax

    def __repr__(self):
        return "%s: %d rows, %d attractors" % (self.path, len(self), len(self.attractors))


def read_sweep(path):
    """O.sweep, `O` for short."""
    path = os.fspath(path)
    return Sweep(path if path.endswith(".sweep") else path + ".sweep")


def over_words(over):
    """--over NAME=FROM:TO:COUNT of {"gamma": (0, 0.05, 200)}."""
    if not hasattr(over, "items"):
        raise Error("over=%r: give what is swept as a dictionary, over={\"gamma\": (0, 0.05, 200)}" % (over,))
    words = []
    for name, values in over.items():
        try:
            values = [float(one) for one in values]
        except (TypeError, ValueError):
            values = []
        two_ends = len(values) == 2 and isinstance(over[name], tuple)
        if len(values) == 2 and not two_ends or len(values) > 3:
            steps = np.diff(values)
            if np.ptp(steps) > 1e-6 * np.abs(steps).max():
                raise Error("over={%r: ...}: the values have to be equally spaced" % name)
            values = [values[0], values[-1], len(values)]
        if len(values) != 3 or values[2] != int(values[2]):
            raise Error("over={%r: ...}: give the first value, the last one and their number, as (0, 0.05, 200), or the "
                        "values themselves" % name)
        words += ["--over", "%s=%r:%r:%d" % (name, *values)]
    return words


def sweep(problem, *words, over, jobs=1, cwd=None, program=None, **options):
    """`tchat sweep` of a Problem, or of a problem by its name: tchat.sweep(problem, over={"gamma": (0, 0.02, 200)},
    section="strike", jobs=2). Options and parameters are those of Problem.sweep."""
    if hasattr(problem, "sweep"):
        return problem.sweep(*words, over=over, jobs=jobs, **options)
    words = over_words(over) + ["-j", jobs] + list(words)
    from .words import value_words
    screen = execute(["sweep", problem] + words + value_words(options, program), cwd, program)
    return read_sweep(os.path.join(cwd or "", output_of(problem, words)))
