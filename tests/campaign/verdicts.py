"""Verdicts of `tchat simulate`, `simulate --lyapunov` and `sweep` on systems whose attractor is known.

    python3 verdicts.py TCHAT [--count N] [--seed S] [--family PATTERN] [--verbose]

Draws N systems of known_systems.py (100), runs the three commands on each as a user would, and compares what they say
with the truth. A sweep along one branch must give its attractor one number. The exit status is 1 where a verdict is
wrong, or where more than one in twenty of a command's verdicts are undecided, with --nothing one in eight. Numbers are
compared, too: period, largest multiplier, exponents within four of their error bars.

With --nothing the systems are those of known_motions.py, most of which settle on nothing: no command may say that
they do.
"""

import argparse
import collections
import math
import os
import random
import re
import subprocess
import sys
import tempfile

import known_motions
import known_systems

# A multiplier mu of a slow orbit is known to about the tolerance of the integration, 1e-10, times its periods' steps.
MULTIPLIER_ACCURACY = 2e-6
# Relative. Sweeps integrate to 1e-8 only, and an event that is met with a velocity of 1e-5 is then off by 1e-3.
PERIOD_ACCURACY = {"simulate": 1e-6, "lyapunov": 1e-6, "sweep": 1e-4}
UNDECIDED_ALLOWED = {False: 0.05, True: 0.125}  # with --nothing: one of eight


class Answer:
    """What a command said: kind as in known_systems.Truth, or undecided, or unstable orbit."""

    def __init__(self, kind, events=None, period=None, multiplier=None, exponents=()):
        self.kind, self.events, self.period = kind, events, period
        self.multiplier, self.exponents = multiplier, exponents

    def __str__(self):
        text = self.kind
        if self.events:
            text += ", %d events" % self.events
        if self.multiplier is not None:
            text += ", |mu| = %.8g" % self.multiplier
        if self.exponents:
            text += ", exponents " + ", ".join("%.4g +- %.1g" % pair for pair in self.exponents)
        return text


def number_with_i(text):
    parts = re.findall(r"([-+]?\s*[\d.eE+-]+\d|[-+]?\s*\d)(?:\s*(i))?", text)
    value = 0j
    for part, imaginary in parts:
        number = float(part.replace(" ", ""))
        value += number * 1j if imaginary else number
    return value


def count_events(signature):
    """Index vectors of a signature with powers, as {(1,1,2), (1,2,1)^3}^2."""
    while power := re.search(r"(\{[^{}]*\}|\([^()]*\))\^(\d+)", signature):
        signature = signature[:power.start()] + power[1] * int(power[2]) + signature[power.end():]
    return signature.count("(")


def orbit_in(text):
    """The orbit that `simulate` prints: events, period, multiplier, whether it is called stable."""
    orbit = re.search(r"Periodic orbit, signature (\{.*?\}(?:\^\d+)?), period (\S+)", text)
    if not orbit:
        return None
    multipliers = re.search(r"multipliers (.*?): (not stable|\w+)", text)
    sizes = [abs(number_with_i(part)) for part in multipliers.group(1).split(",")] if multipliers else []
    return {"events": count_events(orbit.group(1)), "period": float(orbit.group(2)),
            "multiplier": max(sizes, default=None), "stable": bool(multipliers) and multipliers.group(2) == "stable"}


def kind_in_words(text):
    """Of sentences on exponents, or on a simulation that ended."""
    for pattern, kind in (
            (r"which is neutral|which is not stable|volumes are kept|still grows|of a family|a neutral periodic|is no attractor", "nothing"),
            (r"undecided|too large to tell|cannot be told|distinguishes periodic from", "undecided"),
            (r"motion is chaotic", "chaotic"),
            (r"quasi-periodic motion|motion is quasi-periodic", "quasi-periodic"),
            (r"stable periodic orbit", "periodic"),
            (r"[Ee]vents accumulate|chattering", "chattering"),
            (r"comes to rest|dies out|converges to (an|the) equilibrium", "rest")):
        if re.search(pattern, text):
            return kind
    return None


def answer_of_simulate(text):
    orbit = orbit_in(text)
    if orbit:
        kind = "periodic" if orbit["stable"] else "nothing" if "neutral" in text else "unstable orbit"
        return Answer(kind, orbit["events"], orbit["period"], orbit["multiplier"])
    ended = text.partition("No periodic orbit recognised")[0]
    kind = kind_in_words(ended)
    if kind:
        return Answer(kind)
    return Answer("no orbit" if "No periodic orbit" in text or "no orbit" in text else "undecided")


def answer_of_lyapunov(text):
    head, found, tail = text.partition("Lyapunov exponents per")
    if not found:
        return Answer(kind_in_words(text) or "undecided")
    lines = re.findall(r"^\s+\d+\s+(-?[\d.]+(?:e-?\d+)?|-infinity)(?: \+- (\S+))?", tail, re.M)
    exponents = [(float(value.replace("infinity", "inf")), float(error) if error and error != "unknown" else 0.0)
                 for value, error in lines]
    orbit = orbit_in(head) or {}
    kind = kind_in_words(tail) or "undecided"
    return Answer(kind, orbit.get("events") if kind == "periodic" else None, None, None, exponents)


def answer_of_sweep(folder, name, text):
    with open(os.path.join(folder, name + ".sweep")) as file:
        rows = [line.split() for line in file if not line.startswith("#")]
    row = dict(zip(rows[0], rows[1]))
    period = float(row["time"]) if row["kind"] == "periodic" else None
    kind = kind_in_words(text) or "undecided" if row["kind"] in ("none", "neutral") else row["kind"]
    return Answer(kind, int(row["period"]) if row["kind"] == "periodic" else None, period)


def fault_of_numbers(folder, name):
    """Of a sweep along one branch."""
    with open(os.path.join(folder, name + ".sweep")) as file:
        rows = [line.split() for line in file if not line.startswith("#")]
    column = rows[0].index("attractor")
    numbers = sorted({row[column] for row in rows[1:]})
    return None if numbers == ["1"] else "attractors %s along one branch" % ", ".join(numbers)


def commands_of(system):
    parameters = ["PAR(%s)=%.17g" % pair for pair in system.parameters.items()]
    start = ",".join("%s=%.17g" % pair for pair in system.start.items())
    simulate = ["simulate", system.name, "--state", start, "--rows", "0"] + parameters
    first, value = next(iter(system.parameters.items()))
    commands = {"simulate": simulate, "lyapunov": simulate + ["--lyapunov"],
            "sweep": ["sweep", system.name, "--over", "%s=%.17g:%.17g:1" % (first, value, value), "--state", start,
                      "--section", "none", "--fresh"] + parameters[1:]}
    if system.branch:
        commands["numbers"] = ["sweep", system.name, "--over", "%s=%.17g:%.17g:5" % (first, *system.branch), "--state",
                               start, "--section", "none", "--fresh", "--follow", "up"] + parameters[1:]
    return commands


def run(tchat, command, folder):
    try:
        done = subprocess.run([tchat] + command, cwd=folder, capture_output=True, text=True, timeout=300)
    except subprocess.TimeoutExpired:
        return "no end within 300 s", -1
    return done.stdout + done.stderr, done.returncode


# Where a motion settles on nothing, or on it so slowly that nobody can tell; or on what has no word of its own.
WRONG_WORDS = {
    "nothing": ("periodic", "quasi-periodic", "chaotic", "rest"),
    "slow": ("periodic", "quasi-periodic", "chaotic", "rest"),
    "leaves": ("periodic", "quasi-periodic", "chaotic", "rest"),
    "not periodic": ("periodic",),
    "strange nonchaotic": ("periodic", "chaotic", "rest"),
    "chaos without an attractor": ("periodic", "quasi-periodic", "rest")}


def fault_where_nothing_is(command, answer, truth):
    wrong = WRONG_WORDS[truth.kind]
    if truth.kind == "chaos without an attractor" and command == "sweep":
        wrong += ("chaotic",)
    if answer.kind in wrong:
        return "%s, where it is %s" % (answer, truth.kind)
    return "undecided" if answer.kind == "undecided" and truth.kind == "nothing" else None


def fault_of(command, answer, truth):
    """What is wrong with an answer; None where nothing is, "undecided" where it does not say."""
    if truth.kind in WRONG_WORDS:
        return fault_where_nothing_is(command, answer, truth)
    if answer.kind in ("undecided", "unstable orbit"):
        return "undecided"
    if command == "simulate" and answer.kind == "no orbit":
        return "undecided" if truth.kind == "periodic" else None
    if answer.kind != truth.kind:
        return "%s, where it is %s" % (answer, truth.kind)
    if truth.kind == "periodic":
        if answer.events and answer.events != truth.events:
            return "%d events in a period, where there are %d" % (answer.events, truth.events)
        if answer.period and abs(answer.period - truth.period) > PERIOD_ACCURACY[command] * truth.period:
            return "period %.10g, where it is %.10g" % (answer.period, truth.period)
        if (answer.multiplier is not None and truth.multiplier is not None and
                abs(answer.multiplier - truth.multiplier) > MULTIPLIER_ACCURACY):
            return "multiplier %.8g, where it is %.8g" % (answer.multiplier, truth.multiplier)
    return fault_of_exponents(answer, truth)


def fault_of_exponents(answer, truth):
    if not answer.exponents:
        return None
    expected = None
    if truth.kind == "chaotic":
        expected, index = truth.exponent, 0
    elif truth.kind == "periodic" and truth.multiplier:
        expected, index = math.log(truth.multiplier) / truth.period, 1
    if expected is None or len(answer.exponents) <= index:
        return None
    value, error = answer.exponents[index]
    # Where the weighted means have converged bars are of the size of rounding.
    if abs(value - expected) > 4 * error + 1e-7:
        return "exponent %.6g +- %.2g, where it is %.6g" % (value, error, expected)
    return None


def judge(tchat, systems, folder, verbose):
    counts = collections.defaultdict(collections.Counter)
    faults = []
    for number, system in enumerate(systems):
        with open(os.path.join(folder, system.name + ".tch"), "w") as file:
            file.write(system.formulas)
        for name, command in commands_of(system).items():
            text, status = run(tchat, command, folder)
            if status:
                answer, fault = Answer("failed"), "exit status %d: %s" % (status, text.strip()[-300:])
            elif name == "numbers":
                answer, fault = Answer("one attractor"), fault_of_numbers(folder, system.name)
            else:
                answer = (answer_of_simulate(text) if name == "simulate" else answer_of_lyapunov(text)
                          if name == "lyapunov" else answer_of_sweep(folder, system.name, text))
                fault = fault_of(name, answer, system.truth)
            verdict = "right" if fault is None else "undecided" if fault == "undecided" else "wrong"
            counts[(name, system.family.split(" ")[0])][verdict] += 1
            counts[(name, "all")][verdict] += 1
            if verdict == "wrong":
                faults.append((number, name))
            if verdict != "right" or verbose:
                line = "%3d %-9s %-10s %s: %s" % (number, verdict, name, system.family, fault or answer)
                if fault == "undecided":
                    line += " (%s), where it is %s" % (answer, system.truth.kind)
                print(line + "\n    tchat " + " ".join("'%s'" % word if "(" in word else word for word in command),
                      flush=True)
    return counts, faults


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("tchat")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--nothing", action="store_true", help="systems whose motions settle on nothing")
    parser.add_argument("--family", help="only families whose name has this regular expression in it")
    parser.add_argument("--folder", help="where to keep formulas and results")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    source = known_motions if options.nothing else known_systems
    systems = source.draw(random.Random(options.seed), options.count)
    if options.family:
        systems = [system for system in systems if re.search(options.family, system.family)]
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.folder or scratch
        os.makedirs(folder, exist_ok=True)
        counts, faults = judge(os.path.abspath(options.tchat), systems, folder, options.verbose)
    print("\n%-10s %-12s %6s %10s %6s" % ("command", "family", "right", "undecided", "wrong"))
    too_many = False
    for (command, family), count in sorted(counts.items()):
        print("%-10s %-12s %6d %10d %6d" % (command, family, count["right"], count["undecided"], count["wrong"]))
        too_many |= family == "all" and count["undecided"] > UNDECIDED_ALLOWED[options.nothing] * sum(count.values())
    return 1 if faults or too_many else 0


if __name__ == "__main__":
    sys.exit(main())
