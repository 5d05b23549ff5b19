"""Normal form coefficients of LP, PD and TR labels against the branches, doubled orbits and tori there.

    python3 normal_forms.py TCHAT SOURCE [--only NAME] [--folder FOLDER]

Takes every such label of the pipelines in problems/*/Makefile and of the runs in normal_form_systems.py. Each is
located once more on a finer mesh, with tolerances of 1e-12, and measured there at points around it. The measurements
use states, parameters and multipliers of computed orbits and tori, no derivative of the return map beyond the first.
Let eta be the coordinate along the critical vector q, |q| = 1, on the centre manifold, and p the parameter:

fold                eta -> eta + beta(p) + a eta^2. Along the branch beta = -a eta^2, so its multiplier is
                    mu = 1 + 2 a eta + O(eta^2). With the position sigma of the start along the branch's tangent,
                        a = (d mu / d sigma) / (2 |d x / d sigma|)      where mu = 1,
                    and the sign of d x is that which makes its largest entry positive.
period doubling     eta -> mu(p) eta + c eta^3, mu = -1 at the label. The doubled orbit has eta^2 = (-1 - mu)/c and the
                    multiplier (mu + 3 c eta^2)^2 = 1 - 4 c eta^2 + O(eta^4). The two starts are 2 eta q apart, so with
                    s = |x_A - x_B|^2 / 4, in which everything is analytic,
                        c = -(d mu_doubled / d s) / 4                   from the doubled orbits alone,
                        c = -(d mu / d p) (d p / d s)                   from both branches.
torus               z -> e^(i theta) z (|mu(p)| + d' |z|^2), Re d' = Re d. The invariant circle has
                    |z|^2 = (1 - |mu|)/Re d and the normal multiplier |mu| + 3 Re d |z|^2 = 1 + 2 Re d |z|^2 + O(|z|^4).
                    The starts are x_0 + 2 Re(z q e^(i phi)) + ..., so with s the squared complex norm of their first
                    Fourier coefficient
                        Re d = (d nu / d s) / 2                         from the tori alone, nu their normal multiplier,
                        Re d = -(d |mu| / d p) (d p / d s)              from tori and orbits.

Without a section the return map is that of the plane across the flow at the start, so differences of starts are
projected onto it.

Derivatives are those of least-squares polynomials. The uncertainty of a measurement is the difference between fits of
three degrees, and what the last digits in the files do to it. Where other multipliers are inside the unit circle,
simulations decide the sign once more: started beside the orbit at 0.8 and 1.2 of the amplitude of what is born, they
approach that amplitude (supercritical) or leave it.

Prints a line for each label, and the reason where there is no measurement. The exit status is 1 where a coefficient
differs from a measurement by more than both uncertainties and 1e-5 of its size (tori: 1e-4), or a simulation
contradicts the sign.
"""

import argparse
import collections
import glob
import json
import math
import os
import re
import subprocess
import sys

import numpy

import label_accuracy
import normal_form_systems
import pipeline_labels

# What a fit may add to its own uncertainty, relative to the coefficient.
AGREEMENT = {"LP": 1e-5, "PD": 1e-5, "TR": 1e-4}
# The largest distance of the critical multiplier from its value at the label, on the branch and on what is born. Where
# another multiplier is near, it is this share of the distance between both.
RANGE = {"LP": 0.08, "PD": 0.05, "TR": 0.05}
BORN_RANGE = {"PD": 0.1, "TR": 0.05}
SHARE = 0.2
# Smaller ranges follow until the fits agree to WANTED, relative to the coefficient.
SHRINK, RANGES, WANTED = 4.0, 5, 1e-6
POINTS = 12
DEGREES = (5, 4, 6)
# Last digits in files, relative to a value, and errors of multipliers.
ROUNDING, OF_MULTIPLIERS = 5e-11, 1e-10
TIME_LIMIT = 300
SIMULATED_AMPLITUDES = (0.8, 1.2)
FREE = ["UZR={}", "STOP=[]", "BOUNDS={}", "RL0=-1e300", "RL1=1e300", "A0=-1e300", "A1=1e300", "GRSTOP=0", "NPR=1",
        "ILP=0", "ISP=1", "IAD=0", "IADS=0", "NWTN=8", "ITNW=12", "ITMX=30", "IID=2", "NMX=2"]
TOLERANCES = (1e-12, 1e-11, 1e-10)  # the first that rounding lets the label's run reach


class NoFit(Exception):
    """Says why there is no measurement."""


Printed = collections.namedtuple("Printed", "value uncertainty sentence")
Measured = collections.namedtuple("Measured", "how value uncertainty")
Point = collections.namedtuple("Point", "row parameter multipliers starts flow")


class Runs:
    """Runs of one problem in the folder of its results."""

    def __init__(self, tchat, folder, problem):
        self.tchat, self.folder, self.problem = tchat, folder, problem

    def run(self, start, name, settings):
        words = [self.tchat, "run", self.problem, "-c", "r." + start, "-s", start, "-o", name, "-q"] + settings
        for kind in "pqdr":
            path = os.path.join(self.folder, kind + "." + name)
            if os.path.exists(path):
                os.remove(path)
        done = subprocess.run(words, cwd=self.folder, capture_output=True, text=True, timeout=TIME_LIMIT)
        if not os.path.exists(os.path.join(self.folder, "q." + name)):
            raise NoFit("a run fails: %s" % (done.stderr.strip().splitlines() or ["?"])[0])
        return name

    def rows(self, name):
        table = subprocess.run([self.tchat, "table", "--json", "p." + name], cwd=self.folder, capture_output=True,
                               text=True)
        return json.loads(table.stdout or "[]")

    def constants(self, name):
        return label_accuracy.constants_of(self.folder, name)

    def points(self, name):
        """Labelled points of a run: row, ICP(1), multipliers without the one along the flow, starts, PAR."""
        constants = self.constants(name)
        orbits = label_accuracy.stored_orbits(os.path.join(self.folder, "q." + name))
        found = []
        for row in self.rows(name):
            if row["label"] not in orbits or row["type"] == "MX":
                continue
            head, rows, _ = orbits[row["label"]]
            found.append(Point(row, first_parameter(row), multipliers_of(row, constants), starts_of(rows),
                               flow_of(head, rows)))
        if not found:
            raise NoFit("no step from the label")
        return found

    def printed(self, name, row):
        """The coefficient in the d-file, or None."""
        sentence = None
        for line in open(os.path.join(self.folder, "d." + name)):
            match = re.match(r"\s*(\d+)\s+(\d+)\s+NOTE: ((?:no )?normal form.*)", line)
            if match and (int(match.group(1)), int(match.group(2))) == (row["branch"], abs(row["point"])):
                sentence = match.group(3).strip()
        found = re.search(r"= (\S+) \+- ([^\s,]+)", sentence or "")
        return Printed(float(found.group(1)), float(found.group(2)), sentence) if found else Printed(None, None,
                                                                                                   sentence)

    def why_no_fit(self, name):
        """Where a quantity is kept, parameters change with the amplitude itself, not with its square; else ""."""
        text = open(os.path.join(self.folder, "r." + name)).read()
        held = re.search(r"^(HOLD = (?!\[\])|CONSERVED = \S).*", text, re.M)
        return "the family keeps a quantity: " + held.group(0) if held else ""


def first_parameter(row):
    columns = list(row)
    return row[columns[columns.index("admissible") + 1]]


def multipliers_of(row, constants):
    pairs = [pair for pair in row["multipliers"] or [] if None not in pair]
    multipliers = [complex(*pair) for pair in pairs]
    return multipliers[1:] if 0 in constants["GCHIND"] and constants["IPS"] == 180 else multipliers


def starts_of(rows):
    """All states of the first mesh point, and of the middle one for orbits of one segment."""
    return numpy.array(rows[0][1:]), numpy.array(rows[len(rows) // 2][1:])


def flow_of(head, rows):
    """d x / d t at the first mesh point, of the polynomial on the first mesh interval."""
    nodes = numpy.array(rows[:head[10] + 1])
    return numpy.polynomial.polynomial.polyfit(nodes[:, 0] / nodes[-1, 0], nodes[:, 1:], head[10])[1]


def setting(key, value):
    return "%s=%.17g" % (key, value)


def steps(length):
    return [setting("DS", length), setting("DSMAX", abs(length))]


def nearest(multipliers, wanted):
    if not multipliers:
        raise NoFit("no multipliers")
    return min(multipliers, key=lambda mu: abs(mu - wanted))


def linear_coefficient(x, y, weights, degree, constant):
    """Of a least-squares polynomial, whose value at 0 is free (`constant`) or 0."""
    scale = numpy.abs(x).max()
    powers = range(0 if constant else 1, degree + 1)
    columns = numpy.array([weights * (x / scale) ** k for k in powers]).T
    return numpy.linalg.lstsq(columns, weights * y, rcond=None)[0][1 if constant else 0] / scale


def slope(x, y, of_x, of_y, constant=False):
    """d y / d x at 0, and its uncertainty: the differences between the DEGREES, and what errors of x and y do to it."""
    x, y = numpy.asarray(x, float), numpy.asarray(y, float)
    if len(x) < max(DEGREES) + 2:
        raise NoFit("only %d points" % len(x))
    weights = numpy.broadcast_to(1 / numpy.asarray(of_y), len(x)) * numpy.min(of_y)
    values = [linear_coefficient(x, y, weights, degree, constant) for degree in DEGREES]
    noise = numpy.random.default_rng(1)
    moved = [linear_coefficient(x + of_x * noise.uniform(-1, 1, len(x)), y + of_y * noise.uniform(-1, 1, len(x)),
                                weights, DEGREES[0], constant) - values[0] for _ in range(10)]
    return values[0], max(abs(value - values[0]) for value in values) + max(abs(numpy.array(moved)))


def fold_coefficient(x, mu, degree):
    """(d mu / d sigma) / (2 |d x / d sigma|) where mu = 0; sigma is the coordinate along the tangent of the rows x."""
    sigma = x @ numpy.linalg.svd(x)[2][0]
    sigma = sigma / numpy.abs(sigma).max()
    of_mu = numpy.polyfit(sigma, mu, degree)
    root = min(numpy.roots(of_mu), key=abs)
    if abs(root.imag) > 1e-9 or abs(root) > 0.3:
        raise NoFit("no multiplier passes 1 near the label")
    direction = numpy.array([numpy.polyval(numpy.polyder(numpy.polyfit(sigma, column, degree)), root.real)
                             for column in x.T])
    sign = math.copysign(1, direction[numpy.argmax(abs(direction))])
    return sign * numpy.polyval(numpy.polyder(of_mu), root.real) / (2 * numpy.linalg.norm(direction))


def scaled(how, factor, found):
    return Measured(how, factor * found[0], abs(factor) * found[1])


def product(how, factor, one, two):
    value = factor * one[0] * two[0]
    return Measured(how, value, abs(value) * (abs(one[1] / one[0]) + abs(two[1] / two[0])))


def adapted_step(wanted, change):
    """The step length for which `change` of it is `wanted`, to 20 %."""
    length, failure = 1e-3, None
    for _ in range(10):
        try:
            ratio, failure = wanted / max(change(length), 1e-14), None
        except NoFit as error:
            ratio, failure = 0.1, error
        if 0.8 < ratio < 1.25:
            break
        length *= min(max(ratio, 1e-2), 10)
    if failure:
        raise failure
    return length


class Label:
    """One label, located again on a finer mesh."""

    def __init__(self, runs, source, row):
        self.runs, self.source, self.row = runs, source, row
        self.kind = row["type"]
        self.name = "fit_%s_%d" % (source, row["label"])
        self.printed = runs.printed(source, row)

    def locate(self, share):
        """Runs through the label with equal steps, of which `share` of the multiplier's RANGE is covered."""
        self.share = share
        self.critical = self.critical_multiplier()
        self.gap = self.distance_of_others()
        for tolerance in TOLERANCES:
            try:
                self.branch_name = self.run_through(self.fine_settings(tolerance))
                break
            except NoFit as error:
                failure = error
        else:
            raise failure
        self.branch = self.runs.points(self.branch_name)
        located = [point for point in self.branch if point.row["type"] == self.kind]
        if not located:
            raise NoFit("the label is not located again on the finer mesh")
        self.point = located[0]
        self.fine = self.runs.printed(self.branch_name, self.point.row)

    def fine_settings(self, tolerance):
        orbits = label_accuracy.stored_orbits(os.path.join(self.runs.folder, "q." + self.source))
        header = next(iter(orbits.values()))[0]
        return FREE + ["NTST=%d" % min(2 * header[9], 400), "NCOL=%d" % min(header[10] + 2, 7), "ISW=1",
                       setting("EPSL", tolerance), setting("EPSU", tolerance), setting("EPSS", 10 * tolerance)]

    def run_through(self, settings):
        """Half of the points on one side of the label, then from the last of them back through it."""
        base = ["IRS=%d" % self.row["label"]] + settings
        reach = self.share * min(RANGE[self.kind], SHARE * self.gap)
        length = adapted_step(reach / (POINTS / 2), lambda ds: self.change(self.runs.run(
            self.source, self.name + "a", base + steps(ds))))
        before = self.runs.run(self.source, self.name + "a", base + steps(length) + ["NMX=%d" % (POINTS // 2 + 1)])
        last = self.runs.points(before)[-1].row["label"]
        return self.runs.run(before, self.name + "b", ["IRS=%d" % last, "NMX=%d" % (POINTS + 2), "ILP=1", "ISP=2"]
                             + steps(-length))

    def critical_multiplier(self):
        if self.kind != "TR":
            return {"LP": 1.0, "PD": -1.0}[self.kind]
        pairs = [mu for mu in multipliers_of(self.row, self.runs.constants(self.source)) if mu.imag > 0]
        return min(pairs, key=lambda mu: abs(abs(mu) - 1))

    def distance_of_others(self):
        """From the critical multiplier to the nearest other one, as that of the orbit or of what is born."""
        multipliers = multipliers_of(self.row, self.runs.constants(self.source))
        for _ in range(2 if self.kind == "TR" else 1):
            multipliers.remove(nearest(multipliers, self.critical))
            self.critical = self.critical.conjugate()
        distances = {"LP": lambda mu: abs(mu - 1), "PD": lambda mu: min(abs(mu + 1), abs(mu ** 2 - 1)),
                     "TR": lambda mu: min(abs(abs(mu) - 1), abs(mu - self.critical))}[self.kind]
        return min((distances(mu) for mu in multipliers), default=1.0)

    def change(self, name):
        rows = self.runs.rows(name)
        constants = self.runs.constants(name)
        values = [nearest(multipliers_of(row, constants), self.critical) for row in rows[:2] if row["type"] != "MX"]
        if len(values) < 2:
            raise NoFit("no step from the label")
        return abs(values[1] - values[0])

    def size(self, mu):
        """What passes its critical value along the branch, from that value on."""
        return abs(mu) - 1 if self.kind == "TR" else (mu - self.critical).real

    def rate(self):
        """d mu / d p at the label, of |mu| for a pair, and its uncertainty."""
        p = [point.parameter - self.point.parameter for point in self.branch]
        mu = [self.size(nearest(point.multipliers, self.critical)) for point in self.branch]
        return slope(p, mu, self.of_parameter(), OF_MULTIPLIERS, True)

    def of_parameter(self):
        return ROUNDING * abs(self.point.parameter)

    def births(self, how, s, of_s):
        """From the parameter where something is born, as a function of s, and the multiplier's dependence on it."""
        p = [point.parameter - self.point.parameter for point in self.born]
        return product(how, -1.0, self.rate(), slope(s, p, of_s, self.of_parameter(), True))

    def segments(self):
        return len(self.runs.constants(self.source)["GCFIND"])

    def dimension(self, point):
        return len(point.starts[0]) // self.segments()

    def measurements(self):
        return {"LP": self.fold, "PD": self.doubling, "TR": self.torus}[self.kind]()

    def fold(self):
        n = self.dimension(self.point)
        points = [point for point in self.branch if point is not self.point]
        x = self.across(numpy.array([point.starts[0][:n] - self.point.starts[0][:n] for point in points]))
        mu = numpy.array([nearest(point.multipliers, 1.0).real for point in points]) - 1
        values = [fold_coefficient(x, mu, degree) for degree in DEGREES]
        noise = numpy.random.default_rng(1)
        of_x = ROUNDING * self.size_of_start()
        moved = [fold_coefficient(x + of_x * noise.uniform(-1, 1, x.shape),
                                  mu + OF_MULTIPLIERS * noise.uniform(-1, 1, len(x)), DEGREES[0]) for _ in range(10)]
        spread = [max(abs(value - values[0]) for value in some) for some in (values, moved)]
        return [Measured("multiplier along the branch", values[0], sum(spread))]

    def follow_born(self, settings, change):
        """Points of what is born, on equal steps. `change` of a run is the root of what its first step changes."""
        reach = self.share * min(BORN_RANGE[self.kind], SHARE * self.gap)
        base = ["IRS=%d" % self.point.row["label"], "ISW=-1"] + settings
        length = adapted_step(math.sqrt(reach) / POINTS, lambda ds: change(self.runs.run(
            self.branch_name, self.name + "c", base + steps(ds) + ["NMX=2"])))
        self.born_name = self.runs.run(self.branch_name, self.name + "c",
                                       base + steps(length) + ["NMX=%d" % (POINTS + 2)])
        self.born = self.runs.points(self.born_name)

    def doubled_square(self, point):
        """s = |x_A - x_B|^2 / 4."""
        m, n = self.segments(), self.dimension(self.point)
        first = point.starts[0]
        other = first[m * n:(m + 1) * n] if len(first) > m * n else point.starts[1][:n]
        return numpy.sum(self.across(first[:n] - other) ** 2) / 4

    def across(self, x):
        """Differences of starts, rows of x. Of an orbit without a section their part across the flow at the label."""
        if 0 not in self.runs.constants(self.source)["GCHIND"]:
            return x
        flow = self.point.flow / numpy.linalg.norm(self.point.flow)
        return x - numpy.multiply.outer(x @ flow, flow)

    def doubling(self):
        # The multiplier leaves 1 with the square of the amplitude: that of the first step is 1/POINTS^2 of the last.
        def change(name):
            rows, constants = self.runs.rows(name), self.runs.constants(name)
            return math.sqrt(abs(nearest(multipliers_of(rows[-1], constants), 1.0) - 1)) / len(rows)

        self.follow_born([], change)
        s = numpy.array([self.doubled_square(point) for point in self.born])
        mu = [nearest(point.multipliers, 1.0).real - 1 for point in self.born]
        of_s = numpy.sqrt(s) * ROUNDING * self.size_of_start()
        return [scaled("doubled orbits", -0.25, slope(s, mu, of_s, OF_MULTIPLIERS)),
                self.births("both branches", s, of_s)]

    def size_of_start(self):
        return numpy.linalg.norm(self.point.starts[0][:self.dimension(self.point)])

    def harmonic(self, point):
        """The first Fourier coefficient of the starts of a torus."""
        n, m = self.dimension(self.point), self.segments()
        starts = point.starts[0].reshape(-1, m, n)[:, 0, :]
        return numpy.fft.fft(starts, axis=0)[1] / len(starts)

    def normal_multiplier(self, multipliers):
        """That next to the one along the curve, which is the first."""
        return nearest(multipliers[1:], 1.0).real

    def torus(self):
        parameter = list(self.row)[list(self.row).index("admissible") + 1]
        rho = "rho" if "rho" in self.point.row else "60"
        icp = "ICP=[%s,%s]" % (parameter, rho)

        def change(name):
            rows = self.runs.rows(name)
            multipliers = [complex(*pair) for pair in rows[-1]["multipliers"]]
            return math.sqrt(abs(self.normal_multiplier(multipliers) - 1)) / len(rows)

        self.follow_born(["IPS=182", icp, "NHARM=7", "HARMTOL=0"], change)
        s = numpy.array([numpy.sum(abs(self.harmonic(point)) ** 2) for point in self.born])
        nu = [self.normal_multiplier(point.multipliers) - 1 for point in self.born]
        of_s = numpy.sqrt(s) * ROUNDING * self.size_of_start()
        # The first multiplier is 1, along the curve; what it differs by is the error of all.
        of_nu = numpy.array([abs(point.multipliers[0] - 1) for point in self.born]) + OF_MULTIPLIERS
        return [scaled("tori", 0.5, slope(s, nu, of_s, of_nu)),
                self.births("tori and orbits", s, of_s)]

    def simulated(self):
        """'settles' or 'leaves' for what is born, from two simulations beside it; None where it cannot be said."""
        constants = self.runs.constants(self.branch_name)
        if self.kind == "LP" or "another" in self.printed.sentence or 0 in constants["GCHIND"]:
            return None
        n, m = self.dimension(self.point), self.segments()
        point = self.largest_beside()
        curve = point.starts[0].reshape(-1, m, n)[:, 0, :]
        rate = abs(nearest(point.multipliers, 1.0) - 1) if self.kind == "PD" else abs(
            self.normal_multiplier(point.multipliers) - 1)
        centre = curve.mean(axis=0)
        returns = int(min(1.5 / rate, 400)) * (2 if self.kind == "PD" else 1) + 20
        answers = [self.ratio(point, centre, curve, factor, returns) for factor in SIMULATED_AMPLITUDES]
        if None in answers:
            return None
        if all(ratio < 0.8 for ratio in answers):
            return "settles"
        return "leaves" if all(ratio > 1.25 for ratio in answers) else "undecided (%.2g, %.2g)" % tuple(answers)

    def largest_beside(self):
        """The largest of what is born whose multiplier is, to a fifth, what the coefficient says."""
        factor, square = (-4, self.doubled_square) if self.kind == "PD" else (
            2, lambda point: numpy.sum(abs(self.harmonic(point)) ** 2))
        ratios = [(nearest(point.multipliers[self.kind == "TR":], 1.0).real - 1) / (
            factor * self.printed.value * square(point)) for point in self.born]
        fitting = [point for point, ratio in zip(self.born, ratios) if abs(ratio - 1) < 0.2]
        return fitting[-1] if fitting else self.born[0]

    def ratio(self, point, centre, curve, factor, returns):
        """How far the amplitude of the last returns is from that of `curve`, relative to the first returns."""
        state = centre + factor * (curve[0] - centre)
        words = [self.runs.tchat, "simulate", self.runs.problem, "-c", "r." + self.branch_name, "-s", self.born_name,
                 "IRS=%d" % point.row["label"], "--state", ",".join("%.17g" % x for x in state), "--follow-signature",
                 "--events", str(returns * self.segments()), "--rows", "0", "-o", self.name + "s", "-q",
                 "--tolerance", "1e-12"]
        try:
            done = subprocess.run(words, cwd=self.runs.folder, capture_output=True, text=True, timeout=60)
        except subprocess.TimeoutExpired:
            return None
        path = os.path.join(self.runs.folder, self.name + "s.events")
        if done.returncode or not os.path.exists(path):
            return None
        rows = [line.split() for line in open(path) if not line.startswith("#")]
        n = self.dimension(self.point)
        events = [[float(x) for x in row[7 + n:7 + 2 * n]] for row in rows if row[-1].startswith("event")]
        x = numpy.array([state] + events[self.segments() - 1::self.segments()])
        if len(x) < returns:
            return None
        own = [self.amplitude(curve[k % len(curve)], curve[(k + 1) % len(curve)], centre) for k in range(len(curve))]
        amplitudes = [self.amplitude(a, b, centre) for a, b in zip(x[:-1], x[1:])]
        window = 2 if self.kind == "PD" else 8
        first, last = (numpy.mean(part) / numpy.mean(own) for part in (amplitudes[2:2 + window],
                                                                     amplitudes[-window:]))
        return abs(last - 1) / abs(first - 1)

    def amplitude(self, a, b, centre):
        return numpy.linalg.norm(b - a) if self.kind == "PD" else numpy.linalg.norm(a - centre)


def faults_of(label, measurements, simulated):
    faults = []
    for printed in (label.printed, label.fine):
        if printed.value is None:
            continue
        for found in measurements:
            allowed = printed.uncertainty + found.uncertainty + AGREEMENT[label.kind] * abs(printed.value)
            if not abs(printed.value - found.value) <= allowed:
                faults.append("%s: %.10g, printed %.10g" % (found.how, found.value, printed.value))
    expected = {"supercritical": "settles", "subcritical": "leaves"}
    for word, verdict in expected.items():
        if simulated in expected.values() and word in label.printed.sentence and simulated != verdict:
            faults.append("%s, but a simulation %s" % (word, simulated))
    return faults


def labels_of(runs, name):
    constants = runs.constants(name)
    if constants["IPS"] != 180 or constants.get("ISW", 1) not in (0, 1, -1):
        return []
    return [Label(runs, name, row) for row in runs.rows(name) if row["label"] and row["type"] in RANGE]


def pipeline_labels_of(tchat, folder, only):
    """Labels of all runs of the pipelines."""
    for constants in sorted(glob.glob(os.path.join(folder, "pipelines", "results", "*", "r.*"))):
        place, file = os.path.split(constants)
        problem, name = os.path.basename(place), file[2:]
        if only in problem + "/" + name and not name.startswith("fit_") and not name.endswith("~"):
            library = os.path.join(folder, "pipelines", "problems", problem, problem)
            yield from labels_of(Runs(tchat, place, library), name)


def system_labels_of(tchat, source, folder, only):
    for name, formulas, parameter, settings in normal_form_systems.SYSTEMS:
        if only not in name:
            continue
        place = os.path.join(folder, "systems", name)
        os.makedirs(place, exist_ok=True)
        if not formulas:
            formulas = open(os.path.join(source, "tests", "end_to_end", "systems", name + ".tch")).read()
        with open(os.path.join(place, name + ".tch"), "w") as file:
            file.write(formulas)
        for words in (["simulate", name, "--rows", "0", "--dat", parameter, "--free", parameter],
                      ["run", name, "-c", parameter, "-d", parameter, "-o", parameter] + settings):
            done = subprocess.run([tchat] + words + ["-q"], cwd=place, capture_output=True, text=True,
                                  timeout=TIME_LIMIT)
        if not os.path.exists(os.path.join(place, "r." + parameter)):
            print("%s: no run: %s" % (name, done.stderr.strip()))
            continue
        labels = labels_of(Runs(tchat, place, name), parameter)
        if not labels:
            print("%s/%s: no labels" % (name, parameter))
        yield from labels


def measure(label):
    """The best of the measurements over ever smaller ranges, and what simulations say in the first of them."""
    best, simulated, reason = {}, None, None
    for k in range(RANGES):
        try:
            label.locate(SHRINK ** -k)
            for found in label.measurements():
                if not best.get(found.how) or found.uncertainty < best[found.how].uncertainty:
                    best[found.how] = found
            simulated = simulated or label.simulated() or "says nothing"
        except NoFit as error:
            reason = error
        if best and all(found.uncertainty < WANTED * abs(found.value) for found in best.values()):
            break
    if not best:
        raise reason
    return list(best.values()), simulated


def check(label, counts):
    where = "%s/%s %s%d" % (os.path.basename(label.runs.folder), label.source, label.kind, label.row["label"])
    counts[label.kind] += 1
    why_no_fit = label.runs.why_no_fit(label.source)
    if label.printed.value is None:
        why = label.printed.sentence or why_no_fit or "NO SENTENCE, AND NO REASON FOR IT"
        print("%s: not measured: %s" % (where, why))
        counts["without a coefficient"] += 1
        return
    if why_no_fit:
        print("%s: %.10g: not measured: %s" % (where, label.printed.value, why_no_fit))
        counts["not measured"] += 1
        return
    try:
        measurements, simulated = measure(label)
    except (NoFit, subprocess.TimeoutExpired) as error:
        print("%s: %.10g: not measured: %s" % (where, label.printed.value, error))
        counts["not measured"] += 1
        return
    faults = faults_of(label, measurements, simulated)
    texts = ["%s %.10g +- %.1g (%.1e)" % (found.how, found.value, found.uncertainty,
                                         abs(found.value / label.printed.value - 1))
             for found in measurements]
    print("%s: %.10g +- %.1g, fine %s; %s%s" % (
        where, label.printed.value, label.printed.uncertainty,
        "none" if label.fine.value is None else "%.10g +- %.1g" % (label.fine.value, label.fine.uncertainty),
        "; ".join(texts), "; simulation " + simulated if label.kind != "LP" else ""), flush=True)
    counts["measured"] += 1
    closest = min(found.uncertainty for found in measurements)
    counts["measured to %g" % AGREEMENT[label.kind]] += closest < AGREEMENT[label.kind] * abs(label.printed.value)
    counts["simulated"] += simulated in ("settles", "leaves")
    for fault in faults:
        print("    DIFFERENT: " + fault)
    counts["different"] += bool(faults)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("tchat")
    parser.add_argument("source")
    parser.add_argument("--only", default="", help="only problems, runs and systems whose name has this in it")
    parser.add_argument("--systems", action="store_true", help="no pipelines")
    parser.add_argument("--folder", default="normal_forms")
    options = parser.parse_args()
    tchat, folder = os.path.abspath(options.tchat), os.path.abspath(options.folder)
    os.makedirs(folder, exist_ok=True)
    if not options.systems and not os.path.exists(os.path.join(folder, "pipelines")):
        pipeline_labels.make(tchat, options.source, os.path.join(folder, "pipelines"), os.path.join(folder, "labels"))
    counts = collections.Counter()
    if not options.systems:
        for label in pipeline_labels_of(tchat, folder, options.only):
            check(label, counts)
    for label in system_labels_of(tchat, options.source, folder, options.only):
        check(label, counts)
    for what, count in counts.items():
        print("%6d %s" % (count, what))
    return 1 if counts["different"] else 0


if __name__ == "__main__":
    sys.exit(main())
