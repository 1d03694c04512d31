#!/usr/bin/env python3
"""Checks who includes whom in src/ (ARCHITECTURE.md, "Layers").

Each library is a call of vesalius_library in a CMakeLists.txt below src/: its FOLDERS bottom to top, the libraries it
USES, and those that its TESTS_USE besides.

1. A file includes its own folder, folders of its library that stand before its own, the core, and what its library USES.
   Unit tests include all of their library, `capsule` and TESTS_USE as well.
2. No unit (a header with its sources) includes another that includes it, over however many steps.
3. A library that OPENS_NO_FILES includes no <fstream>, <iostream> or <filesystem>.
4. A header that is installed (PUBLIC) includes only headers that are.
5. Every include is written from src/ and names a file that is there; every source belongs to a library.

Usage: check_layers.py [ROOT]. Prints one line for each violation; exit code 1 if there are any.
"""

import re
import sys
from dataclasses import dataclass
from pathlib import Path

CORE = "core"
FOR_TESTS = "capsule"
FILE_HEADERS = {"fstream", "iostream", "filesystem"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^">]+)[">]')
CALL = re.compile(r"^vesalius_library\(\s*([^)]*)\)", re.MULTILINE)
KEYWORDS = ("FOLDERS", "USES", "TESTS_USE", "PUBLIC", "OPENS_NO_FILES", "PRECOMPILED")


@dataclass
class Library:
    name: str
    folders: list  # below src/, bottom to top
    uses: list
    tests_use: list
    public: set  # headers, from src/
    opens_no_files: bool


def set_values(text):
    """Values of set(), so that FOLDERS and USES may come from a variable."""
    values = {}
    for name, value in re.findall(r"\bset\((\w+)\s+([^)$]*)\)", text):
        values[name] = value.split()
    return values


def read_library(path, source_folder):
    text = path.read_text()
    call = CALL.search(text)
    if not call:
        return None
    words = [word for line in call.group(1).splitlines() for word in line.split("#")[0].split()]
    values = set_values(text)
    lists = {keyword: [] for keyword in KEYWORDS}
    present, current = set(), None
    for word in words[1:]:
        if word in KEYWORDS:
            current = word
            present.add(word)
        elif word.startswith("${"):
            lists[current] += values.get(word[2:-1], [])
        else:
            lists[current].append(word)
    # The program's satellites add their folders and what those use (src/cli).
    for satellite in re.findall(r"\bvesalius_satellite\((\w+)([^)]*)\)", text):
        if satellite[0] != "name":
            lists["FOLDERS"].append(satellite[0])
            lists["USES"] += satellite[1].split()
    here = path.parent.relative_to(source_folder)
    folders = [str(here if folder == "." else here / folder) for folder in lists["FOLDERS"] or ["."]]
    public = {str(here / header) for header in lists["PUBLIC"]}
    return Library(words[0], folders, lists["USES"], lists["TESTS_USE"], public, "OPENS_NO_FILES" in present)


def includes(path):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        found = INCLUDE.match(line)
        if found:
            yield number, found.group(1) == '"', found.group(2)


def is_for_tests(path):
    return path.stem.endswith("_test") or path.stem.startswith("test_") or "_test_" in path.stem


def unit_of(target):
    """'io/files/ply' of 'io/files/ply.h'."""
    return target.rsplit(".", 1)[0]


def circles(graph):
    """Groups of units that include each other, each sorted (Tarjan's strongly connected components)."""
    index, low, on_stack, stack, found = {}, {}, set(), [], []

    def visit(unit):
        index[unit] = low[unit] = len(index)
        stack.append(unit)
        on_stack.add(unit)
        for other in graph.get(unit, ()):
            if other not in index:
                visit(other)
                low[unit] = min(low[unit], low[other])
            elif other in on_stack:
                low[unit] = min(low[unit], index[other])
        if low[unit] == index[unit]:
            group = []
            while True:
                other = stack.pop()
                on_stack.remove(other)
                group.append(other)
                if other == unit:
                    break
            if len(group) > 1:
                found.append(sorted(group))

    sys.setrecursionlimit(10000)
    for unit in sorted(graph):
        if unit not in index:
            visit(unit)
    return found


class Checker:
    def __init__(self, root):
        self.root = root
        self.source = root / "src"
        self.violations = []
        found = [read_library(path, self.source) for path in sorted(self.source.rglob("CMakeLists.txt"))]
        self.libraries = {library.name: library for library in found if library}
        self.public = {header for library in self.libraries.values() for header in library.public}
        self.owner = {folder: library for library in self.libraries.values() for folder in library.folders}
        self.graph = {}

    def complain(self, path, number, what):
        self.violations.append(f"{path.relative_to(self.root)}:{number}: {what}")

    def why_not(self, path, library, folder, target):
        """Why the file may not include the target, or None."""
        target_folder = str(Path(target).parent)
        other = self.owner.get(target_folder)
        if other is None:
            return f"includes {target}, which belongs to no library"
        if other is library:
            if is_for_tests(path) or library.folders.index(target_folder) <= library.folders.index(folder):
                return None
            return f"includes {target}, whose folder stands above {folder}"
        allowed = {CORE, *library.uses}
        if is_for_tests(path):
            allowed |= {FOR_TESTS, *library.tests_use}
        return None if other.name in allowed else f"includes {target}: {library.name} may not include {other.name}"

    def check_file(self, path):
        folder = str(path.parent.relative_to(self.source))
        library = self.owner.get(folder)
        if library is None:
            self.complain(path, 1, "belongs to no vesalius_library")
            return
        unit = unit_of(str(path.relative_to(self.source)))
        edges = self.graph.setdefault(unit, set()) if not is_for_tests(path) else set()
        for number, quoted, target in includes(path):
            if not quoted:
                if library.opens_no_files and not is_for_tests(path) and target in FILE_HEADERS:
                    self.complain(path, number, f"includes <{target}>: {library.name} opens no file and prints nothing")
            elif target.endswith(".inc"):
                continue
            elif "/" not in target:
                self.complain(path, number, f'includes "{target}", expected a path from src/')
            elif not (self.source / target).is_file():
                self.complain(path, number, f'includes "{target}", which src/ lacks')
            else:
                reason = self.why_not(path, library, folder, target)
                if reason:
                    self.complain(path, number, reason)
                if str(path.relative_to(self.source)) in library.public and target not in self.public:
                    self.complain(path, number, f"is installed and includes {target}, which is not")
                if unit_of(target) != unit:
                    edges.add(unit_of(target))

    def check(self):
        if CORE not in self.libraries:
            sys.exit("src/: no CMakeLists.txt calls vesalius_library(core ...)")
        for path in sorted(self.source.rglob("*")):
            if path.suffix in (".h", ".cpp"):
                self.check_file(path)
        for group in circles(self.graph):
            self.violations.append(f"src/{group[0]}.h:1: units include each other: {', '.join(group)}")
        return self.violations


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    violations = Checker(root).check()
    print("\n".join(violations) or "layers: all includes go downwards")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
