#!/usr/bin/env python3
"""Compiles the examples in C# and the one for Unity, and runs them beside C. Exit code 77 without mcs or mono.

Usage: csharp.py SOURCE_DIR LIBRARY_FOLDER LAYOUTS REFERENCE
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from expected import expect_example, expect_same, expected_frames, run


def refused(command, what, **options):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False,
                          **options)
    if done.returncode != 1 or what not in done.stderr or len(done.stderr.splitlines()) != 1:
        sys.exit(f"expected a line with {what!r} and exit code 1, got {done.returncode}: {done.stderr}")


def main():
    source, library, layouts, reference = (Path(a).resolve() for a in sys.argv[1:5])
    if not shutil.which("mcs") or not shutil.which("mono"):
        print("SKIPPED: no mcs or mono (mono-mcs, mono-runtime)")
        sys.exit(77)
    binding, here = source / "examples/csharp/Vesalius.cs", source / "tests/c/csharp"
    model = source / "data/models/default.model"
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        quiet = {**os.environ, "LD_LIBRARY_PATH": str(library), "VESALIUS_MODELS": ""}

        def compiled(name, *sources):
            run("mcs", "-langversion:6", "-warn:4", "-warnaserror", "-nowarn:0649,0414", f"-out:{folder / name}", *sources)
            return ["mono", "--debug", folder / name]

        print("structures")
        expect_same(run(*compiled("Layouts.exe", binding, here / "Layouts.cs")), run(layouts), "C#'s structures")
        print("the example")
        frames = expected_frames(reference, source / "data/rooms", folder)[:2]
        example = compiled("DetectPeople.exe", binding, source / "examples/csharp/DetectPeople.cs")
        expect_example(example, model, frames, env=quiet)
        expect_same(run(*example, "-", *frames[0][0], env=quiet), frames[0][1], "the model that comes with vesalius")
        refused([*example, "/none.forest", *frames[0][0]], "/none.forest", env=quiet)
        refused([*example, model, frames[0][0][0], "640", "481", *frames[0][0][3:]], "depth: 307200 values, expected 307840",
                env=quiet)
        refused([*example, model, *frames[0][0][:3], "-1", *frames[0][0][4:]], "camera: focal length", env=quiet)
        print("the rest of the binding")
        print(run(*compiled("Binding.exe", binding, here / "Binding.cs"), model, *frames[0][0], env=quiet))
        print("Unity")
        unity = compiled("DriveUnity.exe", binding, here / "UnityEngine.cs", here / "DriveUnity.cs",
                         source / "examples/unity/VesaliusPeople.cs")
        people = frames[0][1].count("person ")
        lines = run(*unity, source / "data/models", *frames[0][0], env=quiet).splitlines()
        expect_same(lines[0].split(", shown")[0], f"people {people}, spheres {32 * people}", "the component")
        expect_same(sum("in the room" in line for line in lines), people, "the component")
        expect_same(lines[-1], "people 0, spheres 0", "the component, of nobody,")


if __name__ == "__main__":
    main()
