#!/usr/bin/env python3
"""The same problem in other words has the same diagram.

Each system is rewritten at random: states and parameters in other units, x = s y, time in another unit, event functions
with positive factors, a state on which nothing depends, parameters in another order. Simulation must find the same
orbit, and a run from it the same special points: types, values, stability, numbers of points.

Steps are compared with weights that are rewritten like everything else: THU and THL are given, as shares of the sizes
of states and of the range of the parameter.
"""

import argparse
import pathlib
import random
import re
import subprocess
import sys

import foreign_systems

# Of located points: the discretisation is the same, and Newton's method ends at a relative accuracy of 1e-10.
SAME_VALUE = 1e-8
SAME_STEPS = 0.2
POINTS = 60


class Rewriting:
    """Factors of states (and of the idle one), parameters, time and events."""

    def __init__(self, draw, decades):
        def factor():
            return 10.0**draw.uniform(-decades, decades)

        self.draw = draw
        self.time = factor()
        self.units = {}
        self.factor = factor

    def of(self, name):
        if name not in self.units:
            self.units[name] = self.factor()
        return self.units[name]


class Unchanged(Rewriting):
    def __init__(self):
        super().__init__(random.Random(0), 0)


def items(text):
    """'a=1, b=8/3' as [('a', '1'), ('b', '8/3')]."""
    return [tuple(part.strip() for part in item.split("=", 1)) for item in text.split(",")]


def new_name(name):
    return name + "_r"


def rewritten(formulas, by, idle):
    """The file of formulas in other units; `idle`: a state that nothing depends on, if any, as its value."""
    states = set(re.findall(r"(\w+)'\s*=", formulas))
    lines, definitions = [], []
    for line in formulas.splitlines():
        head = re.match(r"(par|init)\s+(.*)", line)
        if head:
            listed = items(head[2])
            if head[1] == "par":
                by.draw.shuffle(listed)
                definitions += ["%s = %r*%s" % (name, by.of(name), new_name(name)) for name, _ in listed]
            lines.append("%s %s" % (head[1], ", ".join("%s=(%s)/%r" % (new_name(name), value, by.of(name))
                                                       for name, value in listed)))
            continue
        jump = re.match(r"jump (\w+):(.*)", line)
        if jump:
            changes = re.findall(r"(\w+) -> ([^,]+)", jump[2])
            changed = ", ".join("%s -> (%s)/%r" % (new_name(x), value, by.of(x)) for x, value in changes)
            lines.append("jump %s: %s" % (jump[1], changed))
            continue
        event = re.match(r"event (\w+) = (.*)", line)
        if event:
            lines.append("event %s = %r*(%s)" % (event[1], by.of("event " + event[1]), event[2]))
            continue
        lines.append(re.sub(r"(\w+)'\s*= (.*)",
                            lambda m: "%s' = %r*(%s)" % (new_name(m[1]), by.time / by.of(m[1]), m[2]), line))
    definitions += ["%s = %r*%s" % (name, by.of(name), new_name(name)) for name in sorted(states)]
    first = next(k for k, line in enumerate(lines) if line.startswith("init")) + 1
    if idle is not None:
        lines[first - 1] += ", idle=%r" % idle
        lines.insert(first, "idle' = %r*(%r - idle)" % (by.time, idle))
    return "\n".join(lines[:first] + definitions + lines[first:]) + "\n"


def rewritten_option(option, by):
    parameter = re.fullmatch(r"PAR\((\w+)\)=(.*)", option)
    if parameter:
        return "PAR(%s)=%r" % (new_name(parameter[1]), float(parameter[2]) / by.of(parameter[1]))
    if "=" not in option:
        return option
    return ",".join("%s=%r" % (new_name(name), float(value) / by.of(name)) for name, value in items(option))


class Diagram:
    """What a simulation and a run from its orbit have found, in the units of the original."""

    def __init__(self, tchat, folder, system, by, idle, sizes):
        formulas, options, parameter, bounds = system
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "system.tch").write_text(rewritten(formulas, by, idle))
        self.tchat = tchat
        self.run("simulate", "system", *[rewritten_option(option, by) for option in options], "--dat", "s", "--wait",
                 repr(1000 / by.time), "--rows", "0")
        self.start = self.states()
        name, unit, width = new_name(parameter), by.of(parameter), bounds[1] - bounds[0]
        scale = sizes or {state: size * by.of(state) for state, size in self.start.items() if state != "idle"}
        self.sizes, self.width = scale, width
        order = list(self.start)
        weights = ", ".join("%d: %r" % (order.index(x) + 1, (by.of(x) / size)**2) for x, size in scale.items())
        self.run("run", "system", "-c", "s", "-d", "s", "-o", "b", "--both", "--clip", "-q", "ICP=[%s]" % name,
                 "THU={%s}" % weights, "THL={%s: %r%s}" % (name, (unit / width)**2, self.durations()),
                 "DS=0.005", "DSMAX=0.03",
                 "NMX=%d" % POINTS, "RL0=%r" % (bounds[0] / unit), "RL1=%r" % (bounds[1] / unit))
        self.sections = self.points(unit, by.time)

    def run(self, *words):
        done = subprocess.run([self.tchat, *words], cwd=self.folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError("%s: %s" % (" ".join(words), done.stderr.strip() or done.stdout.strip()))

    def durations(self):
        """The weight 0 for each of them, as simulation writes it for one."""
        text = (self.folder / "s.dat").read_text()
        return "".join(", %s: 0" % k for k in re.findall(r"# PAR\((6[1-9]|[7-9]\d)\)", text))

    def states(self):
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

    def points(self, unit, time):
        """For each section its special points (type, stable, parameter, period) and how many points it has."""
        sections, period = {}, None
        for line in (self.folder / "p.b").read_text().splitlines():
            words = line.split()
            if "PERIOD" in words:
                period = words.index("PERIOD") - len(words)
            if not words or words[0] == "0" or period is None:
                continue
            branch, point, kind, label = (int(word) for word in words[:4])
            section = sections.setdefault(branch, {"labels": [], "points": 0})
            section["points"] = abs(point)
            if label != 0 and abs(kind) not in (0, 4, 9):
                section["labels"].append((kind, point < 0, float(words[4]) * unit, float(words[period]) * time))
        return sections


def close(a, b, size=0.0):
    return abs(a - b) <= SAME_VALUE * max(abs(a), abs(b), size)


def differences(original, other):
    """Sentences."""
    found = []
    if original.sections.keys() != other.sections.keys():
        return ["sections %s for %s" % (sorted(other.sections), sorted(original.sections))]
    for branch, section in original.sections.items():
        changed = other.sections[branch]
        kinds = [label[:2] for label in section["labels"]]
        if kinds != [label[:2] for label in changed["labels"]]:
            found.append("labels %s for %s" % ([label[0] for label in changed["labels"]],
                                               [label[0] for label in section["labels"]]))
            continue
        for (kind, _, value, period), (_, _, value_there, period_there) in zip(section["labels"], changed["labels"]):
            if not close(value, value_there, original.width) or not close(period, period_there):
                found.append("type %d at %.12g, period %.12g, for %.12g, %.12g" % (kind, value_there, period_there,
                                                                                   value, period))
        if abs(changed["points"] - section["points"]) > SAME_STEPS * section["points"]:
            found.append("%d points for %d" % (changed["points"], section["points"]))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tchat", type=pathlib.Path)
    parser.add_argument("--folder", type=pathlib.Path, required=True, help="for the files of all runs")
    parser.add_argument("--count", type=int, default=300, help="rewritings, in turn of all systems")
    parser.add_argument("--decades", type=float, default=9.0, help="units are from 10^-N to 10^N")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("systems", nargs="*", help="names; all without")
    options = parser.parse_args()
    tchat = str(options.tchat.resolve())
    names = options.systems or list(foreign_systems.FOREIGN)
    originals, wrong = {}, 0
    for k in range(options.count):
        name = names[k % len(names)]
        system = foreign_systems.FOREIGN[name]
        try:
            if name not in originals:
                originals[name] = Diagram(tchat, options.folder / name, system, Unchanged(), None, None)
        except RuntimeError as error:
            print("%s: %s" % (name, error))
            return 1
        draw = random.Random("%d %s %d" % (options.seed, name, k))
        by = Rewriting(draw, options.decades)
        idle = draw.choice([None, 10.0**draw.uniform(-options.decades, options.decades)])
        folder = options.folder / ("%s_%d" % (name, k))
        try:
            found = differences(originals[name], Diagram(tchat, folder, system, by, idle, originals[name].sizes))
        except RuntimeError as error:
            found = [str(error)]
        wrong += bool(found)
        for text in found:
            print("%s, rewriting %d: %s" % (name, k, text[:300]), flush=True)
    labels = sum(len(section["labels"]) for diagram in originals.values() for section in diagram.sections.values())
    print("%d of %d rewritings of %d systems have the same diagram (%d special points)." %
          (options.count - wrong, options.count, len(originals), labels))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
