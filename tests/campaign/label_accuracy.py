"""Runs with coarse and fine meshes, short and long steps, and every label integrated once more by orbit_check.

    python3 label_accuracy.py TCHAT ORBIT_CHECK SOURCE [--count N] [--seed S] [--only NAME] [--folder FOLDER]

Draws N runs (300): half of them runs of the pipelines in problems/*/Makefile, half of the systems in
foreign_systems.py, at NTST = 5 to 200 and DSMAX = 0.01 to 10. Every labelled orbit must agree with the integration
within what the run states of its accuracy (the estimated error of its point in the d-file), and its multipliers with
its type. The exit status is 1 where a label does not.
"""

import argparse
import collections
import glob
import json
import math
import os
import random
import re
import shlex
import shutil
import subprocess
import sys

import foreign_systems
import pipeline_labels

# The run estimates the error between mesh points. At mesh points, which are compared, collocation is more accurate; the
# estimate is of the last two meshes' leading term, which on a mesh that is too coarse for it is off by some factor.
SAFETY = 10
# Times and states in q-files have eleven digits; what the last ones do to an integration is found by disturbing them.
LAST_DIGIT = 1e-11
STORED = 1e-9
# A multiplier moves like the square root of the distance from a fold, which is located to EPSS = 1e-9 or less; what the
# error of the orbit itself does to it is found by disturbing the orbit.
MULTIPLIER = 1e-3
# What a label and the multipliers beside it may differ by.
ROUGHLY = 0.1
# How exactly a least value is found from ten values in an interval.
LEAST = 1e-3
TIME_LIMIT = 60


def constants_of(folder, name):
    """The lines of r.NAME that say what an orbit is made of: lists of integers by the name in the comment."""
    found = {"IPS": 180, "EPSU": 1e-7}
    for line in open(os.path.join(folder, "r." + name)):
        words = line.split()
        for key in ("GCFIND", "GCHIND", "GCGIND"):
            if "(%s(I)" % key in line:
                found[key] = [int(word) for word in words[:words.index("(%s(I)," % key)]]
        if "NDIM, IPS" in line:
            found["IPS"] = int(words[1])
        if "ISW" in words or "ISW," in words:
            found["ISW"] = int(words[4])
        if "EPSL, EPSU" in line:
            found["EPSU"] = float(words[1])
    return found


def stored_orbits(path):
    """label -> header, t and states of all points, PAR."""
    orbits = {}
    with open(path) as file:
        while line := file.readline():
            head = [int(word) for word in line.split()]
            words = "".join(file.readline() for _ in range(head[8])).split()
            width, points = head[7], head[6]
            rows = [[float(w) for w in words[k * width:(k + 1) * width]] for k in range(points)]
            par = [float(w) for w in words[len(words) - head[11]:]]
            orbits[head[3]] = (head, rows, par[:head[11] - head[12]])
    return orbits


def stated_errors(path):
    """(branch, point) -> estimated error, of the d-file."""
    errors = {}
    for line in open(path):
        found = re.match(r"\s+(\d+)\s+(\d+)\s.*estimated error.*?(\S+)\s*$", line)
        if found:
            errors[(int(found.group(1)), int(found.group(2)))] = float(found.group(3))
    return errors


def description(library, constants, orbit, contacts):
    head, rows, par = orbit
    segments = len(constants["GCFIND"])
    n = (head[7] - 1) // segments
    words = [library, n, segments, len(par)] + ["%.17g" % p for p in par]
    for s in range(segments):
        nodes = rows[::head[10]]
        words += [constants[key][s] for key in ("GCFIND", "GCHIND", "GCGIND")] + ["%.17g" % par[60 + s], len(nodes)]
        for row in nodes:
            words += ["%.17g" % row[0]] + ["%.17g" % x for x in row[1 + s * n:1 + (s + 1) * n]]
    words += [len(contacts)] + [k for pair in contacts for k in pair]
    return " ".join(str(word) for word in words)


def multipliers_of(found, constants):
    multipliers = [complex(*pair) for pair in zip(found.get("real", []), found.get("imaginary", []))]
    if multipliers and 0 in constants["GCHIND"]:  # a smooth orbit without a section has a 1 along the flow
        multipliers.remove(min(multipliers, key=lambda mu: abs(mu - 1)))
    return multipliers


def distance_from_type(kind, multipliers):
    if kind == "PD":
        return min((abs(mu + 1) for mu in multipliers), default=math.inf)
    if kind == "TR":
        return min((abs(abs(mu) - 1) for mu in multipliers if mu.imag != 0), default=math.inf)
    return min((abs(mu - 1) for mu in multipliers), default=math.inf)


def has_type(row, constants):
    return (constants["IPS"] == 180 and constants.get("ISW") in (0, 1, -1) and row["type"] in ("LP", "PD", "TR", "BP")
            and "velocity zero" not in (row["kind"] or ""))


def disturbed(orbit, error, seed):
    """A copy whose states are off by up to `error` of the largest one, as those of the run are."""
    head, rows, par = orbit
    noise = random.Random(seed)
    size = error * max(abs(x) for row in rows for x in row[1:])
    return head, [row[:1] + [x + size * noise.uniform(-1, 1) for x in row[1:]] for row in rows], par


def with_other_digits(orbit):
    """A copy whose times and states are off by as much as rounding to eleven digits allows."""
    head, rows, par = disturbed(orbit, 10 * LAST_DIGIT, 2)
    noise = random.Random(2)
    return head, [[row[0] + LAST_DIGIT * noise.uniform(-1, 1) if 0 < row[0] < 1 else row[0]] + row[1:]
                  for row in rows], par


def relative_change(multipliers, others):
    """The largest change of a multiplier, relative to it or to 0.1, whichever is larger; both sets by size."""
    pairs = zip(sorted(multipliers, key=abs), sorted(others, key=abs))
    return max((abs(mu - other) / max(abs(mu), abs(other), 0.1) for mu, other in pairs), default=math.inf)


def fault_of_type(row, answers, constants):
    """None where the orbit has what its type says, within what the multipliers of disturbed copies say of the error."""
    kind = row["type"]
    multipliers = multipliers_of(answers[0], constants)
    distances = [distance_from_type(kind, multipliers_of(found, constants)) for found in answers]
    own = [complex(*pair) for pair in row["multipliers"] or [] if None not in pair]
    if own and distance_from_type(kind, own) > ROUGHLY:
        return "the run's own multipliers are " + text_of(own)
    if not multipliers or not all(math.isfinite(distance) for distance in distances):
        return "unverifiable: no multipliers"
    change = max(relative_change(multipliers, multipliers_of(found, constants)) for found in answers)
    error = max(abs(distance - distances[0]) for distance in distances)
    largest = max(abs(mu) for mu in multipliers)
    allowed = MULTIPLIER + SAFETY * error + 1e-7 * largest  # the last one of the differences
    if allowed > 0.3 or change > 0.3:
        return "unverifiable: multipliers %s change by %.2g" % (text_of(multipliers), max(error, change))
    if distances[0] > allowed:
        return "the nearest multiplier is off by %.3g, allowed are %.2g: %s" % (distances[0], allowed,
                                                                              text_of(multipliers))
    return None


def text_of(multipliers):
    return ", ".join("%.6g%+.6gi" % (mu.real, mu.imag) for mu in multipliers)


def faults_of_label(row, constants, answers, stated, orbit):
    """`answers` of orbit_check: of the orbit, of one with other last digits, and of disturbed copies where its type is
    looked at."""
    found, rounded = answers[0], answers[1]
    if "fault" in found:
        return ["unverifiable: " + found["fault"]]
    faults = []
    accuracy = SAFETY * (stated + constants["EPSU"]) + STORED
    of_digits = SAFETY * abs(rounded.get("interval", 0.0) - found["interval"])
    if found["interval"] > accuracy + of_digits:
        faults.append("integration leaves the stored points by %.2g, stated is %.2g" % (found["interval"], stated))
    if found["connection"] > accuracy:
        faults.append("segments do not meet: %.2g, stated is %.2g" % (found["connection"], stated))
    # Where a segment shrinks to a point.
    at_zero = row["type"] in ("GR", "BE") or "velocity zero" in (row["kind"] or "")
    if found["event"] > accuracy:
        faults.append("a segment ends off its surface by %.2g, stated is %.2g" % (found["event"], stated))
    # The run marks an orbit with a negative duration as inadmissible, which GRSTOP=0 asks for.
    if found["shortest"] < (-1e-9 if at_zero else 0) and row["admissible"] is not False:
        faults.append("a segment lasts %.3g" % found["shortest"])
    kind = row["kind"] or ""
    for segment in re.findall(r"velocity zero at the end of segment (\d+)", kind):
        speed = found["velocity"][int(segment) - 1] if len(found["velocity"]) == len(constants["GCFIND"]) else 0.0
        if abs(speed) * abs(orbit[2][60 + int(segment) - 1]) > MULTIPLIER + 100 * stated:
            faults.append("velocity zero, but h_x f = %.3g at the end of segment %s" % (speed, segment))
    if row["type"] == "GR":
        for least in found["least"]:
            if abs(least) > LEAST + 100 * stated:
                faults.append("contact, but the least value of h is %.3g, relative to the states" % least)
    if has_type(row, constants):
        faults.append(fault_of_type(row, [found] + answers[2:], constants))
    return [fault for fault in faults if fault]


def check_run(tchat, checker, folder, name, library):
    """Faults of each label of q.NAME: list of (label, type, fault); and how many labels there were."""
    constants = constants_of(folder, name)
    if constants["IPS"] not in (150, 180):
        return [], 0
    table = subprocess.run([tchat, "table", "--json", "p." + name], cwd=folder, capture_output=True, text=True)
    rows = [row for row in json.loads(table.stdout or "[]") if row["label"]]
    orbits, errors = stored_orbits(os.path.join(folder, "q." + name)), stated_errors(os.path.join(folder, "d." + name))
    faults, lines, wanted = [], [], []
    for row in rows:
        orbit = orbits[row["label"]]
        numbers = [x for line in orbit[1] for x in line] + orbit[2]
        if not all(math.isfinite(x) and abs(x) < 1e90 for x in numbers):
            faults.append((row["label"], row["type"], "numbers that are not finite"))
            continue
        contacts = [(int(s), int(j)) for s, j in
                    re.findall(r"contact inside segment (\d+), event function (\d+)", row["kind"] or "")]
        stated = errors.get((row["branch"], abs(row["point"])), 0.0)
        copies = [orbit, with_other_digits(orbit)]
        if has_type(row, constants):
            copies += [disturbed(orbit, max(stated, STORED), seed) for seed in range(2)]
        lines += [description(library, constants, copy, contacts) for copy in copies]
        wanted.append((row, orbit, stated, len(copies)))
    try:
        done = subprocess.run([checker], input="\n".join(lines) + "\n", capture_output=True, text=True,
                              timeout=5 * TIME_LIMIT)
    except subprocess.TimeoutExpired:
        return faults + [(0, "all", "unverifiable: the integration takes too long")], len(rows)
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    if len(answers) != len(lines):
        return faults + [(0, "all", "the integration ended: " + done.stderr.strip())], len(rows)
    for row, orbit, stated, copies in wanted:
        for fault in faults_of_label(row, constants, answers[:copies], stated, orbit):
            faults.append((row["label"], row["type"], fault))
        answers = answers[copies:]
    return faults, len(rows)


def pipeline_runs(results):
    """Every `tchat run` of the pipelines' logs: folder, words of the command without the program, library."""
    runs = []
    for log in sorted(glob.glob(os.path.join(results, "*", "log"))):
        for line in open(log).read().replace("\\\n", " ").splitlines():
            found = re.match(r"cd (\S+) && \S+ (run .*)$", line)
            if not found:
                continue
            words = shlex.split(found.group(2))
            runs.append((found.group(1), words, words[words.index("-p") + 1]))
    return runs


def foreign_run(tchat, folder, name):
    formulas, options, parameter, (low, high) = foreign_systems.FOREIGN[name]
    place = os.path.join(folder, "foreign", name)
    if not os.path.exists(os.path.join(place, "start.dat")):
        os.makedirs(place, exist_ok=True)
        with open(os.path.join(place, name + ".tch"), "w") as file:
            file.write(formulas)
        subprocess.run([tchat, "simulate", name, "--rows", "0", "-q", "--dat", "start", "--free", parameter] + options,
                       cwd=place, capture_output=True, timeout=TIME_LIMIT)
    words = ["run", name, "-q", "-c", "start", "-d", "start", "-o", "run", "RL0=%g" % low, "RL1=%g" % high]
    return place, words, os.path.join(place, name)


def with_new_name(words, name):
    words = list(words)
    words[words.index("-o") + 1] = name
    return words


def draw_runs(random, tchat, folder, count, only):
    pipelines = pipeline_runs(os.path.join(folder, "pipelines", "results"))
    pipelines = [run for run in pipelines if not only or only in run[2]]
    foreign = [name for name in foreign_systems.FOREIGN if not only or only in name]
    for number in range(count):
        use_foreign = foreign and (not pipelines or number % 2)
        place, words, library = foreign_run(tchat, folder, foreign[number // 2 % len(foreign)] if pipelines else
                                            foreign[number % len(foreign)]) if use_foreign else random.choice(pipelines)
        length = math.exp(random.uniform(math.log(0.01), math.log(10)))
        settings = ["NTST=%d" % random.choice([5, 8, 12, 20, 40, 100, 200]), "DSMAX=%.3g" % length,
                    "DS=%.3g" % (random.choice([-1, 1]) * min(length, 0.02)), "NMX=%d" % random.choice([20, 60, 150]),
                    "DSMIN=0", "NPR=10"] + random.choice([[], [], ["RL0=-1e300", "RL1=1e300", "GRSTOP=0"]])
        yield place, with_new_name(words, "campaign%d" % number) + settings, library


def add_options(parser, folder):
    parser.add_argument("source")
    parser.add_argument("--only", default="", help="only problems and systems whose name has this in it")
    parser.add_argument("--foreign", action="store_true", help="no pipelines")
    parser.add_argument("--folder", default=folder)


def prepared_folder(tchat, options):
    """The folder of the runs, with the pipelines' results unless they are there or not asked for."""
    folder = os.path.abspath(options.folder)
    shutil.rmtree(os.path.join(folder, "foreign"), ignore_errors=True)
    os.makedirs(folder, exist_ok=True)
    if not options.foreign and not os.path.exists(os.path.join(folder, "pipelines")):
        pipeline_labels.make(tchat, options.source, os.path.join(folder, "pipelines"), os.path.join(folder, "labels"))
    return folder


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("tchat")
    parser.add_argument("orbit_check")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    add_options(parser, "label_accuracy")
    options = parser.parse_args()
    tchat = os.path.abspath(options.tchat)
    folder = prepared_folder(tchat, options)
    counts, wrong = collections.Counter(), 0
    for place, words, library in draw_runs(random.Random(options.seed), tchat, folder, options.count, options.only):
        name = words[words.index("-o") + 1]
        counts["runs"] += 1
        for old in glob.glob(os.path.join(place, "[pqdr]." + name)):
            os.remove(old)
        try:
            done = subprocess.run([tchat] + words, cwd=place, capture_output=True, text=True, timeout=TIME_LIMIT)
        except subprocess.TimeoutExpired:
            counts["runs longer than %d s" % TIME_LIMIT] += 1
            continue
        if not os.path.exists(os.path.join(place, "q." + name)):
            counts["runs that do not start"] += 1
            if done.returncode > 2 or done.returncode < 0:
                print("exit status %d: cd %s && tchat %s" % (done.returncode, place, shlex.join(words)), flush=True)
                wrong += 1
            continue
        libraries = [library + end for end in (".so", ".tch.so") if os.path.exists(library + end)]
        faults, labels = check_run(tchat, os.path.abspath(options.orbit_check), place, name, libraries[0])
        counts["labels"] += labels
        for label, kind, fault in faults:
            verdict = "unverifiable" if fault.startswith("unverifiable") else "wrong"
            counts["labels " + verdict] += 1
            wrong += verdict == "wrong"
            print("%s: label %d, %s: %s" % (verdict, label, kind, fault))
            print("    cd %s && tchat %s" % (place, shlex.join(words)), flush=True)
    for what, count in counts.items():
        print("%6d %s" % (count, what))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
