#!/usr/bin/env python3
"""Checks who includes whom in src/ (ARCHITECTURE.md, "Layers").

1. A core file (src/vesalius) includes only units listed above its own in CORE_UNITS of src/CMakeLists.txt, and
   nothing that opens files or prints.
2. A satellite (io, draw, train, ...) includes the core and itself, never another satellite.
3. Only cli and python put satellites together. Unit tests may include all of the core and their own folder.

Usage: check_layers.py [ROOT]. Prints one line for each violation; exit code 1 if there are any.
"""

import re
import sys
from pathlib import Path

JOINERS = {"cli", "python"}
UMBRELLA = "vesalius"  # src/vesalius/vesalius.h includes any core unit
NOT_IN_CORE = {"fstream", "iostream", "filesystem"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def core_units(root):
    text = (root / "src/CMakeLists.txt").read_text()
    listed = re.search(r"set\(CORE_UNITS\s+([^)]*)\)", text)
    if not listed:
        sys.exit("src/CMakeLists.txt: no set(CORE_UNITS ...)")
    return listed.group(1).split()


def includes(path):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        found = INCLUDE.match(line)
        if found:
            yield number, found.group(1) == '"', found.group(2)


def unit_of(path):
    return Path(path).name.split(".")[0]


class Checker:
    def __init__(self, root):
        self.root = root
        self.units = core_units(root)
        self.rank = {unit: i for i, unit in enumerate(self.units)}
        self.violations = []

    def complain(self, path, number, what):
        self.violations.append(f"{path.relative_to(self.root)}:{number}: {what}")

    def check_core_unit(self, path):
        unit = unit_of(path)
        if unit == UMBRELLA or unit in self.rank:
            return
        if not (unit.endswith("_test") and unit[: -len("_test")] in self.rank):
            self.complain(path, 1, "is no unit of CORE_UNITS in src/CMakeLists.txt")

    def check_core_include(self, path, number, target):
        own, other = unit_of(path), unit_of(target)
        if own.endswith("_test") or own == UMBRELLA or own == other:
            return
        if other not in self.rank:
            self.complain(path, number, f"includes {target}, which is no unit of the core")
        elif self.rank[other] > self.rank.get(own, -1):
            self.complain(path, number, f"includes {target}, which stands below {own} in CORE_UNITS")

    def check_file(self, path):
        folder = path.relative_to(self.root / "src").parts[0]
        in_core = folder == "vesalius"
        is_test = unit_of(path).endswith("_test")
        if in_core:
            self.check_core_unit(path)
        for number, quoted, target in includes(path):
            if not quoted:
                if in_core and not is_test and target in NOT_IN_CORE:
                    self.complain(path, number, f"includes <{target}>: the core opens no file and prints nothing")
                continue
            target_folder = target.split("/")[0] if "/" in target else None
            if target_folder is None:
                if not target.endswith(".inc"):
                    self.complain(path, number, f'includes "{target}", expected a path from src/')
            elif not (self.root / "src" / target).is_file():
                self.complain(path, number, f'includes "{target}", which src/ lacks')
            elif in_core and target_folder == "vesalius":
                self.check_core_include(path, number, target)
            elif target_folder not in ("vesalius", folder) and folder not in JOINERS:
                self.complain(path, number, f'includes "{target}": {folder} may not include {target_folder}')

    def check(self):
        for path in sorted((self.root / "src").rglob("*")):
            if path.suffix in (".h", ".cpp"):
                self.check_file(path)
        return self.violations


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    violations = Checker(root).check()
    print("\n".join(violations) or "layers: all includes go downwards")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
