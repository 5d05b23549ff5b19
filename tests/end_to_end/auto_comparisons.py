"""tchat and AUTO-07p on the same problems: a table of runs whose labels must agree.

usage: auto_comparisons.py TCHAT SOURCE PROBLEM ...      executable, folder of the sources, names in PROBLEMS

Each row of ROWS is one run by one or both programs, from constants that they share and those that only one has. It says
which labels and columns are compared, how closely, and why that closely. Later rows start from the files of earlier
ones, tchat from AUTO's files too and AUTO from tchat's. Exit status 77 (skipped) without AUTO-07p.
"""

import csv
import io
import math
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field

SKIPPED = 77


def auto_objects():
    """AUTO's object files; ends the test as skipped without them."""
    candidates = [os.path.join(os.environ.get("AUTO_DIR", ""), "lib")]
    try:
        listing = subprocess.run(["dpkg", "-L", "auto-07p"], capture_output=True, text=True, check=False).stdout
        candidates += [os.path.dirname(f) for f in listing.split() if f.endswith("/lib/main.o")]
    except OSError:
        pass
    for folder in candidates:
        if os.path.isfile(os.path.join(folder, "main.o")):
            return [os.path.join(folder, f) for f in sorted(os.listdir(folder)) if f.endswith(".o")]
    sys.exit(SKIPPED)


def run(words, folder, **more):
    """Standard output of a command, which must succeed."""
    result = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False, **more)
    if result.returncode != 0:
        sys.exit(f"{' '.join(words)} failed:\n{result.stdout}\n{result.stderr}")
    return result.stdout


@dataclass
class Problem:
    """u1, p1 and so on are states and parameters, in boundary conditions s1 and e1 the states at both ends."""
    par: list
    equations: list
    start: list                     # a state, or with `profile` expressions in t between 0 and 1
    names: tuple = ()               # of parameters
    boundary: tuple = ()
    integrals: tuple = ()
    profile: dict = field(default_factory=dict)  # the numbers that `start` names


def clamped_rod():
    """angle'' = -P sin(angle) + Q cos(angle), angle(0) = angle(1) = 0: its ends have come nearer by D and stay on one
    line. The start is the linear rod: tan(k / 2) = k / 2, angle = q (1 - cos kt - (k / 2) sin kt)."""
    k, shortening = 2 * 4.493409457909064, 0.02
    shape = [1 - math.cos(k * s) - 0.5 * k * math.sin(k * s) for s in ((i + 0.5) / 1000 for i in range(1000))]
    q = math.sqrt(2 * shortening / (sum(s * s for s in shape) / 1000))
    return Problem(
        par=[shortening, k * k, q * k * k], equations=["u2", "-p2*sin(u1) + p3*cos(u1)"],
        boundary=("s1", "e1"), integrals=("1 - p1 - cos(u1)", "sin(u1)"), profile={"k": k, "h": 0.5 * k, "q": q},
        start=["{q}*(1 - cos({k}*t) - {h}*sin({k}*t))", "{q}*{k}*(sin({k}*t) - {h}*cos({k}*t))"])


def predator_and_prey():
    capacity, death, growth = 2.0, 0.4, 0.5
    prey = death / (1 - death)
    return Problem(names=("K", "d", "r"), par=[capacity, death, growth],
                   equations=["p3*u1*(1 - u1/p1) - u1*u2/(1 + u1)", "u2*(u1/(1 + u1) - p2)"],
                   start=[prey, growth * (1 - prey / capacity) * (1 + prey)])


PROBLEMS = {  # ab, lor and tor are AUTO's demos, equations and starts from its manual
    "ab": Problem(par=[0.0, 14.0, 2.0], start=[0.0, 0.0],
                  equations=["-u1 + p1*(1 - u1)*exp(u2)", "-u2 + p1*p2*(1 - u1)*exp(u2) - p3*u2"]),
    "lor": Problem(par=[0.0, 8.0 / 3.0, 10.0], start=[0.0, 0.0, 0.0],
                   equations=["p3*(u2 - u1)", "p1*u1 - u2 - u1*u3", "u1*u2 - p2*u3"]),
    "tor": Problem(par=[-0.9, 0.5, -0.6, 0.6, 0.328578, 0.933578], start=[0.0, 0.0, 0.0],
                   equations=["(-(p2 + p1)*u1 + p2*u2 - p5*u1*u1*u1 + p6*(u2 - u1)*(u2 - u1)*(u2 - u1))/p4",
                              "p2*u1 - (p2 + p3)*u2 - u3 - p6*(u2 - u1)*(u2 - u1)*(u2 - u1)", "u2"]),
    "prey": predator_and_prey(),
    "rod": clamped_rod(),
}


@dataclass
class Row:
    """Run NAME of a problem: tchat writes q.NAME, AUTO q.aNAME."""
    problem: str
    name: str
    constants: dict
    own: dict = field(default_factory=dict)   # constants of tchat alone; None: tchat does not run
    auto: dict = field(default_factory=dict)  # likewise
    start: str = ""                           # a run: each program starts from its own file, unless these say otherwise
    own_start: str = ""
    auto_start: str = ""
    words: tuple = ()                         # of tchat's command line
    other: str = ""                           # the run of AUTO that is compared with; "": of this row
    labels: tuple = ()                        # types that are compared; (): all but regular and end points
    at: tuple = ()                            # a column and values: the last label at each; (): all, in order
    columns: tuple = ()                       # that are compared
    scale: str = "mixed"                      # of differences: 1 + |value| (mixed), 1 (absolute), |value| (relative)
    tolerance: float = 0.0
    why: str = ""                             # the tolerance
    least: int = 1                            # labels
    known: tuple = ()                         # (types, column, value, tolerance) of every such label
    same_stability: bool = False


COMMON = {"EPSL": "1e-10", "EPSU": "1e-10", "EPSS": "1e-8", "NTST": "100", "NCOL": "4", "IAD": "1", "ISP": "2",
          "ILP": "1", "ITMX": "12", "ITNW": "9", "NWTN": "5", "IID": "2", "NPR": "0"}
SECANT = "AUTO ends its secant method at EPSS (1 + sqrt(|DS DSMAX|)) of arclength, and meshes differ"
LOOSE = SECANT + "; EPSS = 1e-6, as with a smaller one AUTO reports a branch point that it cannot locate"
DIFFERENCES = "AUTO's derivatives are differences of differences there, it converges to 1e-6 at best"
SAME_EQUATIONS = "both discretise alike, meshes differ a little"
STATE = ("PAR(1)", "PAR(3)", "period", "U(1)")
ORBIT = ("PAR(1)", "PAR(3)", "period")


def equilibria(**constants):
    return {"IPS": 1, "ICP": "[1]", "IRS": 0, "ISW": 1, "NMX": 300, "DSMIN": 1e-5, **constants}


def born(stop=None, values=None):
    """Periodic orbits from HB1: what AUTO (the period is PAR(11)) and tchat (PAR(61)) call them."""
    def text(period):
        entries = {**(values or {}), **({-period: stop} if stop else {})}
        return "{" + ", ".join(f"{k}: {v}" for k, v in entries.items()) + "}"
    return {"auto": {"IPS": 2, "ICP": "[1, 11]", "ISW": 1, "UZR": text(11), "IRS": "HB1"},
            "own": {"IPS": 180, "ICP": "[1, 61]", "ISW": -1, "GCHIND": "[0]", "GCGIND": "[0]", "UZR": text(61),
                    "IRS": "HB1"}}


def switched(programs):
    return {program: {**constants, "IRS": "BP1", "ISW": -1} for program, constants in programs.items()}


AB = equilibria(RL0=-0.01, RL1=0.15, DS=0.01, DSMAX=0.05, UZR="{1: 0.1, -1: 0.149}")
AB_ORBITS = {"NMX": 300, "RL0": 0, "RL1": 0.15, "DS": 0.1, "DSMIN": 1e-5, "DSMAX": 0.5}
AB_CURVE = {"IPS": 1, "ICP": "[1, 3]", "ISW": 2, "NMX": 400, "RL0": 1e-4, "RL1": 0.6, "DS": 0.05, "DSMIN": 1e-6,
            "DSMAX": 0.05, "EPSL": "1e-6", "EPSU": "1e-6", "EPSS": "1e-6"}
LOR = equilibria(RL0=-0.1, RL1=31, DS=0.1, DSMAX=0.5, UZR="{-1: 30}", MXBF=0)
TOR = equilibria(RL0=-1, RL1=1, DS=0.01, DSMAX=0.05, UZR="{-1: 0.5}", MXBF=0)
TOR_ORBITS = {"NMX": 300, "RL0": -1, "RL1": 0, "DS": 0.05, "DSMIN": 1e-5, "DSMAX": 0.1, "MXBF": 0, "EPSL": "1e-7",
              "EPSU": "1e-7", "EPSS": "1e-6"}
PREY = {"EPSL": "1e-11", "EPSU": "1e-11", "EPSS": "1e-9", "DSMIN": 1e-6, "A0": -1e6, "A1": 1e6, "RL1": 20}
DEATHS = (0.38, 0.37, 0.36, 0.35)
HELD = {"IPS": 180, "ICP": "[K, d]", "HOLD": "[period]", "GCFIND": "[1]", "GCHIND": "[0]", "GCGIND": "[0]",
        "IRS": "UZ1", "DS": 0.02, "DSMAX": 0.05, "NMX": 200, "UZR": f"{{d: {list(DEATHS)}}}"}
HELD_LABELS = {"own_start": "aorbits", "auto": None, "other": "held", "labels": ("UZ",), "at": ("PAR(2)", DEATHS),
               "columns": ("PAR(1)",), "scale": "relative", "tolerance": 1e-9, "why": SAME_EQUATIONS, "least": 4,
               "known": (((), "period", 36.0, 1e-9),)}
ROD = {"IPS": 4, "NBC": 2, "NINT": 2, "ICP": "[1, 2, 3]", "NTST": 40, "IAD": 3, "ISW": 1, "NMX": 200, "RL0": 0,
       "RL1": 0.55, "A0": 0, "A1": 1000, "DS": 0.5, "DSMIN": 1e-5, "DSMAX": 1.0, "UZR": "{1: [0.1, 0.3, 0.5]}"}
ROD_LABELS = {"labels": ("UZ",), "at": ("PAR(1)", (0.1, 0.3, 0.5)), "columns": ("PAR(2)", "PAR(3)"),
              "scale": "relative", "tolerance": 1e-8, "why": SAME_EQUATIONS, "least": 3}

ROWS = [
    Row("ab", "eq", AB, columns=STATE, tolerance=1e-7, why=SECANT, least=7, same_stability=True),
    Row("ab", "per", AB_ORBITS, **born(stop=12), start="eq", columns=ORBIT, tolerance=1e-6, why=SECANT),
    Row("ab", "from_auto", AB_ORBITS, own=born(stop=12)["own"], auto=None, own_start="aeq", other="per", columns=ORBIT,
        tolerance=1e-6, why=SECANT),
    # Each from the other's file; AUTO needs to know how many parameters tchat's has.
    Row("ab", "on", {**AB, "IRS": "LP1"}, own_start="aeq", auto_start="eq", auto={"NPAR": 110}, columns=STATE,
        tolerance=1e-7, why=SECANT, least=4),
    # AUTO looks for no points of codimension two but cusps on curves of folds.
    Row("ab", "folds", {**AB_CURVE, "IRS": "LP1", "UZR": "{3: [2.1, 2.3], -1: 0.09}"}, start="eq", labels=("UZ", "CP"),
        columns=("PAR(1)", "PAR(3)"), scale="absolute", tolerance=1e-5, why=DIFFERENCES, least=4),
    Row("ab", "hopf", {**AB_CURVE, "IRS": "HB1", "DSMAX": 0.1, "RL1": 1, "A0": 1.56, "A1": 100, "UZR": "{3: [2.5, 3]}"},
        start="eq", labels=("UZ", "GH"), columns=("PAR(1)", "PAR(3)"), scale="absolute", tolerance=1e-5,
        why=DIFFERENCES, least=3),
    Row("lor", "eq", LOR, columns=STATE, tolerance=1e-7, why=SECANT, least=2),
    # A symmetry takes one side to the other, so that states may differ.
    Row("lor", "eq2", {**LOR, "IRS": "BP1", "ISW": -1}, start="eq", columns=ORBIT, tolerance=1e-7, why=SECANT, least=2),
    Row("lor", "per", {"NMX": 300, "RL0": 14, "RL1": 30, "DS": 0.1, "DSMIN": 1e-5, "DSMAX": 1},
        **born(values={1: "[20, 16]", -1: 14.5}), start="eq2", columns=ORBIT, tolerance=1e-6, why=SECANT, least=3),
    Row("tor", "eq", TOR, columns=STATE, tolerance=1e-7, why=SECANT, least=3),
    Row("tor", "per", TOR_ORBITS, **born(stop=15, values={1: "[-0.6, -0.65]"}), start="eq", columns=ORBIT,
        tolerance=1e-5, why=LOOSE, least=5),
    # Orbits that break the symmetry, with their torus bifurcation and period doubling.
    Row("tor", "per2", {**TOR_ORBITS, "DSMAX": 0.02}, **switched(born(values={-1: "-0.62"})), start="per",
        columns=ORBIT, tolerance=1e-5, why=LOOSE, least=3),
    # Where the prey's isocline has its maximum at the equilibrium.
    Row("prey", "eq", {**PREY, **equilibria(NMX=100, DS=0.05, DSMAX=0.1, RL1=4)}, own=None,
        known=((("HB",), "PAR(1)", 1.4 / 0.6, 1e-7),)),
    Row("prey", "orbits", {**PREY, "NMX": 400, "DS": 0.05, "DSMAX": 0.2}, own=None, auto=born(stop=36)["auto"],
        start="eq"),
    # A constant period in two parameters: AUTO fixes it, tchat holds a monitor at the start's value or at a given one.
    Row("prey", "held", {**PREY, "IPS": 2, "IRS": "UZ1", "ICP": "[1, 2]", "NMX": 200, "DS": -0.02, "DSMAX": 0.05,
                         "UZR": f"{{2: {list(DEATHS)}}}"}, own=None, start="orbits"),
    Row("prey", "held_as_found", {**PREY, **HELD}, words=("--both",), **HELD_LABELS),
    Row("prey", "held_as_given", {**PREY, **HELD}, words=("--both", "HOLD={period: 36}"), **HELD_LABELS),
    Row("rod", "rod", ROD, **ROD_LABELS),
    Row("rod", "from_auto", ROD, auto=None, own_start="arod", words=("IRS=1",), other="rod", **ROD_LABELS),
]

NAMES = {1: "BP", 2: "LP", 3: "HB", 5: "LP", 6: "BP", 7: "PD", 8: "TR", -4: "UZ", 9: "EP", -9: "MX",
         -1: "BT", -2: "CP", -3: "ZH"}


def translated(text, forms):
    """u1 -> what the language has for it; forms count from 1 ({0}) or 0 ({1})."""
    return re.sub(r"\b([upse])(\d)\b", lambda m: forms[m[1]].format(int(m[2]), int(m[2]) - 1), text)


def fortran_of(text):
    return translated(text, {"u": "u({0})", "p": "par({0})", "s": "u0({0})", "e": "u1({0})"})


def cpp_of(text):
    """Plain numbers become those of the type that the problem is evaluated with."""
    text = re.sub(r"(?<![\w.])(\d+)(?![\w.])", r"T(\1.0)", text)
    return translated(text, {"u": "x[{1}]", "p": "p[{1}]", "s": "x.start(1)[{1}]", "e": "x.end(1)[{1}]"})


def fortran(problem):
    def assigned(name, values):
        return "\n".join(f"  {name}({k + 1}) = {v}" for k, v in enumerate(values))

    def double(value):
        return f"{value:.17g}d0"

    numbers = {name: double(value) for name, value in problem.profile.items()}
    start = [v.format(**numbers) if problem.profile else double(v) for v in problem.start]
    return f"""
subroutine func(ndim,u,icp,par,ijac,f,dfdu,dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim,ndim), dfdp(ndim,*)
{assigned("f", map(fortran_of, problem.equations))}
end subroutine
subroutine stpnt(ndim,u,par,t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
{assigned("par", map(double, problem.par))}
{assigned("u", start)}
end subroutine
subroutine bcnd(ndim,par,icp,nbc,u0,u1,fb,ijac,dbc)
  implicit none
  integer, intent(in) :: ndim, icp(*), nbc, ijac
  double precision, intent(in) :: par(*), u0(ndim), u1(ndim)
  double precision, intent(out) :: fb(nbc)
  double precision, intent(inout) :: dbc(nbc,*)
{assigned("fb", map(fortran_of, problem.boundary))}
end subroutine
subroutine icnd(ndim,par,icp,nint,u,uold,udot,upold,fi,ijac,dint)
  implicit none
  integer, intent(in) :: ndim, icp(*), nint, ijac
  double precision, intent(in) :: par(*), u(ndim), uold(ndim), udot(ndim), upold(ndim)
  double precision, intent(out) :: fi(nint)
  double precision, intent(inout) :: dint(nint,*)
{assigned("fi", map(fortran_of, problem.integrals))}
end subroutine
subroutine fopt
end subroutine
subroutine pvls
end subroutine
"""


def plugin(problem):
    def function(head, name, values):
        return f"  template <class T>\n  void {head} const {{\n" + "".join(
            f"    {name}[{k}] = {cpp_of(v)};\n" for k, v in enumerate(values)) + "  }\n"

    text = f"""#include <tchat/problem.hpp>
struct Demo {{
  static constexpr int dimension = {len(problem.start)}, parameters = {len(problem.par)}, fields = 1;
  static constexpr double initial_parameters[] = {{{", ".join(map(repr, problem.par))}}};
"""
    if problem.names:
        names = ", ".join(f'"{name}"' for name in problem.names)
        text += f"  static constexpr const char* parameter_names[] = {{{names}}};\n"
    text += function("field(int, const T* x, const T* p, T* f)", "f", problem.equations)
    if problem.boundary:
        text += (f"  static constexpr int boundary_conditions = {len(problem.boundary)}, "
                 f"integral_conditions = {len(problem.integrals)};\n"
                 + function("boundary(const tchat::Ends<T>& x, const T*, T* b)", "b", problem.boundary)
                 + function("integrand(int, const T* x, const T* p, T* q)", "q", problem.integrals))
    return text + "};\nTCHAT_PROBLEM(Demo)\n"


def data(problem):
    if not problem.profile:
        return " ".join(map(repr, problem.start)) + "\n"
    expressions = [v.format(**{name: repr(value) for name, value in problem.profile.items()}) for v in problem.start]
    rows = [[t] + [eval(e, {"sin": math.sin, "cos": math.cos, "t": t}) for e in expressions]
            for t in (i / 80 for i in range(81))]
    return "".join(f"# PAR({k + 1}) = {v!r}\n" for k, v in enumerate(problem.par)) + "".join(
        " ".join(map(repr, row)) + "\n" for row in rows)


def read_labels(path):
    """The entries of a q-file, AUTO's or tchat's: type and columns; "" for types without a name here."""
    words = open(path).read().split()
    found, at = [], 0
    while at < len(words):
        head = [int(w) for w in words[at:at + 16]]
        kind, free, points, width, lines, mesh = head[2], head[4], head[6], head[7], head[8], head[9]
        parameters, problem = head[11], head[14]
        first_state = float(words[at + 17])
        at += 16 + points * width
        without_direction = (width - 1) // 7 * points + points + (parameters + 6) // 7
        if mesh > 0 and lines > without_direction:
            at += 2 * free + points * (width - 1)
        par = [float(w) for w in words[at:at + parameters]]
        at += parameters
        basic = kind if abs(kind) < 10 or kind == -32 else kind % 10 - (10 if kind < 0 and kind % 10 else 0)
        columns = {f"PAR({k + 1})": value for k, value in enumerate(par)}
        columns["period"] = par[10] if problem == 2 else par[60] if problem == 180 else 0.0
        columns["U(1)"] = first_state if points == 1 else 0.0
        # AUTO has no label where the first parameter turns along a curve of Hopf points; tchat says EX, kind 9.
        is_extremum = abs(basic) == 4 and parameters >= 100 and par[parameters - 4] == 9
        found.append(("GH" if kind == -32 else "" if is_extremum else NAMES.get(basic, ""), columns))
    return found


def of_types(labels, types):
    return [label for label in labels if (label[0] in types if types else label[0] not in ("", "EP"))]


def stable_parts(path):
    """Stability along the branch, each change once."""
    signs = []
    for line in open(path):
        words = line.split()
        if words and words[0] != "0":
            stable = int(words[1]) < 0
            if not signs or signs[-1] != stable:
                signs.append(stable)
    return signs


SCALES = {"mixed": lambda value: 1.0 + abs(value), "absolute": lambda value: 1.0, "relative": abs}


class Comparison:
    """Both programs on one problem, in a folder."""

    def __init__(self, name, folder, objects, tchat, source):
        self.name, self.problem, self.folder, self.tchat = name, PROBLEMS[name], folder, tchat
        self.environment = {**os.environ, "TCHAT_SOURCE": source, "OMP_NUM_THREADS": "1"}
        self.write(name + ".f90", fortran(self.problem))
        self.write(name + ".cpp", plugin(self.problem))
        self.write(name + ".dat", data(self.problem))
        run(["gfortran", "-O1", "-fopenmp", "-ffree-line-length-none", name + ".f90", "-o", "auto"] + objects, folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)

    def constants(self, row, more):
        values = {**COMMON, "NDIM": len(self.problem.start), **row.constants, **more}
        return "".join(f"{k} = {v}\n" for k, v in values.items())

    def run_auto(self, row):
        start = row.auto_start or ("a" + row.start if row.start else "")
        self.write("fort.2", self.constants(row, {"JAC": 0, **row.auto}))
        self.write("fort.3", open(self.path("q." + start)).read() if start else "")
        run([self.path("auto")], self.folder, env=self.environment)
        for number, letter in ((7, "p"), (8, "q"), (9, "d")):
            os.rename(self.path(f"fort.{number}"), self.path(f"{letter}.a{row.name}"))

    def run_own(self, row):
        start = row.own_start or row.start
        self.write("gc." + self.name, self.constants(row, row.own))
        run([self.tchat, "run", self.name, "-q", "-p", self.name + ".cpp", "-o", row.name,
             *(["-s", start] if start else []), *row.words], self.folder, env=self.environment)

    def labels(self, row, name):
        """Those that the row compares, in its order."""
        found = of_types(read_labels(self.path("q." + name)), row.labels)
        if row.at:
            column, values = row.at
            found = [[label for label in found if abs(label[1][column] - value) < 1e-9][-1:] for value in values]
            found = [label for labels in found for label in labels]
        return [(kind, [columns[c] for c in row.columns]) for kind, columns in found]

    def compare(self, row):
        other = "a" + (row.other or row.name)
        a, b = self.labels(row, row.name), self.labels(row, other)
        types = [label[0] for label in a]
        if types != [label[0] for label in b] or len(a) < row.least or (row.at and len(a) != len(row.at[1])):
            sys.exit(f"{self.name}: labels differ:\n{row.name}: {a}\n{other}: {b}")
        scale = SCALES[row.scale]
        worst = max(abs(x - y) / scale(y) for (_, l), (_, m) in zip(a, b) for x, y in zip(l, m))
        print(f"{self.name}: {row.name} and {other}: {' '.join(types)}, within {worst:.1e}")
        if not worst < row.tolerance:
            sys.exit(f"{self.name}: more than {row.tolerance} ({row.why}):\n{row.name}: {a}\n{other}: {b}")
        if row.same_stability and stable_parts(self.path("p." + row.name)) != stable_parts(self.path("p." + other)):
            sys.exit(f"{self.name}: stability differs along {row.name} and {other}")

    def compare_known(self, row):
        labels = read_labels(self.path("q." + (row.name if row.own is not None else "a" + row.name)))
        for types, column, value, tolerance in row.known:
            found = [columns[column] for kind, columns in labels if not types or kind in types]
            if not found or not all(abs(x - value) < tolerance for x in found):
                sys.exit(f"{self.name}: {row.name}: {column} is {found}, not {value}")

    def check(self, row):
        if row.auto is not None:
            self.run_auto(row)
        if row.own is not None:
            self.run_own(row)
            self.compare(row)
        self.compare_known(row)


def check_readers(comparison, source):
    """`tchat labels` knows AUTO's files too: durations 1, user values as what they are."""
    listing = run([comparison.tchat, "labels", "q.arod"], comparison.folder, env=comparison.environment)
    if "UZ" not in listing:
        sys.exit("tchat labels q.arod:\n" + listing)
    for name, own in (("rod", True), ("arod", False)):
        table = run([comparison.tchat, "labels", "q." + name, "--csv"], comparison.folder, env=comparison.environment)
        for label in csv.DictReader(io.StringIO(table)):
            if float(label["period"]) != 1.0 or (label["type"] == "UZ" and bool(label["kind"]) != own):
                sys.exit(f"tchat labels q.{name} --csv: period {label['period']}, kind {label['kind']}")


def main():
    tchat, source = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    objects = auto_objects()
    for name in sys.argv[3:]:
        with tempfile.TemporaryDirectory() as folder:
            comparison = Comparison(name, folder, objects, tchat, source)
            for row in (row for row in ROWS if row.problem == name):
                comparison.check(row)
            if name == "rod":
                check_readers(comparison, source)


main()
