"""The Python package against `tchat table`, AUTO-07p's own readers, closed forms of the linear oscillator.

usage: package_test.py TCHAT PLUGIN FOLDER WRITE_SAMPLE_RUN     plugin library of linosc, folder of its constants

Exit status 77 (skipped) without numpy.
"""

import csv
import gc
import io
import json
import multiprocessing
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import warnings

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "src", "python"))
sys.path.insert(0, os.path.join(HERE, "..", "files"))
try:
    import numpy as np
except ImportError:
    print("skipped: no numpy (Debian package python3-numpy)")
    sys.exit(77)
import tchat  # noqa: E402
from auto_readers import allow_new_numpy, find_auto  # noqa: E402

TCHAT, PLUGIN, CONSTANTS, WRITE_SAMPLE_RUN = (os.path.abspath(word) for word in sys.argv[1:5])
RUNS = {
    "alpha": ["-c", "nonimpacting_alpha", "-d", "nonimpacting"],
    "grazing": ["-c", "to_grazing", "-d", "nonimpacting"],
    "curve": ["-c", "grazing_curve", "-s", "grazing", "--both"],
    "both": ["-c", "impacting", "-d", "impacting", "--both", "NMX=15"],
    "impacting": ["-c", "impacting_20072", "-s", "curve"],
    "doubling": ["-c", "period_doubling_curve", "-s", "impacting", "NMX=5"],
    "unknown": ["-c", "impacting", "-d", "impacting", "IID=0", "NMX=5"],
}


def setUpModule():
    folder = tempfile.mkdtemp()
    os.chdir(folder)
    for file in os.listdir(CONSTANTS):
        shutil.copy(os.path.join(CONSTANTS, file), folder)
    shutil.copy(PLUGIN, folder)
    os.environ["TCHAT"] = TCHAT
    for name, words in RUNS.items():
        tchat.run("linosc", *words, "-o", name)
    tchat.run("linosc", "-c", "impacting", "-s", "both", "--append", "-o", "both", IRS=1, NMX=4)
    subprocess.run([WRITE_SAMPLE_RUN], check=True)


def tearDownModule():
    folder = os.getcwd()
    os.chdir("/")
    shutil.rmtree(folder)


def table(*words):
    return subprocess.run([TCHAT, "table", *words], check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout


def write(name, text):
    with open(name, "w") as file:
        file.write(text)


def read(name):
    with open(name) as file:
        return file.read()


class Tables(unittest.TestCase):
    def test_columns_are_those_of_tchat_table(self):
        for name in list(RUNS) + ["sample"]:
            lines = list(csv.DictReader(io.StringIO(table(name))))
            branch = tchat.load(name)
            self.assertEqual(len(branch), len(lines), name)
            for heading in branch.headings():
                words = [line[heading] for line in lines]
                if branch[heading].dtype == object:
                    self.assertEqual(words, list(branch[heading]), (name, heading))
                else:
                    values = [float(word) if word else np.nan for word in words]
                    np.testing.assert_array_equal(values, branch[heading].astype(float), "%s: %s" % (name, heading))

    def test_what_plot_draws_is_a_column(self):
        branch = tchat.load("impacting")
        np.testing.assert_allclose(branch["1/omega"] * branch["omega"], 1.0, rtol=1e-15)
        row, = (k for k in range(len(branch)) if branch["name"][k] == "PD1")
        self.assertAlmostEqual(branch["x2@impact"][row], branch.orbit("PD1")["x2"][0, -1], places=9)
        self.assertEqual(branch["x2@after:impact"].shape, (len(branch),))
        with self.assertRaisesRegex(tchat.Error, "no segment ends at 'nowhere'"):
            branch["x2@nowhere"]

    def test_json_is_the_csv(self):
        for name in ("both", "curve"):
            lines = list(csv.DictReader(io.StringIO(table(name, "--csv"))))
            objects = json.loads(table(name, "--json"), parse_constant=self.fail)
            self.assertEqual(len(lines), len(objects))
            for line, point in zip(lines, objects):
                for key, value in point.items():
                    if key == "multipliers":
                        flat = [np.inf if part is None else part for pair in value for part in pair]
                        self.assertEqual(flat, [float(line["multiplier%d_%s" % (k // 2 + 1, ("re", "im")[k % 2])])
                                                for k in range(len(flat))])
                    elif value is None:
                        self.assertEqual(line[key], "")
                    elif isinstance(value, str):
                        self.assertEqual(line[key], value)
                    else:
                        self.assertEqual(float(line[key]), float(value))

    def test_pandas_reads_the_csv(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("no pandas")
        frame = pandas.read_csv(io.StringIO(table("both")), float_precision="round_trip")
        own = tchat.load("both").frame()
        self.assertEqual(list(frame.columns), list(own.columns))
        np.testing.assert_array_equal(frame["alpha"], own["alpha"])
        self.assertEqual(list(frame[frame.label > 0].name), list(own[own.label > 0].name))

    def test_what_points_are(self):
        run = tchat.load("grazing")
        self.assertEqual(list(run["name"]), ["EP1", "GR1"])
        self.assertIn("contact inside segment 1, event function 1", run["kind"][1])
        doubling = tchat.load("doubling")
        self.assertTrue(np.isnan(doubling["stable"]).all())  # along a curve of period doublings it says nothing
        self.assertTrue((np.min(np.abs(doubling.multipliers + 1.0), axis=1) < 1e-5).all())
        self.assertEqual(set(tchat.load("both")["section"]), {1, 2, 3})
        without = tchat.load("unknown")  # IID = 0: the d-file has labelled points only
        self.assertEqual(list(np.isnan(without["admissible"])), list(without["label"] == 0))

    def test_orbit_in_physical_time(self):
        text = subprocess.run([TCHAT, "orbit", "sample", "4", "--csv"], check=True, stdout=subprocess.PIPE,
                              universal_newlines=True).stdout
        rows = list(csv.DictReader(io.StringIO(text)))
        orbit = tchat.load("sample").orbit(4)
        self.assertEqual(list(rows[0]), ["segment", "tau", "t", "x1", "x2", "y1", "y2"])
        np.testing.assert_array_equal([float(row["x2"]) for row in rows], orbit["x2"].ravel())
        np.testing.assert_allclose([float(row["t"]) for row in rows], orbit.t.ravel(), rtol=1e-15)
        self.assertEqual([int(row["segment"]) for row in rows], [1] * orbit.tau.shape[1] + [2] * orbit.tau.shape[1])


class ClosedForms(unittest.TestCase):
    def test_orbit_without_impacts(self):
        run = tchat.load("alpha")
        omega, zeta = 2.0, 0.05
        np.testing.assert_allclose(run["PERIOD"], 2.0 * np.pi / omega, rtol=1e-9)
        amplitude = run["alpha"] / np.hypot(1.0 - omega ** 2, 2.0 * zeta * omega)
        np.testing.assert_allclose(run["MAX x1"], amplitude, rtol=1e-4)  # on the mesh points
        of_oscillator = np.exp((-zeta + 1j * np.sqrt(1.0 - zeta ** 2)) * 2.0 * np.pi / omega)
        for row in run.multipliers:
            self.assertLess(np.min(np.abs(row - of_oscillator)), 1e-7)
            self.assertLess(np.min(np.abs(row - np.exp(-4.0 * np.pi / omega))), 1e-7)  # of the limit cycle

    def test_orbit_of_a_label(self):
        orbit = tchat.load("alpha").orbit("UZ1")
        omega = orbit.parameter("omega")
        self.assertAlmostEqual(orbit.period, 2.0 * np.pi / omega, places=11)
        self.assertEqual(orbit.parameter("zeta"), 0.05)
        x1, t = orbit["x1"][0], orbit.t[0]
        phase = np.arctan2(orbit["y1"][0, 0], orbit["y2"][0, 0])
        forced = orbit.parameter("alpha") / (1.0 - omega ** 2 + 2j * 0.05 * omega) * np.exp(1j * (omega * t + phase))
        np.testing.assert_allclose(x1, forced.real, atol=1e-7)

    def test_impacts_of_a_simulation(self):
        simulation = tchat.simulate("linosc", "PAR(alpha)=3", "-o", "sim", "--events", 6)
        events, r = simulation.events, simulation.events.parameters["r"]
        impacts = events.index[:, 2] == 1
        self.assertTrue(impacts.any())
        np.testing.assert_allclose(events["x1"][impacts], 1.0, atol=1e-12)
        np.testing.assert_allclose(events["x2_after"][impacts], -r * events["x2"][impacts], rtol=1e-14)
        segments = simulation.trajectory.segments()
        self.assertEqual(sum(len(rows) for rows in segments), len(simulation.trajectory))
        for k, rows in enumerate(segments[:-1]):
            np.testing.assert_allclose(simulation.trajectory.t[rows[-1]], events.t[k], rtol=1e-14)

    def test_sweep(self):
        sweep = tchat.sweep("linosc", over={"alpha": (2, 3, 3)}, jobs=2, omega=2.0072)
        self.assertEqual(sweep.over, ["alpha"])
        self.assertEqual(sorted(set(sweep["alpha"])), [2.0, 2.5, 3.0])
        self.assertEqual(set(sweep["kind"]), {"periodic"})
        first = sweep.attractors[0]
        self.assertEqual((first["number"], first["kind"], len(first["state"])), (1, "periodic", 4))
        self.assertAlmostEqual(first["period"], 2 * np.pi / 2.0072, places=6)
        self.assertEqual(len(sweep.frame()), len(sweep))


CIRCUIT = """par R=1
init i=1, t=0.5
i' = -R*i
t' = i - t
event low = i - 0.3
jump up: i -> 1.2
after any: low -> up
"""
OSCILLATOR = """par alpha=2, omega=2
init x=0.1, y2=1
growth = 1 - y1^2 - y2^2
x' = v
v' = alpha*y2 - 0.1*v - x
y1' = growth*y1 + omega*y2
y2' = growth*y2 - omega*y1
event maximum = v
after any: maximum -> identity
"""


def amplitude(alpha, omega=2.0):
    return alpha / np.hypot(1 - omega ** 2, 0.1 * omega)


def _continued(folder, alpha, results):
    """The branch that one of several processes computes in one folder: its first parameter and largest x."""
    problem = tchat.Problem(os.path.join(folder, "forced.tch"), folder=folder)
    branch = problem.simulate(alpha=alpha).orbit.continue_(alpha=(alpha, alpha + 0.5), both=False, DS=0.05)
    results.put((alpha, float(branch["alpha"][0]), float(branch["MAX x"][0])))


class Studies(unittest.TestCase):
    """What a notebook does again and again, in one folder."""

    def test_several_processes_in_one_folder_have_files_of_their_own(self):
        folder = tempfile.mkdtemp()
        pathlib.Path(folder, "forced.tch").write_text(OSCILLATOR)
        results = multiprocessing.Queue()
        jobs = [multiprocessing.Process(target=_continued, args=(folder, 1.0 + 0.1 * k, results)) for k in range(8)]
        for job in jobs:
            job.start()
        found = sorted(results.get(timeout=120) for _ in jobs)
        for job in jobs:
            job.join()
        self.assertEqual(len(found), 8)
        for alpha, first, largest in found:
            self.assertAlmostEqual(first, alpha, places=12)
            self.assertAlmostEqual(largest / amplitude(alpha), 1.0, places=4)
        self.assertEqual([name for name in os.listdir(folder) if "claimed" in name], [])
        shutil.rmtree(folder)

    def test_a_branch_whose_files_another_run_has_replaced_is_refused(self):
        problem = tchat.Problem(OSCILLATOR)
        orbit = problem.simulate().orbit
        old = orbit.continue_(alpha=(1, 2), name="same")
        new = orbit.continue_(alpha=(2, 3), name="same")
        self.assertGreaterEqual(new["1/alpha"].min(), 1 / 3.2)
        for use in (lambda: old["1/alpha"], lambda: old.labels, lambda: old.verify(), lambda: old.picture()):
            self.assertRaisesRegex(tchat.Error, "another run has replaced this file", use)

    def test_formulas_never_replace_a_file_of_the_user(self):
        folder = tempfile.mkdtemp()
        tchat.Problem(OSCILLATOR, name="own", folder=folder)
        again = tchat.Problem(OSCILLATOR.replace("alpha=2", "alpha=3"), name="own", folder=folder)
        self.assertIn("alpha=3", pathlib.Path(again.source).read_text())
        self.assertTrue(again.check().passed)
        with open(again.source, "a") as file:
            file.write("# of the user\n")
        with self.assertRaisesRegex(tchat.Error, "not what a tchat.Problem has written"):
            tchat.Problem(OSCILLATOR, name="own", folder=folder)
        self.assertIn("# of the user", pathlib.Path(again.source).read_text())
        pathlib.Path(folder, "mine.tch").write_text(OSCILLATOR)
        tchat.Problem(OSCILLATOR, name="mine", folder=folder)  # the same
        self.assertEqual(pathlib.Path(folder, "mine.tch").read_text(), OSCILLATOR)
        with self.assertRaisesRegex(tchat.Error, "give another name= or folder="):
            tchat.Problem(CIRCUIT, name="mine", folder=folder)
        shutil.rmtree(folder)

    def test_states_may_be_called_as_columns_of_tchat(self):
        circuit = tchat.Problem(CIRCUIT)
        simulation = circuit.simulate(events=3, transient_events=0)
        trajectory, events = simulation.trajectory, simulation.events
        rows = trajectory.segment == 2
        np.testing.assert_allclose(trajectory["i"][rows], 1.2 * np.exp(-(trajectory.t[rows] - events.t[0])), rtol=1e-7)
        self.assertEqual(trajectory.columns, ["segment", "i_", "j", "k", "t_", "i", "t"])
        self.assertEqual(set(trajectory["i_"]), {1.0})
        self.assertEqual(trajectory["t"][0], 0.5)
        orbit = circuit.simulate().orbit.orbit
        self.assertEqual(orbit.state_names, ["i", "t"])
        np.testing.assert_allclose(orbit["i"][0], orbit["i"][0, 0] * np.exp(-orbit.t[0]), rtol=1e-6)

    def test_why_a_branch_ends(self):
        problem = tchat.Problem(OSCILLATOR)
        orbit = problem.simulate().orbit
        branch = orbit.continue_(alpha=(1, 2.5))
        self.assertEqual([end.reason for end in branch.stopped], ["bound", "bound"])
        self.assertIn("stopped: alpha left the bounds RL0, RL1: ", repr(branch))
        with self.assertWarnsRegex(tchat.TchatWarning, "stopped after .* points computed, before the bound"):
            short = orbit.continue_(alpha=(1, 40), NMX=5, both=False)
        self.assertEqual(short.stopped[0].reason, "points")

    def test_columns_and_labels(self):
        branch = tchat.load("impacting")
        self.assertIn("alpha", branch)
        self.assertNotIn("nothing", branch)
        self.assertEqual(branch.columns, branch.headings())
        self.assertIn("PD", dir(branch))
        self.assertEqual(branch.LPD, [])
        self.assertRaises(AttributeError, lambda: branch.PDD)
        label = branch.label("PD1")
        self.assertLess(np.min(np.abs(label.multipliers + 1)), 1e-5)
        self.assertEqual(label["PERIOD"], label.period)
        self.assertRaisesRegex(tchat.Error, "no 'PERIODS'", lambda: label["PERIODS"])
        self.assertIn("alpha", label)
        self.assertNotIn("PERIODS", label)
        self.assertRaisesRegex(tchat.Error, "p.-h|./-h", tchat.load, "-h")

    def test_multipliers_keep_their_columns(self):
        """Those of the forced oscillator are a constant pair and the cycle's, whatever their order in the file."""
        run = tchat.load("alpha")
        steps = np.abs(np.diff(run.multipliers, axis=0))
        self.assertLess(np.nanmax(steps), 1e-6)

    def test_powers_of_signatures(self):
        self.assertEqual(tchat.orbit.read_signature("{{(1,1,1)}^2, (2,2,2)}^2"),
                         [(1, 1, 1), (1, 1, 1), (2, 2, 2)] * 2)
        self.assertRaisesRegex(tchat.Error, "no signature that could be written out", tchat.orbit.read_signature,
                               "{(1,1,1)}^99999999999")

    def test_values_of_a_sweep(self):
        sweep = tchat.sweep("linosc", over={"alpha": np.linspace(2, 3, 5)}, omega=2.0072)
        self.assertEqual(sorted(set(sweep["alpha"])), [2.0, 2.25, 2.5, 2.75, 3.0])
        for wrong in ((2, 3), 5, (2, 3, 2.5), (2, 2.1, 3, 4, 5), ("a", "b", "c")):
            self.assertRaisesRegex(tchat.Error, "over=.'alpha'", tchat.sweep, "linosc", over={"alpha": wrong})
        two = tchat.sweep("linosc", over={"alpha": [2, 3]}, omega=2.0072)
        self.assertEqual(sorted(set(two["alpha"])), [2.0, 3.0])


class Explored(unittest.TestCase):
    """A diagram of one branch, whose largest values are amplitudes of the oscillator without impacts."""

    def test_diagram(self):
        oscillator, omega = tchat.Problem(PLUGIN, name="linosc", folder="explored"), 2.0072
        diagram = oscillator.explore(over={"alpha": (2, 2.9, 10)}, y="max(x1)", omega=omega)
        self.assertEqual([one.name for one in diagram], ["b1"])
        self.assertEqual((diagram.parameter, diagram.quantity, diagram.coverage, diagram.complete),
                         ("alpha", "max(x1)", 1.0, True))
        branch, sweep = diagram["b1"].branch, diagram.sweep
        for found in (branch, sweep):
            amplitude = found["alpha"] / np.hypot(1 - omega ** 2, 0.1 * omega)
            np.testing.assert_allclose(found["max(x1)"], amplitude, rtol=1e-7)
            np.testing.assert_allclose(found["max(x2)"], omega * amplitude, rtol=1e-7)
        self.assertEqual((diagram["b1"].parent, diagram["b1"].children), (None, []))
        self.assertEqual(branch.problem, oscillator)
        self.assertIn("1 branches. Coverage: 40 of 40", diagram.text)
        self.assertEqual(tchat.Diagram("explored/diagram1").text, diagram.text)

    def test_curves_in_two_parameters(self):
        """The Hopf bifurcation of the Brusselator is at B = 1 + A^2."""
        chemistry = tchat.Problem("par A=1, B=1.5\ninit x=1.2, y=1\nx' = A - (B + 1)*x + x^2*y\ny' = B*x - x^2*y\n")
        diagram = chemistry.explore(over={"B": (1.5, 2.5, 11)}, and_={"A": (0.8, 1.1)})
        curve, = diagram.curves
        self.assertEqual((diagram.second, curve.kind, curve.name), ("A", "HB", "c1"))
        self.assertEqual((curve.parent, diagram[curve.name]), (diagram["b1"], curve))
        np.testing.assert_allclose(curve.branch["B"], 1 + curve.branch["A"] ** 2, rtol=1e-8)
        self.assertEqual(sorted(end["reason"] for end in curve.ends), ["the edge A = 0.8", "the edge A = 1.1"])
        self.assertIn(curve.name, [label["curve"] for label in diagram["b1"].labels])
        self.assertEqual((diagram.slices, diagram.codimension_two), ([], []))

    def test_what_is_none_is_refused(self):
        oscillator = tchat.Problem(PLUGIN, name="linosc")
        self.assertRaisesRegex(tchat.Error, "and_=", oscillator.explore, over={"alpha": (2, 3)},
                               and_={"omega": (1, 2, 3)})
        for over in ({}, {"alpha": (2, 3), "omega": (1, 2)}):
            self.assertRaisesRegex(tchat.Error, "over one parameter", oscillator.explore, over=over)
        self.assertRaisesRegex(tchat.Error, "is no parameter of problem", oscillator.explore, over={"beta": (1, 2)})
        self.assertRaisesRegex(tchat.Error, "what tchat explore -o none writes", tchat.Diagram, "none")
        pathlib.Path("other.json").write_text("{}")
        pathlib.Path("other.txt").write_text("")
        self.assertRaisesRegex(tchat.Error, "no diagram of tchat explore", tchat.Diagram, "other")


class Auto(unittest.TestCase):
    def test_same_as_autos_readers(self):
        folder = find_auto()
        if folder is None:
            self.skipTest("AUTO-07p is not installed")
        sys.path.insert(0, folder)
        warnings.simplefilter("ignore")
        allow_new_numpy()
        from auto import parseB, parseD, parseS
        for name in ("alpha", "curve", "doubling"):
            branches, run = parseB.parseBR("p." + name), tchat.load(name)
            for column in branches[0].coordnames:
                theirs = np.concatenate([branch[column] for branch in branches])
                np.testing.assert_array_equal(theirs, run[column.strip()])
            labels = parseS.parseS("q." + name)
            self.assertEqual(labels.getLabels(), [label.label for label in run.labels])
            for label in run.labels:
                theirs, orbit = labels.getLabel(label.label), label.orbit
                np.testing.assert_array_equal(theirs.indepvararray, orbit.tau[0])
                np.testing.assert_array_equal(theirs.coordarray, orbit.states[0])
                names = ["alpha", "omega", "zeta", "r"]
                np.testing.assert_array_equal(theirs.PAR.toarray()[:4], [orbit.parameter(name) for name in names])
                self.assertEqual(len(theirs["Active ICP"]), len(label["free"].split(",")))
            blocks = parseD.parseD("d." + name)
            blocks = [block for block in (blocks[k] for k in range(len(blocks.data))) if block["Multipliers"]]
            ours = [np.nan_to_num(row[~np.isnan(row)], posinf=1e99, neginf=-1e99) for row in run.multipliers]
            theirs = [[complex(*pair) for pair in block["Multipliers"]] for block in blocks]
            order = (lambda row: sorted(row, key=lambda one: (one.real, one.imag)))  # columns follow one multiplier each
            self.assertEqual([order(row) for row in theirs], [order(row) for row in ours])


class Running(unittest.TestCase):
    def test_progress_sees_every_point(self):
        write("p.new", read("p.alpha"))  # what another run has left is not its own
        points = []
        run = tchat.run("linosc", *RUNS["alpha"], "-o", "new", progress=points.append)
        self.assertEqual([point.value for point in points], list(run["alpha"]))
        self.assertEqual([point.label for point in points], list(run["label"]))
        self.assertIn("points,", run.screen)

    def test_points_appended_are_told_alone(self):
        before = len(tchat.run("linosc", *RUNS["alpha"], "-o", "more"))
        points = []
        run = tchat.run("linosc", *RUNS["alpha"], "-o", "more", "--append", progress=points.append)
        self.assertEqual(len(points), len(run) - before)

    def test_stopped_from_the_callback(self):
        words = ["-c", "impacting", "-d", "impacting", "-o", "long", "NMX=9000", "DSMAX=1e-5", "DS=1e-5", "NTST=100"]
        run = tchat.run("linosc", *words, progress=lambda point: point.number < 3)
        self.assertTrue(3 <= len(run) < 5000)

        def fail(point):
            raise KeyError("mine")
        with self.assertRaises(KeyError):
            tchat.run("linosc", *words, progress=fail)
        self.assertLess(len(tchat.load("long")), 5000)

    def refused(self, *words, **constants):
        with self.assertRaises(tchat.Error) as caught:
            tchat.run(*words, **constants)
        return caught.exception

    def test_names_of_columns_in_full(self):
        """A heading of the p-file is cut at 17 characters; the run's record has the name."""
        name = "displacement of the proof mass"
        write("p.long", "   0   unames = {1: '%s'}\n   0   columns = {2: 'MAX %s'}\n"
                        "   0    PT  TY  LAB                 a  MAX displacement \n"
                        "   1    -1   9    1  1.0000000000E+000  2.0000000000E+000\n" % (name, name))
        self.assertEqual(list(tchat.load("long")["MAX " + name]), [2.0])

    def test_messages_are_those_of_tchat(self):
        error = self.refused("linosc", "-c", "impacting", "-d", "impacting", NTST="x")
        self.assertEqual(error.status, 2)
        self.assertIn("NTST (number of mesh intervals of each segment): found 'x'", str(error))
        self.assertIn("no constants file", str(self.refused("linosc", "-c", "none")))
        error = self.refused("linosc", "-c", "impacting", "-d", "impacting", "PAR(r)=40", "-o", "not", ITNW=1)
        self.assertEqual(error.status, 1)
        self.assertIn("no program", str(self.refused("linosc", program="/nowhere/tchat")).replace("no such", "no"))


class Refused(unittest.TestCase):
    """One sentence for files that are another kind, cut off, or of another run."""

    def message(self, call, *arguments):
        with self.assertRaises(tchat.Error) as caught:
            call(*arguments)
        return str(caught.exception)

    def test_wrong_kinds(self):
        self.assertIn("#segment", self.message(tchat.read_trajectory, "p.alpha"))
        shutil.copy("p.alpha", "points.sweep")
        self.assertIn("# tchat sweep", self.message(tchat.read_sweep, "points"))
        self.assertIn("there is no such file", self.message(tchat.load, "nothing"))
        self.assertIn("no such file", self.message(tchat.Problem, "nothing.tch"))
        self.assertIn("'beta'", self.message(tchat.load("alpha").__getitem__, "beta"))
        self.assertIn("no label GR7; there are 1 (EP1)", self.message(tchat.load("alpha").orbit, "GR7"))

    def test_names_of_files(self):
        self.assertEqual(len(tchat.load(b"alpha")), len(tchat.load("alpha")))
        self.assertEqual(len(tchat.load(pathlib.Path("p.alpha"))), len(tchat.load("alpha")))
        self.assertIn("zero byte", self.message(tchat.load, "alpha\0"))
        self.assertIn("zero byte", self.message(tchat.run, "linosc\0"))

    def test_table_refuses_in_one_sentence(self):
        cases = [(["p.alpha", "d.impacting"], "it is of another run, the one needed is d.alpha"),
                 (["p.alpha", "q.impacting"], "it is of another run, the one needed is q.alpha"),
                 (["p.alpha", "p.impacting"], "files of one kind"),
                 (["gc.impacting"], "this is no p-file"),
                 (["nothing"], "there is no such file"),
                 (["p.alpha", "--csv", "--json"], "excludes"),
                 (["p.alpha", "d.empty"], "no point in it")]
        write("d.empty", "")
        for words, text in cases:
            done = subprocess.run([TCHAT, "table", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  universal_newlines=True)
            self.assertEqual((done.returncode, done.stdout), (2, ""), words)
            self.assertIn(text, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1)

    def test_table_leaves_out_what_does_not_belong(self):
        shutil.copy("p.alpha", "p.odd_one")
        shutil.copy("d.impacting", "d.odd_one")
        done = subprocess.run([TCHAT, "table", "odd_one"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True, check=True)
        self.assertIn("warning: d.odd_one: it has none of the points of p.odd_one; it is of another run", done.stderr)
        self.assertNotIn("multiplier1_re", done.stdout)

    def test_cut_files_lose_only_their_end(self):
        labels = [label.label for label in tchat.load("alpha").labels]
        write("p.cut", read("p.alpha")[:-7])
        write("q.cut", read("q.alpha")[:-20])
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            branch = tchat.load("cut")
            self.assertEqual([label.label for label in branch.labels], labels[:-1])
        self.assertEqual(len(branch), len(tchat.load("alpha")) - 1)
        self.assertTrue(any("q.cut" in str(warning.message) for warning in told))

    def test_files_of_another_run_are_left_out(self):
        for letter in "qd":
            name = "mixed" + letter
            shutil.copy("p.alpha", "p." + name)
            shutil.copy(letter + ".impacting", letter + "." + name)
            with self.assertWarnsRegex(tchat.TchatWarning, "of another run"):
                branch = tchat.load(name)
            self.assertEqual(len(branch), len(tchat.load("alpha")))

    def test_parts_of_a_branch(self):
        header = "   0   IPS = 180   ISP =   2   NSEG=   1\n   0    PT  TY  LAB                 a\n"
        numbers = [-1, -2, 3, 4, -5]
        write("p.parts", header + "".join("   1%6d   0    0%19.10E\n" % (n, abs(n)) for n in numbers))
        parts = tchat.load("parts").parts()
        self.assertEqual([(list(part["a"]), bool(part.stable)) for part in parts],
                         [([1.0, 2.0], True), ([2.0, 3.0, 4.0], False), ([4.0, 5.0], True)])


WALKER = """
par gamma=0.009
init th=0.2, w=-0.2, ph=0.4, p=-0.0157
a = sin(th - gamma)
th' = w
w' = a
ph' = p
p' = a + w^2*sin(ph) - cos(th - gamma)*sin(ph)
event upright = th
event strike = 2*th - ph
jump step: th -> -th, w -> cos(2*th)*w, ph -> -2*th, p -> cos(2*th)*(1 - cos(2*th))*w
after upright: strike -> step
after any: upright -> identity
"""


class Problems(unittest.TestCase):
    """Everything by objects, from formulas in a text; the same files as the command line writes."""

    def test_walker_doubles(self):
        walker = tchat.Problem(WALKER)
        orbit = walker.simulate(state=dict(th=0.20031, w=-0.19983, ph=0.40062, p=-0.015754)).orbit
        self.assertEqual(orbit.signature, [(1, 1, 2), (1, 2, 1)])
        branch = orbit.continue_(gamma=(0.005, 0.018), progress=False)
        self.assertTrue(0.005 < branch["gamma"].max() <= 0.02)
        doubling, = branch.PD
        self.assertTrue(min(abs(branch.multipliers[list(branch["name"]).index("PD1")] + 1.0)) < 1e-6)
        self.assertEqual((doubling["normal_form"], doubling.verdict), ("c", "supercritical"))
        self.assertTrue(0 < doubling.uncertainty < doubling.coefficient)
        at = list(branch["name"]).index("PD1")
        self.assertEqual(branch["coefficient"][at], doubling.coefficient)
        self.assertTrue(np.isnan(branch.labels[0].coefficient) and not branch.labels[0].verdict)
        twice = doubling.switch(name="twice")
        self.assertEqual(len(twice.labels[0].signature), 4)
        self.assertAlmostEqual(twice["PERIOD"][0], 2 * doubling.period, delta=1e-3)
        self.assertTrue(doubling.verify().passed)
        words = ["problem", "-p", walker.source, "-q", "-c", "r.branch1", "-s", "branch1", "IRS=%d" % doubling.label,
                 "ISW=-1"]
        subprocess.run([TCHAT, "run", *words, "-o", "by_hand"], cwd=walker.folder, check=True)
        for letter in "pqd":
            self.assertEqual(read(walker.path(letter + ".by_hand")), read(walker.path(letter + ".twice")))
        self.assertIn("<table>", branch._repr_html_())
        self.assertTrue(branch._repr_png_().startswith(b"\x89PNG"))
        folder = walker.folder
        self.assertEqual(twice["th@strike"].shape, (len(twice), 2))
        del walker, orbit, branch, doubling, twice
        gc.collect()
        self.assertFalse(os.path.exists(folder))

    def test_durations_behind_more_than_60_parameters(self):
        few = ("par Gamma=1.3, r=0.5\ninit velocity=3, w=1.3\ngrowth = 1 - (table^2 + w^2)/Gamma^2\n"
               "height' = velocity\nvelocity' = -1\ntable' = growth*table + w\nw' = growth*w - table\n"
               "event contact = height - table\njump impact: velocity -> -r*velocity + (1 + r)*w\n"
               "after any: contact -> impact\n")
        many = "par %s\n" % ", ".join("q%d=0.5" % k for k in range(1, 101)) + few
        runs = [tchat.Problem(text, name=name).simulate().orbit.continue_(Gamma=(1.2, 1.6), NMX=25)
                for text, name in ((few, "few"), (many, "many"))]
        for column in ("Gamma", "T1", "PERIOD"):
            np.testing.assert_allclose(runs[1][column], runs[0][column], rtol=1e-8)
        ours = runs[1].PD[0]
        self.assertAlmostEqual(ours["Gamma"], runs[0].PD[0]["Gamma"], places=8)
        self.assertAlmostEqual(ours.period, 2.0 * np.pi, places=8)
        self.assertEqual((ours["q70"], ours["r"], ours["PAR(103)"]), (0.5, 0.5, ours.period))
        self.assertTrue(ours.verify().passed)
        self.assertAlmostEqual(ours.switch(DS=0.01, NMX=5)["PERIOD"][0], 4.0 * np.pi, delta=1e-3)
        folder = find_auto()
        if folder is not None:
            sys.path.insert(0, folder)
            allow_new_numpy()
            from auto import parseB, parseS
            theirs = parseS.parseS(runs[1].path.replace("p.", "q.")).getLabel(ours.label)
            self.assertEqual(theirs["Active ICP"], [101, 103])
            self.assertEqual(list(theirs.PAR.toarray()[99:103]), [0.5, ours["Gamma"], 0.5, ours.period])
            theirs = np.concatenate([branch["Gamma"] for branch in parseB.parseBR(runs[1].path)])
            np.testing.assert_array_equal(theirs, runs[1]["Gamma"])

    def test_unstable_gait_from_a_guess(self):
        """The short gait of Garcia, Chatterjee, Ruina and Coleman (1998) at the slope 0.009."""
        orbit = tchat.Problem(WALKER).simulate(state=[0.194, -0.204, 0.388, -0.0151], refine=True).orbit
        branch = orbit.continue_(gamma=(0.008, 0.012), progress=False)
        self.assertFalse(branch["stable"].any())
        self.assertTrue(branch.verify().passed)
        self.assertAlmostEqual(orbit.orbit["U(1)"][0, 0], 0.19393736981, places=9)
        self.assertEqual(orbit.orbit.state_names, orbit.problem.state_names)
        self.assertAlmostEqual(orbit.orbit[orbit.problem.state_names[0]][0, 0], 0.19393736981, places=9)

    def test_grazing_and_its_curve(self):
        oscillator = tchat.Problem(PLUGIN, name="linosc", folder="oscillator")
        smooth = oscillator.simulate(alpha=2, omega=2.0072).orbit.continue_(alpha=(1, 4), name="smooth")
        contact, = smooth.GR
        self.assertAlmostEqual(contact["alpha"], 3.0354953, places=6)
        self.assertIn("verdict", contact.grazing().lower())
        born = contact.resegment("impacting").continue_(alpha=(2.9, 3.2), NMX=100)
        self.assertAlmostEqual(born.PD[0]["alpha"], 3.0361936, places=6)
        curve = contact.curve(("omega", "alpha"), NMX=10)
        omega, zeta = curve["omega"], 0.05
        np.testing.assert_allclose(curve["alpha"], np.hypot(1 - omega ** 2, 2 * zeta * omega), rtol=1e-7)
        again = tchat.load("oscillator/p.smooth", problem=PLUGIN)  # where Python has begun anew
        self.assertEqual(len(again.GR[0].continue_(NMX=3, GRSTOP=0)), 3)
        with self.assertRaisesRegex(tchat.Error, "problem=3: give a tchat.Problem"):
            tchat.load("oscillator/p.smooth", problem=3)

    def test_parameters_and_constants(self):
        oscillator = tchat.Problem(PLUGIN, name="linosc")
        simulation = oscillator.simulate(alpha=2, par={"omega": 2.0072}, NTST=20)
        self.assertEqual(simulation.trajectory.parameters["omega"], 2.0072)
        branch = simulation.orbit.continue_(NTST=30, NMX=4, DS=0.01)
        self.assertEqual(branch.labels[0]["mesh_intervals"], 30)
        with self.assertRaisesRegex(tchat.Error, "beta"):
            oscillator.simulate(beta=1)
        self.assertIsNone(oscillator.simulate(alpha=2, time=1).orbit)

    def test_a_page_for_a_browser(self):
        page = tchat.load("impacting").html("impacting.html", "-y", "MAX x2")
        self.assertEqual(page, "impacting.html")
        text = pathlib.Path(page).read_text(encoding="utf-8")
        self.assertTrue(text.startswith("<!DOCTYPE html>"))
        self.assertIn("PD1", text)

    def test_pictures_with_matplotlib(self):
        try:
            import matplotlib
        except ImportError:
            self.skipTest("no matplotlib")
        matplotlib.use("Agg")
        axes = tchat.load("impacting").plot(y="MAX x2")
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("alpha", "MAX x2"))
        styles = [line.get_linestyle() for line in axes.get_lines()]
        self.assertTrue({"-", "--"} <= set(styles))
        self.assertIn("PD1", [text.get_text() for text in axes.texts])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
