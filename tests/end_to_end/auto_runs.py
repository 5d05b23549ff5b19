"""AUTO-07p as a program beside tchat, and what both write: shared by the tests auto_*.py."""

import os
import subprocess
import sys

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


class AutoProgram:
    """A problem in Fortran linked with AUTO; each run leaves q.NAME in the folder."""

    def __init__(self, folder, source):
        self.folder = folder
        self.write("problem.f90", source)
        run(["gfortran", "-O1", "-fopenmp", "problem.f90", "-o", "problem"] + auto_objects(), folder)

    def write(self, name, text):
        with open(os.path.join(self.folder, name), "w") as file:
            file.write(text)

    def run(self, name, constants, start=None):
        """`start`: q.START, from which IRS takes a label."""
        self.write("fort.2", constants)
        source = open(os.path.join(self.folder, "q." + start)).read() if start else ""
        self.write("fort.3", source)
        run([os.path.join(self.folder, "problem")], self.folder, env={**os.environ, "OMP_NUM_THREADS": "1"})
        os.rename(os.path.join(self.folder, "fort.8"), os.path.join(self.folder, "q." + name))


def solutions(path):
    """(label, type, PAR) of the entries of a q-file, AUTO's or tchat's."""
    words = open(path).read().split()
    entries, at = [], 0
    while at < len(words):
        head = [int(w) for w in words[at:at + 16]]
        kind, label, free, points, width, parameters = head[2], head[3], head[4], head[6], head[7], head[11]
        # Orbits have a direction too, points (equilibria) have none.
        at += 16 + points * width + (2 * free + points * (width - 1) if head[9] > 0 else 0)
        entries.append((label, kind, [float(w) for w in words[at:at + parameters]]))
        at += parameters
    return entries
