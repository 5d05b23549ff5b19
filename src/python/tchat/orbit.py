"""A labelled orbit: states over time, segment by segment."""

import re

import numpy as np

from .program import Error, execute
from .tables import read_table


class Orbit:
    """An orbit of m segments with n states.

    orbit["x1"], orbit["U(1)"]   a state over all segments, m x points
    t, tau                       time since the start of segment 1, and from 0 to 1 on each segment; m x points
    states, state_names          m x n x points, and the names in this order
    period, durations            of the segments, and their sum
    parameters                   by name; orbit.parameter("omega"), orbit.parameter("PAR(1)")
    signature                    [(field, event, jump), ...], one for each segment; None where it is not known
    label, name, type, kind      as in the table of labels: 4, "PD1", "PD", and what it is in words
    """

    def __init__(self, row, columns):
        self.label, self.name, self.type, self.kind = int(row["label"]), row["name"], row["type"], row["kind"]
        self.period, self.signature = row["period"], read_signature(row["signature"])
        self.parameters = {name: value for name, value in list(row.items())[list(row).index("kind") + 1:]
                           if not np.isnan(value)}
        segment, tau, t, *self.state_names = columns  # a state may be called t
        segments = int(columns[segment][-1])
        self.tau, self.t = columns[tau].reshape(segments, -1), columns[t].reshape(segments, -1)
        self.states = np.array([columns[name].reshape(segments, -1) for name in self.state_names]).swapaxes(0, 1)
        self.durations = self.t[:, -1] - self.t[:, 0]

    def __getitem__(self, name):
        match = re.fullmatch(r"U\(([0-9]+)\)", str(name))
        place = int(match[1]) - 1 if match else self.state_names.index(name) if name in self.state_names else -1
        if not 0 <= place < len(self.state_names):
            raise Error("no state %r; there are %s and U(1) to U(%d)" %
                        (name, ", ".join(self.state_names), len(self.state_names)))
        return self.states[:, place, :]

    def parameter(self, name):
        """A parameter by its name, or as PAR(k) where it has none."""
        if name not in self.parameters:
            raise Error("no parameter %r; there are %s" % (name, ", ".join(self.parameters)))
        return float(self.parameters[name])

    def plot(self, ax=None, x=None, y=None, **style):
        """Draws the phase portrait with matplotlib: y over x, by default the second state over the first. x="t": over
        time."""
        ax = ax if ax is not None else _axes()
        x = x or self.state_names[0]
        y = y or self.state_names[min(1, len(self.state_names) - 1)]
        style.setdefault("color", "black")
        for along, values in zip(self.t if x == "t" else self[x], self[y]):
            ax.plot(along, values, **style)
        ax.set_xlabel(x)
        ax.set_ylabel(y)
        return ax

    def __repr__(self):
        return "%s: %d segment%s, period %.10g" % (self.name or "label %d" % self.label, len(self.t),
                                                   "" if len(self.t) == 1 else "s", self.period)


def _axes():
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise Error("plot() needs matplotlib (Debian: python3-matplotlib)") from None
    return plt.gca()


_LONGEST_SIGNATURE = 10 ** 7  # characters
_POWER = re.compile(r"(\{[^{}]*\}|\([^()]*\))\^(\d+)")


def read_signature(text):
    """[(1, 2, 2), (1, 1, 1)] of "{(1,2,2), (1,1,1)}"; a power repeats what is in front of it. None of nothing."""
    text = text or ""
    while power := _POWER.search(text):
        if len(power[1]) * int(power[2]) > _LONGEST_SIGNATURE:
            raise Error("%s...: a power of %s is no signature that could be written out" % (text[:40], power[2][:20]))
        text = text[:power.start()] + power[1].strip("{}") * int(power[2]) + text[power.end():]
    triples = re.findall(r"\((\d+),(\d+),(\d+)\)", text)
    return [tuple(map(int, triple)) for triple in triples] or None


def read_labels(path, program=None):
    """The table of labels of a q-file, a dictionary a row."""
    columns = read_table(execute(["labels", path, "--csv"], program=program))
    return [dict(zip(columns, values)) for values in zip(*columns.values())]


def read_orbit(path, row, program=None):
    """The orbit of a row of that table."""
    return Orbit(row, read_table(execute(["orbit", path, int(row["label"]), "--csv"], program=program)))
