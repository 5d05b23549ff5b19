"""A boundary value problem with integral conditions beside AUTO-07p: the same loads, and AUTO's file starts a run.

usage: auto_boundary_values.py TCHAT SOURCE      executable, folder of the sources

A clamped rod of two arcs, angle'' = -P sin(angle) + Q cos(angle), angle(0) = angle(1) = 0: its ends have come nearer by
D (integral of 1 - D - cos(angle)) and stay on one line (integral of sin(angle)). D, P and Q are free. Exit status 77
(skipped) without AUTO-07p.
"""

import math
import os
import sys
import tempfile

from auto_runs import auto_objects, run

SOURCE_OF_AUTO = """
subroutine func(ndim,u,icp,par,ijac,f,dfdu,dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim,ndim), dfdp(ndim,*)
  f(1) = u(2)
  f(2) = -par(2)*sin(u(1)) + par(3)*cos(u(1))
end subroutine
subroutine stpnt(ndim,u,par,t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  double precision, parameter :: k = {k:.17g}d0, q = {q:.17g}d0
  par(1:3) = (/ {shortening:.17g}d0, k*k, q*k*k /)
  u(1) = q*(1 - cos(k*t) - 0.5d0*k*sin(k*t))
  u(2) = q*k*(sin(k*t) - 0.5d0*k*cos(k*t))
end subroutine
subroutine bcnd(ndim,par,icp,nbc,u0,u1,fb,ijac,dbc)
  implicit none
  integer, intent(in) :: ndim, icp(*), nbc, ijac
  double precision, intent(in) :: par(*), u0(ndim), u1(ndim)
  double precision, intent(out) :: fb(nbc)
  double precision, intent(inout) :: dbc(nbc,*)
  fb(1) = u0(1)
  fb(2) = u1(1)
end subroutine
subroutine icnd(ndim,par,icp,nint,u,uold,udot,upold,fi,ijac,dint)
  implicit none
  integer, intent(in) :: ndim, icp(*), nint, ijac
  double precision, intent(in) :: par(*), u(ndim), uold(ndim), udot(ndim), upold(ndim)
  double precision, intent(out) :: fi(nint)
  double precision, intent(inout) :: dint(nint,*)
  fi(1) = 1 - par(1) - cos(u(1))
  fi(2) = sin(u(1))
end subroutine
subroutine fopt
end subroutine
subroutine pvls
end subroutine
"""

PROBLEM = """
#include <tchat/problem.hpp>
struct Rod {
  static constexpr int dimension = 2, parameters = 3, fields = 1;
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    f[0] = x[1];
    f[1] = -par[1] * sin(x[0]) + par[2] * cos(x[0]);
  }
  static constexpr int boundary_conditions = 2, integral_conditions = 2;
  template <class T>
  void boundary(const tchat::Ends<T>& rod, const T*, T* b) const {
    b[0] = rod.start(1)[0];
    b[1] = rod.end(1)[0];
  }
  template <class T>
  void integrand(int, const T* x, const T* par, T* q) const {
    q[0] = T(1.0) - par[0] - cos(x[0]);
    q[1] = sin(x[0]);
  }
};
TCHAT_PROBLEM(Rod)
"""

CONSTANTS = """NDIM = 2, IPS = 4, NBC = 2, NINT = 2
ICP = [1, 2, 3]
NTST = 40, NCOL = 4, IAD = 3, ISP = 2, ISW = 1
NMX = 200, RL0 = 0, RL1 = 0.55, A0 = 0, A1 = 1000
EPSL = 1e-10, EPSU = 1e-10, EPSS = 1e-8
DS = 0.5, DSMIN = 1e-5, DSMAX = 1.0
UZR = {1: [0.1, 0.3, 0.5]}
"""


def solutions(path):
    """(type, PAR(1..3)) of the entries of a q-file, AUTO's or tchat's."""
    words = open(path).read().split()
    entries, at = [], 0
    while at < len(words):
        head = [int(w) for w in words[at:at + 16]]
        kind, free, points, width, parameters = head[2], head[4], head[6], head[7], head[11]
        at += 16 + points * width + 2 * free + points * (width - 1)
        entries.append((kind % 10 - 10 if kind < 0 else kind, [float(w) for w in words[at:at + 3]]))
        at += parameters
    return entries


def loads(path):
    """(P, Q) at D = 0.1, 0.3, 0.5."""
    found = {}
    for _, (shortening, load, side) in solutions(path):
        for wanted in (0.1, 0.3, 0.5):
            if abs(shortening - wanted) < 1e-7:
                found[wanted] = (load, side)
    return found


def compare(name, mine, others, tolerance):
    if sorted(mine) != [0.1, 0.3, 0.5] or sorted(others) != [0.1, 0.3, 0.5]:
        sys.exit(f"{name}: not all values were found: {mine}, {others}")
    worst = max(abs(a - b) / abs(mine[d][0]) for d in mine for a, b in zip(mine[d], others[d]))
    print(f"{name}: loads agree to {worst:.1e}")
    if not worst < tolerance:
        sys.exit(f"{name}: {mine}\n{others}")


def check_module(source, folder):
    """tchat.py knows both files: durations 1, user values as what they are. Left out where there is no numpy."""
    sys.path.insert(0, os.path.join(source, "src", "python"))
    try:
        import tchat
    except ImportError:
        return
    for name, own in (("rod", True), ("auto", False)):
        for solution in tchat.read_solutions(os.path.join(folder, "q." + name)):
            if solution.period != 1.0 or (solution.type_name == "UZ" and bool(solution.kinds) != own):
                sys.exit(f"tchat.py, q.{name}: period {solution.period}, kinds {solution.kinds}")


def main():
    tchat, source = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    objects = auto_objects()
    # The linear rod: tan(k / 2) = k / 2, angle = q (1 - cos ks - (k / 2) sin ks).
    k = 2 * 4.493409457909064
    shortening = 0.02

    def angle(s):
        return 1 - math.cos(k * s) - 0.5 * k * math.sin(k * s)

    q = math.sqrt(2 * shortening / (sum(angle((i + 0.5) / 1000) ** 2 for i in range(1000)) / 1000))

    with tempfile.TemporaryDirectory() as folder:
        def write(name, text):
            with open(os.path.join(folder, name), "w") as file:
                file.write(text)

        write("rod.f90", SOURCE_OF_AUTO.replace("{k:.17g}", f"{k:.17g}").replace("{q:.17g}", f"{q:.17g}")
              .replace("{shortening:.17g}", f"{shortening:.17g}"))
        run(["gfortran", "-O1", "-fopenmp", "rod.f90", "-o", "rod"] + objects, folder)
        write("fort.2", CONSTANTS)
        write("fort.3", "")
        run([os.path.join(folder, "rod")], folder, env={**os.environ, "OMP_NUM_THREADS": "1"})
        os.rename(os.path.join(folder, "fort.8"), os.path.join(folder, "q.auto"))

        write("rod.cpp", PROBLEM)
        write("gc.rod", CONSTANTS)
        write("rod.dat", f"# PAR(1) = {shortening}\n# PAR(2) = {k * k}\n# PAR(3) = {q * k * k}\n" + "".join(
            f"{i / 80} {q * angle(i / 80)} {q * k * (math.sin(k * i / 80) - 0.5 * k * math.cos(k * i / 80))}\n"
            for i in range(81)))
        environment = {**os.environ, "TCHAT_SOURCE": source}
        run([tchat, "run", "rod", "-q", "-p", "rod.cpp"], folder, env=environment)
        mine, others = loads(os.path.join(folder, "q.rod")), loads(os.path.join(folder, "q.auto"))
        # Both discretise alike; meshes differ a little. EPSL = EPSU = 1e-10.
        compare("tchat and AUTO-07p", mine, others, 1e-8)
        # AUTO's own file starts a run: its solutions are on the interval from 0 to 1.
        run([tchat, "run", "rod", "-q", "-p", "rod.cpp", "-s", "auto", "-o", "on", "IRS=1"], folder, env=environment)
        compare("from AUTO-07p's file", loads(os.path.join(folder, "q.on")), others, 1e-8)
        listing = run([tchat, "labels", "q.auto"], folder, env=environment)
        if "UZ" not in listing:
            sys.exit("tchat labels q.auto:\n" + listing)
        check_module(source, folder)


main()
