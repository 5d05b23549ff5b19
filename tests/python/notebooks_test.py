"""The notebooks of the documentation, executed by nbconvert: every cell runs, and what they verify holds.

usage: notebooks_test.py TCHAT NOTEBOOK      exit status 77 (skipped) without nbconvert, a kernel or matplotlib
"""

import importlib.util
import json
import os
import subprocess
import sys
import tempfile

if any(importlib.util.find_spec(name) is None for name in ("nbconvert", "ipykernel", "matplotlib", "numpy")):
    print("skipped: no nbconvert, ipykernel, matplotlib or numpy (Debian: jupyter-nbconvert python3-ipykernel "
          "python3-matplotlib)")
    sys.exit(77)
tchat, notebook = (os.path.abspath(word) for word in sys.argv[1:3])
package = os.path.join(os.path.dirname(notebook), "..", "..", "python")
with tempfile.TemporaryDirectory() as folder:
    environment = dict(os.environ, TCHAT=tchat, PYTHONPATH=os.path.abspath(package), IPYTHONDIR=folder,
                       JUPYTER_RUNTIME_DIR=folder, PYDEVD_DISABLE_FILE_VALIDATION="1")
    words = [sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute", "--output-dir", folder, notebook]
    done = subprocess.run(words, env=environment, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(done.stdout)
    with open(os.path.join(folder, os.path.basename(notebook)), encoding="utf-8") as file:
        cells = json.load(file)["cells"]
outputs = [output for cell in cells for output in cell.get("outputs", [])]
texts = "".join("".join(output["text"]) for output in outputs if output.get("name") == "stdout")
if "verified: True" not in texts:
    sys.exit("nothing is verified:\n" + texts)
if not any("image/png" in output.get("data", {}) for output in outputs):
    sys.exit("no picture")
