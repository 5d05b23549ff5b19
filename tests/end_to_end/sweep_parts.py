"""A sweep gives the same bytes for any number of workers, cut into parts in any way, killed and gone on with.

usage: sweep_parts.py TCHAT LINOSC_SOURCE WHAT      executable, linosc.cpp; what: diagram, following or basin

With TCHAT_ALL_TESTS in the environment (scripts/test --all) the grids are several times finer.

The reference is one worker, undisturbed. Compared with it are: two workers; seven parts, made by GNU parallel where it is
installed, and gathered; a sweep killed by SIGKILL several times, once with its journal cut within a line, once
interrupted, that every time goes on behind what was there. Journals of another command or another plugin are refused, not
mixed; missing parts are named with the commands that make them, which are then run as they stand.
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

TCHAT, SOURCE, WHAT = sys.argv[1:4]
IS_FULL = bool(os.environ.get("TCHAT_ALL_TESTS"))
VALUES = {"diagram": (250, 1000), "following": (30, 150), "basin": (12, 25)}[WHAT][IS_FULL]
OVER = {
    "diagram": ["--over", f"alpha=2:6:{VALUES}", "PAR(zeta)=0.3", "--section", "1", "--penetration", "1"],
    "following": ["--over", f"alpha=1.9:2.6:{VALUES}", "--over", "r=0.7:0.8:2", "PAR(omega)=1.8901", "--follow", "both",
                  "--max"],
    "basin": ["--over", f"x1=-1:1:{VALUES}", "--over", "x2=-5:5:20", "PAR(alpha)=2.2", "PAR(omega)=1.8901",
              "PAR(zeta)=0.1"],
}[WHAT]
LINES = 30 if IS_FULL else 25  # of the journal between two kills: the first 20 are its heading
FAULTS = []


def check(condition, what):
    if not condition:
        FAULTS.append(what)
        print("FAULT:", what)


def run(*words, status=0):
    done = subprocess.run([TCHAT, "sweep", "linosc", *words], capture_output=True, text=True)
    if done.returncode != status:
        FAULTS.append(words)
        print(f"FAULT: status {done.returncode} instead of {status}: {words}\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def read(path):
    with open(path, "rb") as file:
        return file.read()


def lines(path):
    return read(path).count(b"\n") if os.path.exists(path) else 0


def kill_when(name, grown_by, sent):
    """Starts the sweep and ends it when its journal has that many further lines. False: it has come to its end."""
    journal = name + ".sweep.journal"
    before = lines(journal)
    process = subprocess.Popen([TCHAT, "sweep", "linosc", *OVER, "-o", name, "-j", "2"], stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True)
    while process.poll() is None and lines(journal) < before + grown_by:
        time.sleep(0.002)
    is_running = process.poll() is None
    if is_running:
        process.send_signal(sent)
    out = process.communicate()[0]
    if is_running and sent == signal.SIGINT and process.returncode == 130:
        check("the same command continues" in out, "an interrupted sweep does not say how to continue it")
    return is_running


def workers_and_interruptions():
    run(*OVER, "-o", "one")
    reference = read("one.sweep")
    check(not os.path.exists("one.sweep.journal"), "the journal is left")
    run(*OVER, "-o", "two", "-j", "2")
    check(read("two.sweep") == reference, "two workers")
    run(*OVER, "-o", "many", "-j", "5")
    check(read("many.sweep") == reference, "five workers")

    kills = 0
    for sent in [signal.SIGKILL, signal.SIGINT, signal.SIGKILL, signal.SIGKILL]:
        kills += kill_when("killed", LINES, sent)
    check(kills >= 2, f"the sweep was killed {kills} times only: it is too short for this test")
    journal = read("killed.sweep.journal")
    with open("killed.sweep.journal", "wb") as file:
        file.write(journal[:-20])  # as where the disk was full
    other = [word.replace(f":{VALUES}", f":{VALUES - 1}") for word in OVER]
    said = run(*other, "-o", "killed", status=2)
    check("of another sweep" in said and "over is" in said, f"a journal of another command: {said}")
    said = run(*OVER, "-o", "killed", "-j", "2")
    check("Going on with killed.sweep.journal" in said, f"nothing of going on: {said}")
    check(read("killed.sweep") == reference, "killed and gone on with")
    return reference


def parts(reference):
    said = run(*OVER, "-o", "cut", "--gather", status=2)
    check("no part cut.sweep.1" in said, f"gathered without parts: {said}")
    command = [TCHAT, "sweep", "linosc", *OVER, "-o", "cut", "-q", "--part"]
    if shutil.which("parallel"):
        subprocess.run(["parallel", "--will-cite", "-j2", *(f"'{word}'" for word in command), "{}/7", ":::", *"1246"],
                       check=True)
    else:
        print("GNU parallel is not installed: parts are made one after the other")
        for part in "1246":
            subprocess.run([*command, f"{part}/7"], check=True)
    said = run(*OVER, "-o", "cut", "--gather", status=2)
    missing = re.findall(r"^\s+tchat (sweep .*--part [357]/7)$", said, re.M)
    check(len(missing) == 3, f"missing parts are not named: {said}")
    for words in missing:
        subprocess.run(f"'{TCHAT}' {words} -j 2", shell=True, check=True)
    run(*OVER, "-o", "cut", "--gather")
    check(read("cut.sweep") == reference, "seven parts")

    part = read("cut.sweep.3")
    with open("cut.sweep.3", "wb") as file:
        file.write(part[:len(part) // 2])
    said = run(*OVER, "-o", "cut", "--gather", status=2)
    check("cut.sweep.3" in said and "make it again" in said, f"a damaged part: {said}")
    said = run(*OVER, "-o", "cut", "--gather", "--tolerance", "1e-7", status=2)
    check("tolerance is 1e-08 there and 1e-07 here" in said, f"parts of another sweep: {said}")


def another_plugin():
    kill_when("changed", LINES, signal.SIGKILL)
    with open("linosc.cpp") as file:
        text = file.read()
    with open("linosc.cpp", "w") as file:
        file.write(text.replace("g[1] = -par[3] * x[1]", "g[1] = -0.9 * par[3] * x[1]"))
    said = run(*OVER, "-o", "changed", status=2)
    check("plugin is" in said, f"a journal of another plugin: {said}")
    run(*OVER, "-o", "changed", "--fresh", "-j", "2")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    shutil.copy(SOURCE, "linosc.cpp")
    bytes_of_reference = workers_and_interruptions()
    parts(bytes_of_reference)
    if WHAT == "diagram":
        another_plugin()
print("faults:", len(FAULTS))
sys.exit(1 if FAULTS else 0)
