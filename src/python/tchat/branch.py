"""Branches: the points of a run with all that its files know of them, and where their labels lead."""

import base64
import collections
import functools
import os
import re
import tempfile
import warnings

import numpy as np

from .orbit import _axes, read_labels, read_orbit, read_signature
from .program import Error, GrowingPoints, ProgressBar, TchatWarning, execute
from .tables import as_frame, read_table

_PLACES = {"grazing": "grazing-curve"}  # what resegment(to=) calls shorter


End = collections.namedtuple("End", "reason text")
Missing = collections.namedtuple("Missing", "start end text")
Missing.__doc__ = """Between these values of the first parameter a special point may be missing, and why."""
End.__doc__ = """Why a branch has no further points in one direction: a word ("bound", "points", "closed",
"special_point", "curve_end", "equilibrium", "no_orbit", "unresolved", "no_convergence", "first_step", "interrupted"),
and the sentence of tchat."""


@functools.lru_cache(maxsize=None)
def _types(program=None):
    """The letters of all types of points."""
    return frozenset(read_table(execute(["table", "--types", "--csv"], program=program))["type"])


def _tracked(multipliers, pieces):
    """Each multiplier in a column of its own along a piece of the branch: from a point to the next one, pairs are formed
    in the order of their distance."""
    result = multipliers.copy()
    for begin, end in pieces:
        before = result[begin]
        for row in range(begin + 1, end):
            now = multipliers[row]
            left, ordered = list(range(len(now))), np.full(len(now), np.nan, dtype=complex)
            distance = np.abs(before[:, None] - now[None, :])
            distance[np.isnan(distance)] = np.inf
            for place in np.argsort(distance, axis=None):
                i, j = divmod(int(place), len(now))
                if np.isinf(distance[i, j]):
                    break
                if np.isnan(ordered[i]) and j in left:
                    ordered[i] = now[j]
                    left.remove(j)
            for i in np.flatnonzero(np.isnan(ordered)):
                if left:
                    ordered[i] = now[left.pop(0)]
            result[row] = ordered
            before = ordered if np.isfinite(ordered).any() else before
    return result


class Part:
    """Consecutive points of one branch that are alike in stability and admissibility: part["alpha"], part.stable,
    part.admissible. The last point of the part before is repeated, so that lines meet."""

    def __init__(self, branch, rows, stable, admissible):
        self._branch, self.rows, self.stable, self.admissible = branch, rows, stable, admissible

    def __getitem__(self, name):
        return self._branch[name][self.rows]


class Branch:
    """The points of a run.

    branch["alpha"]     a column by its heading in `tchat table`, one value a point: section, branch, point, type, name,
                        label, kind, stable, admissible (1, 0, NaN where it is not known), the columns of the p-file,
                        fixed parameters, newton_iterations; and whatever `tchat plot` takes for an axis: "x2@wall"
                        (points x values in a period where there are several), "1/omega"
    branch.multipliers  complex, points x most multipliers, NaN where a point has fewer; a column follows one of them
                        along the branch
    branch.labels       the labelled points (Label); branch.PD those of a type, branch.label("PD1") one of them
    branch.stopped      why it has no further points, an End for each direction: reason, text
    branch.may_be_missing  where a special point may be missing, a list of Missing: start, end, text
    branch.screen       what tchat printed, where it was run from here

    "omega" in branch, branch.columns: the columns of the table. A Branch is of the files that it has read: where another
    run has replaced them, what it has not read yet is an Error.
    """

    def __init__(self, path, problem=None, screen="", program=None):
        self.path, self.problem, self.screen = path, problem, screen
        self._file = os.path.abspath(path)
        self._program = problem.program if problem else program
        self._state = self._file_state()
        columns = read_table(execute(["table", self._file, "--csv"], program=self._program))
        parts = [name for name in columns if re.fullmatch(r"multiplier[0-9]+_(re|im)", name)]
        self.multipliers = np.array([columns[name] for name in parts[::2]] or np.empty((0, len(columns["point"]))),
                                    dtype=complex).T
        if parts:
            self.multipliers += 1j * np.array([columns[name] for name in parts[1::2]]).T
        self._table, self._columns = columns, {k: v for k, v in columns.items() if k not in parts}
        pieces = list(zip(columns["section"], columns["branch"]))
        begins = [row for row in range(len(pieces)) if row == 0 or pieces[row] != pieces[row - 1]] + [len(pieces)]
        self.multipliers = _tracked(self.multipliers, list(zip(begins, begins[1:])))
        self._labels = None
        self.stopped = [End(*found) for found in self._recorded(r"END (\w+): (.*)")]
        self.may_be_missing = [Missing(float(start), float(end), text)
                               for start, end, text in self._recorded(r"LOST (\S+) (\S+): (.*)")]

    def _file_state(self):
        try:
            state = os.stat(self._file)
        except (OSError, ValueError):
            return None
        return state.st_ino, state.st_size, state.st_mtime_ns

    def _check(self):
        """Are the files those that the points are from?"""
        if self._file_state() != self._state:
            raise Error("%s: another run has replaced this file since the branch was read; read it again with "
                        "tchat.load(), or give runs names of their own with name=" % self.path)

    def _recorded(self, form):
        """What the lines of this form in the d-file say."""
        try:
            with open(_beside(self._file, "d"), encoding="utf-8", errors="replace") as file:
                return re.findall(r"^ *[0-9]+ +[0-9]+  %s$" % form, file.read(), re.M)
        except OSError:
            return []

    def warn_of_ends(self):
        """Warns of each direction that ended by the number of points, before the bounds that were given."""
        for end in self.stopped:
            if end.reason == "points":
                warnings.warn("%s: stopped after %s, before the bound; NMX=%d goes on" %
                              (self.path, end.text, 4 * len(self)), TchatWarning, stacklevel=4)

    def __len__(self):
        return len(self._columns["point"])

    def __getitem__(self, name):
        if name not in self._columns:
            self._columns[name] = self._quantity(name)
        return self._columns[name]

    def __contains__(self, name):
        return name in self._columns

    @property
    def columns(self):
        return self.headings()

    def _quantity(self, name):
        self._check()
        columns = read_table(execute(["table", self._file, "--csv", "--column", str(name)], program=self._program))
        values = [column for heading, column in columns.items() if heading not in ("section", "point")]
        return values[0] if len(values) == 1 else np.array(values).T

    def headings(self):
        return [name for name in self._table if name in self._columns]

    def frame(self):
        """The table of the points as a pandas.DataFrame."""
        return as_frame(self._table)

    @property
    def labels(self):
        if self._labels is None:
            self._check()
            path = _beside(self._file, "q")
            self._labels = [Label(self, path, row) for row in read_labels(path, self._program)]
        return self._labels

    def label(self, name):
        """The label with a number or a name: 4, "PD1"."""
        for label in self.labels:
            if label.label == name or name in label.name.split():
                return label
        raise Error("%s: no label %s; there are %s" %
                    (self.path, name, ", ".join("%d (%s)" % (one.label, one.name) for one in self.labels) or "none"))

    def orbit(self, name):
        """The orbit of a label."""
        return self.label(name).orbit

    def __getattr__(self, name):
        if re.fullmatch(r"[A-Z][A-Z0-9]+", name) and name in _types(self._program):
            return [label for label in self.labels if name in re.sub(r"[0-9]+( |$)", r"\1", label.name).split()]
        raise AttributeError("%r has no %r" % (type(self).__name__, name))

    def __dir__(self):
        return sorted(set(super().__dir__()) | {kind for kind in self["type"] if kind})

    def parts(self):
        """The branch cut where it, its stability or admissibility change: the line from a point to the next belongs to
        the next point."""
        branch = list(zip(self["section"], self["branch"]))
        state = list(zip(branch, self["stable"] != 0, self["admissible"] != 0))  # not known: as if it were
        parts, begin, size = [], 0, len(self)
        for row in range(1, size + 1):
            if row < size and state[row] == state[row - 1]:
                continue
            goes_on = begin > 0 and branch[begin - 1] == branch[begin]
            before_all = not goes_on and row - begin == 1 and row < size and branch[row] == branch[begin]
            if not before_all:  # the first point of a branch alone has no line
                parts.append(Part(self, np.arange(begin - goes_on, row), *state[begin][1:]))
            begin = row
        return parts

    def plot(self, ax=None, x=None, y=None, labels=("LP", "PD", "TR", "BP", "GR", "HB", "CP"), **style):
        """Draws the branch with matplotlib: stable parts solid, unstable ones dashed, inadmissible ones dotted."""
        ax = ax if ax is not None else _axes()
        numbers = [name for name in self.headings() if name not in ("section", "branch", "point", "label", "type",
                                                                    "name", "kind", "stable", "admissible")]
        x, y = x or numbers[0], y or numbers[1]
        style.setdefault("color", "black")
        for part in self.parts():
            ax.plot(part[x], part[y], linestyle=":" if not part.admissible else "-" if part.stable else "--", **style)
        names = self["name"]
        for row in np.flatnonzero([kind in labels for kind in self["type"]]) if labels else []:
            value = np.atleast_1d(self[y][row])[0]
            ax.plot(self[x][row], value, "o", color=style["color"], markersize=3)
            ax.annotate(names[row], (self[x][row], value), xytext=(4, 4), textcoords="offset points", fontsize="small")
        ax.set_xlabel(x)
        ax.set_ylabel(y)
        return ax

    def picture(self, *words):
        """The bytes of the PNG that `tchat plot` draws of the branch; words are its options, as "-y", "MAX x"."""
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "branch.png")
            self._check()
            execute(["plot", self._file, "-o", file] + list(words), program=self._program)
            with open(file, "rb") as picture:
                return picture.read()

    def html(self, file, *words):
        """Writes the page that `tchat plot` makes of the branch, for a browser: zoom, the values of points, and the
        orbits of labels. file ends in .html; words are options of `tchat plot`, as "-y", "MAX x". Returns file."""
        self._check()
        execute(["plot", self._file, "-o", file] + _plugin(self.problem) + list(words), program=self._program)
        return file

    def verify(self, *names, tolerance=None):
        """`tchat verify`: labelled orbits against forward integration. A Report, whose `passed` is the verdict."""
        self._check()
        words = ["verify", _beside(self._file, "q")] + list(names) + _plugin(self.problem)
        return execute(words + (["--tolerance", tolerance] if tolerance else []), program=self._program, accepted=(0, 1))

    def _repr_png_(self):
        return self.picture()

    def _repr_html_(self):
        first = [name for name in self.headings() if name not in ("section", "branch", "point", "label", "type", "name",
                                                                  "kind", "stable", "admissible")][0]
        rows = "".join("<tr><td>%s</td><td>%.10g</td><td>%s</td></tr>" %
                       (self["name"][row] or self["label"][row], self[first][row], self["kind"][row])
                       for row in np.flatnonzero((self["label"] > 0) & (self["type"] != "RG")))
        return ("<p>%s</p><img src='data:image/png;base64,%s' width='600'><table><tr><th>label</th><th>%s</th>"
                "<th></th></tr>%s</table>" % (_escaped(repr(self)), base64.b64encode(self.picture()).decode(),
                                              _escaped(first), rows))

    def __repr__(self):
        text = "%s: %d points, %d of them with labels" % (self.path, len(self), np.count_nonzero(self["label"] > 0))
        for one in self.may_be_missing:
            text += "; a special point may be missing between %g and %g: %s" % one
        return text + "".join("; stopped: %s" % end.text for end in self.stopped)


class Label:
    """A labelled point of a branch, and what it leads to.

    label.name, label.type, label.label, label.point     "PD1", "PD", 4, and the number of the point
    label["omega"]       a parameter, or a column of the table of labels (`tchat labels --csv`) or of the branch
    label.multipliers    complex, those of its point
    label.orbit          its states; label.signature, label.period
    label.coefficient, label.uncertainty, label.verdict  its normal form: NaN, NaN and "" where it has none;
                         label["normal_form"] is the name of the coefficient, "c"
    """

    def __init__(self, branch, path, row):
        self.branch, self._path, self._row = branch, path, row
        self.name, self.type, self.label, self.point = row["name"], row["type"], int(row["label"]), int(row["point"])
        self.period, self.signature, self.kind = row["period"], read_signature(row["signature"]), row["kind"]
        self.coefficient, self.uncertainty, self.verdict = row["coefficient"], row["uncertainty"], row["verdict"]
        self._orbit = None

    def __getitem__(self, name):
        if name == "PERIOD":
            return self.period  # with all its digits
        if name in self._row:
            return self._row[name]
        if name in self.branch and self._place() is not None:
            return self.branch[name][self._place()]
        raise Error("%s, %s: no %r; there are %s" %
                    (self._path, self.name, name, ", ".join(self._names())))

    def __contains__(self, name):
        return name == "PERIOD" or name in self._names()

    def __iter__(self):
        return iter(self._names())

    def _names(self):
        """Of the table of labels, then further columns of the branch."""
        return list(dict.fromkeys([*self._row, *self.branch.columns]))

    def _place(self):
        """The row of its point in the branch."""
        rows = np.flatnonzero(self.branch["label"] == self.label)
        return int(rows[0]) if len(rows) else None

    @property
    def multipliers(self):
        row = self._place()
        values = self.branch.multipliers[row] if row is not None else np.empty(0, dtype=complex)
        return values[~np.isnan(values)]

    @property
    def orbit(self):
        if self._orbit is None:
            self.branch._check()
            self._orbit = read_orbit(self._path, self._row, self.branch._program)
        return self._orbit

    def _problem(self):
        self.branch._check()
        if self.branch.problem is None:
            raise Error("%s: the problem is not known; load it with problem= (a tchat.Problem or its file)"
                        % self.branch.path)
        return self.branch.problem

    def continue_(self, *words, **values):
        """A run from this label, with the constants of the run that wrote it: Problem.continue_from."""
        start = ["-s", self._path, "-c", _beside(self._path, "r")]
        return self._problem().continue_from(start + list(words), {"IRS": self.label, **values})

    def switch(self, *words, **values):
        """The branch that is born here: at a branch point, a period doubling, a Hopf bifurcation. At a period doubling
        both directions have the same orbits: one is followed, with both=True both are."""
        switching = {"ISW": -1}
        if self.type == "PD":
            switching["both"] = False
        if self.type == "HB":
            switching.update(IPS=180, GCHIND=[0], GCGIND=[0])
        return self.continue_(*words, **{**switching, **values})

    def resegment(self, to="impacting", *words, **values):
        """A start with another signature (`tchat resegment`): to="impacting", "grazing", "double", "rotate",
        "signature"."""
        return self._problem().resegment(self._path, self.label, _PLACES.get(to, to), words, values)

    def curve(self, free, *words, **values):
        """The curve of such points in two parameters, free=("omega", "alpha"); of grazing orbits at a GR."""
        if self.type == "GR":
            return self.resegment("grazing").continue_(*words, **{"ICP": list(free), **values})
        return self.continue_(*words, **{"ISW": 2, "ICP": list(free), **values})

    def verify(self, tolerance=None):
        """`tchat verify` of this label: a Report, whose `passed` is the verdict."""
        return self.branch.verify(self.label, tolerance=tolerance)

    def grazing(self, *words):
        """`tchat grazing`: what follows from this contact, as a Report."""
        self.branch._check()
        return execute(["grazing", self._path, self.label] + list(words) + _plugin(self.branch.problem),
                       program=self.branch._program)

    def __repr__(self):
        free = [name for name in (self._row["free"] or "").split(",")
                if name in self._row and not name.startswith("PAR(6")]  # durations
        return "%s: %s%s" % (self.name, ", ".join("%s = %.10g" % (name, self._row[name]) for name in free[:2]),
                             " (%s)" % self.kind if self.kind else "")


def _plugin(problem):
    return ["-p", problem.source] if problem else []


def _escaped(text):
    return text.replace("&", "&amp;").replace("<", "&lt;")


_LETTERS = {"p.": {}, "b.": {"q": "s", "r": "c"}}  # of AUTO: others
_FORTS = {"p": "fort.7", "q": "fort.8", "d": "fort.9"}


def _beside(path, letter):
    """The file of the same run with another letter: p.mems -> q.mems, b.mems -> s.mems, fort.7 -> fort.8."""
    folder, name = os.path.split(path)
    if name in _FORTS.values():
        return os.path.join(folder, _FORTS[letter])
    return os.path.join(folder, _LETTERS.get(name[:2], {}).get(letter, letter) + name[1:])


def branch_of_files(name, problem=None, program=None):
    """As tchat.load(), with a Problem."""
    path = os.fsdecode(name)
    if path.startswith("-"):  # no option
        path = os.path.join(".", path)
    folder, last = os.path.split(path)
    of_name = os.path.join(folder, "p." + last)
    is_points = last[:2] in ("p.", "b.") or last == _FORTS["p"]
    return Branch(path if is_points or "\0" in path or not os.path.exists(of_name) else of_name, problem,
                  program=program)


def run_words(words, output, cwd=None, program=None, progress=None, append=False, problem=None):
    """`tchat run` with these words, which writes p.OUTPUT: its Branch."""
    path = os.path.join(cwd or "", _output(output))
    watch = progress if callable(progress) else ProgressBar(os.path.basename(output)) if progress is not False else None
    growing = GrowingPoints(path, append)

    def poll():
        return all([watch(point) is not False for point in growing.new_points()]) if watch else True

    try:
        screen = execute(["run"] + list(words), cwd, program, poll)
    finally:
        if isinstance(watch, ProgressBar):
            watch.close()
    return Branch(path, problem, screen, program)


def _output(name):
    folder, last = os.path.split(name)
    return os.path.join(folder, "p." + last)


def output_of(name, words):
    """What -o says, else the name of the problem."""
    for k, word in enumerate(words):
        if word in ("-o", "--output") and k + 1 < len(words):
            return words[k + 1]
        if isinstance(word, str) and re.match(r"-o.", word):
            return word[2:]
        if isinstance(word, str) and word.startswith("--output="):
            return word[len("--output="):]
    return os.path.basename(name)


def run(name, *words, progress=None, cwd=None, program=None, **constants):
    """`tchat run NAME words KEY=VALUE...`, and the Branch that it has written.

        tchat.run("linosc", "-c", "impacting", "-d", "impacting", "-o", "x", DS=-0.02, UZR={1: 3.2})

    progress(point) is called for every point (a Progress) while the run goes on; when it returns False the run ends as
    after Ctrl-C and what there is comes back. cwd: the folder to run in. program: the path of tchat, else the
    environment variable TCHAT, else tchat on PATH. Raises Error with tchat's message, its exit status and screen.
    """
    from .program import constant_word
    words = [name] + list(words) + [constant_word(key, value) for key, value in constants.items()]
    return run_words(words, output_of(name, words[1:]), cwd, program, progress or False, "--append" in words)
