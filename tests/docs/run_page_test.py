"""The runner of pages passes what is right and fails what is wrong.

usage: run_page_test.py TCHAT SOURCE
"""

import os
import struct
import subprocess
import sys
import tempfile
import zlib

RUNNER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "run_page.py")
SH, PYTHON, TEXT, CONSOLE = "```sh\n%s\n```\n", "```python\n%s\n```\n", "```text\n%s\n```\n", "```console\n%s\n```\n"

# A picture of lines in the given rows, drawn by this file itself: `-o FILE WIDTH ROW...`
DRAW = f"python3 '{os.path.abspath(__file__)}' -o "
SHOWN = 120, 20, 40, 60
MADE = "![own](page/a.png)\n"

RIGHT = {
    "output": SH % "echo a; echo '  b   c'; echo d" + TEXT % "a\nb c",
    "standard error": SH % "echo wrong >&2" + TEXT % "wrong",
    "lines left out": SH % "seq 9" + TEXT % "2\n...\n5\n6\n...\n9",
    "nothing left out": SH % "seq 3" + TEXT % "1\n...\n2\n3\n...",
    "text left out": SH % "echo 'x = 3.14159, y'" + TEXT % "x = 3.14..., y",
    "prose between": SH % "seq 3" + TEXT % "1" + "and\n" + TEXT % "3",
    "the program": SH % "tchat --version" + TEXT % "tchat ...",
    "state of the shell": SH % "mkdir f && cd f && n=1" + "x\n" + SH % "pwd; echo $n" + TEXT % ".../f\n1",
    "folder of Python": SH % "mkdir f && cd f && echo 7 > file" + PYTHON % "print(open('file').read())" + TEXT % "7",
    "names of Python": PYTHON % "x = 8" + PYTHON % "print(x)" + TEXT % "8",
    "a failure that is shown": SH % "false || echo \"exit status $?\"" + TEXT % "exit status 1",
    "here documents": SH % "cat > f <<'END'\na $b\nEND\ncat f" + TEXT % "a $b",
    "not run": CONSOLE % "false" + TEXT % "anything" + "```\nfalse\n```\n```c++\n#error\n```\n",
    "a link": "[this](page.md#a-heading-here)\n# A heading, here\n",
    "a picture": SH % (DRAW + "a.png 120 20 40 60") + MADE,
    "a picture moved a little": SH % (DRAW + "a.png 120 22 42 62") + MADE,
    "a picture of two": SH % (DRAW + "a.png 120 20 40 60; " + DRAW + "b.png 120 1") + "x\n" + MADE,
    "a picture of something else": SH % (DRAW + "b.png 120 1") + "![other](figures/a.png)\n",
}
WRONG = {
    "a command fails": SH % "false\necho a",
    "a command in a pipe fails": SH % "false | cat",
    "not the last command": SH % "tchat run nothing\ntrue",
    "a word is wrong": SH % "echo a b" + TEXT % "a c",
    "a line is missing": SH % "seq 3" + TEXT % "1\n3",
    "wrong order": SH % "seq 3" + TEXT % "3\n...\n1",
    "one line for two": SH % "seq 3" + TEXT % "2\n...\n2",
    "part of a line": SH % "echo ab" + TEXT % "a",
    "output of an earlier block": SH % "echo a" + SH % "echo b" + TEXT % "a",
    "output of nothing": TEXT % "a",
    "Python fails": PYTHON % "1/0",
    "Python says something else": PYTHON % "print(2)" + TEXT % "1",
    "no end": "```sh\ntrue\n",
    "not run by mistake": "    tchat labels q.x\n",
    "another name of the shell": "```bash\ntrue\n```\n",
    "no such file": "[there](nowhere.md)\n",
    "no such heading": "[there](page.md#nowhere)\n# Somewhere\n",
    "a curve less": SH % (DRAW + "a.png 120 20 40") + MADE,
    "a curve more": SH % (DRAW + "a.png 120 20 40 60 80") + MADE,
    "a curve elsewhere": SH % (DRAW + "a.png 120 20 40 65") + MADE,
    "a picture of another size": SH % (DRAW + "a.png 121 20 40 60") + MADE,
    "no picture": SH % "true -o a.png" + MADE,
    "a picture of another name": SH % (DRAW + "b.png 120 20 40 60") + MADE,
    "a picture from elsewhere that differs": SH % (DRAW + "a.png 120 1") + "![other](figures/a.png)\n",
}


def draw(file, width, *rows):
    line, blank = (b"\0" + color * (3 * width) for color in (b"\0", b"\xff"))
    chunks = {b"IHDR": struct.pack(">IIBBBBB", width, 90, 8, 2, 0, 0, 0),
              b"IDAT": zlib.compress(b"".join(line if row in rows else blank for row in range(90))), b"IEND": b""}
    with open(file, "wb") as picture:
        picture.write(b"\x89PNG\r\n\x1a\n")
        for name, data in chunks.items():
            picture.write(struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)))


def status_of(folder, text):
    page = os.path.join(folder, "page.md")
    with open(page, "w") as file:
        file.write(text)
    done = subprocess.run([sys.executable, RUNNER, page, *sys.argv[1:3]], capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


if sys.argv[1] == "-o":
    draw(sys.argv[2], *map(int, sys.argv[3:]))
    sys.exit()
failed = []
with tempfile.TemporaryDirectory() as folder:
    for shown in ("page", "figures"):
        os.mkdir(os.path.join(folder, shown))
        draw(os.path.join(folder, shown, "a.png"), *SHOWN)
    for expected, pages in ((0, RIGHT), (1, WRONG)):
        for name, text in pages.items():
            status, output = status_of(folder, text)
            if status != expected or "Traceback" in output and name != "Python fails":
                failed.append(f"{name}: exit status {status}\n{output}")
if failed:
    sys.exit("\n".join(failed))
print(f"{len(RIGHT)} pages pass, {len(WRONG)} fail")
