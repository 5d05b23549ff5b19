"""Special points on adapted meshes against uniform ones: an adapted mesh must not be worse.

    python3 adapted_meshes.py TCHAT SOURCE [--only NAME] [--foreign] [--folder FOLDER]

Every run of the pipelines in problems/*/Makefile and of the systems in foreign_systems.py, with the NTST intervals of a
coarse mesh: left uniform (IAD = 0) and adapted at every point (IAD = 1). Each special point that both find, and a run
with a fine mesh of more collocation points, is compared by its parameter and period. The exit status is 1 where the
adapted mesh is off by more than WORSE times the error of the uniform one.
"""

import argparse
import collections
import json
import os
import subprocess
import sys

import label_accuracy

INTERVALS = 20
FINE = ["NTST=200", "NCOL=5", "IAD=1", "ERRMAX=0"]
# On a uniform mesh the errors of a smooth orbit cancel over a period, on another one they do not.
WORSE = 10
# Location to EPSS, rounding, and what is left of the fine mesh's error.
LEAST = 1e-8
SPECIAL = {"LP", "BP", "PD", "TR", "GR"}


def special_points(tchat, place, words, settings):
    """(type, kind, how manieth) -> (parameter, period) of a run."""
    for file in ("p.adapted", "q.adapted"):
        if os.path.exists(os.path.join(place, file)):
            os.remove(os.path.join(place, file))
    words = label_accuracy.with_new_name(words, "adapted") + ["NPR=0"] + settings
    try:
        subprocess.run([tchat] + words, cwd=place, capture_output=True, timeout=label_accuracy.TIME_LIMIT)
    except subprocess.TimeoutExpired:
        return {}
    table = subprocess.run([tchat, "table", "--json", "p.adapted"], cwd=place, capture_output=True, text=True)
    points, counts = {}, collections.Counter()
    for row in json.loads(table.stdout or "[]") if table.returncode == 0 else []:
        if row["type"] not in SPECIAL:
            continue
        columns = list(row)
        values = [row[columns[columns.index("admissible") + 1]], row.get("PERIOD")]
        kind = (row["type"], (row["kind"] or "").split(", tau")[0])
        counts[kind] += 1
        points[kind + (counts[kind],)] = [value for value in values if isinstance(value, float | int)]
    return points


def distance(values, exact):
    return max((abs(a - b) / (1 + abs(b)) for a, b in zip(values, exact)), default=0.0)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("tchat")
    label_accuracy.add_options(parser, "adapted_meshes")
    options = parser.parse_args()
    tchat = os.path.abspath(options.tchat)
    folder = label_accuracy.prepared_folder(tchat, options)
    runs = [] if options.foreign else label_accuracy.pipeline_runs(os.path.join(folder, "pipelines", "results"))
    runs = [(place, words) for place, words, _ in runs]
    runs += [label_accuracy.foreign_run(tchat, folder, name)[:2] for name in label_accuracy.foreign_systems.FOREIGN]
    compared, worse, better = 0, 0, 0
    for place, words in runs:
        if options.only not in place:
            continue
        meshes = [["NTST=%d" % INTERVALS, "NCOL=4", "ERRMAX=0", "IAD=%d" % adapt] for adapt in (0, 1)]
        uniform, adapted, exact = (special_points(tchat, place, words, mesh) for mesh in meshes + [FINE])
        for point in uniform.keys() & adapted.keys() & exact.keys():
            errors = [distance(points[point], exact[point]) for points in (uniform, adapted)]
            # Another point of the same kind, where one of the three missed one.
            if max(errors) > 1e-2:
                continue
            compared += 1
            better += errors[0] > WORSE * errors[1] + LEAST
            if errors[1] > WORSE * errors[0] + LEAST:
                worse += 1
                print("worse: %s: off by %.2g, uniform %.2g" % (" ".join(map(str, point)), errors[1], errors[0]))
                print("    cd %s && tchat %s" % (place, " ".join(words)), flush=True)
    print("%6d special points\n%6d better by more than %d on adapted meshes\n%6d worse" % (compared, better, WORSE, worse))
    return 1 if worse or not compared else 0


if __name__ == "__main__":
    sys.exit(main())
