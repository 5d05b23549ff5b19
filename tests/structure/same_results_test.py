"""scripts/same-results finds different files, missing files and failures of make, and its exit statuses say so.

    same_results_test.py SCRIPT

Two shell scripts take the place of tchat, and a folder of Makefiles that of problems/.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

SCRIPT = os.path.abspath(sys.argv.pop(1))
MAKEFILE = "all:\n\tcd $(OUT) && $(TCHAT) {}\n"
# What `tchat WHAT` writes: the same file always, another one as its own name says, files of one executable only.
TCHAT = """#!/bin/sh
case $1 in
same) echo 1 2.5 >p.same; echo "$PWD" >r.same ;;
rounding) printf '1 EP 200.0\\n2 PD %s\\n' {number} >p.rounding ;;
missing) echo 1 >p.both; echo 1 >q.{name} ;;
one_fails) echo 1 >p.both; {status} ;;
both_fail) echo 'no convergence' >&2; exit 3 ;;
beside) echo 1 >"$OLDPWD/q.beside"; echo {name} >"$OLDPWD/beside.so" ;;
slow) trap 'echo >"$ENDED"; exit 1' TERM; echo >"$STARTED"; sleep 60 & wait ;;
esac
"""


class SameResults(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)
        (self.folder / "temporary").mkdir()
        for name in ("same", "rounding", "missing", "one_fails", "both_fail", "beside", "nothing", "slow"):
            (self.folder / "problems" / name).mkdir(parents=True)
            (self.folder / "problems" / name / "Makefile").write_text(MAKEFILE.format(name))
        for name, number, status in (("old", "100.0", "true"), ("new", "100.00000002", "exit 1")):
            program = self.folder / name
            program.write_text(TCHAT.format(name=name, number=number, status=status))
            program.chmod(0o755)

    def words(self, *words):
        return [sys.executable, SCRIPT, "--problems", str(self.folder / "problems"), *words]

    def environment(self):
        return {**os.environ, "TMPDIR": str(self.folder / "temporary"), "STARTED": str(self.folder / "started"),
                "ENDED": str(self.folder / "ended")}

    def run_script(self, status, *words):
        result = subprocess.run(self.words(*words), capture_output=True, text=True, cwd=self.folder,
                                env=self.environment())
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        self.assertEqual(os.listdir(self.folder / "temporary"), [])
        return result.stdout + result.stderr

    def test_same(self):
        text = self.run_script(0, "./old", "./new", "--only", "same,beside", "--keep", "kept")
        self.assertIn("3 files of 2 problems: no difference", text)
        self.assertEqual((self.folder / "kept/new/same/p.same").read_text(), "1 2.5\n")
        self.assertIn("exists already", self.run_script(2, "./old", "./new", "--keep", "kept"))

    def test_differences(self):
        text = self.run_script(1, "./old", "./new", "--only", "rounding,missing,one_fails,both_fail,nothing")
        self.assertIn("p.rounding: first differs in line 2; largest relative difference of numbers 1.0e-10\n", text)
        self.assertIn("old: 2 PD 100.0\n    new: 2 PD 100.00000002\n", text)
        self.assertIn("missing/q.old: only OLD wrote it", text)
        self.assertIn("missing/q.new: only NEW wrote it", text)
        self.assertIn("one_fails: make fails with NEW only", text)
        self.assertIn("both_fail: make fails with both executables", text)
        self.assertIn("no convergence", text)
        self.assertIn("nothing: make wrote no files", text)
        self.assertIn("3 of 5 files differ; failed: both_fail, nothing, one_fails", text)

    def test_usage(self):
        self.assertIn("there is no executable ./none", self.run_script(2, "./old", "./none"))
        self.assertIn("on PATH", self.run_script(2, "no-such-tchat", "./old"))
        self.assertIn("chmod +x", self.run_script(2, "./old", "problems/same/Makefile"))
        self.assertIn("problems with one: beside, both_fail", self.run_script(2, "./old", "./new", "--only", "sme"))

    def test_interrupt(self):
        """An interrupt ends what runs and removes the temporary folder."""
        script = subprocess.Popen(self.words("old", "new", "--only", "slow"), stdout=subprocess.PIPE, env={
            **self.environment(), "PATH": f"{self.folder}:{os.environ['PATH']}"})
        while not (self.folder / "started").exists():
            self.assertIsNone(script.poll())
            time.sleep(0.01)
        script.terminate()
        self.assertEqual(script.communicate(timeout=20)[0], b"")
        self.assertEqual(script.returncode, 130)
        self.assertEqual(os.listdir(self.folder / "temporary"), [])
        self.assertTrue((self.folder / "ended").exists())


if __name__ == "__main__":
    unittest.main()
