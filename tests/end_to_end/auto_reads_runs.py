"""AUTO-07p's own Python readers load the files of real runs: same labels, points, parameters and states.

usage: auto_reads_runs.py TCHAT PLUGIN FOLDER      executable, plugin library, folder of gc-files and data

What the files hold is read here once more, word by word. Exit status 77 (skipped) without AUTO-07p.
"""

import os
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "files"))
from auto_readers import FAULTS, allow_new_numpy, find_auto, near, same  # noqa: E402

RUNS = [
    ["-c", "nonimpacting_alpha", "-d", "nonimpacting", "-o", "alpha"],
    ["-c", "nonimpacting_omega", "-d", "nonimpacting", "-o", "omega"],
    ["-c", "impacting", "-d", "impacting", "-o", "impacting"],
    ["-c", "impacting", "-s", "impacting", "-o", "back", "IRS=3", "DS=-0.02"],
    ["-c", "impacting", "-d", "impacting", "-o", "both", "--both"],
    ["-c", "impacting", "-d", "impacting", "-o", "mx", "ITNW=2", "DSMIN=0.019", "DSMAX=5", "RL1=99"],
]


def read_rows(name):
    """The point lines of p.NAME: ([BR, PT, TY, LAB], values)."""
    rows = []
    for line in open("p." + name):
        words = line.split()
        if words[0] != "0":
            rows.append(([int(w) for w in words[:4]], [float(w) for w in words[4:]]))
    return rows


def read_entries(name):
    """The solutions of q.NAME: identifier, rows of t and states, free parameters, parameters."""
    words = open("q." + name).read().split()
    entries, at = [], 0
    while at < len(words):
        identifier = [int(w) for w in words[at:at + 16]]
        at += 16
        free, points, width, parameters = identifier[4], identifier[6], identifier[7], identifier[11]
        take = []
        for count in (points * width, free, free, points * (width - 1), parameters):
            take.append([float(w) for w in words[at:at + count]])
            at += count
        states = [take[0][k * width:(k + 1) * width] for k in range(points)]
        entries.append({"identifier": identifier, "states": states, "icp": [int(x) for x in take[1]],
                        "rates": take[2], "par": take[4]})
    return entries


def check_blocks(name, parseD, rows, states):
    """Every point has a block of its own in d.NAME, with its branch, label and as many multipliers as states."""
    blocks = parseD.parseD("d." + name)
    blocks = [block for block in (blocks[k] for k in range(len(blocks.data))) if block["Multipliers"]]
    same([len(block["Multipliers"]) for block in blocks], [states] * len(rows), name + ": multipliers of each block")
    same([block["Branch number"] for block in blocks], [row[0][0] for row in rows], name + ": branches of the d-file")
    same([block["Label"] for block in blocks], [row[0][3] for row in rows], name + ": labels of the d-file")


def check_run(name, parseB, parseBandS, parseD, parseS):
    rows = read_rows(name)
    branches = parseB.parseBR("p." + name)
    read = [(int(branch["BR"]), branch) for branch in branches]
    same(sum(len(branch.coordarray[0]) for _, branch in read), len(rows), name + ": number of points")
    same(branches.getLabels(), [r[0][3] for r in rows if r[0][3] > 0], name + ": labels of the p-file")
    check_blocks(name, parseD, rows, 4)
    at = 0
    for number, branch in read:
        for k in range(len(branch.coordarray[0])):
            near([column[k] for column in branch.coordarray], rows[at][1], "%s: point %d" % (name, at + 1))
            same(rows[at][0][0], number, "%s: branch of point %d" % (name, at + 1))
            at += 1
    same([n.strip() for n in branches[0].coordnames][1:], ["L2-NORM", "MAX x1", "MAX x2", "MAX y1", "MAX y2",
                                                          "PAR(61)", "PERIOD"], name + ": columns")

    entries = read_entries(name)
    solutions = parseS.parseS("q." + name)
    same(solutions.getLabels(), [e["identifier"][3] for e in entries], name + ": labels of the q-file")
    same(branches.getLabels(), solutions.getLabels(), name + ": labels of both files")
    for entry in entries:
        branch, point, kind, label = entry["identifier"][:4]
        what = "%s: label %d" % (name, label)
        solution = solutions.getLabel(label)
        for key, value in (("BR", branch), ("PT", point), ("TY number", kind), ("NTST", entry["identifier"][9]),
                           ("NCOL", entry["identifier"][10]), ("NDIM", 4), ("IPS", 180)):
            same(solution[key], value, "%s: %s" % (what, key))
        near(list(solution.indepvararray), [s[0] for s in entry["states"]], what + ": t")
        for k in range(4):
            near(list(solution.coordarray[k]), [s[k + 1] for s in entry["states"]], "%s: U(%d)" % (what, k + 1))
        near(list(solution.PAR.toarray()), entry["par"], what + ": parameters")
        same(list(solution["Active ICP"]), entry["icp"], what + ": free parameters")
        near(solution["rldot"], entry["rates"], what + ": direction")
    same(parseBandS.parseBandS("p." + name, "q." + name).getLabels(), solutions.getLabels(), name + ": read together")


def main():
    auto = find_auto()
    if auto is None:
        print("skipped: AUTO-07p is not installed (Debian package auto-07p)")
        return 77
    tchat, plugin, constants = (os.path.abspath(a) for a in sys.argv[1:4])
    sys.path.insert(0, auto)
    allow_new_numpy()
    from auto import parseB, parseBandS, parseD, parseS

    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        for file in os.listdir(constants):
            shutil.copy(os.path.join(constants, file), work)
        shutil.copy(plugin, work)
        for run in RUNS:
            subprocess.run([tchat, "run", "linosc", "-q"] + run, check=True)
            check_run(run[run.index("-o") + 1], parseB, parseBandS, parseD, parseS)
        os.chdir(constants)
    print("%d runs, %d faults" % (len(RUNS), len(FAULTS)))
    return 1 if FAULTS else 0


if __name__ == "__main__":
    sys.exit(main())
