"""A problem: formulas or a plugin, and the folder that its files are in."""

import contextlib
import hashlib
import os
import shutil
import tempfile
import weakref

from .branch import branch_of_files, run_words
from .diagram import explore
from .program import Error, GrowingSweep, ProgressBar, execute
from .simulation import Simulation
from .start import Start
from .sweep import over_words, read_sweep
from .words import option_words, split_bounds, state_word, value_words


_WRITTEN = "# formulas of tchat.Problem "


def _write_formulas(path, text):
    """Replaces what a Problem has written there, and no file of the user's: its last line is a hash of the others."""
    whole = text + _WRITTEN + hashlib.sha256(text.encode()).hexdigest()[:16] + "\n"
    try:
        with open(path, encoding="utf-8") as file:
            known = file.read()
    except FileNotFoundError:
        pass
    except (OSError, ValueError) as error:
        raise Error("%s: cannot be read, and is not written over: %s" % (path, error)) from None
    else:
        there, mark, of_text = known.rpartition(_WRITTEN)
        if known == text:
            return
        if not mark or hashlib.sha256(there.encode()).hexdigest()[:16] != of_text.strip():
            raise Error("%s: there is such a file, which is not what a tchat.Problem has written; give another name= or "
                        "folder=, or use the file itself: tchat.Problem(%r)" % (path, path))
    with open(path, "w", encoding="utf-8") as file:
        file.write(whole)


class Problem:
    """A problem, from formulas or a plugin.

        tchat.Problem("par A=1\\nx' = v\\n...")       formulas (src/docs/formulas.md), a text of several lines
        tchat.Problem("walker.tch")                   a file of formulas, a plugin's source in C++ or Fortran, a library

    folder    where its files go; without one they go to a scratch folder, which is removed when Python ends
    program   the path of tchat, else the environment variable TCHAT, else tchat on PATH

    In all methods keywords in the names of constants are constants (NMX=200, UZR={"A": 1.5}), others are parameters
    (A=1.2); par={"DS": 1} is a parameter in any case. `name` names the files that are written.
    """

    def __init__(self, source, name=None, folder=None, program=None):
        self.program = program
        self._scratch = None
        if folder is None:
            folder = tempfile.mkdtemp(prefix="tchat-")
            self._scratch = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        os.makedirs(folder, exist_ok=True)
        self.folder = os.path.abspath(folder)
        self._counts = {}
        self._state_names = None
        if "\n" in source:
            self.name = name or "problem"
            self.source = self.path(self.name + ".tch")
            _write_formulas(self.source, source if source.endswith("\n") else source + "\n")
        else:
            self.source = os.path.abspath(source)
            self.name = name or os.path.splitext(os.path.basename(source))[0]
            if not os.path.isfile(self.source):
                raise Error("%s: there is no such file; give formulas of several lines, a file NAME.tch, a plugin's "
                            "source or its library NAME.so" % source)

    def path(self, name):
        return os.path.join(self.folder, name)

    @contextlib.contextmanager
    def _named(self, kind, name):
        """The name of new files: `name`, else kind1, kind2, ..., which no other process of this folder has meanwhile."""
        if name:
            yield name
            return
        while True:
            self._counts[kind] = self._counts.get(kind, 0) + 1
            name = "%s%d" % (kind, self._counts[kind])
            claim = self.path(".%s.claimed" % name)
            try:
                os.close(os.open(claim, os.O_CREAT | os.O_EXCL | os.O_WRONLY))
            except FileExistsError:
                continue
            try:
                if any(os.path.exists(self.path(file % name)) for file in
                       ("p.%s", "q.%s", "%s.dat", "%s.trajectory", "%s.sweep", "%s.json")):
                    continue
                yield name
                return
            finally:
                os.unlink(claim)

    def _execute(self, command, words, accepted=(0,), poll=lambda: True):
        return execute([command] + words, self.folder, self.program, poll, accepted)

    def check(self):
        """`tchat check`: derivatives against finite differences. A Report, whose `passed` is the verdict."""
        return self._execute("check", [self.source], accepted=(0, 1))

    @property
    def state_names(self):
        """The names of its states, as `tchat check` has them; U(1), ... where they have none."""
        if self._state_names is None:
            report = str(self.check())
            line = next((line for line in report.splitlines() if line.startswith("  states ")), "")
            self._state_names = line.split()[1:]
        return self._state_names

    def simulate(self, *words, name=None, state=None, free=None, time=None, events=None, transient_time=None,
                 transient_events=None, refine=None, signature=None, without_sections=None, lyapunov=None, tolerance=None, stiff=None,
                 **values):
        """Integrates from `state` (a list, a dictionary by name, else the problem's own) until the motion repeats
        itself, or as long as time= or events= say: a Simulation, whose orbit= is the periodic orbit, None without one.
        refine=True: `state` is a guess of an orbit, stable or not, which Newton's method finds. `free` is the parameter that the orbit is followed in unless continue_ says another. Other keywords are
        parameters and constants; words are further options of `tchat simulate`."""
        with self._named("simulation", name) as name:
            options = option_words(dict(
                state=state_word(state), free=free, time=time, events=events, transient_time=transient_time,
                transient_events=transient_events, refine=refine, signature=signature,
                without_sections=without_sections, lyapunov=lyapunov, tolerance=tolerance, stiff=stiff,
                dat=None if lyapunov else name))
            words = [self.name, "-p", self.source, "-o", name] + options + list(words)
            screen = self._execute("simulate", words + value_words(values, self.program), accepted=(0, 1))
            found = screen.passed and os.path.exists(self.path(name + ".dat"))
            return Simulation(self.path(name), screen, Start(self, name, True) if found else None)

    def continue_from(self, words, values):
        """`tchat run` with these words, in this folder: its Branch.

        A parameter with a pair of bounds, A=(0.5, 2), is the one that is free (several: the first is ICP(1), whose
        bounds count), and the branch is followed both ways; both=False: one way, by the sign of DS. name= names its
        files, progress= is a function that is called for every point, or False for no progress bar.
        """
        values = dict(values)
        name = values.pop("name", None)
        progress = values.pop("progress", None)
        bounds, values = split_bounds(values, self.program)
        both = values.pop("both", bool(bounds))
        if bounds:
            (_, (low, high)), *_ = bounds.items()
            values.setdefault("ICP", list(bounds))
            values.setdefault("RL0", min(low, high))
            values.setdefault("RL1", max(low, high))
        words = list(words) + (["--both"] if both else []) + value_words(values, self.program)
        with self._named("branch", name) as name:
            words = [self.name, "-p", self.source, "-o", name] + words
            branch = run_words(words, name, self.folder, self.program, progress, problem=self)
        if bounds or "RL0" in values or "RL1" in values:
            branch.warn_of_ends()
        return branch

    def resegment(self, path, label, to, words=(), values=None):
        """`tchat resegment`: a Start with another signature. Label.resegment names what it can lead to."""
        values = dict(values or {})
        with self._named("start", values.pop("name", None)) as name:
            words = [path, label, "--to", to, "-p", self.source, "-o", name] + list(words)
            self._execute("resegment", words + value_words(values, self.program))
            return Start(self, name, False)

    def sweep(self, *words, over, jobs=1, name=None, section=None, follow=None, state=None, lyapunov=None,
              penetration=None, max=None, events=None, transient_events=None, tolerance=None, **values):
        """`tchat sweep`: what attracts, over={"A": (0.5, 2, 200)} or two of them; section= the event whose passages are
        recorded, follow="up", "down" or "both"; max=True records the largest value of each state. A Sweep."""
        options = option_words(dict(section=section, follow=follow, state=state_word(state), lyapunov=lyapunov,
                                    penetration=penetration, max=max, events=events,
                                    transient_events=transient_events, tolerance=tolerance))
        with self._named("sweep", name) as name:
            words = [self.name, "-p", self.source, "-o", name, "-j", jobs] + over_words(over) + options + list(words)
            bar, growing = ProgressBar(name), GrowingSweep(self.path(name) + ".sweep")
            try:
                screen = self._execute("sweep", words + value_words(values, self.program),
                                       poll=lambda: growing.show(bar))
            finally:
                bar.close()
            result = read_sweep(self.path(name))
        result.screen = screen
        return result

    def explore(self, *words, over, and_=None, jobs=1, name=None, state=None, starts=None, doublings=None,
                segments=None, branches=None, time=None, y=None, **values):
        """`tchat explore`: the whole diagram over={"A": (0.5, 2)}, or {"A": (0.5, 2, 401)} with the number of values of
        its sweep; and_={"B": (1, 3)} follows special points as curves in both parameters. A Diagram. jobs= commands run
        at a time, starts= further initial states at each value; doublings=, segments=, branches= and time= (seconds)
        limit it, y= is along its picture. Parameters are those of all commands, constants those of the runs."""
        options = option_words(dict(jobs=jobs, state=state_word(state), starts=starts, doublings=doublings,
                                    segments=segments, branches=branches, time=time)) + (["-y", y] if y else [])
        with self._named("diagram", name) as name:
            return explore(self, words, name, over, and_, options, value_words(values, self.program))

    def __repr__(self):
        return "problem %s in %s" % (self.name, self.folder)


def load(name, problem=None, program=None):
    """The branch whose files are p.NAME, with q.NAME and d.NAME beside it; `name` may be p.NAME, with a folder. With a
    Problem, or the file of one (problem="walker.tch"), it can be continued."""
    if problem is not None and not isinstance(problem, Problem):
        if not isinstance(problem, (str, os.PathLike)):
            raise Error("problem=%r: give a tchat.Problem, or the file of one, problem=\"walker.tch\"" % (problem,))
        problem = Problem(os.fsdecode(problem), program=program)
    return branch_of_files(name, problem, program)
