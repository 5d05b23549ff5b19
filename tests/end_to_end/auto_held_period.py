"""Periodic orbits of a predator and its prey at the constant period 36, in two parameters, beside AUTO-07p.

usage: auto_held_period.py TCHAT SOURCE      executable, folder of the sources

    prey' = r prey (1 - prey / K) - prey predator / (1 + prey),  predator' = predator (prey / (1 + prey) - d)

AUTO goes from the equilibrium through its Hopf bifurcation to the orbit of period 36 in K, and on in K and d with the
period fixed. tchat starts from AUTO's orbit of that period (its PAR(11)) without a section and holds `period`. Exit
status 77 (skipped) without AUTO-07p.
"""

import os
import sys
import tempfile

from auto_runs import AutoProgram, run, solutions

SOURCE_OF_AUTO = """
subroutine func(ndim,u,icp,par,ijac,f,dfdu,dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim,ndim), dfdp(ndim,*)
  f(1) = par(3)*u(1)*(1 - u(1)/par(1)) - u(1)*u(2)/(1 + u(1))
  f(2) = u(2)*(u(1)/(1 + u(1)) - par(2))
end subroutine
subroutine stpnt(ndim,u,par,t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  par(1:3) = (/ 2.0d0, 0.4d0, 0.5d0 /)
  u(1) = par(2)/(1 - par(2))
  u(2) = par(3)*(1 - u(1)/par(1))*(1 + u(1))
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

PROBLEM = """
#include <tchat/problem.hpp>
struct PredatorPrey {
  static constexpr int dimension = 2, parameters = 3, fields = 1;
  static constexpr const char* parameter_names[] = {"K", "d", "r"};
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    f[0] = par[2] * x[0] * (1.0 - x[0] / par[0]) - x[0] * x[1] / (1.0 + x[0]);
    f[1] = x[1] * (x[0] / (1.0 + x[0]) - par[1]);
  }
};
TCHAT_PROBLEM(PredatorPrey)
"""

COMMON = """NDIM = 2, NTST = 100, NCOL = 4, IAD = 1, ISP = 2, ILP = 1
EPSL = 1e-11, EPSU = 1e-11, EPSS = 1e-9, ITMX = 12, ITNW = 9, NWTN = 5, IID = 2
DSMIN = 1e-6, A0 = -1e6, A1 = 1e6
"""
VALUES = [0.38, 0.37, 0.36, 0.35]


def of_type(path, wanted):
    return [entry for entry in solutions(path) if abs(entry[1]) % 10 == wanted]


def curve(path):
    """K at each of the values of d."""
    found = {}
    for _, _, par in solutions(path):
        for d in VALUES:
            if abs(par[1] - d) < 1e-10:
                found[d] = par[0]
    return found


def main():
    tchat, source = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        auto = AutoProgram(folder, SOURCE_OF_AUTO)
        auto.run("equilibria", COMMON + "IPS = 1, ICP = [1], NMX = 100, NPR = 0, DS = 0.05, DSMAX = 0.1, RL1 = 4\n")
        hopf = of_type(os.path.join(folder, "q.equilibria"), 3)[0]
        k_hopf = (1 + 0.4) / (1 - 0.4)  # where the prey's isocline has its maximum at the equilibrium
        if abs(hopf[2][0] - k_hopf) > 1e-7:
            sys.exit(f"Hopf bifurcation at {hopf[2][0]}, expected {k_hopf}")
        auto.run("orbits", COMMON + f"IPS = 2, IRS = {hopf[0]}, ICP = [1, 11], NMX = 400, NPR = 0, DS = 0.05, "
                 "DSMAX = 0.2, RL1 = 20\nUZR = {-11: 36}\n", "equilibria")
        start = of_type(os.path.join(folder, "q.orbits"), 6)  # UZ is -4
        start = start or [e for e in solutions(os.path.join(folder, "q.orbits")) if e[1] == -4]
        values = f"UZR = {{2: {VALUES}}}\n"
        auto.run("auto", COMMON + f"IPS = 2, IRS = {start[-1][0]}, ICP = [1, 2], NMX = 200, NPR = 0, DS = -0.02, "
                 f"DSMAX = 0.05, RL1 = 20\n{values}", "orbits")

        with open(os.path.join(folder, "pp.cpp"), "w") as file:
            file.write(PROBLEM)
        with open(os.path.join(folder, "gc.pp"), "w") as file:
            file.write(COMMON + "IPS = 180, ICP = [K, d], HOLD = [period], RL1 = 20\n"
                       "GCFIND = [1], GCHIND = [0], GCGIND = [0]\nNMX = 200, DS = 0.02, DSMAX = 0.05\n"
                       f"UZR = {{d: {VALUES}}}\n")
        environment = {**os.environ, "TCHAT_SOURCE": source}
        for name, more in (("held", []), ("valued", ["HOLD={period: 36}"])):
            run([tchat, "run", "pp", "-q", "-p", "pp.cpp", "-s", "orbits", f"IRS={start[-1][0]}", "-o", name, "--both"]
                + more, folder, env=environment)
            mine, others = curve(os.path.join(folder, "q." + name)), curve(os.path.join(folder, "q.auto"))
            if sorted(mine) != sorted(VALUES) or sorted(others) != sorted(VALUES):
                sys.exit(f"not all values were found: {mine}, {others}")
            worst = max(abs(mine[d] / others[d] - 1) for d in VALUES)
            print(f"{name}: K at period 36 agrees with AUTO-07p to {worst:.1e}")
            if not worst < 1e-9:
                sys.exit(f"{mine}\n{others}")
            for entry in solutions(os.path.join(folder, "q." + name)):
                if abs(entry[2][60] - 36) > 1e-9:
                    sys.exit(f"label {entry[0]} has period {entry[2][60]}")


main()
