"""The manual pages: one for the program and for each of its commands, with every option of the help, and without a
complaint of the formatter where it is installed.

    manual_test.py TCHAT
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile


def output(*words, status=0):
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == status, f"{words}: status {done.returncode}, {done.stderr}"
    return done.stdout


def plain(page):
    """Text without the macros of roff."""
    return re.sub(r"\\f[A-Z]|\\&", "", page).replace("\\-", "-").replace("\\e", "\\")


def check(tchat):
    help_text = output(tchat, "--help")
    commands = re.findall(r"^  ([a-z]+) ", help_text.split("SUBCOMMANDS:" if "SUBCOMMANDS:" in help_text else "Subcommands:")[1], re.M)
    assert len(commands) >= 12, commands
    with tempfile.TemporaryDirectory() as folder:
        output(tchat, "manual", folder)
        names = sorted(os.listdir(folder))
        assert names == sorted(["tchat.1"] + [f"tchat-{command}.1" for command in commands]), names
        for name in names:
            path = os.path.join(folder, name)
            page = plain(open(path, encoding="utf-8").read())
            words = name[:-2].split("-")[1:]
            options = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", output(tchat, *words, "--help")))
            missing = [option for option in options if option not in page]
            assert options and not missing, f"{name} does not have {missing}"
            for section in ("NAME", "SYNOPSIS", "OPTIONS"):
                assert f".SH {section}" in page, f"{name} has no section {section}"
            formatter = shutil.which("groff")
            if formatter:
                done = subprocess.run([formatter, "-man", "-Tutf8", "-ww", path], capture_output=True, text=True)
                assert done.returncode == 0 and not done.stderr, f"{name}: {done.stderr}"


check(sys.argv[1])
