"""What `tchat explore` finds: the branches over a parameter, what each begins at, and curves in two parameters."""

import json
import os

from .branch import branch_of_files
from .orbit import _axes, read_signature
from .program import Error
from .sweep import read_sweep


class _Explored:
    """What branches and curves of a diagram have in common: files of a name."""

    def __init__(self, diagram, found):
        self._diagram, self._parent, self._branch = diagram, found["parent"], None
        self.name, self.origin = found["name"], found["origin"]
        self.signatures = [read_signature(text) for text in found["signatures"]]
        self.labels, self.commands = found["labels"], found["commands"]

    @property
    def parent(self):
        return self._diagram[self._parent] if self._parent else None

    @property
    def branch(self):
        if self._branch is None:
            path = os.path.join(self._diagram.path, "p." + self.name)
            self._branch = branch_of_files(path, self._diagram.problem, self._diagram._program)
        return self._branch


class ExploredBranch(_Explored):
    """A branch of a diagram.

    name, origin          of its files, and in words what it begins at: "PD 3 of b2 at alpha = 3.03619"
    parent, children      branches of the diagram; parent is None for that of an attractor
    range, signatures     of the parameter, and of its orbits
    labels                a dictionary for each special point: label, type, parameter, leads_to and curve (names or ""),
                          remark
    ends                  a dictionary for each direction in which it ends: reason (a word: "bound", "points", ...), text
    commands              those of tchat that make it, in the folder of the problem
    branch                its points, orbits and labels: a Branch
    """

    def __init__(self, diagram, found):
        super().__init__(diagram, found)
        self.range, self.ends = (found["from"], found["to"]), found["ends"]

    @property
    def children(self):
        return [one for one in self._diagram.branches if one._parent == self.name]

    def __repr__(self):
        return "%s: %.6g to %.6g, %s" % (self.name, *self.range, self.origin)


class ExploredCurve(_Explored):
    """A curve of special points in two parameters. name, signatures, commands and branch as those of a branch.

    kind, origin          "PD", and the label that it begins at: "PD 3 of b2"
    parent                the branch or curve of that label
    ranges                of both parameters
    labels                a dictionary for each special point: label, type, first and second (the parameters), detail,
                          leads_to (names of curves and branches)
    ends                  a dictionary for each end: first, second, reason
    """

    def __init__(self, diagram, found):
        super().__init__(diagram, found)
        self.kind, self.ends = found["kind"], found["ends"]
        self.ranges = tuple(found["first"]), tuple(found["second"])

    def __repr__(self):
        return "%s: %s curve from %s" % (self.name, self.kind, self.origin)


class Diagram:
    """The branches that `tchat explore` has found: diagram.branches, or diagram["b1"] by name.

    parameter, quantity   along the axes of its picture
    coverage              the share of the sweep's periodic attractors and equilibria that lie on a branch; None without any
    unexplained           a dictionary for each attractor on no branch: attractor, kind, count, first, last,
                          segments, leads_to, command
    joins, failures       runs that led to branches found before, and those that failed, in words
    complete              False if an interruption has left something
    sweep                 its Sweep
    second                the other parameter of its curves; None without and_
    curves                those of special points in two parameters, by name like branches: diagram["c1"]
    slices                branches over the parameter that begin beside points of grazing curves
    codimension_two       a dictionary for each point that several curves have in common: first, second, curves
    without_curve         a dictionary for each reason why labels have no curve: labels, reason
    text                  the tree in words
    path                  the folder of the branches; path + ".png", ".svg", ".html" are its picture and page
    """

    def __init__(self, path, problem=None, program=None):
        self.path, self.problem, self._program = os.fspath(path), problem, problem.program if problem else program
        try:
            with open(self.path + ".json", encoding="utf-8") as file:
                found = json.load(file)
            with open(self.path + ".txt", encoding="utf-8") as file:
                self.text = file.read()
            self.branches = [ExploredBranch(self, one) for one in found["branches"]]
            self.second = found.get("second_parameter")
            self.curves = [ExploredCurve(self, one) for one in found.get("curves", [])]
            self.slices = [ExploredBranch(self, one) for one in found.get("slices", [])]
            self.codimension_two = found.get("codimension_two", [])
            self.without_curve = found.get("without_curve", [])
            self.parameter, self.quantity, self.complete = found["parameter"], found["quantity"], found["complete"]
            self.unexplained, self.joins, self.failures = found["unexplained"], found["joins"], found["failures"]
            known = found["periodic"] + found["at_rest"]
            self.coverage = found["on_branches"] / known if known else None
        except OSError as error:
            raise Error("%s: cannot be read (what tchat explore -o %s writes): %s" %
                        (error.filename, self.path, error.strerror)) from None
        except (ValueError, KeyError, TypeError):
            raise Error("%s.json: this is no diagram of tchat explore" % self.path) from None
        self._by_name = {one.name: one for one in self.branches + self.curves + self.slices}

    def __getitem__(self, name):
        if name not in self._by_name:
            raise Error("%s: no branch %r; there are %s" % (self.path, name, ", ".join(self._by_name) or "none"))
        return self._by_name[name]

    def __iter__(self):
        return iter(self.branches)

    def __len__(self):
        return len(self.branches)

    @property
    def sweep(self):
        return read_sweep(os.path.join(self.path, "sweep"))

    def plot(self, ax=None, y=None, **style):
        """Draws all branches with matplotlib on the attractors of the sweep; y is by default that of the picture."""
        ax = ax if ax is not None else _axes()
        y = y or self.quantity
        if y in self.sweep.columns:
            self.sweep.plot(ax, x=self.parameter, y=y, marker=".", color="0.65", zorder=0)
        for one in self.branches:
            one.branch.plot(ax, x=self.parameter, y=y, **style)
        return ax

    def plot_curves(self, ax=None, **style):
        """Draws all curves over both parameters with matplotlib."""
        ax = ax if ax is not None else _axes()
        for one in self.curves:
            one.branch.plot(ax, x=self.parameter, y=self.second, **style)
        return ax

    def picture(self):
        """The bytes of its PNG."""
        return self._drawn(".png")

    def _drawn(self, ending):
        try:
            with open(self.path + ending, "rb") as file:
                return file.read()
        except OSError as error:
            raise Error("%s: cannot be read (tchat explore draws it with gnuplot): %s" %
                        (self.path + ending, error.strerror)) from None

    def _repr_png_(self):
        return self.picture() if os.path.exists(self.path + ".png") else None

    def __repr__(self):
        return self.text.rstrip("\n")


def range_word(over, option="over", counts=(0, 1)):
    """NAME=FROM:TO or NAME=FROM:TO:COUNT of {"gamma": (0, 0.05)} or {"gamma": (0, 0.05, 200)}."""
    pairs = list(over.items()) if hasattr(over, "items") else []
    if len(pairs) != 1 or not hasattr(pairs[0][1], "__len__") or len(pairs[0][1]) - 2 not in counts:
        raise Error("%s=%r: a diagram is explored over one parameter between two values, as %s={\"gamma\": (0, 0.05)}" %
                    (option, over, option))
    (name, (begin, end, *count)), = pairs
    return "%s=%r:%r" % (name, float(begin), float(end)) + "".join(":%d" % one for one in count)


def explore(problem, words, name, over, second, options, value_words):
    """Runs `tchat explore` of a Problem: its Diagram, also without any branch."""
    ranges = ["--over", range_word(over)] + (["--and", range_word(second, "and_", (0,))] if second else [])
    try:
        problem._execute("explore", [problem.name, "-p", problem.source, "-o", name] + ranges + options + list(words) +
                         value_words)
    except Error as error:
        if error.status != 1 or "Coverage: " not in error.screen:
            raise
    return Diagram(problem.path(name), problem)
