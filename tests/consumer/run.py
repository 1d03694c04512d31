#!/usr/bin/env python3
"""Installs to a temporary prefix, builds the program of vesalius.h against it and runs it on the sample.

Usage: run.py SOURCE_DIR BUILD_DIR EXAMPLE_BINARY
"""

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


def program_of(header):
    """The program in the header's first comment: the lines that are indented in it."""
    lines = []
    for line in header.read_text().splitlines():
        if line.startswith("//   "):
            lines.append(line[5:])
        elif lines and not line.startswith("//"):
            break
    return lines


def code_of(source):
    return [line for line in source.read_text().splitlines() if line and not line.startswith("//")]


def main():
    source, build, example = (Path(a).resolve() for a in sys.argv[1:4])
    with tempfile.TemporaryDirectory() as folder:
        prefix, outside = Path(folder) / "prefix", Path(folder) / "build"
        run("cmake", "--install", build, "--prefix", prefix)
        (headers,) = prefix.glob("include/vesalius-*")
        program = program_of(headers / "vesalius/vesalius.h")
        if program != code_of(source / "examples/detect_people.cpp"):
            sys.exit("examples/detect_people.cpp differs from the program in src/vesalius/vesalius.h")
        main_cpp = Path(folder) / "main.cpp"
        main_cpp.write_text("\n".join(program) + "\n")
        run("cmake", "-S", source / "tests/consumer", "-B", outside, f"-DCMAKE_PREFIX_PATH={prefix}",
            f"-DMAIN_SOURCE={main_cpp}", f"-DVESALIUS_HEADERS={headers}")
        run("cmake", "--build", outside)
        arguments = source / "data/models/capsule.forest", source / "data/sample"
        found = run(outside / "consumer", *arguments)
        if " parts\n" not in found:
            sys.exit(f"expected people in the sample, got: {found!r}")
        if found != run(example, *arguments):
            sys.exit("the installed library and the build tree's disagree")


if __name__ == "__main__":
    main()
