"""What `tchat simulate` writes."""

import os
import re

import numpy as np

from .branch import output_of
from .program import Error, constant_word, execute


class Trajectory:
    """Rows of O.trajectory or O.events: segment, index (rows x 3: field, event, jump), t, and columns by their
    headings, trajectory["x1"], which are the states' own names: where a state is called i or t, the column of the
    field or the time is i_ or t_; parameters: values by name, from the heading; what: what each event is (else None)."""

    def __init__(self, path):
        try:
            with open(path, encoding="latin-1", newline="") as file:
                lines = file.read().splitlines()
        except OSError as error:
            raise Error("%s: cannot be read (what tchat simulate writes): %s" % (path, error.strerror)) from None
        if len(lines) < 2 or not lines[1].startswith("#segment"):
            raise Error("%s:2: no heading #segment; give a NAME.trajectory or NAME.events of tchat simulate" % path)
        self.path, self.columns = path, lines[1][1:].split()
        self.parameters = {name: float(value) for name, value in re.findall(r"(\S+) = ([^,\s]+)", lines[0])}
        events = self.columns[-1] == "what"
        rows, self._begins, fresh = [], [], True
        for number, words in enumerate(map(str.split, lines[2:]), 3):
            if not words:
                fresh = True
                continue
            if len(words) != len(self.columns):
                if number == len(lines):  # cut off
                    break
                raise Error("%s:%d: %d words, expected are %d; the file is damaged" %
                            (path, number, len(words), len(self.columns)))
            if fresh:
                self._begins.append(len(rows))
            fresh = False
            rows.append(words)
        self.what = np.array([row[-1] for row in rows], dtype=object) if events else None
        try:
            numbers = [float(word) for row in rows for word in (row[:-1] if events else row)]
        except ValueError:
            raise Error("%s: there is a word that is no number; the file is damaged" % path) from None
        self.data = np.array(numbers).reshape(len(rows), len(self.columns) - events)
        self.segment, self.index, self.t = self.data[:, 0].astype(int), self.data[:, 1:4].astype(int), self.data[:, 4]

    def __len__(self):
        return len(self.data)

    def __getitem__(self, name):
        if name not in self.columns or name == "what":
            raise Error("%s: no column %r; there are %s" % (self.path, name, ", ".join(self.columns)))
        return self.data[:, self.columns.index(name)]

    def segments(self):
        """Row indices of each segment: for rows in trajectory.segments(): plot(trajectory.t[rows], ...)."""
        return np.split(np.arange(len(self)), self._begins[1:]) if len(self) else []


class Simulation:
    """What `tchat simulate` has written.

    trajectory, events    of its files
    start                 the periodic orbit that it ended on (Start), None where there was none
    orbit                 the same: simulation.orbit.continue_(...), simulation.orbit.period
    screen                what it printed
    """

    def __init__(self, output, screen, start=None):
        self._output, self.screen, self.start = output, screen, start

    orbit = property(lambda self: self.start)
    trajectory = property(lambda self: read_trajectory(self._output))
    events = property(lambda self: read_events(self._output))

    def __repr__(self):
        return str(self.screen).strip()


def read_trajectory(path):
    """O.trajectory of tchat simulate, `O` for short."""
    path = os.fspath(path)
    return Trajectory(path if os.path.exists(path) else path + ".trajectory")


def read_events(path):
    """O.events of tchat simulate, `O` for short."""
    path = os.fspath(path)
    return Trajectory(path if path.endswith(".events") else path + ".events")


def simulate(name, *words, cwd=None, program=None, **constants):
    """`tchat simulate NAME words KEY=VALUE...`; parameters as `"PAR(alpha)=3"` among the words."""
    words = list(words) + [constant_word(key, value) for key, value in constants.items()]
    screen = execute(["simulate", name] + words, cwd, program)
    return Simulation(os.path.join(cwd or "", output_of(name, words)), screen)
