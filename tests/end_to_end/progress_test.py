"""While no label is due a line on the terminal tells point, parameter and step; it is gone when the run ends, and
nothing of it comes into a file.

    progress_test.py TCHAT LINOSC.so CONSTANTS
"""
import glob
import os
import pty
import re
import shutil
import subprocess
import sys
import tempfile

ARGUMENTS = ["run", "linosc", "-c", "nonimpacting_omega", "-d", "nonimpacting", "-o", "long",
             "NTST=400", "NMX=100000", "NPR=0", "DS=1e-4", "DSMAX=1e-4", "UZR={}", "GCIPSI=[]", "IAD=0"]


def terminal():
    """Both ends of a pseudo terminal; ends the test as skipped where the machine has none."""
    try:
        return pty.openpty()
    except OSError as error:
        print(error)
        sys.exit(77)


def on_terminal(words):
    """What the program writes to a terminal until it ends, interrupted at its second renewal of the line."""
    main, side = terminal()
    program = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=side, stderr=side)
    os.close(side)
    text = ""
    interrupted = False
    while True:
        try:
            part = os.read(main, 4096)
        except OSError:  # the other side is closed
            break
        if not part:
            break
        text += part.decode()
        if not interrupted and len(re.findall(r"point \d+", text)) >= 2:
            program.send_signal(2)
            interrupted = True
    return program.wait(), text


def check(tchat, library, constants):
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        shutil.copy(library, "linosc.so")
        for path in glob.glob(os.path.join(constants, "*")):
            shutil.copy(path, folder)
        status, text = on_terminal([tchat] + ARGUMENTS)
        lines = re.findall(r"point (\d+), omega = ([0-9.e+-]+), step ([0-9.e+-]+)", text)
        assert status == 130 and len(lines) >= 2, f"status {status}: {text!r}"
        assert 1 < int(lines[0][0]) < int(lines[1][0]), lines
        assert all(0.9e-4 < float(step) < 1.1e-4 for _, _, step in lines), lines
        # The last state of the line of the terminal, as its control characters leave it.
        after = text[text.rindex("point "):]
        assert "\r" in after and "\x1b[K" in after or re.search(r"\r +\r", after), repr(after)
        quiet = subprocess.run([tchat] + ARGUMENTS + ["NMX=20"], capture_output=True, text=True)
        assert quiet.returncode == 0 and not re.search(r"point \d+, omega", quiet.stdout), quiet.stdout
        assert "point 2," not in open("d.long").read()


check(*map(os.path.realpath, sys.argv[1:]))
