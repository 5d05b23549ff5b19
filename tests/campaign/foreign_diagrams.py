"""Systems of foreign_systems.py as they are or written in other words, and their diagrams."""

import json
import re
import subprocess

import problem_pipelines
import rewriting
from rewriting import items

POINTS = 60


def new_name(name):
    return name + "_r"


def rewritten(formulas, by):
    """The file of formulas in other units, perhaps with a state that nothing depends on."""
    states = set(re.findall(r"(\w+)'\s*=", formulas))

    def unit(name):
        return by.of("states" if name in states else "parameters", name)
    lines, definitions = [], []
    for line in formulas.splitlines():
        head = re.match(r"(par|init)\s+(.*)", line)
        if head:
            listed = items(head[2])
            if head[1] == "par":
                listed = by.order("parameters", listed)
                definitions += ["%s = %r*%s" % (name, unit(name), new_name(name)) for name, _ in listed]
            lines.append("%s %s" % (head[1], ", ".join("%s=(%s)/%r" % (new_name(name), value, unit(name))
                                                       for name, value in listed)))
            continue
        jump = re.match(r"jump (\w+):(.*)", line)
        if jump:
            changes = re.findall(r"(\w+) -> ([^,]+)", jump[2])
            changed = ", ".join("%s -> (%s)/%r" % (new_name(x), value, unit(x)) for x, value in changes)
            lines.append("jump %s: %s" % (jump[1], changed))
            continue
        event = re.match(r"event (\w+) = (.*)", line)
        if event:
            lines.append("event %s = %r*(%s)" % (event[1], by.of("events", event[1]), event[2]))
            continue
        lines.append(re.sub(r"(\w+)'\s*= (.*)",
                            lambda m: "%s' = %r*(%s)" % (new_name(m[1]), by.time / unit(m[1]), m[2]), line))
    definitions += ["%s = %r*%s" % (name, unit(name), new_name(name)) for name in sorted(states)]
    first = next(k for k, line in enumerate(lines) if line.startswith("init")) + 1
    if by.idle is not None:
        lines[first - 1] += ", idle=%r" % by.idle
        lines.insert(first, "idle' = %r*(%r - idle)" % (by.time, by.idle))
    return "\n".join(lines[:first] + definitions + lines[first:]) + "\n"


class Diagram:
    """What a simulation and a run from its orbit have found, in the units of the original."""

    def __init__(self, tchat, folder, system, by, sizes):
        formulas, options, parameter, bounds = system
        self.tchat, self.folder, self.by = tchat, folder, by
        self.states = set(re.findall(r"(\w+)'\s*=", formulas))
        self.failed, self.said, self.sections, self.sizes = {}, {}, {}, sizes
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "system.tch").write_text(rewritten(formulas, by))
        before = problem_pipelines.user_seconds()
        self.steps = ["simulate s", "run b"]
        try:
            self.call("simulate s", "simulate", "system", *[self.option(option) for option in options], "--dat", "s",
                      "--wait", repr(1000 / by.time), "--rows", "0")
            self.rotate()
            self.sizes = sizes or self.sizes_of_states()
            name, unit, width = new_name(parameter), by.of("parameters", parameter), bounds[1] - bounds[0]
            order = list(self.sizes_of_states())
            weights = ", ".join("%d: %r" % (order.index(x) + 1, (self.unit(x) / size)**2)
                                for x, size in self.sizes.items() if x != "idle")
            self.call("run b", "run", "system", "-c", "s", "-d", "s", "-o", "b", "--both", "--clip",
                      "ICP=[%s]" % name, "THU={%s}" % weights,
                      "THL={%s: %r%s}" % (name, (unit / width)**2, self.durations()), "DS=0.005", "DSMAX=0.03",
                      "NMX=%d" % POINTS, "EPSL=1e-10", "EPSU=1e-10", "EPSS=1e-9",
                      "RL0=%r" % (bounds[0] / unit), "RL1=%r" % (bounds[1] / unit))
            rows = json.loads(self.call(None, "table", "--json", "p.b"))
            self.sections["run b"] = problem_pipelines.sections_of(rows, {name: unit, "PERIOD": by.time})
        except problem_pipelines.CommandFailed:
            pass
        self.seconds = problem_pipelines.user_seconds() - before

    def unit(self, name):
        return self.by.of("states" if name in self.states else "parameters", name)

    def option(self, option):
        parameter = re.fullmatch(r"PAR\((\w+)\)=(.*)", option)
        if parameter:
            return "PAR(%s)=%r" % (new_name(parameter[1]), float(parameter[2]) / self.unit(parameter[1]))
        if "=" not in option:
            return option
        return ",".join("%s=%r" % (new_name(name), float(value) / self.unit(name)) for name, value in items(option))

    def call(self, step, *words):
        done = subprocess.run([self.tchat, *words], cwd=self.folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            self.failed[step] = (done.stderr or done.stdout).strip()
            raise problem_pipelines.CommandFailed(self.failed[step])
        if step:
            self.said[step] = problem_pipelines.verdicts(done.stdout)
        return done.stdout

    def rotate(self):
        """The orbit that was found, another segment first."""
        data, constants = self.folder / "s.dat", self.folder / "gc.s"
        found = rewriting.constants_of(self.call(None, "constants", "s", "--keyword"))
        by = self.by.rotation(len(rewriting.list_of(found["GCFIND"])))
        if by:
            data.write_text(rewriting.rotated_data(data.read_text(), by))
            constants.write_text(rewriting.text_of_constants(rewriting.rotated_constants(found, by)))

    def durations(self):
        """The weight 0 for each of them, as simulation writes it for one."""
        text = (self.folder / "s.dat").read_text()
        return "".join(", %s: 0" % k for k in re.findall(r"# PAR\((6[1-9]|[7-9]\d)\)", text))

    def sizes_of_states(self):
        """The largest |x| of each state of the orbit in s.dat."""
        names, rows = [], []
        for line in (self.folder / "s.dat").read_text().splitlines():
            if line.startswith("#"):
                continue
            rows.append([float(word) for word in line.split()])
        text = (self.folder / "system.tch").read_text()
        for name in re.findall(r"(\w+)'\s*=", text):
            if name not in names:
                names.append(name)  # states are numbered as their equations come
        columns = list(zip(*rows))[1:]
        sizes = {}
        for k, column in enumerate(columns):
            name = names[k % len(names)].removesuffix("_r")
            sizes[name] = max(sizes.get(name, 0.0), max(abs(value) for value in column))
        return {name: size or 1.0 for name, size in sizes.items()}
