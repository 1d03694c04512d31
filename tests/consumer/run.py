#!/usr/bin/env python3
"""Installs to a temporary prefix, builds the examples against it and runs them beside those of the build tree.

Usage: run.py SOURCE_DIR BUILD_DIR EXAMPLES_DIR, where EXAMPLES_DIR holds the build tree's programs
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path


def run(*command):
    print("$", *command, flush=True)
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{done.stdout}\nexit code {done.returncode}")
    return done.stdout


def expect(condition, what):
    if not condition:
        sys.exit(what)


def main():
    source, build, examples = (Path(a).resolve() for a in sys.argv[1:4])
    model, frames = source / "data/models/capsule.forest", source / "data/sample"
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        prefix, outside = folder / "prefix", folder / "build"
        run("cmake", "--install", build, "--prefix", prefix)
        (headers,) = prefix.glob("include/vesalius-*")
        run("cmake", "-S", source / "tests/consumer", "-B", outside, f"-DCMAKE_PREFIX_PATH={prefix}",
            f"-DEXAMPLES={source / 'examples'}", f"-DVESALIUS_HEADERS={headers}")
        run("cmake", "--build", outside)

        def both(name, *arguments):
            """What the program says that uses the installed libraries, and that it says the same as the build tree's."""
            said = run(outside / name / name, *arguments)
            expect(said == run(examples / name, *arguments), f"{name}: the installed library and the build tree's disagree")
            return said

        found = both("detect_people", model, frames)
        expect(" parts\n" in found, f"expected people in the sample, got: {found!r}")
        drawn = both("draw_people", model, frames, folder / "drawn").split()
        expect(len(drawn) == 8 and all(Path(each).read_bytes()[1:4] == b"PNG" for each in drawn), f"no pictures: {drawn}")
        grown = both("own_appearance", model, frames)
        expect(" pixels\n" in grown, f"expected people in the sample, got: {grown!r}")
        lines = [json.loads(line) for line in both("stream_people", model, frames).splitlines()]
        expect(len(lines) == 8 and any(line["people"] for line in lines), f"other frames: {lines}")

        # The installed program finds the installed model.
        bin_folder = prefix / "bin"
        said = run(bin_folder / "vesalius", "detect", frames)
        expect("person" in said or "people" in said, f"expected people in the sample, got: {said!r}")


if __name__ == "__main__":
    main()
