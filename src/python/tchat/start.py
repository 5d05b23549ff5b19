"""Starting data of runs, from simulations, `tchat resegment` or files."""

import os

from .orbit import read_labels, read_orbit
from .program import execute


class Start:
    """An orbit that a run can start from, with the constants that go with it.

    start.continue_(A=(0.5, 2))   the branch through it (Problem.continue_from has the words)
    start.orbit                   its states, start.signature, start.period
    """

    def __init__(self, problem, name, is_data, row=None):
        self.problem, self.name, self._is_data, self._row, self._orbit = problem, name, is_data, row, None

    @property
    def orbit(self):
        if self._orbit is None:
            path = self._solutions()
            rows = read_labels(path, self.problem.program)
            self._orbit = read_orbit(path, rows[0], self.problem.program)
            names = self.problem.state_names  # a start has no p-file beside it, which would hold them
            if len(names) == len(self._orbit.state_names):
                self._orbit.state_names = list(names)
        return self._orbit

    def _solutions(self):
        if self._is_data:  # as a label, in the same numbers
            if not os.path.exists(self.problem.path("q." + self.name)):
                execute(["dat", self.name, "-p", self.problem.source, "-c", self.name, "-o", self.name],
                        self.problem.folder, self.problem.program)
        return self.problem.path("q." + self.name)

    period = property(lambda self: self.orbit.period)
    signature = property(lambda self: self.orbit.signature)

    def continue_(self, *words, **values):
        """The branch through this orbit: Problem.continue_from."""
        start = ["-d", self.name] if self._is_data else ["-s", self.name]
        return self.problem.continue_from(start + ["-c", "gc." + self.name] + list(words), values)

    def __repr__(self):
        return "start %s: %r" % (self.name, self.orbit)
