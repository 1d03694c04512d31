"""Renders people, trains a small forest on them and finds people with it: usage: train_forest.py FOLDER

Rendering, training and evaluation are the program's: `vesalius` must be on PATH.
"""

import subprocess
import sys
from pathlib import Path

import vesalius


def program(*arguments):
    subprocess.run(["vesalius", *map(str, arguments)], check=True)


folder = Path(sys.argv[1])
options = folder / "options.toml"
folder.mkdir(parents=True, exist_ok=True)
options.write_text("trees = 2\ndepth = 12\npixels = 500\n")
recipe = folder / "recipe.toml"
recipe.write_text('[body]\nkind = "builtin"\n[pose]\ncaptured = 0\n')
program("train", "--recipe", recipe, "--count", 300, "--options", options, "--out", folder / "small.forest", "--quiet")
program("synth", "--recipe", recipe, "--seed", 9, "--count", 3, "--format", "folder", "--out", folder / "unseen", "-q")
detector = vesalius.Detector(folder / "small.forest")
for frame in vesalius.open(folder / "unseen"):
    print(frame, len(detector.detect(frame)), "people")
