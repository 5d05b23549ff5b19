#!/usr/bin/env python3
"""The same problem in other words has the same diagrams.

The problems of `problems`, with the pipelines of their Makefiles, and the systems of foreign_systems.py are rewritten
at random: states, parameters, time and user values in other units, x = s y, event functions times positive factors,
states and parameters in another order, a state on which nothing depends, the segments of orbits in cyclic order. Every
command must find what it finds for the original: special points with their types, values and stability, verdicts,
numbers of points.

Steps are compared with weights that are rewritten like everything else: THU and THL are given. Those of pipelines are 1
in the units of the original, those of other systems are shares of the sizes of states and of the range of the
parameter.
"""

import argparse
import pathlib
import shutil
import sys

import foreign_diagrams
import foreign_systems
import problem_pipelines
import rewriting

# Of located points: the discretisation is the same, and Newton's method ends at a relative accuracy of 1e-10.
SAME_VALUE = 1e-8
SAME_STEPS = 0.2
SAME_SECONDS = 1.5
# In a shorter campaign that is the time of compilers, and chance.
LEAST_SECONDS = 60.0
# Differences of one rewriting that are printed. What a command has found differently is where the next ones start.
PRINTED = 3


def close(a, b, size):
    return abs(a - b) <= SAME_VALUE * max(abs(a), abs(b), size)


def sizes(diagram):
    """The largest value of each quantity on all branches."""
    found = {}
    for sections in diagram.sections.values():
        for section in sections.values():
            for values in section["values"]:
                for name, value in values.items():
                    found[name] = max(found.get(name, 0.0), abs(value))
    return found


def differences_of_section(section, changed, size):
    """Sentences; `size`: of each quantity."""
    def kinds(some):
        return [(label["type"], label["stable"], label["admissible"]) for label in some["labels"]]
    if kinds(section) != kinds(changed):
        texts = [" ".join(kind + "u" * (stable is False) + "!" * (admissible is False)
                          for kind, stable, admissible in kinds(some)) for some in (changed, section)]
        return ["labels %s (u: unstable) for %s" % tuple(texts)]
    found = []
    for label, other in zip(section["labels"], changed["labels"]):
        if label["type"] in problem_pipelines.NOT_LOCATED:
            continue
        for name, value in label["values"].items():
            there = other["values"].get(name)
            if there is None or not close(value, there, size[name]):
                found.append("%s at %s = %s for %r" % (label["type"], name, there, value))
    if abs(changed["points"] - section["points"]) > max(1, SAME_STEPS * section["points"]):
        found.append("%d points for %d" % (changed["points"], section["points"]))
    return found


def differences(original, other):
    """Sentences, in the order of the commands."""
    found, size = [], sizes(original)
    for step in original.steps:
        if (step in original.failed) != (step in other.failed):
            found.append("%s: %s" % (step, other.failed.get(step) or "does not fail"))
            continue
        if original.said.get(step) != other.said.get(step):
            found.append("%s: says %s for %s" % (step, other.said.get(step), original.said.get(step)))
        sections, changed = (diagram.sections.get(step, {}) for diagram in (original, other))
        if sections.keys() != changed.keys():
            found.append("%s: %d parts for %d" % (step, len(changed), len(sections)))
            continue
        for k, section in sections.items():
            found += ["%s: %s" % (step, text) for text in differences_of_section(section, changed[k], size)]
    return found


def shortened(text):
    return " ".join(text.split())[:300]


class Campaign:
    def __init__(self, options):
        self.options = options
        self.tchat = str(options.tchat.resolve())
        self.source = pathlib.Path(__file__).resolve().parents[2]
        self.names = options.systems or ["problems/" + name for name in problem_pipelines.problems(self.source)] + \
            list(foreign_systems.FOREIGN)
        self.originals, self.seconds = {}, [0.0, 0.0]

    def diagram(self, name, folder, by):
        folder = self.options.folder.resolve() / folder.replace("/", "_")
        shutil.rmtree(folder, ignore_errors=True)
        if name in foreign_systems.FOREIGN:
            sizes = self.originals[name].sizes if name in self.originals else None
            return foreign_diagrams.Diagram(self.tchat, folder, foreign_systems.FOREIGN[name], by, sizes)
        return problem_pipelines.Pipeline(self.tchat, self.source, name.removeprefix("problems/"), folder, by)

    def differences(self, k, kinds, names=None):
        """Sentences on rewriting `k`, and the names of what it has in other units."""
        name = self.names[k % len(self.names)]
        if name not in self.originals:
            self.originals[name] = self.diagram(name, name, rewriting.Unchanged())
            for step, text in self.originals[name].failed.items():
                print("%s: %s: %s" % (name, step, text), flush=True)
        original = self.originals[name]
        options = self.options
        by = rewriting.Rewriting("%d %s %d" % (options.seed, name, k), options.decades, kinds, names)
        other = self.diagram(name, "%s_%d" % (name, k), by)
        self.seconds[0] += original.seconds
        self.seconds[1] += other.seconds
        if options.times:
            print("%s, rewriting %d%s: %.2f s for %.2f s" %
                  (name, k, ", idle state" * (by.idle is not None), other.seconds, original.seconds), flush=True)
        return differences(original, other), by.used

    def explain(self, k):
        """Which kinds of changes, and which single units or factors, make a difference without the others."""
        for kind in self.options.kinds:
            found, used = self.differences(k, [kind])
            if not found:
                continue
            print("  %s alone: %s" % (kind, shortened(found[0])), flush=True)
            names = sorted(used.get(kind, ())) if kind in ("states", "parameters", "values", "events") else []
            for name in names if len(names) > 1 else []:
                found, _ = self.differences(k, [kind], [name])
                if found:
                    print("    %s alone: %s" % (name, shortened(found[0])), flush=True)

    def run(self):
        options = self.options
        wrong, numbers = 0, options.only or range(options.count)
        for k in numbers:
            found, _ = self.differences(k, options.kinds, options.names)
            wrong += bool(found)
            for text in found[:PRINTED]:
                print("%s, rewriting %d: %s" % (self.names[k % len(self.names)], k, shortened(text)), flush=True)
            if found and options.explain:
                self.explain(k)
        labels = sum(len(section["labels"]) for diagram in self.originals.values()
                     for sections in diagram.sections.values() for section in sections.values())
        ratio = self.seconds[1] / self.seconds[0]
        print("%d of %d rewritings of %d systems have the same diagrams (%d labels), in %.2f times the CPU time." %
              (len(numbers) - wrong, len(numbers), len(self.originals), labels, ratio))
        is_slow = ratio > SAME_SECONDS and self.seconds[0] > LEAST_SECONDS
        return 1 if wrong or is_slow else 0


def kinds_of(text):
    kinds = sum((list(rewriting.UNITS) if kind == "units" else [kind] for kind in text.split(",")), [])
    unknown = [kind for kind in kinds if kind not in rewriting.KINDS]
    if unknown:
        raise argparse.ArgumentTypeError("unknown: %s; known: units, %s" % (unknown[0], ", ".join(rewriting.KINDS)))
    return kinds


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tchat", type=pathlib.Path)
    parser.add_argument("--folder", type=pathlib.Path, required=True, help="for the files of all runs")
    parser.add_argument("--count", type=int, default=300, help="rewritings, in turn of all systems")
    parser.add_argument("--only", type=lambda text: [int(k) for k in text.split(",")],
                        help="those of these numbers, from 0")
    parser.add_argument("--decades", type=float, default=9.0, help="units are from 10^-N to 10^N")
    parser.add_argument("--kinds", type=kinds_of, default=rewriting.KINDS,
                        help="what is rewritten, of units (%s), %s" % (", ".join(rewriting.UNITS),
                                                                       ", ".join(rewriting.KINDS[4:])))
    parser.add_argument("--names", type=lambda text: text.split(","),
                        help="states, parameters, events that have another unit or factor; all without")
    parser.add_argument("--explain", action="store_true", help="find what alone makes each difference")
    parser.add_argument("--times", action="store_true", help="print the CPU seconds of each rewriting")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("systems", nargs="*", help="names; all without")
    return Campaign(parser.parse_args()).run()


if __name__ == "__main__":
    sys.exit(main())
