"""pip install . in this folder: the package tchat, in the version of the program."""

import pathlib
import re

from setuptools import setup

PROJECT = pathlib.Path(__file__).resolve().parents[2] / "CMakeLists.txt"

setup(name="tchat", version=re.search(r"project\(tchat VERSION ([0-9.]+)", PROJECT.read_text())[1],
      description="continuation of periodic orbits of hybrid dynamical systems", packages=["tchat"],
      python_requires=">=3.9", install_requires=["numpy"], extras_require={"frame": ["pandas"], "plot": ["matplotlib"]})
