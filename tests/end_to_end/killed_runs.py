"""Runs killed at random instants lose nothing but the point in progress, and no complete set that was there before.

usage: killed_runs.py TCHAT PLUGIN FOLDER [KILLS [SEED]]      executable, plugin library, folder of gc-files and data

Plain runs, runs with --append and runs left to their end follow each other under one output name. After every SIGKILL
each file ends with a whole block, tchat and (where it is installed) AUTO-07p's own readers read it, and the last complete set stands whole, as p.O, q.O, d.O or as p.O~, q.O~, d.O~, possibly with more after
it.
"""

import collections
import fcntl
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "output"))
from auto_readers import FAULTS, allow_new_numpy, check, find_auto  # noqa: E402

NAME = "branch"
COMPLETE = ["NMX=6", "NPR=2"]
ENDLESS = ["NMX=1000000", "DS=1e-6", "DSMAX=1e-6", "NPR=2"]
LONGEST = 0.12  # seconds until a kill: from before the first file to many points


def auto_readers():
    """AUTO's modules, or None."""
    folder = find_auto()
    if folder is None:
        return None
    sys.path.insert(0, folder)
    allow_new_numpy()
    from auto import parseB, parseD, parseS
    return parseB, parseD, parseS


def read(path):
    with open(path, "rb") as file:
        return file.read()


def names(suffix=""):
    return [letter + "." + NAME + suffix for letter in "pqd"]


def wait_for_last_block():
    """A block that was being stored is finished by a process of its own, which holds the lock as long."""
    lock = "." + NAME + ".lock"
    if os.path.exists(lock):
        with open(lock) as file:
            fcntl.flock(file, fcntl.LOCK_EX)


def check_readable(tchat, path, auto, when):
    letter, text = path[0], read(path)
    check(not text or text.endswith(b"\n"), "%s: %s ends within a line" % (when, path))
    if letter == "q":
        outcome = subprocess.run([tchat, "labels", path], capture_output=True, text=True)
        check(outcome.returncode == 0 and path + ":" not in outcome.stderr,
              "%s: tchat labels %s: %s" % (when, path, outcome.stderr))
    if letter == "p":
        widths = {len(line.split()) for line in text.decode().splitlines() if line.split()[0] != "0"}
        check(len(widths) <= 1, "%s: %s has lines of %s words" % (when, path, sorted(widths)))
    if auto is None:
        return
    parseB, parseD, parseS = auto
    try:
        if letter == "p":
            for branch in parseB.parseBR(path):
                branch.coordarray
        if letter == "q":
            for solution in parseS.parseS(path):
                solution.PAR, solution.coordarray
        if letter == "d":
            blocks = parseD.parseD(path)
            labels = [blocks[k]["Multipliers"] for k in range(len(blocks.data))]
            check(all(len(m) <= 4 for m in labels), "%s: two points in a block of %s" % (when, path))
    except Exception as error:
        check(False, "%s: AUTO's reader of %s: %r" % (when, path, error))


def check_folder(tchat, auto, known, complete, when, killed):
    """`complete`: the texts of the last complete set. A killed run may leave files .NAME.XXXXXX.new, the next one not."""
    files = set(os.listdir("."))
    for suffix in ("", "~", "~~"):
        for path in names(suffix):
            if path in files:
                check_readable(tchat, path, auto, when)
    ours = set(names()) | set(names("~")) | {"r." + NAME, "r." + NAME + "~", "." + NAME + ".lock"}
    left = {file for file in files - known - ours if killed is False or not file.endswith(".new")}
    check(not left, "%s: left behind: %s" % (when, sorted(left)))
    check("r." + NAME not in files or read("r." + NAME), "%s: r.%s is empty" % (when, NAME))
    places = [suffix for suffix in ("", "~") if all(path in files and read(path).startswith(text)
                                                    for path, text in zip(names(suffix), complete))]
    check(places, "%s: the complete set is lost" % when)
    return places


def main():
    tchat, plugin, constants = (os.path.abspath(a) for a in sys.argv[1:4])
    kills = int(sys.argv[4]) if len(sys.argv) > 4 else 20
    random.seed(int(sys.argv[5]) if len(sys.argv) > 5 else 1)
    auto = auto_readers()
    count = collections.Counter()
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        for file in os.listdir(constants):
            shutil.copy(os.path.join(constants, file), work)
        shutil.copy(plugin, work)
        known = set(os.listdir("."))
        run = [tchat, "run", "linosc", "-q", "-c", "impacting", "-d", "impacting", "-o", NAME, "NTST=10", "UZR={}"]
        complete = None
        while count["kills"] < kills:
            if complete is None or random.random() < 0.2:
                subprocess.run(run + COMPLETE, check=True)
                if complete is not None:
                    check_folder(tchat, auto, known, complete, "after run %d to its end" % count["complete runs"], False)
                complete = [read(path) for path in names()]
                count["complete runs"] += 1
                continue
            append = random.random() < 0.5
            before = [read(path) for path in names()]
            process = subprocess.Popen(run + ENDLESS + (["--append"] if append else []), stderr=subprocess.PIPE)
            time.sleep(random.uniform(0.0, LONGEST))
            process.send_signal(signal.SIGKILL)
            error = process.communicate()[1]
            wait_for_last_block()
            count["kills"] += 1
            when = "kill %d%s" % (count["kills"], ", --append" if append else "")
            check(process.returncode == -signal.SIGKILL, "%s: ended before it: %s" % (when, error))
            count["before anything was written" if [read(path) for path in names()] == before else
                  "while appending" if append else "while writing a new set"] += 1
            places = check_folder(tchat, auto, known, complete, when, True)
            count["complete set in " + " and ".join("O" + suffix for suffix in places)] += 1
        os.chdir(constants)
    print("AUTO's readers: %s" % ("used" if auto else "not installed"))
    for what, number in sorted(count.items()):
        print("%4d  %s" % (number, what))
    print("%d faults" % len(FAULTS))
    return 1 if FAULTS else 0


if __name__ == "__main__":
    sys.exit(main())
