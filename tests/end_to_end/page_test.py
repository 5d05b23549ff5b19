"""Pages of `tchat plot -o FILE.html` in Chromium: what is drawn, what clicks and keys show, commands that run, speed.

    page_test.py TCHAT LINOSC.so SOURCE_FOLDER [SCREENSHOTS]

Exit status 77 (skipped) without Chromium. With a folder SCREENSHOTS each page is kept there as a picture.
"""
import csv
import io
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from headless_browser import SHIFT, Browser, find_browser  # noqa: E402

TCHAT, LINOSC, SOURCE = (os.path.abspath(word) for word in sys.argv[1:4])
SCREENSHOTS = sys.argv[4] if len(sys.argv) > 4 else None
WIDE, NARROW = (1280, 900), (400, 800)

if not find_browser():
    print("skipped: no Chromium (Debian package chromium-headless-shell)")
    sys.exit(77)


def tchat(*words):
    done = subprocess.run([TCHAT] + list(words), capture_output=True, text=True)
    assert done.returncode == 0, (words, done.stdout, done.stderr)
    return done.stdout


def table(path):
    return list(csv.DictReader(io.StringIO(tchat("table", path, "--csv"))))


def setUpModule():
    global BROWSER
    os.chdir(tempfile.mkdtemp())
    for name in ("impacting", "impacting_20072"):
        shutil.copy(os.path.join(SOURCE, "constants", "linosc", "gc." + name), ".")
    shutil.copy(os.path.join(SOURCE, "constants", "linosc", "impacting.dat"), ".")
    shutil.copy(LINOSC, "linosc.so")
    tchat("run", "linosc", "-q", "-c", "impacting", "-d", "impacting", "-o", "branch", "NMX=60", "DS=-0.02", "GRSTOP=0")
    tchat("plot", "p.branch", "-o", "branch.html")
    BROWSER = Browser()


def tearDownModule():
    BROWSER.__exit__()
    folder = os.getcwd()
    os.chdir("/")
    shutil.rmtree(folder)


class PageTest(unittest.TestCase):
    def open(self, path, size=WIDE):
        """A page that must not complain and loads nothing but itself."""
        page = BROWSER.open(path, *size)
        self.addCleanup(self.check_quiet, page)
        return page

    def check_quiet(self, page):
        page.value("1")
        self.assertEqual(page.errors, [])
        self.assertEqual([url for url in page.requests if not url.startswith("data:")][1:], [])

    def keep(self, page, name):
        if SCREENSHOTS:
            os.makedirs(SCREENSHOTS, exist_ok=True)
            page.screenshot(os.path.join(SCREENSHOTS, name + ".png"))

    def point_values(self, page):
        """The table of values beside the diagram."""
        return dict(page.value("""Array.from(document.querySelectorAll(".point-values tr"))
                                  .map(row => Array.from(row.cells).map(cell => cell.innerText))"""))

    def check_values(self, page, row):
        """Every column of the p-file is shown with the digits of `tchat table`."""
        shown = self.point_values(page)
        self.assertEqual(shown["point"], row["point"])
        for name in ("alpha", "L2-NORM", "MAX x1", "PERIOD"):
            self.assertEqual(float(shown[name].replace("\u2212", "-")), float(row[name]), name)

    def open_label(self, page, name):
        page.click(*page.middle('.marker[aria-label^="%s,"] .symbol' % name))
        page.drawn_again()

    def place_of_point(self, page, number):
        """Where a point of the branch is, in pixels of the window."""
        return page.value("""(() => {
            const picture = tchat.pictures[0], panel = picture.panels[0], data = panel.data.computed;
            const box = picture.plot.getBoundingClientRect(), k = data.row.indexOf(%d);
            return [box.left + panel.x(data.x[k]), box.top + panel.y(data.y[k])];
        })()""" % (number - 1))

    def domain(self, page):
        return page.value("tchat.pictures[0].panels[0].x.domain().concat(tchat.pictures[0].panels[0].y.domain())")


class LinearOscillator(PageTest):
    def test_a_label_shows_its_values_orbit_multipliers_and_a_command_that_runs(self):
        row = next(row for row in table("p.branch") if row["name"].startswith("PD1"))
        page = self.open("branch.html")
        self.open_label(page, "PD1")
        self.keep(page, "linosc_PD1")
        self.assertIn("PD1, label " + row["label"], page.text("#details h2"))
        self.assertIn("period doubling", page.text(".meaning"))
        self.assertRegex(page.text(".form"), "^normal form c = .* (super|sub)critical$")
        self.check_values(page, row)
        self.assertEqual(self.point_values(page)["omega (fixed)"], "2.0072")
        known = [name for name in row if re.fullmatch("multiplier[0-9]+_re", name) and row[name]]
        self.assertEqual(page.value("document.querySelectorAll('.multipliers tr').length"), len(known) + 1)
        self.assertEqual(page.value("document.querySelectorAll('.portrait svg').length"), 1)
        self.assertEqual(page.value("document.querySelectorAll('.series svg').length"), 2)
        self.assertGreater(page.value("document.querySelectorAll('.portrait .jump').length"), 0)
        self.assertIn("wall", page.text(".ends"))
        circle = page.value("""(() => { const box = document.querySelector(".circle").getBoundingClientRect();
                               return box.width / box.height; })()""")
        self.assertAlmostEqual(circle, 1.0, places=3)
        for command in ("#restart", "#switch"):
            self.check_command(page.text(command))

    def check_command(self, command):
        self.assertTrue(command.startswith("tchat run linosc -c r.branch -s branch -o branch_PD1"), command)
        done = subprocess.run(["bash", "-c", command + " NMX=3 -q"], capture_output=True, text=True,
                              env={**os.environ, "PATH": os.path.dirname(TCHAT) + ":" + os.environ["PATH"]})
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_every_label_restarts(self):
        page = self.open("branch.html")
        for name in [row["name"] for row in table("p.branch") if row["label"] not in ("", "0")]:
            parts = page.value("JSON.parse(document.getElementById('data').textContent).branches[0].restart")
            self.check_start(parts[0] + name + parts[1] + name, name)

    def check_start(self, command, name):
        done = subprocess.run(["bash", "-c", command + " NMX=2 GRSTOP=0 -q"], capture_output=True, text=True,
                              env={**os.environ, "PATH": os.path.dirname(TCHAT) + ":" + os.environ["PATH"]})
        self.assertEqual(done.returncode, 0, (name, done.stderr))

    def test_a_point_without_an_orbit_shows_its_own_values_and_the_orbit_of_the_nearest_label(self):
        rows = table("p.branch")
        row = rows[4]
        self.assertIn(row["label"], ("", "0"))
        page = self.open("branch.html")
        at = self.place_of_point(page, 5)
        page.move(*at)
        self.assertIn("point\t5", page.text("#tip"))
        self.assertIn(row["alpha"], page.text("#tip"))
        page.click(*at)
        self.assertIn("point 5", page.text("#details h2"))
        self.check_values(page, row)
        self.assertIn("no stored orbit. Shown is the orbit of the nearest label", page.text("#details .warning"))
        self.assertEqual(page.value("document.querySelectorAll('.portrait svg').length"), 1)
        known = [name for name in row if re.fullmatch("multiplier[0-9]+_re", name) and row[name]]
        self.assertEqual(page.value("document.querySelectorAll('.multipliers tr').length"), len(known) + 1)

    def test_states_of_portrait_and_series_can_be_chosen(self):
        page = self.open("branch.html")
        self.open_label(page, "PD1")
        page.value("""(() => { const choice = document.querySelectorAll(".choices select")[1];
                      choice.value = "2"; choice.dispatchEvent(new Event("change")); })()""")
        self.assertIn("y1 over x1", page.value("document.querySelector('.portrait svg').getAttribute('aria-label')"))
        page.value("document.querySelectorAll('.choices input')[3].click()")
        self.assertEqual(page.value("document.querySelectorAll('.series svg').length"), 3)

    def test_the_wheel_zooms_a_drag_moves_and_reset_shows_everything(self):
        page = self.open("branch.html")
        whole = self.domain(page)
        at = self.place_of_point(page, 5)
        page.wheel(*at, -300)
        zoomed = self.domain(page)
        self.assertLess(zoomed[1] - zoomed[0], whole[1] - whole[0])
        page.drag(at, (at[0] + 60, at[1] + 10))
        moved = self.domain(page)
        self.assertAlmostEqual(moved[1] - moved[0], zoomed[1] - zoomed[0], places=9)
        self.assertLess(moved[0], zoomed[0])
        self.assertEqual(page.text("#details h2"), "Labels")  # a drag is no click
        for direction in (-1, 1):
            for _ in range(15):
                page.wheel(*at, 2000 * direction)
            self.assertTrue(page.value("Array.from(document.querySelectorAll('.axis text')).length > 3"))
        for key in "+-":
            for _ in range(60):
                page.press(key)
        page.click(*page.middle("#reset"))
        page.drawn_again()
        self.assertEqual(self.domain(page), whole)

    def test_keys(self):
        page = self.open("branch.html")
        whole = self.domain(page)
        page.press("+")
        self.assertLess(self.domain(page)[1] - self.domain(page)[0], whole[1] - whole[0])
        page.press("ArrowRight", SHIFT)
        page.press("0")
        self.assertEqual(self.domain(page), whole)
        page.press("-")
        page.press("Home")
        self.assertEqual(self.domain(page), whole)
        page.press("ArrowRight")
        first = page.text("#details h2")
        page.press("ArrowRight")
        self.assertNotEqual(page.text("#details h2"), first)
        page.press("ArrowLeft")
        self.assertEqual(page.text("#details h2"), first)
        page.press("ArrowUp")
        self.assertNotEqual(page.text("#details h2"), first)
        page.press("Escape")
        self.assertEqual(page.text("#details h2"), "Labels")
        page.press("?")
        self.assertTrue(page.value("!document.getElementById('keys').hidden"))
        self.keep(page, "keys")
        page.press("Escape")
        self.assertTrue(page.value("document.getElementById('keys').hidden"))
        page.value("document.querySelector('.marker[tabindex]').focus()")
        page.press("Enter")
        self.assertNotEqual(page.text("#details h2"), "Labels")

    def test_every_control_can_be_reached_by_tab_and_has_a_name(self):
        page = self.open("branch.html")
        page.value("document.body.focus()")
        names = set()
        for _ in range(12):
            page.press("Tab")
            names.add(page.value("""document.activeElement.getAttribute("aria-label") ||
                                    document.activeElement.innerText"""))
        self.assertTrue({"Zoom in", "Zoom out", "Reset", "Keys"} <= names, names)
        self.assertTrue(any(name.startswith("PD1, label") for name in names), names)
        self.assertTrue(any(name.startswith("Diagram:") for name in names), names)

    def test_a_small_window_has_one_column(self):
        page = self.open("branch.html", NARROW)
        self.open_label(page, "PD1")
        self.keep(page, "linosc_narrow_PD1")
        self.assertLessEqual(page.value("document.documentElement.scrollWidth"), NARROW[0])
        below = page.value("""document.getElementById("details").getBoundingClientRect().top >=
                              document.getElementById("pictures").getBoundingClientRect().bottom - 1""")
        self.assertTrue(below)
        page.value("window.scrollTo(0, 0)")
        page.drawn_again()
        self.keep(page, "linosc_narrow")

    def test_a_finger_opens_a_label_of_a_phone(self):
        page = self.open("branch.html", NARROW)
        page.resize(*NARROW, is_phone=True)
        page.drawn_again()
        page.tap(*page.middle('.marker[aria-label^="PD1,"] .symbol'))
        page.wait_for("document.querySelector('#details h2').innerText.startsWith('PD1')")

    def test_without_orbits_and_multipliers_the_page_says_why(self):
        for name in ("p.branch", "r.branch"):
            shutil.copy(name, name.replace("branch", "alone"))
        tchat("plot", "p.alone", "-o", "alone.html")
        page = self.open("alone.html")
        self.assertIn("q.alone is missing", page.text("#details"))
        self.assertIn("d.alone is missing", page.text("#details"))
        page.click(*self.place_of_point(page, 5))
        self.assertIn("Orbits are not available: q.alone is missing", page.text("#details"))

    def test_a_damaged_file_is_explained(self):
        for letter in "pdr":
            shutil.copy(letter + ".branch", letter + ".damaged")
        with open("q.damaged", "w") as file:
            file.write("1 2 3 </script><script>alert(1)</script>\n")
        tchat("plot", "p.damaged", "-o", "damaged.html")
        page = self.open("damaged.html")
        self.assertIn("q.damaged", page.text("#details .warning"))

    def test_equal_commands_make_equal_pages(self):
        with open("branch.html", "rb") as file:
            before = file.read()
        tchat("plot", "p.branch", "-o", "branch.html")
        with open("branch.html", "rb") as file:
            self.assertEqual(file.read(), before)
        self.assertLess(len(before), 2_000_000)

    def test_several_branches_and_panels_are_in_one_page(self):
        tchat("plot", "p.branch", "-y", "MAX x2", "--panel", "p.branch", "-y", "PERIOD", "-o", "panels.html")
        page = self.open("panels.html")
        self.assertEqual(page.value("tchat.pictures.length"), 2)
        self.open_label(page, "PD1")
        self.keep(page, "panels")
        self.assertIn("PD1", page.text("#details h2"))

    def test_orbits_series_and_multipliers_alone(self):
        for words in (["q.branch", "PD1"], ["--time", "q.branch", "PD1"], ["--multipliers", "q.branch"]):
            tchat("plot", *words, "-o", "other.html")
            page = self.open("other.html")
            self.keep(page, "other_" + words[0].strip("-"))
            self.assertGreater(page.value("tchat.pictures[0].panels.length"), 0)


class Mems(PageTest):
    def test_an_orbit_of_two_segments(self):
        shutil.copy(os.path.join(SOURCE, "problems", "mems", "mems.cpp"), ".")
        shutil.copy(os.path.join(SOURCE, "constants", "mems", "gc.nonimpacting"), "gc.nonimpacting")
        tchat("simulate", "mems", "-q", "PAR(V)=0.3", "--dat", "found", "-o", "found")
        tchat("run", "mems", "-q", "-c", "nonimpacting", "-d", "found", "-o", "free")
        tchat("resegment", "-q", "q.free", "GR1", "--to", "impacting", "-o", "born", "-p", "mems", "NMX=200")
        tchat("run", "mems", "-q", "-c", "born", "-s", "born", "-o", "mems")
        tchat("plot", "p.mems", "-o", "mems.html")
        rows = table("p.mems")
        page = self.open("mems.html")
        self.keep(page, "mems")
        name = next(row["name"].split()[0] for row in rows if row["type"] in ("PD", "LP", "GR"))
        self.open_label(page, name)
        self.keep(page, "mems_" + name)
        row = next(row for row in rows if name in row["name"].split())
        shown = self.point_values(page)
        self.assertEqual(float(shown["PERIOD"]), float(row["PERIOD"]))
        self.assertEqual(page.value("document.querySelectorAll('.portrait .line').length"), 2)
        at = self.place_of_point(page, 12)
        page.click(*at)
        self.assertIn("point 12", page.text("#details"))
        narrow = self.open("mems.html", NARROW)
        self.assertLessEqual(narrow.value("document.documentElement.scrollWidth"), NARROW[0])
        self.keep(narrow, "mems_narrow")


class Sweeps(PageTest):
    def test_dots_beneath_a_branch(self):
        tchat("sweep", "linosc", "-q", "--over", "alpha=3:3.3:31", "PAR(omega)=2.0072", "--section", "wall",
              "-o", "dots")
        tchat("plot", "dots.sweep", "-o", "sweep.html")
        page = self.open("sweep.html")
        self.keep(page, "sweep")
        dot = page.value("""(() => {
            const picture = tchat.pictures[0], panel = picture.panels[0], points = panel.data.clouds[0].points;
            const box = picture.plot.getBoundingClientRect();
            return {x: points[20], y: points[21], at: [box.left + panel.x(points[20]), box.top + panel.y(points[21])]};
        })()""")
        page.move(*dot["at"])
        self.assertIn(repr(dot["x"]).rstrip("0").rstrip("."), page.text("#tip"))
        page.click(*dot["at"])
        self.assertIn("Values", page.text("#details h2"))
        self.assertIn("periodic", page.text(".sweep-row"))
        self.assertIn("omega (fixed)\t2.0072", page.text(".sweep-row"))
        self.keep(page, "sweep_clicked")
        narrow = self.open("sweep.html", NARROW)
        self.assertLessEqual(narrow.value("document.documentElement.scrollWidth"), NARROW[0])
        self.keep(narrow, "sweep_narrow")

    def test_a_map_in_colours(self):
        tchat("sweep", "linosc", "-q", "--over", "x1=-1:1:20", "--over", "x2=-5:5:20", "PAR(alpha)=2.2",
              "PAR(omega)=1.8901", "-o", "basin")
        tchat("plot", "basin.sweep", "-o", "basin.html")
        page = self.open("basin.html")
        at = page.value("""(() => { const box = document.querySelector(".area").getBoundingClientRect();
                           return [box.left + 0.3 * box.width, box.top + 0.4 * box.height]; })()""")
        page.move(*at)
        self.keep(page, "basin")
        self.assertIn("colour", page.text("#tip"))
        page.click(*at)
        self.assertIn("attractor\t", page.text(".sweep-row"))
        self.keep(page, "basin_clicked")


class ManyPoints(PageTest):
    # A page that is opened begins to count here: performance.now() is 0 when the navigation begins. A browser that
    # draws without a graphics card, on a machine that builds something else besides, is given three times as long.
    SECONDS = 1.0
    PATIENCE = 3.0

    def test_ten_thousand_points_are_drawn_within_a_second(self):
        count = 10_000
        with open("p.branch") as file:
            header = [line for line in file if line.split()[0] == "0"]
        with open("p.many", "w") as points, open("d.many", "w") as diagnostics:
            points.writelines(header)
            for k in range(1, count + 1):
                angle = 60.0 * k / count
                alpha, norm = 3 + 0.01 * angle * math.cos(angle), 5 + 0.01 * angle * math.sin(angle)
                sign = -1 if k % 1000 < 500 else 1
                values = [alpha, norm, 1.0, 2.0, 1.0, 1.0, 3.13, 3.13]
                points.write("%4d%6d%4d%5d" % (1, sign * ((k - 1) % 9999 + 1), 0, 0) +
                             "".join("%19.10E" % value for value in values[:self.columns(header)]) + "\n")
                diagnostics.write("  BR    PT  TY  LAB      alpha\n%4d%6d%9d%13.5E\n" %
                                  (1, sign * ((k - 1) % 9999 + 1), 0, alpha) +
                                  "".join("Multiplier %d %.10E %.10E\n" % (j, math.cos(angle + j), math.sin(angle + j))
                                          for j in range(1, 5)) + "=" * 47 + "\n")
        tchat("plot", "p.many", "-o", "many.html")
        times = []
        for _ in range(3):
            page = self.open("many.html")
            times.append(float(page.value("document.documentElement.dataset.drawn")) / 1000)
        self.keep(page, "many")
        self.assertEqual(page.value("tchat.pictures[0].panels[0].data.computed.x.length"), count)
        print("%d points: %d bytes, drawn %s s after the page was asked for" %
              (count, os.path.getsize("many.html"), ", ".join("%.2f" % time for time in times)))
        self.assertLess(min(times), self.SECONDS * (self.PATIENCE if os.getloadavg()[0] > os.cpu_count() else 1))
        at = self.place_of_point(page, 4321)
        page.click(*at)
        self.assertIn("point 4", page.text("#details h2"))

    def columns(self, header):
        return len(header[-1].split("LAB")[1].replace("MAX ", "MAX_").split())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
