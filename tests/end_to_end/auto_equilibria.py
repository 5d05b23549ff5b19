"""Equilibria and the periodic orbits that are born at them beside AUTO-07p: its demos ab, lor and tor, equations and
starts from its manual.

usage: auto_equilibria.py TCHAT SOURCE      executable, folder of the sources

Each is followed from the equilibrium through branch points to a Hopf bifurcation and on along the periodic orbits, by
both programs; all labels are compared in their order, parameter and period. Then AUTO's files start runs of tchat and
the reverse, and curves of folds and Hopf bifurcations are compared. Exit status 77 (skipped) without AUTO-07p.
"""

import os
import sys
import tempfile

from auto_runs import auto_objects, run

# The equations in a notation that both languages read: u1, p1 and so on.
DEMOS = {
    "ab": {
        "par": ["0.", "14.", "2."], "start": ["0.", "0."],
        "equations": ["-u1 + p1*(1 - u1)*exp(u2)", "-u2 + p1*p2*(1 - u1)*exp(u2) - p3*u2"],
    },
    "lor": {
        "par": ["0.", "8./3.", "10."], "start": ["0.", "0.", "0."],
        "equations": ["p3*(u2 - u1)", "p1*u1 - u2 - u1*u3", "u1*u2 - p2*u3"],
    },
    "tor": {
        "par": ["-0.9", "0.5", "-0.6", "0.6", "0.328578", "0.933578"], "start": ["0.", "0.", "0."],
        "equations": ["(-(p2 + p1)*u1 + p2*u2 - p5*u1*u1*u1 + p6*(u2 - u1)*(u2 - u1)*(u2 - u1))/p4",
                      "p2*u1 - (p2 + p3)*u2 - u3 - p6*(u2 - u1)*(u2 - u1)*(u2 - u1)", "u2"],
    },
}

COMMON = {"EPSL": "1e-10", "EPSU": "1e-10", "EPSS": "1e-8", "NTST": "100", "NCOL": "4", "IAD": "1", "ISP": "2",
          "ILP": "1", "ITMX": "12", "ITNW": "9", "NWTN": "5", "IID": "2"}
# AUTO finds a zero by a secant method that ends at EPSS (1 + sqrt(|DS DSMAX|)) of arclength; meshes differ.
EQUILIBRIUM_TOLERANCE = 1e-7
ORBIT_TOLERANCE = 1e-6
LOOSE_ORBIT_TOLERANCE = 1e-5  # with EPSS = 1e-6
CURVE_TOLERANCE = 1e-5
NAMES = {1: "BP", 2: "LP", 3: "HB", 5: "LP", 6: "BP", 7: "PD", 8: "TR", -4: "UZ", 9: "EP", -9: "MX",
         -1: "BT", -2: "CP", -3: "ZH"}


def numbered(text, symbols):
    """u1 -> what the language has for it."""
    for letter, form in symbols.items():
        for k in range(9, 0, -1):
            text = text.replace(f"{letter}{k}", form(k))
    return text


def fortran(demo):
    lines = [f"  f({k + 1}) = " + numbered(e, {"u": lambda k: f"u({k})", "p": lambda k: f"par({k})"})
             for k, e in enumerate(demo["equations"])]
    double = lambda v: "/".join(part.rstrip(".") + ("d0" if "." in part.rstrip(".") else ".d0") for part in v.split("/"))
    start = [f"  par({k + 1}) = {double(v)}" for k, v in enumerate(demo["par"])]
    start += [f"  u({k + 1}) = {double(v)}" for k, v in enumerate(demo["start"])]
    return """
subroutine func(ndim,u,icp,par,ijac,f,dfdu,dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim,ndim), dfdp(ndim,*)
""" + "\n".join(lines) + """
end subroutine
subroutine stpnt(ndim,u,par,t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
""" + "\n".join(start) + """
end subroutine
subroutine bcnd
end subroutine
subroutine icnd
end subroutine
subroutine fopt
end subroutine
subroutine pvls
end subroutine
"""


def plugin(demo):
    lines = [f"    f[{k}] = " + numbered(e.replace("(1 - ", "(T(1.0) - "),
                                        {"u": lambda k: f"x[{k - 1}]", "p": lambda k: f"p[{k - 1}]"}) + ";"
             for k, e in enumerate(demo["equations"])]
    return f"""#include <tchat/problem.hpp>
struct Demo {{
  static constexpr int dimension = {len(demo["start"])}, parameters = {len(demo["par"])}, fields = 1;
  static constexpr double initial_parameters[] = {{{", ".join(demo["par"])}}};
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {{
""" + "\n".join(lines) + "\n  }\n};\nTCHAT_PROBLEM(Demo)\n"


class Pair:
    """Both programs on one problem, in folders of their own."""

    def __init__(self, name, demo, folder, objects, tchat, environment):
        self.name, self.demo, self.tchat = name, demo, tchat
        self.folder = os.path.join(folder, name)
        self.environment = environment
        os.mkdir(self.folder)
        self.write(name + ".f90", fortran(demo))
        self.write(name + ".cpp", plugin(demo))
        self.write(name + ".dat", " ".join(demo["start"]) + "\n")
        run(["gfortran", "-O1", "-fopenmp", name + ".f90", "-o", "auto"] + objects, self.folder)

    def write(self, name, text):
        with open(os.path.join(self.folder, name), "w") as file:
            file.write(text)

    def auto(self, output, start=None, **constants):
        """q.OUTPUT and p.OUTPUT by AUTO, from q.START."""
        values = {**COMMON, "NDIM": len(self.demo["start"]), "JAC": "0", **constants}
        self.write("fort.2", "".join(f"{k} = {v}\n" for k, v in values.items()))
        text = open(os.path.join(self.folder, "q." + start)).read() if start else ""
        self.write("fort.3", text)
        run([os.path.join(self.folder, "auto")], self.folder, env={**os.environ, "OMP_NUM_THREADS": "1"})
        for number, letter in ((7, "p"), (8, "q"), (9, "d")):
            os.rename(os.path.join(self.folder, f"fort.{number}"), os.path.join(self.folder, f"{letter}.{output}"))

    def own(self, output, start=None, **constants):
        """The same by tchat."""
        values = {**COMMON, "NDIM": len(self.demo["start"]), **constants}
        self.write("gc." + self.name, "".join(f"{k} = {v}\n" for k, v in values.items()))
        words = [self.tchat, "run", self.name, "-q", "-p", self.name + ".cpp", "-o", output]
        run(words + (["-s", start] if start else []), self.folder, env=self.environment)

    def labels(self, output):
        """(type, PAR(1), PAR(3), period, U(1)) of the labelled solutions but for regular and end points."""
        words = open(os.path.join(self.folder, "q." + output)).read().split()
        found, at = [], 0
        while at < len(words):
            head = [int(w) for w in words[at:at + 16]]
            kind, free, points, width, lines, ntst = head[2], head[4], head[6], head[7], head[8], head[9]
            parameters, problem = head[11], head[14]
            first_state = float(words[at + 17])
            at += 16 + points * width
            plain = (width - 1) // 7 * points + points + (parameters + 6) // 7
            if ntst > 0 and lines > plain:
                at += 2 * free + points * (width - 1)
            par = [float(w) for w in words[at:at + parameters]]
            at += parameters
            basic = kind if abs(kind) < 10 or kind == -32 else kind % 10 - (10 if kind < 0 and kind % 10 else 0)
            name = "GH" if kind == -32 else NAMES.get(basic, "")
            if name not in ("", "EP", "RG"):
                found.append((name, par[0], par[2], par[10] if problem == 2 else par[60] if problem == 180 else 0.0,
                              first_state if points == 1 else 0.0))
        return found

    def same_labels(self, mine, others, tolerance, least, same_side=True):
        """The labels of two runs, in their order; of branches that a symmetry takes to each other without the state."""
        a, b = self.labels(mine), self.labels(others)
        if [l[0] for l in a] != [l[0] for l in b] or len(a) < least:
            sys.exit(f"{self.name}: labels differ:\n{mine}: {a}\n{others}: {b}")
        worst = max(abs(x - y) / (1.0 + abs(y)) for l, m in zip(a, b)
                    for x, y in zip(l[1:4 if not same_side else 5], m[1:4 if not same_side else 5]))
        print(f"{self.name}: {mine} and {others}: {' '.join(l[0] for l in a)}, within {worst:.1e}")
        if not worst < tolerance:
            sys.exit(f"{self.name}: they differ:\n{mine}: {a}\n{others}: {b}")

    def same_places(self, mine, others, kinds, tolerance, least):
        """Labels of these types alone, by PAR(1) and PAR(3)."""
        a, b = ([l for l in self.labels(q) if l[0] in kinds] for q in (mine, others))
        worst = max((abs(x - y) for l, m in zip(a, b) for x, y in zip(l[1:3], m[1:3])), default=1.0)
        print(f"{self.name}: {mine} and {others}: {' '.join(l[0] for l in a)}, within {worst:.1e}")
        if len(a) < least or [l[0] for l in a] != [l[0] for l in b] or not worst < tolerance:
            sys.exit(f"{self.name}: curves differ:\n{mine}: {self.labels(mine)}\n{others}: {self.labels(others)}")

    def stable_parts(self, output):
        """Stability along the branch, each change once."""
        signs = []
        for line in open(os.path.join(self.folder, "p." + output)):
            words = line.split()
            if words and words[0] not in ("0",):
                stable = int(words[1]) < 0
                if not signs or signs[-1] != stable:
                    signs.append(stable)
        return signs


def both(pair, output, auto_start, own_start, auto_only, own_only, **constants):
    pair.auto("a" + output, auto_start, **{**constants, **auto_only})
    pair.own(output, own_start, **{**constants, **own_only})


def periodic(period_stop=None, values=None):
    """UZR for AUTO (period is PAR(11)) and for tchat (PAR(61))."""
    def text(k):
        entries = dict(values or {})
        if period_stop:
            entries[-k] = period_stop
        return "{" + ", ".join(f"{i}: {v}" for i, v in entries.items()) + "}"
    return ({"IPS": 2, "ICP": "[1, 11]", "ISW": 1, "UZR": text(11)},
            {"IPS": 180, "ICP": "[1, 61]", "ISW": -1, "GCHIND": "[0]", "GCGIND": "[0]", "UZR": text(61)})


def check_ab(pair):
    equilibria = dict(IPS=1, ICP="[1]", IRS=0, ISW=1, NMX=300, RL0=-0.01, RL1=0.15, DS=0.01, DSMIN=1e-5, DSMAX=0.05,
                      UZR="{1: 0.1, -1: 0.149}")
    both(pair, "eq", None, None, {}, {}, **equilibria)
    pair.same_labels("eq", "aeq", EQUILIBRIUM_TOLERANCE, 7)
    if pair.stable_parts("eq") != pair.stable_parts("aeq"):
        sys.exit(f"ab: stability differs: {pair.stable_parts('eq')} {pair.stable_parts('aeq')}")
    orbits = dict(NMX=300, RL0=0, RL1=0.15, DS=0.1, DSMIN=1e-5, DSMAX=0.5)
    auto_only, own_only = periodic(period_stop=12)
    both(pair, "per", "aeq", "eq", {**auto_only, "IRS": "HB1"}, {**own_only, "IRS": "HB1"}, **orbits)
    pair.same_labels("per", "aper", ORBIT_TOLERANCE, 1)
    # AUTO's files as starts, and the reverse.
    pair.own("from_auto", "aeq", **{**orbits, **own_only, "IRS": "HB1"})
    pair.same_labels("from_auto", "aper", ORBIT_TOLERANCE, 1)
    pair.own("on", "aeq", **{**equilibria, "IRS": "LP1"})
    pair.auto("aon", "eq", **{**equilibria, "IRS": "LP1", "NPAR": 110})  # as many as the file has
    pair.same_labels("on", "aon", EQUILIBRIUM_TOLERANCE, 4)
    # Curves in two parameters: where they pass given values, and the cusp. AUTO's derivatives are differences of
    # differences there, so that it converges to 1e-6 at best, and it does not look for the other points of
    # codimension two from a fold.
    curve = dict(IPS=1, ICP="[1, 3]", ISW=2, NMX=400, RL0=1e-4, RL1=0.6, DSMIN=1e-6, DSMAX=0.05, EPSL="1e-6",
                 EPSU="1e-6", EPSS="1e-6")
    both(pair, "folds", "aeq", "eq", {}, {},
         **{**curve, "IRS": "LP1", "DS": 0.05, "UZR": "{3: [2.1, 2.3], -1: 0.09}"})
    both(pair, "hopf", "aeq", "eq", {}, {},
         **{**curve, "IRS": "HB1", "DS": 0.05, "DSMAX": 0.1, "RL1": 1, "A0": 1.56, "A1": 100, "UZR": "{3: [2.5, 3]}"})
    for name, kinds, least in (("folds", ("UZ", "CP"), 4), ("hopf", ("UZ", "GH"), 3)):
        pair.same_places(name, "a" + name, kinds, CURVE_TOLERANCE, least)


def check_lor(pair):
    equilibria = dict(IPS=1, ICP="[1]", IRS=0, ISW=1, NMX=300, RL0=-0.1, RL1=31, DS=0.1, DSMIN=1e-5, DSMAX=0.5,
                      UZR="{-1: 30}", MXBF=0)
    both(pair, "eq", None, None, {}, {}, **equilibria)
    pair.same_labels("eq", "aeq", EQUILIBRIUM_TOLERANCE, 2)
    both(pair, "eq2", "aeq", "eq", {}, {}, **{**equilibria, "IRS": "BP1", "ISW": -1})
    pair.same_labels("eq2", "aeq2", EQUILIBRIUM_TOLERANCE, 2, same_side=False)
    auto_only, own_only = periodic(values={1: "[20, 16]", -1: 14.5})
    both(pair, "per", "aeq2", "eq2", {**auto_only, "IRS": "HB1"}, {**own_only, "IRS": "HB1"}, NMX=300, RL0=14, RL1=30,
         DS=0.1, DSMIN=1e-5, DSMAX=1)
    pair.same_labels("per", "aper", ORBIT_TOLERANCE, 3)


def check_tor(pair):
    equilibria = dict(IPS=1, ICP="[1]", IRS=0, ISW=1, NMX=300, RL0=-1, RL1=1, DS=0.01, DSMIN=1e-5, DSMAX=0.05,
                      UZR="{-1: 0.5}", MXBF=0)
    both(pair, "eq", None, None, {}, {}, **equilibria)
    pair.same_labels("eq", "aeq", EQUILIBRIUM_TOLERANCE, 3)
    orbits = dict(NMX=300, RL0=-1, RL1=0, DS=0.05, DSMIN=1e-5, DSMAX=0.1, MXBF=0)
    # With smaller EPSS AUTO tells of a branch point that it cannot locate.
    orbits |= {"EPSL": "1e-7", "EPSU": "1e-7", "EPSS": "1e-6"}
    auto_only, own_only = periodic(period_stop=15, values={1: "[-0.6, -0.65]"})
    both(pair, "per", "aeq", "eq", {**auto_only, "IRS": "HB1"}, {**own_only, "IRS": "HB1"}, **orbits)
    pair.same_labels("per", "aper", LOOSE_ORBIT_TOLERANCE, 5)
    # The orbits that break the symmetry, with their torus bifurcation and period doubling.
    auto_only, own_only = periodic(values={-1: "-0.62"})
    both(pair, "per2", "aper", "per", {**auto_only, "IRS": "BP1", "ISW": -1}, {**own_only, "IRS": "BP1", "ISW": -1},
         **{**orbits, "DSMAX": 0.02})
    pair.same_labels("per2", "aper2", LOOSE_ORBIT_TOLERANCE, 3)


def main():
    tchat, source = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    objects = auto_objects()
    environment = {**os.environ, "TCHAT_SOURCE": source}
    with tempfile.TemporaryDirectory() as folder:
        for name, check in (("ab", check_ab), ("lor", check_lor), ("tor", check_tor)):
            check(Pair(name, DEMOS[name], folder, objects, tchat, environment))


main()
