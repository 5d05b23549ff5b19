"""Results of tchat in Python: reads its files, runs it. Needs numpy; pandas only for frame().

    import tchat
    run = tchat.run("linosc", "-c", "impacting", "-d", "impacting", "-o", "impacting")
    run = tchat.load("impacting")                # or what an earlier run has left: p.impacting, q. and d. beside it
    run["alpha"], run["MAX x2"], run["stable"]   # numpy arrays, one value a point; the names are those of tchat table
    run.multipliers                              # complex, points x multipliers
    orbit = run.orbit("UZ1")                     # a labelled solution: orbit.t, orbit["x1"], orbit.parameter("omega")

The readers alone: read_points (p-files), read_solutions (q), read_diagnostics (d), read_trajectory and read_events (of
tchat simulate). What cannot be read, and what tchat itself refuses, raises tchat.Error with one sentence; what is left
out is told by a warning (tchat.TchatWarning). AUTO-07p's files are read too. src/docs/results.md has examples.
"""

import functools
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
import warnings

import numpy as np

__all__ = ["Error", "TchatWarning", "load", "run", "simulate", "sweep", "read_points", "read_solutions",
           "read_diagnostics", "read_trajectory", "read_events", "Run", "Section", "Solution", "Solutions", "Diagnostic",
           "Point", "Trajectory"]

FIRST_DURATION = 61    # PAR(60 + s) is the duration of segment s
MOST_SEGMENTS = 64
AUTO_PERIOD = 11       # PAR(11) is the period in AUTO's own files
EQUILIBRIA = 1  # IPS
BOUNDARY_VALUES = 4
NOT_FINITE = 1e99      # stands in the files for NaN and infinity
POLL_SECONDS = 0.1


class Error(Exception):
    """What was wrong and what to do; of a run of tchat its own message, with the exit status and the screen."""

    def __init__(self, message, status=None, screen=""):
        super().__init__(message)
        self.status = status
        self.screen = screen


class TchatWarning(UserWarning):
    """What a reader left out, or tchat warned of."""


def _warn(text):
    warnings.warn(text, TchatWarning, stacklevel=3)


# ---------------------------------------------------------------------------------------------------------- text


def _checked_path(name, what):
    """`name` as text; an Error for what is no name of a file."""
    try:
        path = os.fsdecode(name)
    except TypeError:
        raise Error("%r is no name of a file (%s); give a text such as \"mems\"" % (name, what)) from None
    if not path or "\0" in path:
        raise Error("%r is no name of a file (%s): it %s; give a name such as \"mems\"" %
                    (path, what, "is empty" if not path else "has a zero byte in it"))
    return path


def _read_text(path, what):
    path = _checked_path(path, what)
    try:
        with open(path, encoding="latin-1", newline="") as file:
            return file.read()
    except OSError as error:
        raise Error("%s: cannot be read (%s): %s" % (path, what, error.strerror)) from None


_EXPONENT_WITHOUT_LETTER = re.compile(r"(?<=[0-9.])([+-][0-9]+)$")


def _real(word):
    """A number as Fortran writes it: 1.5E-03, 1.5D-03, 1.5-101; NaN for NaN, infinities and fields of stars."""
    try:
        value = float(word)
    except ValueError:
        if word.strip("*") == "":
            return np.nan
        value = float(_EXPONENT_WITHOUT_LETTER.sub(r"E\1", word.replace("D", "E").replace("d", "e")))
    return value if np.isfinite(value) else np.nan


def _reals(words):
    try:
        return np.array(words, dtype=float)
    except ValueError:
        return np.array([_real(word) for word in words])


def _integer(word):
    """An integer, or None."""
    return int(word) if re.fullmatch(r"[+-]?[0-9]+", word) else None


def _known(values):
    """NaN where the file says 1e99."""
    values = np.asarray(values, dtype=float)
    return np.where(np.abs(values) == NOT_FINITE, np.nan, values)


def _sibling(path, letter):
    """The file of the same run with another letter: p.mems -> q.mems, fort.7 -> fort.8, b.x -> s.x; None if unknown."""
    folder, name = os.path.split(path)
    forts = {"p": "fort.7", "q": "fort.8", "d": "fort.9"}
    if name in forts.values():
        return os.path.join(folder, forts[letter])
    if len(name) < 3 or name[1] != ".":
        return None
    ours = os.path.join(folder, letter + name[1:])
    of_auto = os.path.join(folder, {"p": "b", "q": "s", "d": "d"}[letter] + name[1:])
    return of_auto if name[0] in "bs" and not os.path.isfile(ours) else ours


def _resolve(name, letter):
    """`name`, or LETTER.NAME in its folder where there is no such file but that one."""
    name = _checked_path(name, letter + "-file")
    folder, last = os.path.split(name)
    prefixed = os.path.join(folder, letter + "." + last)
    return prefixed if not os.path.exists(name) and os.path.exists(prefixed) else name


def _distinct(names):
    """A name that is there already gets a number."""
    taken = []
    for name in names:
        new, k = name, 2
        while new in taken:
            new, k = "%s (%d)" % (name, k), k + 1
        taken.append(new)
    return taken


# ----------------------------------------------------------------------------------------------- types of points

# generated: tchat table --types
_POINT_TYPES = [
    ("BP", 6, 0, False),
    ("BP", 1, 0, False),
    ("LP", 5, 0, False),
    ("LP", 2, 0, False),
    ("HB", 3, 0, False),
    ("PD", 7, 0, False),
    ("TR", 8, 0, False),
    ("UZ", -4, 0, False),
    ("UZ", -4, 1, False),
    ("GR", -4, 2, False),
    ("GR", -4, 4, False),
    ("BE", -4, 7, False),
    ("XI", -4, 3, False),
    ("GC", -4, 5, False),
    ("CP", -2, 0, False),
    ("BT", -1, 0, False),
    ("ZH", -3, 0, False),
    ("GH", -32, 0, True),
    ("R1", -5, 0, False),
    ("R2", -6, 0, False),
    ("R3", -7, 0, False),
    ("R4", -8, 0, False),
    ("EP", 9, 0, False),
    ("MX", -9, 0, False),
    ("RG", 4, 0, False),
    ("LTR", 23, 0, True),
    ("LTR", 83, 0, True),
    ("LPD", 28, 0, True),
    ("LPD", 78, 0, True),
    ("PTR", 77, 0, True),
    ("PTR", 87, 0, True),
    ("TTR", 88, 0, True),
]
# end
_NO_KIND, _USER_VALUE, _CONTACT, _XI, _IMPACT_VELOCITY, _GRAZING_CODIMENSION_TWO, _OTHER_TYPE, _BOUNDARY_EQUILIBRIUM = range(8)
_USER_POINT = -4


@functools.lru_cache(maxsize=None)
def type_name(number, kind=0):
    """Letters of a type number: "PD"; of UZ points by their kind (GR, XI, GC, BE); "" for an ordinary point."""
    for letters, whole, _, is_whole in _POINT_TYPES:
        if is_whole and whole == number:
            return letters
    basic = int(np.fmod(number, 10))
    found = {of_kind if basic == _USER_POINT else kind: letters
             for letters, basic_number, of_kind, is_whole in _POINT_TYPES if basic_number == basic and not is_whole}
    return found.get(kind, found.get(0, ""))


# ------------------------------------------------------------------------------------------------------- p-files


class Point:
    """A point as a run writes it: branch, point, stable, type, label, and its columns: point["alpha"]."""

    def __init__(self, section, row):
        self._section = section
        self.branch, number, self.type, self.label = section.rows[row][0]
        self.point, self.stable = abs(number), number < 0
        self.type_name = type_name(self.type)
        self.values = section.rows[row][1]

    def __getitem__(self, name):
        return self.values[self._section.column(name)]

    def __repr__(self):
        values = ", ".join("%s = %.6g" % pair for pair in list(zip(self._section.columns, self.values))[:2])
        return "point %d of branch %d%s: %s" % (self.point, self.branch, " " + self.type_name, values)


class Section:
    """The points of one run (or of one direction of it) in a p-file.

    columns      their names in full
    data         points x columns, exactly the numbers of the file (1e99 stands for a value that is not finite)
    branch, point, type, label, stable      one value a point; point is positive
    ips, isw, isp, ndim, nseg, curve_type   of the header, 0 where it does not say
    states, parameters                      names by number; active: PAR indices that are free
    """

    def __init__(self, header=None):
        self.ips, self.isw, self.isp, self.ndim, self.nseg, self.curve_type = 0, 1, 2, 0, 0, 0
        self.states, self.parameters, self.active, self.columns = {}, {}, [], []
        if header is not None:
            for key in ("ips", "isw", "isp", "ndim", "nseg", "curve_type", "states", "parameters", "active"):
                setattr(self, key, getattr(header, key))
        self.rows = []  # ([BR, PT, TY, LAB], values)

    def __len__(self):
        return len(self.rows)

    def _integers(self, k):
        return np.array([row[0][k] for row in self.rows], dtype=int)

    data = property(lambda self: np.array([row[1] for row in self.rows]))
    branch = property(lambda self: np.abs(self._integers(0)))
    point = property(lambda self: np.abs(self._integers(1)))
    stable = property(lambda self: self._integers(1) < 0)
    type = property(lambda self: self._integers(2))
    label = property(lambda self: self._integers(3))

    def parameter_name(self, k):
        return self.parameters.get(k, "PAR(%d)" % k)

    def column(self, name):
        """The place of a column: by its name, or as PAR(k), MAX U(k) where the name is another one."""
        named = re.sub(r"PAR\(([0-9]+)\)", lambda m: self.parameter_name(int(m[1])), str(name))
        named = re.sub(r"U\(([0-9]+)\)", lambda m: self.states.get(int(m[1]), m[0]), named)
        for wanted in (name, named):
            if wanted in self.columns:
                return self.columns.index(wanted)
        raise Error("no column %r; there are %s" % (name, ", ".join(self.columns)))

    def __getitem__(self, name):
        return self.data[:, self.column(name)]

    def parameter_of_column(self, place):
        for k, name in self.parameters.items():
            if name == self.columns[place]:
                return k
        match = re.fullmatch(r"PAR\(([0-9]+)\)", self.columns[place])
        return int(match[1]) if match else None

    def tells_stability(self):
        """Not along curves of folds, period doublings, torus bifurcations, and where multipliers are not computed."""
        return self.isp != 0 and self.ips != 4 and self.curve_type == 0 and abs(self.isw) != 2


class _Header:
    """The lines before the points of a section."""

    def __init__(self):
        self.section = Section()
        self.long_names = {}
        self.headings = ""

    def read(self, line):
        for key in ("IPS", "ISW", "ISP", "NDIM", "NSEG"):
            match = re.search(r"(?:^|[ ,])%s *= *(-?[0-9]+)" % key, line)
            if match:
                setattr(self.section, key.lower(), int(match[1]))
        for key, names in (("unames", self.section.states), ("parnames", self.section.parameters),
                           ("columns", self.long_names)):
            match = re.search(r"(?:^|[ ,])%s *= *\{([^}]*)\}" % key, line)
            if match:
                names.clear()
                entries = re.findall(r"([0-9]+): *(?:'([^']+)'|\"([^\"]+)\")", match[1])
                names.update((int(k), single or double) for k, single, double in entries)
        match = re.search(r"Branch *type: *(-?[0-9]+)", line)
        if match:
            self.section.curve_type = int(match[1])
        match = re.search(r"Active continuation parameter(?:\(s\)|s)?:(.*)", line)
        if match:
            numbers = {name: k for k, name in self.section.parameters.items()}
            words = [numbers.get(word, word) for word in match[1].replace("'", " ").split()]
            self.section.active = [int(word) for word in words if _integer(str(word)) is not None]
        self.headings = line

    def columns(self, line):
        """The names of the numbers in `line`: headings begin one column to the right of the numbers' fields."""
        ends = [match.end() for match in re.finditer(r"\S+", line)]
        names = []
        for k in range(4, len(ends)):
            last = len(self.headings) if k + 1 == len(ends) else ends[k] + 1
            name = self.headings[ends[k - 1] + 1:last].strip() if " PT " in self.headings else ""
            names.append(self.long_names.get(k - 3) or name or "COLUMN(%d)" % (k - 3))
        return names


class _PointParser:
    """Sections from the lines of a p-file, which may still be growing."""

    def __init__(self, path):
        self.path, self.line, self.sections = path, 0, []
        self._header, self._in_header, self._new_header = _Header(), False, False

    def feed(self, line):
        """Takes a whole line; the point in it, None for any other line."""
        self.line += 1
        words = line.split()
        if not words:
            return None
        if words[0] == "0":
            self._new_header = self._new_header or not self._in_header
            self._in_header = True
            if self._new_header and "=" in line:  # headings alone: the constants go on
                self._header, self._new_header = _Header(), False
            self._header.read(line.rstrip("\r\n"))
            return None
        return self._point(line, words)

    def _point(self, line, words):
        integers = [_integer(word) for word in words[:4]]
        if len(words) < 5 or None in integers:
            self._refuse("a point has BR, PT, TY, LAB and at least one value; this is no p-file")
        try:
            values = _reals(words[4:])
        except ValueError:
            self._refuse("there is a word that is no number; the file is damaged or no p-file")
        if self._in_header or not self.sections:
            self.sections.append(Section(self._header.section))
            self.sections[-1].columns = self._header.columns(line)
            self._in_header = self._new_header = False
        section = self.sections[-1]
        if len(values) != len(section.columns):
            self._refuse("%d values after BR, PT, TY and LAB, but the points before have %d; the file is damaged" %
                         (len(values), len(section.columns)))
        section.rows.append((integers, values))
        return Point(section, len(section) - 1)

    def _refuse(self, what):
        raise Error("%s:%d: %s" % (self.path, self.line, what))


def read_points(path):
    """The sections of a p-file (b-file, fort.7), `mems` for p.mems. A last line that is cut off is left out."""
    path = _resolve(path, "p")
    parser = _PointParser(path)
    lines = _read_text(path, "points of branches").splitlines(keepends=True)
    if lines and not lines[-1].endswith("\n"):
        _warn("%s:%d: the last line is not complete and is left out" % (path, len(lines)))
        lines.pop()
    for line in lines:
        parser.feed(line)
    if not parser.sections:
        raise Error("%s: no point in it; a run writes points to p.NAME (fort.7)" % path)
    return parser.sections


# ------------------------------------------------------------------------------------------------------- q-files


class Solution:
    """A labelled orbit of m segments with n states.

    branch, point, type, label, isw, ips    of the file; type_name and names: "GR", ["GR1"], as IRS knows it
    kind                                    what it is in words: "contact inside segment 1, ...", "" for nothing
    tau                                     mesh of every segment, from 0 to 1
    states                                  m x n x len(tau); solution["x1"] or solution["U(1)"] is m x len(tau)
    t                                       m x len(tau), time since the start of segment 1
    free, parameters                        PAR indices that are free; PAR(k) is parameters[k - 1], all digits
    durations, period                       of the segments, and their sum
    direction, state_direction              d PAR(free) / ds and d states / ds along the branch, None without
    """

    def __init__(self):
        self.kinds, self.names, self.state_names, self.parameter_names = [], [], {}, {}
        self.direction = self.state_direction = None

    @property
    def type_name(self):
        return type_name(self.type, self.kinds[0][0] if self.kinds else _NO_KIND)

    @property
    def durations(self):
        own = self.parameters[FIRST_DURATION - 1:FIRST_DURATION - 1 + len(self.states)]
        of_auto = self.ips not in (EQUILIBRIA, 150, 180) and len(self.states) == 1 and not np.any(own)
        if of_auto and self.ips == BOUNDARY_VALUES:  # on the interval from 0 to 1
            return np.ones(1)
        return self.parameters[AUTO_PERIOD - 1:AUTO_PERIOD] if of_auto else own

    @property
    def period(self):
        return float(np.sum(self.durations))

    @property
    def t(self):
        starts = np.concatenate(([0.0], np.cumsum(self.durations)[:-1]))
        return starts[:, None] + self.tau[None, :] * self.durations[:, None]

    @property
    def kind(self):
        return "; ".join(filter(None, (self._description(*kind) for kind in self.kinds)))

    def _description(self, kind, segment, index, tau):
        if kind == _USER_VALUE:
            return "user value of " + self.parameter_names.get(index, "PAR(%d)" % index)
        if kind == _CONTACT:
            return "contact inside segment %d, event function %d, tau = %.6g" % (segment, index, tau)
        if kind == _XI:
            return "xi_%d = 0" % index
        if kind == _IMPACT_VELOCITY:
            return "impact velocity zero at the end of segment %d, event function %d" % (segment, index)
        if kind == _GRAZING_CODIMENSION_TWO:
            if index == 0:
                return "a* = 0: h is no longer least at the contact"
            return "grazing-%s: multiplier %s1 of the orbit that grazes, without the contact" % (
                ("flip", "-") if index < 0 else ("fold", "+"))
        if kind == _BOUNDARY_EQUILIBRIUM:
            return "boundary equilibrium, event function %d" % index
        return type_name(index) if kind == _OTHER_TYPE else ""

    def type_names(self):
        """Letters of all that the point is, its own first."""
        own = self.type_name
        further = [type_name(index if kind == _OTHER_TYPE else -4, kind) for kind, _, index, _ in self.kinds[1:]]
        return [name for name in dict.fromkeys([own] + further) if name]

    def parameter(self, name):
        """PAR(k) by its number, as "PAR(k)" or by its name."""
        numbers = {known: k for k, known in self.parameter_names.items()}
        match = re.fullmatch(r"(?:PAR\()?([0-9]+)\)?", str(name))
        k = int(match[1]) if match else numbers.get(name, 0)
        if not 1 <= k <= len(self.parameters):
            raise Error("no parameter %r; there are %s and PAR(1) to PAR(%d)" %
                        (name, ", ".join(numbers) or "no names (they are in the p-file)", len(self.parameters)))
        return float(self.parameters[k - 1])

    def __getitem__(self, name):
        """A state over all segments, m x len(tau), by its name or as U(k)."""
        numbers = {known: k for k, known in self.state_names.items()}
        match = re.fullmatch(r"U\(([0-9]+)\)", name)
        k = int(match[1]) if match else numbers.get(name, 0)
        if not 1 <= k <= self.states.shape[1]:
            raise Error("no state %r; there are %s and U(1) to U(%d)" %
                        (name, ", ".join(numbers) or "no names (they are in the p-file)", self.states.shape[1]))
        return self.states[:, k - 1, :]

    def __repr__(self):
        return "label %d %s, %d segment(s), period %.10g" % (self.label, " ".join(self.names) or self.type_name,
                                                             len(self.states), self.period)


class Solutions(list):
    """The labelled solutions of a q-file in its order; find(4) and find("PD1") as IRS finds them."""

    path = ""

    def find(self, label):
        for solution in self:
            if label == solution.label or label in solution.names:
                return solution
        known = ", ".join("%d (%s)" % (s.label, " ".join(s.names)) for s in self)
        raise Error("%s: no label %s; there are %s" % (self.path, label, known or "none"))


def _entry(path, line, identifier, words):
    """A solution from the numbers after its first line; None for an entry that only carries the largest label."""
    identifier = identifier + [0] * (16 - len(identifier))
    free, points, width, parameters = identifier[4], identifier[6], identifier[7], identifier[11]
    if points == 0:
        return None
    without = points * width + parameters
    with_direction = without + 2 * free + points * (width - 1)
    if points < 0 or width < 2 or len(words) not in (without, with_direction):
        raise Error("%s:%d: the solution has %d numbers, expected are %d or %d; this is no q-file or it is damaged" %
                    (path, line, len(words), without, with_direction))
    try:
        numbers = _reals(words)
    except ValueError:
        raise Error("%s:%d: there is a word in the solution that is no number; the file is damaged" %
                    (path, line)) from None
    solution = Solution()
    solution.branch, solution.point, solution.type, solution.label = (abs(identifier[0]), abs(identifier[1]),
                                                                      identifier[2], identifier[3])
    solution.isw, solution.ntst, solution.ncol = identifier[5], identifier[9], identifier[10]
    solution.ips = identifier[14]
    table = numbers[:points * width].reshape(points, width)
    solution.tau, at = table[:, 0], points * width
    solution.free = []
    if len(words) == with_direction:
        solution.free = [int(number) for number in numbers[at:at + free]]
        solution.direction = numbers[at + free:at + 2 * free]
        at += 2 * free
    n = identifier[13] if identifier[13] > 0 and (width - 1) % identifier[13] == 0 else _states_of(solution.free, width)
    shape = ((width - 1) // n, n, points)
    solution.states = table[:, 1:].T.reshape(shape)
    if len(words) == with_direction:
        solution.state_direction = numbers[at:at + points * (width - 1)].reshape(points, width - 1).T.reshape(shape)
    # Boundary value problems and equilibria are AUTO's too, whose PAR has no room for durations.
    is_ours = identifier[14] in (180, 150) or (identifier[14] in (BOUNDARY_VALUES, EQUILIBRIA)
                                               and parameters - identifier[12] >= FIRST_DURATION)
    internal = identifier[12] if is_ours and identifier[12] % 4 == 0 else 0
    values = numbers[len(numbers) - parameters:]
    solution.parameters = values[:parameters - internal]
    groups = values[parameters - internal:].reshape(-1, 4)
    solution.kinds = [(int(group[0]), int(group[1]), int(group[2]), float(group[3])) for group in groups]
    return solution


def _states_of(free, width):
    """n in files of the older generation, by the number of durations that are free."""
    durations = sum(FIRST_DURATION <= k < FIRST_DURATION + MOST_SEGMENTS for k in free)
    return (width - 1) // durations if durations > 0 and (width - 1) % durations == 0 else width - 1


def read_solutions(path, names=True):
    """The solutions of a q-file (s-file, fort.8), `mems` for q.mems. A last one that is cut off is left out.

    names: take the names of states and parameters from the p-file beside it.
    """
    path = _resolve(path, "q")
    lines = _read_text(path, "labelled solutions").splitlines(keepends=True)
    solutions, at = Solutions(), 0
    solutions.path = path
    while at < len(lines):
        words = lines[at].split()
        if not words:
            at += 1
            continue
        identifier = [_integer(word) for word in words]
        if len(identifier) not in (12, 16) or None in identifier:
            if not lines[at].endswith("\n"):
                _warn("%s:%d: the last solution is not complete and is left out" % (path, at + 1))
                break
            raise Error("%s:%d: a solution begins with 12 or 16 integers; this is no q-file, or it is damaged" %
                        (path, at + 1))
        end = at + 1 + identifier[8]
        if end > len(lines) or not lines[end - 1].endswith("\n"):
            _warn("%s:%d: the last solution is not complete and is left out" % (path, at + 1))
            break
        solution = _entry(path, at + 1, identifier, " ".join(lines[at + 1:end]).split())
        if solution is not None:
            solutions.append(solution)
        at = end
    _name(solutions, path if names else None)
    return solutions


def _name(solutions, path):
    counts = {}
    for solution in solutions:
        for name in solution.type_names():
            counts[name] = counts.get(name, 0) + 1
            solution.names.append("%s%d" % (name, counts[name]))
    points = _sibling(path, "p") if path else None
    if points is None or not os.path.isfile(points):
        return
    try:
        section = read_points(points)[0]
    except Error as error:
        _warn("%s (names of states and parameters are left out)" % error)
        return
    for solution in solutions:
        solution.state_names, solution.parameter_names = section.states, section.parameters


# ------------------------------------------------------------------------------------------------------- d-files


class Diagnostic:
    """What a d-file says of a point.

    branch, point, label, stable, type_name; admissible: the orbit does not violate the model; first: ICP(1), 6 digits
    multipliers     complex, infinite where the file has 1e99; iterations: of Newton's method, None when not known
    notes           texts of the block
    """

    def __init__(self, branch, number, name, label, words):
        self.branch, self.point, self.stable, self.type_name, self.label = branch, abs(number), number < 0, name, label
        self.admissible = words[-1] != "inadmissible"
        self.first = None
        try:
            self.first = _real(words[3 if name == "" else 4])
        except (IndexError, ValueError):
            pass
        self.multipliers, self.iterations, self.notes = np.zeros(0, dtype=complex), None, []


def _diagnostic(words):
    if len(words) < 4:
        return None
    branch, point, third = (_integer(word) for word in words[:3])
    label = third if third is not None else _integer(words[3])
    if branch is None or point is None or label is None:
        return None
    return Diagnostic(branch, point, "" if third is not None else words[2], label, words)


def _multiplier(words, name):
    at = words.index(name)
    if len(words) < at + 4 or _integer(words[at + 1].split(":")[0]) is None:
        return None
    try:
        parts = [_real(word) for word in words[at + 2:at + 4]]
    except ValueError:
        return None
    return complex(*(np.copysign(np.inf, part) if abs(part) == NOT_FINITE else part for part in parts))


class _DiagnosticParser:
    """Blocks of a d-file; in AUTO's, multipliers stand before their point."""

    def __init__(self):
        self.points, self._open, self._after_heading = [], False, False
        self._clear()

    def _clear(self):
        self._multipliers, self._iterations, self._notes = [], None, []

    def close(self):
        if self._open:
            point = self.points[-1]
            point.multipliers, point.iterations = np.array(self._multipliers, dtype=complex), self._iterations
            point.notes = self._notes
        self._clear()
        self._open = False

    def feed(self, line):
        words = line.split()
        if not words:
            return
        if self._after_heading:
            point = _diagnostic(words)
            if point is not None:
                if self._open:
                    self.close()
                self.points.append(point)
                self._open = True
        elif words == ["=" * 47]:
            self.close()
        elif "Multipliers:" in words or "Eigenvalues:" in words:
            self._multipliers = []
        elif "NOTE:" in words:
            self._notes.append(" ".join(words[words.index("NOTE:") + 1:]))
        elif "Iterations" in words:
            tail = words[words.index("Iterations") + 1:]
            if len(tail) > 1 and tail[0] == ":":
                self._iterations = _integer(tail[1])
        elif "Multiplier" in words or "Eigenvalue" in words:
            multiplier = _multiplier(words, "Multiplier" if "Multiplier" in words else "Eigenvalue")
            if multiplier is not None:
                self._multipliers.append(multiplier)
        self._after_heading = words[:4] == ["BR", "PT", "TY", "LAB"]


def read_diagnostics(path):
    """The points of a d-file (fort.9), `mems` for d.mems."""
    path = _resolve(path, "d")
    parser = _DiagnosticParser()
    for line in _read_text(path, "diagnostics of a run").split("\n"):
        parser.feed(line)
    parser.close()
    if not parser.points:
        raise Error("%s: no point in it; a run writes its diagnostics to d.NAME (fort.9)" % path)
    return parser.points


# ------------------------------------------------------------------------------------------------ a run as a whole


class Part:
    """Consecutive points of one branch that are alike in stability and admissibility: part["alpha"], part.stable,
    part.admissible. The last point of the part before is repeated, so that lines meet."""

    def __init__(self, run, rows, stable, admissible):
        self._run, self.rows, self.stable, self.admissible = run, rows, stable, admissible

    def __getitem__(self, name):
        return self._run[name][self.rows]


class Run:
    """The points of a run with all that its files know of them.

    run["alpha"]    a column by its heading in `tchat table`, one value a point: section, branch, point, type, name,
                    label, kind, stable, admissible (1, 0, NaN when not known), the columns of the p-file, fixed
                    parameters, newton_iterations; not finite is NaN
    multipliers     complex, points x most multipliers, NaN beyond a point's own
    sections, solutions, diagnostics        as the readers give them (solutions, diagnostics: None without a file)
    screen          what tchat printed, when it was run from here
    """

    def __init__(self, path, sections, solutions=None, diagnostics=None):
        self.path, self.sections, self.screen = path, sections, ""
        self.solutions = None if solutions is None else self._checked(solutions, "q", self._match_solutions)
        self.diagnostics = None if diagnostics is None else self._checked(diagnostics, "d", self._match_diagnostics)
        if self.solutions is None:
            self._solution = [None] * len(self)
        if self.diagnostics is None:
            self._diagnostic = [None] * len(self)
        most = max([len(d.multipliers) for d in self._diagnostic if d is not None], default=0)
        self.multipliers = np.full((len(self), most), complex(np.nan, np.nan))
        for row, diagnostic in enumerate(self._diagnostic):
            if diagnostic is not None:
                self.multipliers[row, :len(diagnostic.multipliers)] = diagnostic.multipliers
        self._columns = self._build()

    def __len__(self):
        return sum(len(section) for section in self.sections)

    def __getitem__(self, name):
        for wanted in [name] + [re.sub(r"PAR\(([0-9]+)\)", lambda m: self.sections[0].parameter_name(int(m[1])), name)]:
            if wanted in self._columns:
                return self._columns[wanted]
        raise Error("%s: no column %r; there are %s" % (self.path, name, ", ".join(self._columns)))

    def __repr__(self):
        return "%s: %d points, %d of them with labels" % (self.path, len(self), len(self.labels()))

    def headings(self):
        return list(self._columns)

    def table(self):
        """All columns by their headings, the multipliers among them: those of `tchat table`."""
        table = dict(self._columns)
        iterations = table.pop("newton_iterations")
        for k in range(self.multipliers.shape[1]):
            table["multiplier%d_re" % (k + 1)] = self.multipliers[:, k].real
            table["multiplier%d_im" % (k + 1)] = self.multipliers[:, k].imag
        table["newton_iterations"] = iterations
        return table

    def frame(self):
        """The table as a pandas.DataFrame."""
        try:
            import pandas
        except ImportError:
            raise Error("frame() needs pandas (Debian: python3-pandas); table() does not") from None
        return pandas.DataFrame(self.table())

    def orbit(self, label):
        """The labelled solution with a number or a name: 4, "PD1"."""
        if self.solutions is None:
            raise Error("%s: there is no q-file beside it that could be read, so there are no orbits" % self.path)
        return self.solutions.find(label)

    def labels(self):
        """Rows with a label, as indices into the columns."""
        return np.flatnonzero(self["label"] > 0)

    def parts(self):
        """The run cut where branch, stability or admissibility change: the line from a point to the next belongs to
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

    def _rows(self):
        for section in self.sections:
            for integers, values in section.rows:
                yield section, integers, values

    def _checked(self, others, letter, match):
        try:
            match(others)
        except Error as error:
            _warn("%s; it is left out" % error)
            return None
        return others

    def _other_run(self, letter, what):
        return Error("%s: %s; it is of another run" % (_sibling(self.path, letter) or letter + "-file", what))

    def _check_value(self, letter, integers, values, value):
        if value is not None and abs(value - values[0]) > 1e-5 * max(abs(value), abs(values[0])):
            raise self._other_run(letter, "point %d, label %d has %.6g where %s has %.6g" %
                                  (abs(integers[1]), integers[3], value, self.path, values[0]))

    def _match_solutions(self, solutions):
        by_label = {solution.label: solution for solution in solutions}
        found, missing = [], 0
        for section, integers, values in self._rows():
            solution = by_label.get(integers[3]) if integers[3] > 0 else None
            missing += integers[3] > 0 and solution is None
            if solution is not None and solution.point != abs(integers[1]):
                solution = None
            k = section.parameter_of_column(0)
            if solution is not None and k is not None and k <= len(solution.parameters):
                self._check_value("q", integers, values, solution.parameters[k - 1])
            found.append(solution)
        if missing and solutions and not any(solution is not None for solution in found):
            raise self._other_run("q", "it has none of the labels of %s" % self.path)
        if missing:
            _warn("%s: %d of the labels of %s not in it" % (solutions.path, missing, self.path))
        self._solution = found

    def _match_diagnostics(self, diagnostics):
        places = {}
        for point in reversed(diagnostics):
            number = -point.point if point.stable else point.point
            places.setdefault((point.branch, number, point.label), []).append(point)
        found = []
        for _, integers, values in self._rows():
            left = places.get((integers[0], integers[1], integers[3]))
            point = left.pop() if left else None
            if point is not None:
                self._check_value("d", integers, values, point.first)
            found.append(point)
        if not any(point is not None for point in found):
            raise self._other_run("d", "it has none of the points of %s" % self.path)
        self._diagnostic = found

    def _build(self):
        """The columns of `tchat table` but for the multipliers."""
        size, columns = len(self), {}
        sections = np.concatenate([np.full(len(s), k + 1) for k, s in enumerate(self.sections)])
        columns["section"] = sections
        columns["branch"] = np.concatenate([s.branch for s in self.sections])
        columns["point"] = np.concatenate([s.point for s in self.sections])
        columns["type"] = self._types()
        columns["name"] = np.array([" ".join(s.names) if s else "" for s in self._solution], dtype=object)
        columns["label"] = np.concatenate([s.label for s in self.sections])
        columns["kind"] = np.array([s.kind if s else "" for s in self._solution], dtype=object)
        columns["stable"] = np.concatenate([s.stable.astype(float) if s.tells_stability() else np.full(len(s), np.nan)
                                            for s in self.sections])
        columns["admissible"] = np.array([np.nan if d is None else float(d.admissible) for d in self._diagnostic])
        reserved = list(columns) + ["multipliers", "newton_iterations"]
        names = self._number_names()
        for name, heading in zip(names, _distinct(reserved + names)[len(reserved):]):
            columns[heading] = self._numbers(name)
        iterations = [np.nan if d is None or d.iterations is None else d.iterations for d in self._diagnostic]
        columns["newton_iterations"] = np.array(iterations, dtype=float)
        assert all(len(column) == size for column in columns.values())
        return columns

    def _types(self):
        types = []
        for (_, integers, _), solution, diagnostic in zip(self._rows(), self._solution, self._diagnostic):
            name = solution.type_name if solution else type_name(integers[2])
            types.append(diagnostic.type_name if name == "UZ" and diagnostic and diagnostic.type_name else name)
        return np.array(types, dtype=object)

    def _first_solution(self, section):
        at = 0
        for other in self.sections:
            if other is section:
                return next((s for s in self._solution[at:at + len(section)] if s is not None), None)
            at += len(other)
        return None

    def _parameters(self, section):
        """The parameters worth a column: those with a name, those that are not zero, durations."""
        solution = self._first_solution(section)
        values = [] if solution is None else solution.parameters
        shown = [k for k, value in enumerate(values, 1)
                 if FIRST_DURATION <= k < FIRST_DURATION + section.nseg or (k < FIRST_DURATION and value != 0.0)]
        return sorted(set(shown) | set(section.parameters))

    def _number_names(self):
        names = [name for section in self.sections for name in _distinct(section.columns)]
        names += [s.parameter_name(k) for s in self.sections for k in self._parameters(s)]
        return list(dict.fromkeys(names))

    def _numbers(self, name):
        parts, at = [], 0
        for section in self.sections:
            columns = _distinct(section.columns)
            solutions = self._solution[at:at + len(section)]
            at += len(section)
            numbers = {section.parameter_name(k): k for k in self._parameters(section)}
            if name in columns:
                parts.append(section.data[:, columns.index(name)])
            elif name in numbers:
                parts.append(self._parameter(section, numbers[name], solutions))
            else:
                parts.append(np.full(len(section), np.nan))
        return _known(np.concatenate(parts))

    def _parameter(self, section, k, solutions):
        """A parameter without a column: one that is free, or may be, is known at labels only."""
        if section.nseg == 1 and k == FIRST_DURATION and "PERIOD" in section.columns:
            return section["PERIOD"]
        duration = FIRST_DURATION <= k < FIRST_DURATION + section.nseg
        first = self._first_solution(section)
        if section.active and k not in section.active and not duration:
            known = first is not None and k <= len(first.parameters)
            return np.full(len(section), first.parameters[k - 1] if known else np.nan)
        return np.array([np.nan if s is None or k > len(s.parameters) else s.parameters[k - 1] for s in solutions])


def load(name):
    """The run whose files are p.NAME, and q.NAME and d.NAME if they are there; `name` may be p.NAME, with a folder."""
    path = _resolve(name, "p")
    if os.path.basename(path)[:2] in ("q.", "d."):
        path = _sibling(path, "p")
    sections = read_points(path)

    def beside(letter, reader):
        other = _sibling(path, letter)
        if other is None or not os.path.isfile(other):
            return None
        try:
            return reader(other)
        except Error as error:
            _warn("%s (left out)" % error)
            return None

    solutions = beside("q", lambda other: read_solutions(other, names=False))
    for solution in solutions or []:
        solution.state_names, solution.parameter_names = sections[0].states, sections[0].parameters
    return Run(path, sections, solutions, beside("d", read_diagnostics))


# --------------------------------------------------------------------------------------- files of tchat simulate


class Trajectory:
    """Rows of O.trajectory or O.events: segment, index (rows x 3: field, event, jump), t, and columns by their
    headings, trajectory["x1"]; parameters: values by name, from the heading; what: what each event is (else None)."""

    def __init__(self, path):
        lines = _read_text(path, "what tchat simulate writes").splitlines()
        if len(lines) < 2 or not lines[1].startswith("#segment"):
            raise Error("%s:2: no heading #segment; give a NAME.trajectory or NAME.events of tchat simulate" % path)
        self.path, self.columns = path, lines[1][1:].split()
        self.parameters = {name: float(value) for name, value in re.findall(r"(\S+) = ([^,\s]+)", lines[0])}
        events = self.columns[-1] == "what"
        rows, self._begins = [], []
        fresh = True
        for number, line in enumerate(lines[2:], 3):
            words = line.split()
            if not words:
                fresh = True
                continue
            if len(words) != len(self.columns):
                if number == len(lines):
                    _warn("%s:%d: the last line is not complete and is left out" % (path, number))
                    break
                raise Error("%s:%d: %d words, expected are %d; the file is damaged" %
                            (path, number, len(words), len(self.columns)))
            if fresh:
                self._begins.append(len(rows))
            fresh = False
            rows.append(words)
        self.what = np.array([row[-1] for row in rows], dtype=object) if events else None
        try:
            data = _reals([word for row in rows for word in (row[:-1] if events else row)])
        except ValueError:
            raise Error("%s: there is a word that is no number; the file is damaged" % path) from None
        self.data = data.reshape(len(rows), len(self.columns) - events)
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


def read_trajectory(path):
    """O.trajectory of tchat simulate, `O` for short."""
    path = _checked_path(path, "what tchat simulate writes")
    return Trajectory(path if os.path.exists(path) else path + ".trajectory")


def read_events(path):
    """O.events of tchat simulate, `O` for short."""
    path = _checked_path(path, "what tchat simulate writes")
    return Trajectory(path if path.endswith(".events") else path + ".events")


# --------------------------------------------------------------------------------------------------- running tchat


def _program(program):
    program = program or os.environ.get("TCHAT", "tchat")
    found = shutil.which(program)
    if found is None:
        raise Error("%s: there is no such program on PATH; give program= or the environment variable TCHAT the path of "
                    "tchat" % program)
    return os.path.abspath(found)


def _output_name(name, arguments):
    """What -o says, else the name of the problem."""
    for k, word in enumerate(arguments):
        if word == "-o" and k + 1 < len(arguments):
            return arguments[k + 1]
        if word.startswith("-o") and len(word) > 2 and not word.startswith("--"):
            return word[2:]
    return name


def _words(command, name, arguments, constants):
    words = [command, name] + [str(word) for word in arguments]
    return words + ["%s=%s" % (key, value) for key, value in constants.items()]


def _own_message(text):
    """tchat's own message, without its warnings, which become warnings here."""
    message, in_message = [], False
    for line in text.splitlines():
        if line.startswith("tchat: warning: "):
            in_message = False
            _warn(line[len("tchat: warning: "):])
        elif line.startswith("tchat: ") or in_message:
            in_message = True
            message.append(line[len("tchat: "):] if line.startswith("tchat: ") else line)
    return "\n".join(message)


class _GrowingPoints:
    """The points that a run adds to its p-file, as they come."""

    def __init__(self, path, append):
        self._parser, self._path = _PointParser(path), path
        self._old, self._offset, self._rest = None, 0, ""
        try:
            state = os.stat(path)
            if append:
                with open(path, "rb") as file:
                    self._offset = file.read().rfind(b"\n") + 1
            else:
                self._old = state.st_ino
        except OSError:
            pass

    def new_points(self):
        try:
            with open(self._path, encoding="latin-1", newline="") as file:
                if os.fstat(file.fileno()).st_ino == self._old:
                    return  # of the run before
                file.seek(self._offset)
                text = file.read()
                self._offset = file.tell()
        except OSError:
            return
        lines = (self._rest + text).split("\n")
        self._rest = lines.pop()
        for line in lines:
            point = self._parser.feed(line)
            if point is not None:
                yield point


def _execute(words, cwd, program, poll=lambda: True):
    """Runs tchat to its end, calling poll() now and then; SIGINT when it returns False or raises. (status, screen)."""
    for word in words:
        if "\0" in word:
            raise Error("the argument %r has a zero byte in it, which no program can be given; leave it out" % word)
    with tempfile.TemporaryFile() as screen, tempfile.TemporaryFile() as errors:
        process = subprocess.Popen([_program(program)] + words, stdin=subprocess.DEVNULL, stdout=screen, stderr=errors,
                                   cwd=cwd)
        stopped = False
        try:
            while True:
                try:
                    process.wait(POLL_SECONDS)
                except subprocess.TimeoutExpired:
                    pass
                ended = process.poll() is not None
                if not stopped and not poll():
                    stopped = True
                    if not ended:
                        process.send_signal(signal.SIGINT)
                if ended:
                    break
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
                process.wait()
        texts = []
        for file in (screen, errors):
            file.seek(0)
            texts.append(file.read().decode("utf-8", "replace"))
        message = _own_message(texts[1])
        if process.returncode != 0 and not (stopped and process.returncode == 130):
            raise Error(message or "tchat ended with the exit status %d" % process.returncode, process.returncode,
                        texts[0])
        return texts[0]


def run(name, *arguments, progress=None, cwd=None, program=None, **constants):
    """`tchat run NAME arguments KEY=VALUE...`, and the Run that it has written.

        tchat.run("linosc", "-c", "impacting", "-d", "impacting", "-o", "x", DS=-0.02, UZR={1: 3.2})

    progress(point) is called for every point (a Point) while the run goes on; when it returns False the run is
    interrupted as by Ctrl-C and what there is comes back. cwd: the folder to run in. program: the path of tchat, else
    the environment variable TCHAT, else tchat on PATH. Raises Error with tchat's message, its exit status and screen.
    """
    words = _words("run", name, arguments, constants)
    output = os.path.join(cwd or "", _output_name(os.path.basename(name), words[2:]))
    folder, last = os.path.split(output)
    path = os.path.join(folder, "p." + last)
    growing = _GrowingPoints(path, "--append" in words) if progress else None
    started = time.time()

    def poll():
        return growing is None or all(progress(point) is not False for point in growing.new_points())

    screen = _execute(words, cwd, program, poll)
    if not os.path.isfile(path) or os.stat(path).st_mtime < started - 2:
        raise Error("%s: the run has written no points" % path, 0, screen)
    result = load(path)
    result.screen = screen
    return result


class Simulation:
    """What `tchat simulate` has written: trajectory, events, and its text on the screen."""

    def __init__(self, output, screen):
        self.trajectory, self.events, self.screen = read_trajectory(output), read_events(output), screen


def simulate(name, *arguments, cwd=None, program=None, **constants):
    """`tchat simulate NAME arguments KEY=VALUE...`; parameters as `"PAR(alpha)=3"` among the arguments."""
    words = _words("simulate", name, arguments, constants)
    screen = _execute(words, cwd, program)
    return Simulation(os.path.join(cwd or "", _output_name(os.path.basename(name), words[2:])), screen)


def sweep(name, parameter, values, *arguments, cwd=None, program=None, **constants):
    """A brute-force diagram: tchat simulate for each value of a parameter, (value, events) one after the other.

        for alpha, events in tchat.sweep("linosc", "alpha", np.arange(3, 3.1, 0.01), "--transient-events", 300,
                                         "--events", 40):
            plt.plot([alpha] * len(events), events["x2"], "k,")
    """
    with tempfile.TemporaryDirectory() as folder:
        output = os.path.join(folder, "sweep")
        for value in values:
            more = ["PAR(%s)=%r" % (parameter, float(value)), "--rows", "0", "-q", "-o", output]
            _execute(_words("simulate", name, list(arguments) + more, constants), cwd, program)
            yield value, read_events(output)
