#!/usr/bin/env python3
"""Runs examples/detect_people.c beside the C++ detector, and on what it must refuse.

Usage: example.py SOURCE_DIR EXAMPLE REFERENCE
"""

import subprocess
import sys
import tempfile
from pathlib import Path

from expected import expect_example, expected_frames


def refused(command, code, what):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != code or what not in done.stderr or len(done.stderr.splitlines()) != 1:
        sys.exit(f"expected a line with {what!r} and exit code {code}, got {done.returncode}: {done.stderr}")


def main():
    source, example, reference = (Path(a).resolve() for a in sys.argv[1:4])
    model = source / "data/models/default.model"
    with tempfile.TemporaryDirectory() as folder:
        frames = expected_frames(reference, source / "data/rooms", folder)[:3]  # CLibrary has all
        expect_example([example], model, frames)
        expect_example([example], "-", frames[:1])
        depth, width, height, *camera = frames[0][0]
        refused([example], 2, "usage")
        refused([example, "/none.forest", depth, width, height, *camera], 1, "/none.forest")
        refused([example, model, depth, width, int(height) + 1, *camera], 1, "expected a file of")
        refused([example, model, depth, "0", height, *camera], 2, "width and height")
        refused([example, model, depth, width, height, "nan", *camera[1:]], 1, "focal length")


if __name__ == "__main__":
    main()
