"""The pipelines of problems/*/Makefile, run with the problem as it is or written in other words.

The commands are those that `make -n` prints for the targets of pipeline_labels.py. Commands that only show results are
left out.
"""

import json
import os
import pathlib
import re
import resource
import shlex
import subprocess

import pipeline_labels
import rewriting

OPTIONS_WITH_VALUE = {"-c", "-p", "-d", "-s", "-o", "--to", "--signature", "--state", "--transient-events", "--events",
                      "--transient-time", "--rows", "--tolerance", "--dat", "--torus", "--free", "--wait", "--by"}
OPTIONS_OF_TIME = {"--transient-time", "--time"}
WAIT = 1000.0
TIME_LIMIT = 600
# Types of points that say where a branch ends or that every so many points is labelled; their values are not located.
NOT_LOCATED = {"EP", "MX", "RG"}
# `check` of the limit of its impacts takes minutes. Units of chatter have tests of their own (tests/model/chatter_test.cpp).
NOT_REWRITTEN = {"valve"}


class CommandFailed(Exception):
    """The command and what it said."""


def problems(source):
    """Names of the problems that are written in C++ and have a pipeline."""
    names = sorted(folder.name for folder in (source / "problems").iterdir() if folder.is_dir())
    return [name for name in names
            if (source / "problems" / name / (name + ".cpp")).exists() and name not in NOT_REWRITTEN]


def commands(source, name):
    """The words of each command that computes something, and the texts of shell commands that write data."""
    home = source / "problems" / name
    if not (home / "Makefile").exists():
        return [["tchat"] + shlex.split(text) for text in pipeline_labels.SINGLE_RUNS[name]]
    targets = ["all"] + pipeline_labels.MORE_TARGETS.get(name, [])
    printed = subprocess.run(["make", "-n", "--no-print-directory", "TCHAT=tchat", "OUT=.", "figures=", *targets],
                             cwd=home, capture_output=True, text=True, check=True).stdout
    found = []
    for text in printed.replace("\\\n", " ").splitlines():
        text = text.removeprefix("cd . && ")
        if re.match(r"(printf|echo) .*> \S+\.dat$", text):
            found.append(text)
        elif re.match(r"tchat (run|simulate|resegment) ", text):
            found.append(shlex.split(text))
    return found


def user_seconds():
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


class Pipeline:
    """One run of a pipeline in a folder of its own."""

    def __init__(self, tchat, source, name, folder, by):
        self.tchat, self.source, self.name, self.folder, self.by = tchat, source, name, folder, by
        home = source / "problems" / name
        self.commands = commands(source, name)
        self.problem = rewriting.ProblemRewriting(home / (name + ".cpp"), by)
        self.rotation_allowed = not any("HOLD" in word and value in word for words in self.commands
                                        for word in words for value in self.problem.values)
        self.steps, self.failed, self.said, self.sections = ["check"], {}, {}, {}
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "plugin").mkdir(exist_ok=True)
        generic = pathlib.Path(__file__).resolve().parent / "rewritten_problem.cpp"
        plugin = folder / "plugin" / (name + ".cpp")
        plugin.write_text(self.problem.plugin(os.path.relpath(generic, plugin.parent)))
        self.check()
        before = user_seconds()
        for words in self.commands:
            self.perform(words)
        self.seconds = user_seconds() - before

    def call(self, words):
        done = subprocess.run([self.tchat, *words], cwd=self.folder, capture_output=True, text=True, check=False,
                              timeout=TIME_LIMIT)
        if done.returncode != 0:
            raise CommandFailed("exit status %d: %s" % (done.returncode, (done.stderr or done.stdout).strip()))
        return done.stdout

    def check(self):
        """Compiles the problem; its derivatives are those of differences."""
        try:
            self.call(["check", "plugin/" + self.name])
        except CommandFailed as error:
            self.failed["check"] = str(error)

    def perform(self, words):
        if isinstance(words, str):
            subprocess.run(words, shell=True, cwd=self.folder, check=True)
            path = self.folder / words.split()[-1]
            path.write_text(self.problem.data(path.read_text()))
            return
        output = words[words.index("-o") + 1] if "-o" in words else self.name
        step = "%s %s" % (words[1], output)
        self.steps.append(step)
        try:
            changed = self.rewritten(words)
            with open(self.folder / "commands", "a", encoding="utf-8") as log:
                log.write("tchat " + shlex.join(changed) + "\n")
            said = self.call(changed)
        except (CommandFailed, subprocess.TimeoutExpired) as error:
            self.failed[step] = str(error)
            return
        if words[1] in ("run", "simulate"):
            self.said[step] = verdicts(said)
        if words[1] == "run":
            units = {name: self.problem.unit(name) for name in self.problem.parameters}
            if self.read_constants("r." + output)["IPS"] not in ("182", "152"):
                units["PERIOD"] = self.by.time  # of a torus it is a sum over as many orbits as are stored
            rows = json.loads(self.call(["table", "--json", "p." + output]))
            self.sections[step] = sections_of(rows, {"rho": 1.0, **units})
        if "--dat" in words:
            self.rotate(words[words.index("--dat") + 1])

    def rotate(self, name):
        """The starting data of a simulation, and their constants."""
        data, constants = self.folder / (name + ".dat"), self.folder / ("gc." + name)
        found = rewriting.constants_of(self.call(["constants", constants.name, "--keyword"]))
        by = self.rotation(found)
        if by:
            data.write_text(rewriting.rotated_data(data.read_text(), by))
            constants.write_text(rewriting.text_of_constants(rewriting.rotated_constants(found, by)))

    def rotation(self, constants):
        segments = len(rewriting.list_of(constants.get("GCFIND", "[1]")))
        return self.by.rotation(segments) if self.rotation_allowed and constants["IPS"] == "180" else 0

    def constants_file(self, path, starts_from_data):
        """The name of the file in the folder. It is written at first use, unless a simulation has written it."""
        original = pathlib.Path(path)
        if not original.is_absolute():
            local = self.source / "constants" / self.name / ("gc." + path)
            if (self.folder / ("gc." + path)).exists() or not local.exists():
                return path
            data = local.parent / (path + ".dat")
            if data.exists():
                (self.folder / data.name).write_text(self.problem.data(data.read_text()))
            original, target = local, self.folder / local.name
        else:
            target = self.folder / "constants" / original.name
        if not target.exists():
            target.parent.mkdir(exist_ok=True)
            found = rewriting.constants_of(self.call(["constants", str(original), "--keyword"]))
            by = self.rotation(found) if starts_from_data else 0
            target.write_text(rewriting.text_of_constants(self.problem.constants(found, by)))
        return str(target.relative_to(self.folder))

    def read_constants(self, file):
        return rewriting.constants_of(self.call(["constants", file, "--keyword"]))

    def rewritten(self, words):
        """The words of a command that does the same for the rewritten problem."""
        command, by = words[1], self.by
        file, changed, settings, k = None, [command], {}, 2
        while k < len(words):
            word = words[k]
            if word == "-c":
                k += 1
                file = self.constants_file(words[k], "-d" in words)
            elif word == "-p":
                k += 1
            elif word in OPTIONS_OF_TIME:
                k += 1
                changed += [word, repr(float(words[k]) / by.time)]
            elif word == "--state":
                k += 1
                changed += [word, ",".join("%s=%r" % (name, float(value) / self.problem.unit(name))
                                           for name, value in rewriting.items(words[k]))]
            elif word in OPTIONS_WITH_VALUE:
                changed += words[k:k + 2]
                k += 1
            elif re.match(r"[A-Z0-9]+(\([^)]*\))?=", word):
                key, text = word.split("=", 1)
                settings[key] = text
            elif word != "-q" and not os.path.isabs(word):
                changed.append(word)
            elif os.path.isabs(word):
                changed.append("plugin/" + self.name)
            k += 1
        if command == "run" and file is None:
            file = self.constants_file(self.name, True)
        if not any("plugin/" in word for word in changed):
            changed += ["-p", "plugin/" + self.name]
        if file:
            changed += ["-c", file]
        if command == "simulate":
            changed += ["--wait", repr(WAIT / by.time)]
            if "--dat" in words and file is None:
                changed += ["--free", self.problem.parameters[0]]
        constants = self.constants_of_command(command, file, words)
        before = self.problem.new_name((rewriting.list_of(constants.get("ICP", "")) or ["?"])[0])
        first = self.problem.name_of((rewriting.list_of(settings.get("ICP", "")) or [before])[0])
        if first != before:  # the bounds of the file are now those of another parameter
            for key in ("RL0", "RL1"):
                if key in constants and key not in settings and abs(float(constants[key])) < rewriting.NO_BOUND:
                    settings[key] = repr(float(constants[key]) * self.problem.unit(before))
        segments = len(rewriting.list_of(constants.get("GCFIND", "[1]")))
        rotation = self.rotation(constants) if constants.get("IPS") == "180" else 0
        settings = {key: self.problem.constant(key, text, first, segments, rotation if "start(" in text else 0)
                    for key, text in settings.items()}
        changed += ["%s=%s" % pair for pair in settings.items()]
        if command == "run":
            constants.update(settings)
            changed += self.problem.weights(constants)
        return changed

    def constants_of_command(self, command, file, words):
        """The constants, already rewritten, that a command starts from."""
        if command == "resegment":
            label_file = next(word for word in words[2:] if word.startswith("q."))
            return self.read_constants("r." + label_file[2:])
        return self.read_constants(file) if file else {}


def sections_of(rows, units):
    """For each part of a branch its labels, with values in the original's units, and how many points it has."""
    sections = {}
    for row in rows:
        section = sections.setdefault(row["section"], {"labels": [], "points": 0})
        section["points"] = abs(row["point"])
        values = {name: row[name] * unit for name, unit in units.items() if isinstance(row.get(name), float | int)}
        section.setdefault("values", []).append(values)
        if row["label"] and row["type"] != "RG":
            section["labels"].append({"type": row["type"], "stable": row["stable"], "admissible": row["admissible"],
                                      "values": values})
    return sections


def verdicts(text):
    """Words of the summary of a command that say what an orbit, a normal form or the end of a branch is."""
    found = []
    for line in text.splitlines():
        normal_form = re.match(r"\s+normal form .*?, ([a-z][^:]*)", line)
        if normal_form:
            found.append("normal form: " + normal_form[1])
        stopped = re.match(r"\s+stopped: (.*)", line)
        if stopped:
            found.append("stopped: " + re.split(r"[:;(,]", re.sub(r"(?<!\w)[-+]?\d[\d.e+-]*", "#", stopped[1]))[0])
        if re.match(r"Periodic orbit|Events accumulate|The motion|No periodic", line):
            found.append(re.split(r"[,:]", line)[0])
        stable = re.match(r"\s+multipliers .*: (\w+)$", line)
        if stable:
            found.append("orbit " + stable[1])
    return found
