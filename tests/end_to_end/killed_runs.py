"""Runs killed at any instant lose nothing but the point in progress, and nothing that was there before.

usage: killed_runs.py TCHAT PLUGIN FOLDER [KILLS [SEED]]      executable, plugin library, folder of gc-files and data

Plain runs and runs with --append, endless ones and ones that come to their end, follow each other under one output
name. Most are killed just before a change of a file or a name that is drawn from all changes of such a run, with the
library of recorded_calls.cpp, which is looked for beside the plugin; some at a random time. After every SIGKILL tchat
reads each file up to its last whole block, and so do AUTO-07p's own readers (where they are installed) unless a part of
a block follows. Each file is the beginning of what the run would have written, after what was there before. The last
complete set stands whole, as p.O, q.O, d.O or as p.O~, q.O~, d.O~, possibly with more after it.
"""

import collections
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "files"))
from auto_readers import FAULTS, allow_new_numpy, check, find_auto  # noqa: E402

NAME = "branch"
FINITE = ["NMX=6", "NPR=2"]
ENDLESS = ["NMX=1000000", "DS=1e-6", "DSMAX=1e-6", "NPR=2"]
LATEST = 0.12  # seconds until a kill at a random time: from before the first file to many points
CALLS_OF_ENDLESS = 40  # after its files have been opened
CALLS_OF_ENDING = 12
END_OF_RUN = b"end of run\n"


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


def whole_part(letter, text):
    """What --append leaves of a file: whole lines, of a p-file no heading without points, of a q-file whole entries."""
    lines = text.splitlines(keepends=True)
    if lines and not lines[-1].endswith(b"\n"):
        lines.pop()
    while letter == "p" and lines and lines[-1].split()[0] == b"0":
        lines.pop()
    if letter == "q":
        end = 0
        while end < len(lines) and end + 1 + int(lines[end].split()[8]) <= len(lines):
            end += 1 + int(lines[end].split()[8])
        lines = lines[:end]
    return b"".join(lines)


def check_readable(tchat, path, auto, when):
    """A kill within a write may leave a part of a block: tchat leaves it out and says so, AUTO's readers need not."""
    letter, text = path[0], read(path)
    whole = whole_part(letter, text)
    if letter == "q":
        outcome = subprocess.run([tchat, "labels", path], capture_output=True, text=True)
        warned = path + ":" in outcome.stderr and "not complete and is left out" in outcome.stderr
        check(outcome.returncode == 0 and (warned if whole != text else path + ":" not in outcome.stderr),
              "%s: tchat labels %s: %s" % (when, path, outcome.stderr))
    if letter == "p":
        widths = {len(line.split()) for line in whole.decode().splitlines() if line.split()[0] != "0"}
        check(len(widths) <= 1, "%s: %s has lines of %s words" % (when, path, sorted(widths)))
        outcome = subprocess.run([tchat, "table", path], capture_output=True, text=True)
        check(outcome.returncode == 0 or "no point in it" in outcome.stderr,
              "%s: tchat table %s: %s" % (when, path, outcome.stderr))
    if whole != text:
        return
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


def inodes(suffix=""):
    return [os.stat(path).st_ino if os.path.exists(path) else None for path in names(suffix)]


class Folder:
    """The files p.O, q.O, d.O at one instant."""

    def __init__(self):
        self.texts = [read(path) if os.path.exists(path) else b"" for path in names()]
        self.inodes = inodes()
        self.kept = inodes("~")
        self.others = {file for file in os.listdir(".") if file.startswith(".")}

    def is_complete(self):
        return self.texts[2].endswith(END_OF_RUN)


def phase(before, after):
    """How far a killed run had come."""
    begun = after.others - before.others
    if after.inodes != before.inodes:
        replaced = sum(a != b for a, b in zip(after.inodes, before.inodes))
        if replaced < 3 or not after.texts[0]:
            return "while the old files were replaced"
        return "after the last line" if after.is_complete() else "while writing a new set"
    if after.texts != before.texts:
        return "after the last line" if after.is_complete() else "while appending"
    if after.kept != before.kept or any(name.endswith(".new") for name in begun):
        return "while the old files were kept"
    return "with nothing but the lock" if begun else "before anything was there"


def check_beginning(when, before, after, append, reference):
    """The files hold what was there, for --append, and the beginning of what the run writes."""
    for letter, old, new, whole, old_inode, inode in zip("pqd", before.texts, after.texts, reference, before.inodes,
                                                         after.inodes):
        if append:
            check(new.startswith(whole_part(letter, old)), "%s: %s.%s has lost what was there" % (when, letter, NAME))
        elif inode != old_inode:
            check(whole.startswith(new), "%s: %s.%s is no beginning of the run's" % (when, letter, NAME))
        else:
            check(new == old, "%s: %s.%s was changed where it stands" % (when, letter, NAME))


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


class Runs:
    """Starts runs and kills them."""

    def __init__(self, tchat, library):
        self.command = [tchat, "run", "linosc", "-q", "-c", "impacting", "-d", "impacting", "-o", NAME, "NTST=10",
                        "UZR={}"]
        self.library = library if os.path.exists(library) else None
        self.calls = {}  # by --append: the calls of a run to its end, and the number of the last one that opens files
        self.reference = {}  # by finite: what a run writes

    def start(self, finite, append, **environment):
        command = self.command + (FINITE if finite else ENDLESS) + (["--append"] if append else [])
        if self.library:
            environment["LD_PRELOAD"] = self.library
        return subprocess.Popen(command, stderr=subprocess.PIPE, env=dict(os.environ, **environment))

    def to_its_end(self, append=False):
        record = os.path.abspath("calls")
        process = self.start(True, append, RECORDED_CALLS=record)
        process.communicate()
        if process.returncode != 0:
            sys.exit("a run that nobody kills fails with status %d" % process.returncode)
        if self.library:
            calls = read(record).decode().splitlines()
            os.remove(record)
            opening = max(k for k, call in enumerate(calls) if call.startswith("rename")) + 1
            self.calls[append] = (len(calls), opening)

    def learn(self):
        """What runs write, and how many calls that takes."""
        process = self.start(False, False)
        time.sleep(10 * LATEST + 1.0)
        kill(process)
        self.reference[False] = Folder().texts
        self.to_its_end()
        self.to_its_end(append=True)
        self.to_its_end()
        self.reference[True] = Folder().texts

    def moment(self, finite, append):
        """The number of a call: half of them while files are opened, of finite runs some at the end."""
        calls, opening = self.calls[append]
        drawn = random.random()
        if drawn < 0.5:
            return random.randint(1, opening + 1)
        if not finite:
            return random.randint(opening, opening + CALLS_OF_ENDLESS)
        return random.randint(calls - CALLS_OF_ENDING, calls) if drawn < 0.8 else random.randint(opening, calls)

    def killed_one(self, finite, append):
        """The error text of a run that ended otherwise; "" of a killed one, None of one that came to its end."""
        if self.library and random.random() < 0.75:
            process = self.start(finite, append, KILLED_AT=str(self.moment(finite, append)))
            try:
                process.wait(timeout=30)
            except subprocess.TimeoutExpired:
                pass
        else:
            process = self.start(finite, append)
            time.sleep(random.uniform(0.0, LATEST))
        return kill(process)


def kill(process):
    process.send_signal(signal.SIGKILL)
    error = process.communicate()[1].decode()
    if process.returncode == 0:
        return None
    return error if process.returncode != -signal.SIGKILL else ""


def main():
    tchat, plugin, constants = (os.path.abspath(a) for a in sys.argv[1:4])
    kills = int(sys.argv[4]) if len(sys.argv) > 4 else 20
    random.seed(int(sys.argv[5]) if len(sys.argv) > 5 else 1)
    auto = auto_readers()
    count = collections.Counter()
    kinds, places = collections.Counter(), collections.Counter()
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        for file in os.listdir(constants):
            shutil.copy(os.path.join(constants, file), work)
        shutil.copy(plugin, work)
        known = set(os.listdir("."))
        runs = Runs(tchat, os.path.join(os.path.dirname(plugin), "libend_to_end_recorded_calls.so"))
        runs.learn()
        complete = Folder().texts
        in_a_row = 0
        while sum(count.values()) < kills:
            if random.random() < 0.4:
                runs.to_its_end()
                check_folder(tchat, auto, known, complete, "after a run to its end", False)
                complete = Folder().texts
                check(complete == runs.reference[True], "a run to its end has written something else")
                in_a_row = 0
                continue
            finite, append = random.random() < 0.4, random.random() < 0.5
            before = Folder()
            when = "kill %d, %s%s" % (sum(count.values()) + 1, "finite" if finite else "endless",
                                      ", --append" if append else "")
            error = runs.killed_one(finite, append)
            after = Folder()
            if error is None:
                complete = after.texts
                continue
            check(error == "", "%s: ended before it: %s" % (when, error))
            count[phase(before, after)] += 1
            in_a_row += 1
            kinds["--append" if append else "plain"] += 1
            if in_a_row > 1:
                kinds["after another killed run"] += 1
            check_beginning(when, before, after, append, runs.reference[finite])
            if finite and not append and after.is_complete() and after.inodes != before.inodes:
                complete = after.texts  # it had come to its end
            for place in check_folder(tchat, auto, known, complete, when, True):
                places["last complete set stands in O" + place] += 1
        os.chdir(constants)
    print("AUTO's readers: %s; kills at chosen calls: %s" %
          ("used" if auto else "not installed", "yes" if runs.library else "no"))
    print("%d kills" % sum(count.values()))
    for numbers in (count, kinds, places):
        for what, number in sorted(numbers.items()):
            print("%6d  %s" % (number, what))
    print("%d faults" % len(FAULTS))
    return 1 if FAULTS else 0


if __name__ == "__main__":
    sys.exit(main())
