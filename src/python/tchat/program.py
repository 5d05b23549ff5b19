"""Runs the program tchat: its words, its messages as errors and warnings, Ctrl-C, progress."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import warnings

_POLL_SECONDS = 0.1
_QUIET_SECONDS = 1.0  # a run that is over by then tells nothing


class Error(Exception):
    """What was wrong and what to do; of a command of tchat its own message, with the exit status and the screen."""

    def __init__(self, message, status=None, screen=""):
        super().__init__(message)
        self.status = status
        self.screen = screen


class TchatWarning(UserWarning):
    """What tchat warned of."""


class Report(str):
    """What a command has printed; `passed` is False where it tells by its exit status that something is not so."""

    passed = True

    def __repr__(self):
        return str(self)


def find_program(program=None):
    """The path of tchat: `program`, else the environment variable TCHAT, else tchat on PATH."""
    program = program or os.environ.get("TCHAT", "tchat")
    found = shutil.which(program)
    if found is None:
        raise Error("%s: there is no such program on PATH; give program= or the environment variable TCHAT the path of "
                    "tchat" % program)
    return os.path.abspath(found)


def _own_message(text):
    """tchat's own message, without its warnings, which become warnings here."""
    message, in_message = [], False
    for line in text.splitlines():
        if line.startswith("tchat: warning: "):
            in_message = False
            warnings.warn(line[len("tchat: warning: "):], TchatWarning, stacklevel=4)
        elif line.startswith("tchat: ") or in_message:
            in_message = True
            message.append(line[len("tchat: "):] if line.startswith("tchat: ") else line)
    return "\n".join(message)


def _wait(process, poll):
    """Waits for the end, calling poll() now and then; SIGINT once it returns False. Was it sent?"""
    stopped = False
    while True:
        try:
            process.wait(_POLL_SECONDS)
        except subprocess.TimeoutExpired:
            pass
        ended = process.poll() is not None
        if not stopped and poll() is False:
            stopped = True
            if not ended:
                process.send_signal(signal.SIGINT)
        if ended:
            return stopped


def execute(words, cwd=None, program=None, poll=lambda: True, accepted=(0,)):
    """Runs tchat to its end: what it printed, as a Report. Exit statuses that are not among `accepted` raise Error.

    poll() is called now and then; when it returns False, or Ctrl-C comes, the command ends as after Ctrl-C in a
    terminal, with complete files.
    """
    words = [str(word) for word in words]
    for word in words:
        if "\0" in word:
            raise Error("the argument %r has a zero byte in it, which no program can be given; leave it out" % word)
    with tempfile.TemporaryFile() as screen, tempfile.TemporaryFile() as errors:
        process = subprocess.Popen([find_program(program)] + words, stdin=subprocess.DEVNULL, stdout=screen,
                                   stderr=errors, cwd=cwd)
        try:
            stopped = _wait(process, poll)
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
                process.wait()
        texts = []
        for file in (screen, errors):
            file.seek(0)
            texts.append(file.read().decode("utf-8", "replace"))
    message = _own_message(texts[1])
    if process.returncode not in accepted and not (stopped and process.returncode == 130):
        raise Error(message or "tchat ended with the exit status %d" % process.returncode, process.returncode, texts[0])
    report = Report(texts[0])
    report.passed = process.returncode == 0
    return report


def constant_word(key, value):
    """KEY=VALUE as tchat reads it: lists and dictionaries in its own form."""
    return "%s=%s" % (key, _value_text(value))


def _value_text(value):
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, dict):
        return "{%s}" % ", ".join("%s: %s" % (key, _value_text(one)) for key, one in value.items())
    if isinstance(value, (list, tuple)):
        return "[%s]" % ", ".join(_value_text(one) for one in value)
    if hasattr(value, "tolist"):  # of numpy
        return _value_text(value.tolist())
    return str(value)


class Progress:
    """A point as a run writes it: point.number, point.value (of the first free parameter), point.label (0: none),
    point.stable."""

    def __init__(self, words):
        self.number, self.stable = abs(int(words[1])), int(words[1]) < 0
        self.label, self.value = int(words[3]), float(words[4])

    def __repr__(self):
        return "point %d: %.6g%s" % (self.number, self.value, ", label %d" % self.label if self.label else "")


class GrowingFile:
    """The whole lines that a command adds to a file, as they come."""

    def __init__(self, path, append=False):
        self._path, self._old, self._offset, self._rest = path, None, 0, ""
        try:
            state = os.stat(path)
        except (OSError, ValueError):  # none yet, or no name of a file, which execute() says
            return
        if append:
            with open(path, "rb") as file:
                self._offset = file.read().rfind(b"\n") + 1
        else:
            self._old = state.st_ino

    def new_lines(self):
        try:
            with open(self._path, encoding="latin-1", newline="") as file:
                if os.fstat(file.fileno()).st_ino == self._old:
                    return  # of the run before
                file.seek(self._offset)
                text = file.read()
                self._offset = file.tell()
        except OSError:
            return
        lines = (self._rest + text).split("\n")
        self._rest = lines.pop()
        yield from map(str.split, lines)


class GrowingPoints(GrowingFile):
    """The points that a run adds to its p-file, as they come."""

    def new_points(self):
        for words in self.new_lines():
            if len(words) > 4 and words[0] != "0":
                yield Progress(words)


class GrowingSweep(GrowingFile):
    """How many values a sweep has in its journal."""

    def __init__(self, path):
        super().__init__(path + ".journal", append=True)
        self._done = 0

    def show(self, bar):
        for words in self.new_lines():
            self._done += words[:1] != ["#"] and words[1:2] != ["0"]  # start 0: attractors known beforehand
        if self._done:
            bar("%d values" % self._done)
        return True


class ProgressBar:
    """One line on the standard error that tells how far a long run is; nothing where nobody watches."""

    def __init__(self, name):
        self._name, self._begin, self._width = name, time.monotonic(), 0
        self._watched = sys.stderr.isatty() or "ipykernel" in sys.modules

    def __call__(self, point):
        if not self._watched or time.monotonic() - self._begin < _QUIET_SECONDS:
            return
        text = "%s: %s" % (self._name, point)
        sys.stderr.write("\r" + text.ljust(self._width))
        sys.stderr.flush()
        self._width = len(text)

    def close(self):
        if self._width:
            sys.stderr.write("\r%s\r" % (" " * self._width))
            sys.stderr.flush()
