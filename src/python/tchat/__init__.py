"""tchat in Python: problems, branches of their orbits, simulations and sweeps. Needs numpy and the program tchat.

    import tchat
    problem = tchat.Problem("pendulum.tch")          # or the formulas themselves, or a C++ or Fortran plugin
    orbit = problem.simulate(A=1.2).orbit            # the periodic orbit that a simulation ends on
    branch = orbit.continue_(A=(0.5, 2.0))           # followed in the parameter A, within these bounds
    branch["A"], branch["MAX x"], branch["stable"]   # numpy arrays, one value a point
    branch.PD[0].switch().plot()                     # the branch that is born at the first period doubling

Everything is done by the commands of tchat, on files in a folder of the problem (a scratch folder unless one is named):
the same numbers, the same messages. What tchat refuses raises tchat.Error with its sentence.

    Problem            a problem: simulate(), start(), sweep(), explore()
    Branch, Label      a branch, and what its labels lead to: switch(), resegment(), curve(), verify(), grazing()
    Orbit              a labelled orbit: orbit.t, orbit["x"], orbit.period
    Diagram            all branches that explore() finds, or that are in files of tchat explore
    load               the branch of files that are there already
    run, simulate, sweep    the commands themselves, with their own words
"""

from .branch import Branch, Label, Part, run
from .diagram import Diagram, ExploredBranch, ExploredCurve
from .orbit import Orbit
from .problem import Problem, load
from .program import Error, Progress, Report, TchatWarning
from .simulation import Simulation, Trajectory, read_events, read_trajectory, simulate
from .start import Start
from .sweep import Sweep, read_sweep, sweep

__all__ = ["Problem", "Start", "Branch", "Label", "Part", "Orbit", "Simulation", "Trajectory", "Sweep", "Diagram",
           "ExploredBranch", "ExploredCurve", "Report", "Progress", "Error", "TchatWarning", "load", "run", "simulate",
           "sweep", "read_trajectory", "read_events", "read_sweep"]
