"""AUTO-07p's own Python readers load the files of a run: same points, labels, types, parameters, states.

usage: auto_readers.py WRITE_SAMPLE_RUN      the program that writes p.sample, q.sample, d.sample and expected.txt

Exit status 77 (skipped) when AUTO-07p is not installed.
"""

import os
import subprocess
import sys
import tempfile

RELATIVE_TOLERANCE = 1e-9  # ten decimals are written


def find_auto():
    """Folder that holds AUTO's package `auto`, or None."""
    candidates = [os.path.join(os.environ.get("AUTO_DIR", ""), "python")]
    try:
        listing = subprocess.run(["dpkg", "-L", "auto-07p"], capture_output=True, text=True, check=False).stdout
        candidates += [os.path.dirname(os.path.dirname(f)) for f in listing.split() if f.endswith("/auto/parseB.py")]
    except OSError:
        pass
    for folder in candidates:
        if os.path.isfile(os.path.join(folder, "auto", "parseB.py")):
            return folder
    return None


def allow_new_numpy():
    """AUTO asks for names that newer versions of numpy have dropped."""
    try:
        import numpy
    except ImportError:
        return
    for name, kind in (("bool", bool), ("int", int), ("float", float)):
        if name not in numpy.__dict__:
            setattr(numpy, name, kind)


def read_expected(path):
    """List of sections: columns, points, and for each labelled point its solution."""
    sections = []
    for line in open(path):
        kind, _, rest = line.strip().partition(":")
        words = rest.split()
        if kind == "section":
            sections.append({"columns": [], "points": [], "solutions": [], "multipliers": []})
        elif kind == "column":
            sections[-1]["columns"].append(rest.strip())
        elif kind == "point":
            numbers = [int(w) for w in words[:4]]
            sections[-1]["points"].append((numbers, [float(w) for w in words[4:]]))
        elif kind == "multipliers":
            sections[-1]["multipliers"].append((int(words[0]), int(words[1]), [float(w) for w in words[2:]]))
        elif kind == "solution":
            sections[-1]["solutions"].append({"identifier": [int(w) for w in words], "states": []})
        elif kind == "states":
            sections[-1]["solutions"][-1]["states"].append([float(w) for w in words])
        else:
            sections[-1]["solutions"][-1][kind] = [float(w) for w in words]
    return sections


FAULTS = []


def check(condition, what):
    if not condition:
        FAULTS.append(what)
        print("FAULT:", what)


def same(a, b, what):
    check(a == b, "%s: read %r, written %r" % (what, a, b))


def near(a, b, what):
    a, b = list(a), list(b)
    close = len(a) == len(b) and all(abs(x - y) <= RELATIVE_TOLERANCE * max(1e-300, abs(y)) + 1e-13 * (abs(y) > 1e-9)
                                     for x, y in zip(a, b))
    check(close, "%s: read %r, written %r" % (what, a, b))


def check_points(branches, sections, type_translation):
    same(len(branches), len(sections), "number of sections")
    for branch, section in zip(branches, sections):
        same([name.strip() for name in branch.coordnames], section["columns"], "column names")
        columns = [list(c) for c in branch.coordarray]
        same(len(columns[0]), len(section["points"]), "number of points")
        labels = [p[0][3] for p in section["points"] if p[0][3] > 0]
        same(branch.getLabels(), labels, "labels of the p-file")
        for index, (numbers, values) in enumerate(section["points"]):
            near([column[index] for column in columns], values, "point %d" % numbers[1])
            if numbers[3] > 0:
                point = branch.getLabel(numbers[3])
                same(point["PT"], numbers[1], "signed point number of label %d" % numbers[3])
                same(point["TY name"], type_translation(numbers[2])["short name"] if numbers[2] else "No Label",
                     "type of label %d" % numbers[3])
        same(branch["BR"], section["points"][0][0][0], "branch number")
        stable = [p[0][1] < 0 for p in section["points"]]
        changes = [k for k in range(1, len(stable)) if stable[k] != stable[k - 1]] + [len(stable)]
        same([abs(int(s)) for s in branch.stability()], changes, "where stability changes")


def check_constants(branch):
    constants = branch.c
    same(constants["NDIM"], 4, "NDIM of the header")
    same(constants["IPS"], 180, "IPS of the header")
    same(constants["NTST"], 6, "NTST of the header")
    same(constants["ICP"], [1, 61, 62], "ICP of the header")
    same(constants["Active ICP"], [1, 61, 62], "active ICP of the header")
    same(constants["THL"], [[61, 0.0]], "THL of the header")
    same(constants["UZR"], [[1, [2.5, 3.0]]], "UZR of the header")
    same(constants["UZSTOP"], [[2, 4.0]], "UZSTOP of the header")
    same(constants["STOP"], ["PD1"], "STOP of the header")
    same(constants["unames"], [[1, "x1"], [2, "x2"], [3, "y1"], [4, "y2"]], "unames of the header")
    same(constants["parnames"], [[1, "alpha"], [2, "omega"]], "parnames of the header")
    near([constants["RL0"], constants["RL1"]], [-1.7976e308, 1e300], "RL0, RL1 of the header")


def check_solutions(solutions, sections, type_translation):
    expected = [s for section in sections for s in section["solutions"]]
    same(solutions.getLabels(), [s["identifier"][3] for s in expected], "labels of the q-file")
    for wanted in expected:
        branch, point, type_number, label, intervals, collocation = wanted["identifier"]
        solution = solutions.getLabel(label)
        for key, value in (("BR", branch), ("PT", point), ("LAB", label), ("TY number", type_number),
                           ("NTST", intervals), ("NCOL", collocation), ("IPS", 180), ("NDIM", 4),
                           ("NPARI", len(wanted["internal"]))):
            same(solution[key], value, "%s of label %d" % (key, label))
        same(solution["TY"], type_translation(type_number)["short name"], "type of label %d" % label)
        near(list(solution.indepvararray), [s[0] for s in wanted["states"]], "t of label %d" % label)
        for row in range(8):
            near(list(solution.coordarray[row]), [s[row + 1] for s in wanted["states"]],
                 "U(%d) of label %d" % (row + 1, label))
        parameters = list(solution.PAR.toarray())
        ordinary = len(wanted["parameters"])
        near(parameters[:ordinary], wanted["parameters"], "parameters of label %d" % label)
        internal = len(wanted["internal"])
        near(parameters[ordinary:-internal], [0.0] * (len(parameters) - ordinary - internal),
             "padding of label %d" % label)
        near(parameters[-internal:], wanted["internal"], "internal values of label %d" % label)
        if wanted["rates"]:
            same(list(solution["Active ICP"]), [1, 61, 62], "free parameters of label %d" % label)
            near(solution["rldot"], wanted["rates"], "direction of label %d" % label)


def check_multipliers(diagnostics, sections):
    expected = [m for section in sections for m in section["multipliers"]]
    blocks = [diagnostics[k] for k in range(len(diagnostics.data))]
    blocks = [b for b in blocks if b["Multipliers"]]
    same(len(blocks), len(expected), "blocks of the d-file")
    for block, (point, label, multipliers) in zip(blocks, expected):
        # Below the first heading of a block: a table of iterations without the sign, or the point itself with it.
        same(abs(block["Point number"]), point, "point number of a d-file block")
        same(block["Label"], label, "label of the d-file block of point %d" % point)
        same(block["Branch number"], 2, "branch number of the d-file block of point %d" % point)
        near([x for pair in block["Multipliers"] for x in pair], multipliers, "multipliers of point %d" % point)


def check_written_by_auto(program, parseS):
    """Our reader finds the same in what AUTO's writer makes of the file, fully parsed or copied line by line."""
    original = subprocess.run([program, "q.sample"], check=True, capture_output=True).stdout
    for parsed in (True, False):
        solutions = parseS.parseS("q.sample")
        for solution in solutions if parsed else ():
            solution["Parameters"]
        solutions.writeFilename("q.rewritten", mlab=True)
        rewritten = subprocess.run([program, "q.rewritten"], check=True, capture_output=True).stdout
        check(rewritten == original and len(original) > 1000, "our reading of a q-file that AUTO wrote (%s)" % parsed)


def main():
    folder = find_auto()
    if folder is None:
        print("skipped: AUTO-07p is not installed (Debian package auto-07p)")
        return 77
    writer = os.path.abspath(sys.argv[1])
    sys.path.insert(0, folder)
    allow_new_numpy()
    from auto import bifDiag, parseB, parseBandS, parseD, parseS

    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        subprocess.run([writer], check=True)
        sections = read_expected("expected.txt")
        branches = parseB.parseBR("p.sample")
        check_points(branches, sections, parseB.type_translation)
        check_constants(branches[0])
        same(branches[1].TY, 5, "type of the curve of the second section")
        check_solutions(parseS.parseS("q.sample"), sections, parseB.type_translation)
        both = parseBandS.parseBandS("p.sample", "q.sample")
        same(both.getLabels(), [s["identifier"][3] for section in sections for s in section["solutions"]],
             "labels of p- and q-file read together")
        diagram = bifDiag.bifDiag("p.sample", "q.sample", "d.sample")
        solution, wanted = diagram(5), sections[0]["solutions"][4]
        near([solution["alpha"], solution["PAR(3)"]], [wanted["parameters"][0], wanted["parameters"][2]],
             "parameters by their names")
        near(solution["x2"], [s[2] for s in wanted["states"]], "a state by its name")
        near([solution.b["energy"]], [sections[0]["points"][9][1][-2]], "a column by its name")
        check_multipliers(parseD.parseD("d.sample"), sections)
        check_written_by_auto(writer, parseS)
        os.chdir(os.path.dirname(writer))
    print("%d sections, %d faults" % (len(sections), len(FAULTS)))
    return 1 if FAULTS else 0


if __name__ == "__main__":
    sys.exit(main())
