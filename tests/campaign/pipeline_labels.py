"""Lists the labels of all pipelines of problems/*/Makefile, and compares two such lists.

    python3 pipeline_labels.py make TCHAT SOURCE FOLDER LIST     runs every pipeline in FOLDER and writes LIST
    python3 pipeline_labels.py compare BEFORE AFTER              exit status 1 where a label is lost, new or changed

SOURCE is the folder of the project. A line of a list is one labelled solution: file, type, what it is, free parameters
and period with 6 digits. Numbers of labels and points, which may change with any step size, are left out.
"""

import collections
import json
import math
import os
import shutil
import subprocess
import sys

# Targets besides the default one that run continuations.
MORE_TARGETS = {"fvdp": ["tori_runs"], "rand4d": ["tori_runs"]}
# mems_fortran does what mems does, in a Makefile of another form; without a picture there is nothing in microactuator.
WITHOUT_LABELS = {"mems_fortran", "microactuator"}
# Their README.md runs these without a Makefile.
SINGLE_RUNS = {
    "langford": ["run langford -o langford", "run langford -s langford -o torus IRS=TR1 ISW=2 ICP=[2,1,61] --both"],
    "torus": ["simulate torus -c torus --torus found", "run torus -c torus -s found"],
}


def rounded(value):
    """Six digits; what rounding leaves of zero is zero."""
    if abs(value) < 5e-7:
        return "0"
    return "%.6g" % value


def lines_of_branch(tchat, folder, name, problem):
    table = subprocess.run([tchat, "table", "--json", "p." + name], cwd=folder, capture_output=True, text=True)
    if table.returncode:
        return ["%s/%s UNREADABLE %s" % (problem, name, table.stderr.strip())]
    rows = json.loads(table.stdout)
    lines = []
    for row in rows:
        if not row["label"]:
            continue
        columns = list(row)
        first = columns.index("admissible") + 1
        values = [rounded(row[column]) for column in (columns[first], "PERIOD")
                  if isinstance(row.get(column), float | int)]
        lines.append("%s/%s %s [%s] %s = %s" % (problem, name, row["type"], row["kind"] or "", columns[first],
                                                 " ".join(values)))
    return lines


def make(tchat, source, folder, list_file):
    tchat = os.path.abspath(tchat)
    shutil.rmtree(folder, ignore_errors=True)
    for part in ("problems", "constants"):
        shutil.copytree(os.path.join(source, part), os.path.join(folder, part),
                        ignore=shutil.ignore_patterns("*.so", "build"))
    lines = []
    for problem in sorted(os.listdir(os.path.join(folder, "problems"))):
        if problem in WITHOUT_LABELS:
            continue
        home = os.path.join(folder, "problems", problem)
        results = os.path.abspath(os.path.join(folder, "results", problem))
        os.makedirs(results)
        log = open(os.path.join(results, "log"), "w")
        if os.path.exists(os.path.join(home, "Makefile")):
            # A pipeline that fails loses its labels, which the comparison shows; the others go on.
            made = subprocess.run(["make", "-k", "TCHAT=" + tchat, "OUT=" + results, "figures="] + ["all"]
                                  + MORE_TARGETS.get(problem, []), cwd=home, stdout=log, stderr=subprocess.STDOUT)
        elif problem in SINGLE_RUNS:
            for name in os.listdir(os.path.join(folder, "constants", problem)):
                shutil.copy(os.path.join(folder, "constants", problem, name), results)
            for command in SINGLE_RUNS[problem]:
                made = subprocess.run([tchat] + command.split() + ["-p", os.path.join(os.path.abspath(home), problem)],
                                      cwd=results, stdout=log, stderr=subprocess.STDOUT)
        else:
            continue
        if made.returncode:
            print("%s: exit status %d, see %s" % (problem, made.returncode, log.name))
        for name in sorted(os.listdir(results)):
            if name.startswith("p.") and not name.endswith("~"):
                lines += lines_of_branch(tchat, results, name[2:], problem)
    with open(list_file, "w") as file:
        file.write("\n".join(lines) + "\n")
    print("%d labels in %s" % (len(lines), list_file))
    return 0


def split(line):
    head, _, values = line.rpartition(" = ")
    return head, [float(value) for value in values.split()]


def agree(a, b):
    """Six digits, of which rounding may move the last by one or two."""
    return len(a) == len(b) and all(math.isclose(p, q, rel_tol=3e-5, abs_tol=3e-6) for p, q in zip(a, b))


def compare(before, after):
    lists = []
    for name in (before, after):
        groups = collections.defaultdict(list)
        for line in open(name).read().splitlines():
            if "UNREADABLE" in line:
                groups[line].append([])
            else:
                head, values = split(line)
                groups[head].append(values)
        lists.append(groups)
    old, new = lists
    differences = 0
    for head in sorted(set(old) | set(new)):
        remaining = list(new.get(head, []))
        for values in old.get(head, []):
            match = next((candidate for candidate in remaining if agree(values, candidate)), None)
            if match is None:
                print("lost: %s = %s" % (head, values))
                differences += 1
            else:
                remaining.remove(match)
        for values in remaining:
            print("new:  %s = %s" % (head, values))
            differences += 1
    labels = [sum(len(group) for group in groups.values()) for groups in lists]
    print("%d labels before, %d after, %d differences" % (labels[0], labels[1], differences))
    return 1 if differences else 0


if __name__ == "__main__":
    if len(sys.argv) == 6 and sys.argv[1] == "make":
        sys.exit(make(*sys.argv[2:]))
    if len(sys.argv) == 4 and sys.argv[1] == "compare":
        sys.exit(compare(*sys.argv[2:]))
    sys.exit(__doc__)
