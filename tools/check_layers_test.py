#!/usr/bin/env python3
"""check_layers.py passes a tree that keeps the rules and fails each way of breaking them."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).parent / "check_layers.py"

GOOD = {
    "src/CMakeLists.txt": "set(CORE_UNITS\n    error\n    image\n    detect)\n",
    "src/vesalius/error.h": "#include <string>\n",
    "src/vesalius/image.h": '#include "vesalius/error.h"\n',
    "src/vesalius/detect.h": '//   #include "io/read.h"\n#include "vesalius/image.h"\n',
    "src/vesalius/detect.cpp": '#include "vesalius/detect.h"\n#include "generated.inc"\n',
    "src/vesalius/error_test.cpp": '#include <fstream>\n#include "vesalius/detect.h"\n',
    "src/vesalius/vesalius.h": '#include "vesalius/detect.h"\n',
    "src/io/read.h": '#include "vesalius/vesalius.h"\n',
    "src/io/read.cpp": '#include "io/read.h"\n#include <iostream>\n',
    "src/draw/draw.h": '#include "vesalius/image.h"\n',
    "src/cli/main.cpp": '#include "draw/draw.h"\n#include "io/read.h"\n',
}


def run(changes):
    """Exit code and output for the good tree with these files changed."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in {**GOOD, **changes}.items():
            path = Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        done = subprocess.run([sys.executable, SCRIPT, folder], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr


class CheckLayers(unittest.TestCase):
    def expect_violation(self, changes, place):
        code, output = run(changes)
        self.assertEqual(code, 1, output)
        self.assertEqual(len(output.splitlines()), 1, output)
        self.assertTrue(output.startswith(place), output)

    def test_good_tree_passes(self):
        code, output = run({})
        self.assertEqual(code, 0, output)

    def test_core_includes_unit_below(self):
        self.expect_violation({"src/vesalius/error.h": '\n#include "vesalius/image.h"\n'}, "src/vesalius/error.h:2:")

    def test_core_includes_satellite(self):
        self.expect_violation({"src/vesalius/detect.cpp": '#include "io/read.h"\n'}, "src/vesalius/detect.cpp:1:")

    def test_core_unit_missing_from_list(self):
        self.expect_violation({"src/vesalius/stray.cpp": ""}, "src/vesalius/stray.cpp:1:")

    def test_core_opens_files(self):
        self.expect_violation({"src/vesalius/image.h": "#include <fstream>\n"}, "src/vesalius/image.h:1:")

    def test_satellite_includes_satellite(self):
        self.expect_violation({"src/draw/draw.h": '#include "io/read.h"\n'}, "src/draw/draw.h:1:")

    def test_test_of_satellite_includes_satellite(self):
        self.expect_violation({"src/draw/draw_test.cpp": '#include "io/read.h"\n'}, "src/draw/draw_test.cpp:1:")

    def test_satellite_includes_cli(self):
        changes = {"src/cli/flags.h": "", "src/io/read.h": '#include "cli/flags.h"\n'}
        self.expect_violation(changes, "src/io/read.h:1:")

    def test_path_not_from_root(self):
        self.expect_violation({"src/io/read.cpp": '#include "read.h"\n'}, "src/io/read.cpp:1:")

    def test_missing_file(self):
        self.expect_violation({"src/io/read.cpp": '#include "io/gone.h"\n'}, "src/io/read.cpp:1:")

    def test_missing_list(self):
        code, output = run({"src/CMakeLists.txt": ""})
        self.assertNotEqual(code, 0)
        self.assertIn("CORE_UNITS", output)


if __name__ == "__main__":
    unittest.main()
