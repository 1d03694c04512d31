"""The package's types, as mypy and pyright see them: they find each wrong line of typed_use.py and nothing else, and nothing in the
package itself.

Usage: test_types.py CHECKERS   CHECKERS: an environment that has both (tools/python/pins/types.txt); the package is found as Python does
"""

import importlib.util
import os
import re
import subprocess
import sys
import unittest
from pathlib import Path

import vesalius

CHECKERS = Path(sys.argv.pop(1)).resolve() / "bin"
PACKAGE = Path(vesalius.__file__).parent
# Without Rerun, which not every environment has, nobody knows the types of what shows people in it.
SOURCES = [path for path in sorted(PACKAGE.glob("*.py")) if path.stem != "rerun" or importlib.util.find_spec("rerun")]
INSTALLED = PACKAGE.parent.name == "site-packages"  # where mypy finds it by itself, and takes no file of it for a source
USE = Path(__file__).resolve().parent / "typed_use.py"
WRONG = {number for number, line in enumerate(USE.read_text(encoding="utf-8").splitlines(), 1) if line.endswith("# WRONG")}
NAMED = re.compile(r"^\s*(\S+\.pyi?):(\d+)(?::\d+)?(?: -|:) error: ", re.MULTILINE)


def check(*command):
    """Returns {file name: lines with errors} and all that was said."""
    environment = dict(os.environ, PATH=f"{CHECKERS}:{os.environ['PATH']}", MYPYPATH="" if INSTALLED else str(PACKAGE.parent))
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, env=environment, cwd=USE.parent)
    found = {}
    for name, line in NAMED.findall(done.stdout):
        found.setdefault(Path(name).name, set()).add(int(line))
    return found, done.stdout + done.stderr


class Types(unittest.TestCase):
    def expect(self, *command):
        found, said = check(*command)
        self.assertEqual(found, {USE.name: WRONG}, said)

    def test_mypy(self):
        # nanobind writes arrays of any type without saying so.
        sources = [] if INSTALLED else SOURCES
        self.expect(CHECKERS / "mypy", "--strict", "--allow-any-generics", "--python-executable", sys.executable, USE, *sources)

    def test_pyright(self):
        version = subprocess.run([CHECKERS / "pyright", "--version"], capture_output=True, text=True)
        if version.returncode != 0:  # it fetches itself from a registry of Node packages
            self.skipTest(f"pyright cannot be had: {version.stderr.strip().splitlines()[-1]}")
        self.expect(CHECKERS / "pyright", "--pythonpath", sys.executable, USE, *SOURCES)


if __name__ == "__main__":
    unittest.main()
