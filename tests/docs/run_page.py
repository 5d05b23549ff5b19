"""Runs what a page of the documentation shows, in order, in one fresh folder, and compares what it shows as output.

usage: run_page.py PAGE TCHAT SOURCE [CACHE]   page, executable, root of the repository, folder shared by the pages

    ```sh        run by one bash for the whole page, so that variables and folders last; a failing command fails the page,
                 also within a pipe. `tchat` is on PATH; TCHAT_SOURCE is the root of the repository.
    ```python    run by Python in the folder where the shell is; names last from block to block
    ```text      output of the block before it: these lines, one after the other, somewhere in standard output and standard
                 error together. A line `...` stands for any lines, `...` in a line for any text; blanks count as one.
    ```console   cannot run in a test (it installs, or needs root or the network): counted, and what is said of it
Other blocks are not run. Links to files and to headings must lead somewhere.

A picture FOLDER/NAME.png below an ```sh block that writes `-o NAME.png` is compared with what the block has written:
the same size, and at most UNLIKE of the drawn pixels of either picture without one of about the same colour within
REACH pixels in the other. Equality would be too strict: versions of gnuplot and fonts shift texts and tics, a shown
picture may have fewer colours, and rounding moves the dots of chaotic motion. A missing curve exceeds the tolerance, a
missing letter does not. A picture in a folder with the name of the page must be compared.
"""

import contextlib
import os
import re
import subprocess
import sys
import tempfile
import traceback

PYTHONS = [sys.executable, "/usr/bin/python3"]
REACH, CONTRAST, UNLIKE = 4, 0.3, 0.05
COMMAND = re.compile(r"(    |\t)\s*(\$ |tchat |make |cd |cp |sudo |scripts/|\./)")


class PageError(Exception):
    """What is wrong, with the line of the page."""

    def __init__(self, line, text):
        super().__init__(f"line {line}: {text}")


class Block:
    def __init__(self, kind, line):
        self.kind, self.line, self.lines = kind, line, []

    @property
    def text(self):
        return "\n".join(self.lines) + "\n"


def read_page(path):
    """The blocks between ``` and the other lines with their numbers."""
    blocks, prose, block = [], [], None
    for number, line in enumerate(open(path, encoding="utf-8").read().split("\n"), 1):
        fence = re.match(r"\s*```(.*)", line)
        if fence and block is None:
            block = Block(fence[1].strip(), number)
        elif fence:
            blocks.append(block)
            block = None
        elif block is not None:
            block.lines.append(line)
        else:
            prose.append((number, line))
    if block is not None:
        raise PageError(block.line, "this block does not end")
    return blocks, prose


def check_prose(blocks, prose):
    for number, line in prose:
        if COMMAND.match(line):
            raise PageError(number, f"a command outside of ```sh is not run: {line.strip()}")
    for block in blocks:
        if block.kind in ("bash", "shell", "zsh", "py"):
            raise PageError(block.line, f"```{block.kind} is not run: write ```sh, ```python or ```console")


def anchors(path):
    """What GitHub calls the headings of a page."""
    found = set()
    for _, line in read_page(path)[1]:
        heading = re.match(r"#+ +(.*)", line)
        if heading:
            name = re.sub(r"[^\w\- ]", "", heading[1].strip().lower()).replace(" ", "-")
            count = 0
            while (f"{name}-{count}" if count else name) in found:
                count += 1
            found.add(f"{name}-{count}" if count else name)
    return found


def check_links(path, prose):
    for number, line in prose:
        for target in re.findall(r"\]\(([^)\s]+)\)", line):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, anchor = target.partition("#")
            file = os.path.normpath(os.path.join(os.path.dirname(path), name)) if name else path
            if not os.path.exists(file):
                raise PageError(number, f"the link {target} leads to no file")
            if anchor and anchor not in anchors(file):
                raise PageError(number, f"the link {target} leads to no heading")


def pictures_below(block, blocks, prose):
    """The pictures shown between a block and the next one that runs: number of the line, file as the page names it."""
    later = [other.line for other in blocks if other.line > block.line and other.kind in ("sh", "python")]
    end = min(later, default=float("inf"))
    return [(number, name) for number, line in prose if block.line < number < end
            for name in re.findall(r"!\[[^\]]*\]\(([^)\s]+\.png)\)", line)]


def written_pictures(block):
    return set(re.findall(r"(?<!\S)(?:-o|--output)[ =]?(\S+\.png)", block.text)) if block.kind == "sh" else set()


def share_unlike(picture, other):
    """The share of the drawn pixels of a picture that have no pixel of about their colour within REACH in the other."""
    import numpy
    drawn = (1 - picture).max(axis=2) > CONTRAST
    rows, columns = numpy.nonzero(drawn & (abs(picture - other).max(axis=2) > CONTRAST))
    padded = numpy.pad(other, ((REACH, REACH), (REACH, REACH), (0, 0)), mode="edge")
    unlike = numpy.ones(len(rows), dtype=bool)
    for down in range(2 * REACH + 1):
        for right in range(2 * REACH + 1):
            near = padded[rows + down, columns + right]
            unlike &= abs(picture[rows, columns] - near).max(axis=1) > CONTRAST
    return unlike.sum() / max(drawn.sum(), 1)


def compare_pictures(block, blocks, prose, page):
    """Compares what a block has written with the pictures of the same names below it; returns how many there are."""
    own_folder = os.path.splitext(os.path.basename(page))[0]
    compared = 0
    for number, name in pictures_below(block, blocks, prose):
        made = os.path.basename(name)
        if made not in written_pictures(block):
            if os.path.dirname(name) == own_folder:
                raise PageError(number, f"the block above does not write -o {made}")
            continue
        if not os.path.exists(made):
            raise PageError(number, f"the block above has left no {made}")
        import numpy
        from matplotlib.image import imread
        shown = os.path.join(os.path.dirname(page), name)
        pictures = [numpy.atleast_3d(imread(file))[..., :3] for file in (made, shown)]
        sizes = [f"{picture.shape[1]}x{picture.shape[0]}" for picture in pictures]
        if sizes[0] != sizes[1]:
            raise PageError(number, f"{made} has the size {sizes[0]} when it is made, {sizes[1]} on the page")
        unlike = max(share_unlike(*pictures), share_unlike(*reversed(pictures)))
        if unlike > UNLIKE:
            raise PageError(number, f"{100 * unlike:.1f} % of {made} differs from what the page shows")
        compared += 1
    return compared


def line_pattern(line):
    """A line of a ```text block as a regular expression."""
    parts = [r"\s+".join(re.escape(word) for word in part.split()) for part in line.strip().split("...")]
    return re.compile(r"\s*" + r".*?".join(r"\s*" + part + r"\s*" for part in parts) + r"\s*")


def missing_line(shown, output):
    """The first line of `shown` that the output has not where it should; None when all is there."""
    pieces, piece = [], []
    for line in shown:
        if line.strip() == "...":
            pieces.append(piece)
            piece = []
        else:
            piece.append(line)
    pieces.append(piece)
    at = 0
    for piece in pieces:
        patterns = [line_pattern(line) for line in piece]
        best = 0
        for start in range(at, len(output) - len(patterns) + 1):
            same = 0
            while same < len(patterns) and patterns[same].fullmatch(output[start + same]):
                same += 1
            if same == len(patterns):
                at = start + same
                break
            best = max(best, same)
        else:
            return piece[best]
    return None


class Shell:
    """One bash that runs block after block; what each prints goes to a file outside the page's folder."""

    def __init__(self, scratch):
        self.scratch = scratch
        read_end, write_end = os.pipe()
        self.bash = subprocess.Popen(["bash", "--norc", "-seo", "pipefail", str(write_end)], stdin=subprocess.PIPE,
                                     pass_fds=[write_end], text=True, stderr=subprocess.DEVNULL)
        os.close(write_end)
        self.answers = os.fdopen(read_end)

    def run(self, text):
        """Output and, where the block succeeded, the folder in which the shell is now; else None."""
        block, output = os.path.join(self.scratch, "block"), os.path.join(self.scratch, "output")
        with open(block, "w") as file:
            file.write(text)
        self.bash.stdin.write(f". '{block}' >'{output}' 2>&1 </dev/null\nprintf '%s\\n' \"$PWD\" >&\"$1\"\n")
        self.bash.stdin.flush()
        folder = self.answers.readline().rstrip("\n")
        with open(output, errors="replace") as file:
            return file.read(), folder or None


    def close(self):
        self.bash.stdin.close()
        self.bash.wait()


def run_python(block, page, names, scratch):
    """Output and whether the block ran to its end."""
    sys.stdout.flush()
    kept = os.dup(1), os.dup(2)
    good = True
    with open(os.path.join(scratch, "output"), "w+", errors="replace") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
        try:
            exec(compile("\n" * block.line + block.text, page, "exec"), names)
        except (Exception, SystemExit):
            traceback.print_exc()
            good = False
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os.dup2(kept[0], 1)
            os.dup2(kept[1], 2)
        file.seek(0)
        return file.read(), good


def run_blocks(blocks, prose, page, scratch, shell):
    """Runs the page; returns how many pictures it has compared."""
    names, shown_by, output, compared = {"__name__": "__main__"}, None, "", 0
    for block in blocks:
        if block.kind in ("sh", "python"):
            if block.kind == "sh":
                output, folder = shell.run(block.text)
                good = folder is not None
                if good:
                    os.chdir(folder)
            else:
                output, good = run_python(block, page, names, scratch)
            if not good:
                raise PageError(block.line, f"this block failed. It is\n{block.text}and says\n{output}")
            shown_by = block
            compared += compare_pictures(block, blocks, prose, page)
        elif block.kind == "console":
            shown_by = block
        elif block.kind == "text":
            if shown_by is None:
                raise PageError(block.line, "no block before this one has an output that ```text could show")
            missing = None if shown_by.kind == "console" else missing_line(block.lines, output.split("\n"))
            if missing is not None:
                raise PageError(block.line, f"the output of the block at line {shown_by.line} does not go on with\n"
                                            f"{missing}\nIt is\n{output}")
    return compared


def with_numpy():
    """Starts again with an interpreter that has numpy and matplotlib, unless this one has them."""
    try:
        import matplotlib  # noqa: F401
        import numpy  # noqa: F401
    except ImportError:
        for python in PYTHONS[1:]:
            if python != sys.executable and os.path.exists(python):
                os.execv(python, [python] + sys.argv)


def main():
    page, tchat, source = (os.path.abspath(word) for word in sys.argv[1:4])
    blocks, prose = read_page(page)
    check_prose(blocks, prose)
    check_links(page, prose)
    if any("python" in block.kind or block.kind == "sh" and ("python" in block.text or written_pictures(block))
           for block in blocks):
        with_numpy()
    with tempfile.TemporaryDirectory(prefix="tchat_page_") as scratch:
        for folder in ("bin", "page"):
            os.mkdir(os.path.join(scratch, folder))
        os.symlink(tchat, os.path.join(scratch, "bin", "tchat"))
        os.symlink(sys.executable, os.path.join(scratch, "bin", "python3"))
        os.environ["PATH"] = os.path.join(scratch, "bin") + os.pathsep + os.environ["PATH"]
        os.environ.update(TCHAT_SOURCE=source, PYTHONPATH=os.path.join(source, "src", "python"), LC_ALL="C.UTF-8",
                          MPLBACKEND="Agg")
        sys.path.insert(0, os.environ["PYTHONPATH"])
        os.environ.pop("DISPLAY", None)
        if len(sys.argv) > 4:
            os.environ["XDG_CACHE_HOME"] = os.path.abspath(sys.argv[4])
        os.chdir(os.path.join(scratch, "page"))
        try:
            with contextlib.closing(Shell(scratch)) as shell:
                compared = run_blocks(blocks, prose, page, scratch, shell)
        finally:
            os.chdir("/")
    count = {kind: sum(block.kind == kind for block in blocks) for kind in ("sh", "python", "text", "console")}
    print(f"{os.path.relpath(page, source)}: {count['sh']} shell and {count['python']} Python blocks run, "
          f"{count['text']} outputs and {compared} pictures compared, "
          f"{count['console']} blocks that cannot run in a test")


if __name__ == "__main__":
    try:
        main()
    except PageError as error:
        sys.exit(f"{sys.argv[1]}: {error}")
