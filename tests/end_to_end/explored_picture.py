"""tchat explore: every periodic attractor of the sweep lies on a branch in the picture, the Makefile alone makes the
same picture and page, and the Python package reads the same tree.

usage: explored_picture.py TCHAT REPOSITORY PROBLEM

Exit status 77 (skipped) without numpy or gnuplot.
"""

import filecmp
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

TCHAT, REPOSITORY, PROBLEM = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]), sys.argv[3]
sys.path.insert(0, os.path.join(REPOSITORY, "src", "python"))
try:
    import numpy as np
except ImportError:
    print("skipped: no numpy (Debian package python3-numpy)")
    sys.exit(77)
import tchat  # noqa: E402

if shutil.which("gnuplot") is None:
    print("skipped: no gnuplot")
    sys.exit(77)

# Range, constants and parameters, and the quantity that varies most.
PROBLEMS = {
    "linosc": ({"alpha": (1.5, 4, 51)}, {"omega": 2.0072}, "max(x2)"),
    "ball": ({"Gamma": (1, 1.75, 76)}, {}, "max(height)"),
    "buck": ({"Vin": (12, 33, 43)}, {}, "max(u) or max(i)"),  # alike but for chaotic dots
}
TOLERANCE = 1e-5  # of width and height: far below a pixel


def smooth_line(points):
    """Points of the cubics through four consecutive points, parametrised by their distance."""
    keep = np.append(True, np.hypot(*np.diff(points, axis=0).T) > 1e-12)
    points = points[keep]
    if len(points) < 4:
        return points
    at = np.append(0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
    line = []
    for k in range(len(points) - 1):
        four = np.arange(4) + min(max(k - 1, 0), len(points) - 4)
        s = np.linspace(at[k], at[k + 1], 33)
        weights = [np.prod([(s - at[j]) / (at[i] - at[j]) for j in four if j != i], axis=0) for i in four]
        line.append(np.tensordot(weights, points[four], axes=(0, 0)))
    return np.concatenate(line)


def distance(dot, line):
    """Of a point from a polyline."""
    begin, step = line[:-1], np.diff(line, axis=0)
    length = np.maximum(np.sum(step ** 2, axis=1), 1e-300)
    share = np.clip(np.sum((dot - begin) * step, axis=1) / length, 0, 1)
    return np.min(np.hypot(*(begin + share[:, None] * step - dot).T))


def check_dots(diagram):
    sweep = diagram.sweep
    periodic = sweep["kind"] == "periodic"
    dots = np.array([sweep[diagram.parameter], sweep[diagram.quantity]]).T[periodic]
    assert len(dots) > 0 and np.all(np.isfinite(dots))
    size = np.ptp(np.concatenate([np.array([one.branch[diagram.parameter], one.branch[diagram.quantity]]).T
                                  for one in diagram] + [dots]), axis=0)
    lines = [smooth_line(np.array([one.branch[diagram.parameter], one.branch[diagram.quantity]]).T[
                             one.branch["section"] == section] / size)
             for one in diagram for section in np.unique(one.branch["section"])]
    lines = [line for line in lines if len(line) > 1]  # a direction that ends where it begins is none
    farthest = max(min(distance(dot, line) for line in lines) for dot in dots / size)
    print("%d dots, at most %.1e of the picture beside a branch" % (len(dots), farthest))
    assert farthest <= TOLERANCE, farthest


def check_tree(diagram):
    with open(diagram.path + ".json", encoding="utf-8") as file:
        tree = json.load(file)
    assert len(diagram) == len(tree["branches"]) > 0
    for one, found in zip(diagram, tree["branches"]):
        assert (one.name, one.origin, list(one.range)) == (found["name"], found["origin"], [found["from"], found["to"]])
        assert (one.parent.name if one.parent else "") == found["parent"]
        assert one.parent is None or one in one.parent.children
        assert one.labels == found["labels"] and one.commands == found["commands"]
        assert {label.label for label in one.branch.labels} >= {label["label"] for label in one.labels}
    assert diagram.coverage == tree["on_branches"] / tree["periodic"]
    assert diagram.unexplained == tree["unexplained"] and diagram.joins == tree["joins"]


def check_makefile(problem, diagram):
    """make in a folder of its own."""
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.basename(diagram.path)
        makefile = "Makefile." + name
        shutil.copy(problem.path(makefile), folder)
        made = subprocess.run(["make", "-s", "-j2", "-f", makefile, "TCHAT=" + TCHAT], cwd=folder,
                              capture_output=True, text=True)
        assert made.returncode == 0, made.stderr
        for ending in (".png", ".svg"):
            assert filecmp.cmp(os.path.join(folder, name + ending), diagram.path + ending, shallow=False), ending
        pages = [pathlib.Path(path + ".html").read_text() for path in (os.path.join(folder, name), diagram.path)]
        here, there = (re.sub(r"-p [^ ]+", "-p SOURCE", page) for page in pages)  # as seen from the folder
        assert here == there, "the pages differ"


def main():
    over, values, quantity = PROBLEMS[PROBLEM]
    with tempfile.TemporaryDirectory() as folder:
        source = shutil.copy(os.path.join(REPOSITORY, "problems", PROBLEM, PROBLEM + ".cpp"), folder)
        os.chdir(folder)
        problem = tchat.Problem(source, folder=folder, program=TCHAT)
        diagram = problem.explore(over=over, jobs=2, name="diagram", doublings=2, **values)
        print(diagram)
        assert diagram.quantity in quantity.split(" or "), diagram.quantity
        assert diagram.coverage == 1.0
        assert diagram.picture().startswith(b"\x89PNG")
        check_dots(diagram)
        check_tree(diagram)
        if PROBLEM == "linosc" or os.environ.get("TCHAT_ALL_TESTS"):
            check_makefile(problem, diagram)
        again = tchat.Diagram(diagram.path, program=TCHAT)
        assert [one.name for one in again] == [one.name for one in diagram]


if __name__ == "__main__":
    main()
