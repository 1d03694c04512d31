#!/usr/bin/env python3
"""Checks who includes whom, and how much there is (ARCHITECTURE.md, "Folders").

The product stands in src/, what its users include in include/vesalius/, the workshop in training/. Each library is a call of
vesalius_library in a CMakeLists.txt there: its FOLDERS bottom to top, the libraries it USES, and those that its TESTS_USE
besides. PUBLIC says whose a header of include/vesalius/ is: `base/image.h` belongs to the folder base.

1. A file includes its own folder, folders of its library that stand before its own, the core, and what its library USES.
   Unit tests include all of their library, `capsule` and TESTS_USE as well.
2. No unit (a header with its sources) includes another that includes it, over however many steps.
3. A library that OPENS_NO_FILES includes no <fstream>, <iostream> or <filesystem>.
4. A public header includes only public headers. There are at most 25, those of the table of docs/library.md.
5. Every include is written from include/ or its wing's folder and names a file that is there; every source belongs to a library.
6. No library of the product uses one of the workshop. The program has the workshop's commands by its build alone. The workshop
   includes of the product what is PUBLIC, and what tools/private_headers.txt lists with a reason; unit tests include all.
7. A folder has at most 25 units besides tests, and at most the lines of C++ that tools/line_budget.txt grants it.
8. No two headers define types of one name in one namespace: the linker would keep one's functions for both.

Prints one line for each violation; exit code 1 if there are any.
"""

import argparse
import re
import sys
from dataclasses import dataclass
from pathlib import Path

CORE = "core"
FOR_TESTS = "capsule"
INCLUDE_DIR = "include"
WINGS = (INCLUDE_DIR, "src", "training", "tests/capsule", "tests/simulator")
MOST_UNITS = 25
MOST_PUBLIC = 25
TABLE = "docs/library.md"
PRIVATE = "tools/private_headers.txt"
BUDGET = "tools/line_budget.txt"
FILE_HEADERS = {"fstream", "iostream", "filesystem"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^">]+)[">]')
NAMESPACE = re.compile(r"^(?:inline )?namespace ([\w:]+)? ?\{|^\}\s*// namespace")
TYPE = re.compile(r"^(?:struct|class) (?:alignas\(.*\) )?(\w+)[^;]*\{")
CALL = re.compile(r"^vesalius_library\(\s*([^)]*)\)", re.MULTILINE)
KEYWORDS = ("FOLDERS", "USES", "TESTS_USE", "PUBLIC", "OPENS_NO_FILES", "PRECOMPILED")


@dataclass
class Library:
    name: str
    wing: str
    folders: list  # from the wing's folder, bottom to top
    uses: list
    tests_use: list
    public: set  # headers, from the wing's folder
    opens_no_files: bool


def set_values(text):
    """Values of set(), so that FOLDERS and USES may come from a variable."""
    values = {}
    for name, value in re.findall(r"\bset\((\w+)\s+([^)$]*)\)", text):
        values[name] = value.split()
    return values


def read_library(path, root):
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
    wing = path.relative_to(root).parts[0]
    here = path.parent.relative_to(root / wing)
    folders = [str(here if folder == "." else here / folder) for folder in lists["FOLDERS"] or ["."]]
    public = {str(here / header) for header in lists["PUBLIC"]}
    return Library(words[0], wing, folders, lists["USES"], lists["TESTS_USE"], public, "OPENS_NO_FILES" in present)


def includes(path):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        found = INCLUDE.match(line)
        if found:
            yield number, found.group(1) == '"', found.group(2)


def types(path):
    """The types that a header defines, but templates: number of the line, name with namespaces."""
    inside, before = [], ""
    for number, line in enumerate(path.read_text().splitlines(), 1):
        space, found = NAMESPACE.match(line), TYPE.match(line)
        if space and line.startswith("}"):
            del inside[-1:]
        elif space:
            inside.append(space.group(1) or "")
        elif found and not before.startswith("template"):
            yield number, "::".join([*inside, found.group(1)])
        before = line


def is_for_tests(path):
    return path.stem.endswith("_test") or path.stem.startswith("test_") or "_test_" in path.stem


def unit_of(target):
    """'io/files/ply' of 'io/files/ply.h'."""
    return target.rsplit(".", 1)[0]


def units_of(paths):
    """The units of a folder: its headers, and sources that go with none of them by name ('parallel_std' goes with 'parallel')."""
    headers = {path.stem for path in paths if path.suffix == ".h"}
    sources = {path.stem for path in paths if path.suffix == ".cpp"}
    return headers | {name for name in sources if not any(name.startswith(header + "_") for header in headers)}


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
        self.violations = []
        found = [read_library(path, root) for wing in WINGS for path in sorted((root / wing).rglob("CMakeLists.txt"))]
        self.libraries = {library.name: library for library in found if library}
        self.public = {header for library in self.libraries.values() for header in library.public}
        self.places = {f"vesalius/{Path(header).name}": header for header in self.public}
        self.owner = {folder: library for library in self.libraries.values() for folder in library.folders}
        self.graph = {}
        self.private = self.read_private()  # headers and folders, each with whether somebody includes it

    def complain(self, path, number, what):
        self.violations.append(f"{path.relative_to(self.root)}:{number}: {what}")

    def wing_of(self, path):
        return path.relative_to(self.root).parts[0]

    def place_of(self, path):
        """The file's path from its wing's folder; of a public header the one that it would have beside its source."""
        place = path.relative_to(self.root / self.wing_of(path))
        return Path(self.places.get(str(place), place)) if self.wing_of(path) == INCLUDE_DIR else place

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
        if library.wing == "src" and other.wing == "training":
            return f"includes {target}: the product uses nothing of the workshop"
        allowed = {CORE, *library.uses}
        if is_for_tests(path):
            allowed |= {FOR_TESTS, *library.tests_use}
        return None if other.name in allowed else f"includes {target}: {library.name} may not include {other.name}"

    def check_file(self, path):
        folder = str(self.place_of(path).parent)
        library = self.owner.get(folder)
        if self.wing_of(path) == INCLUDE_DIR and str(self.place_of(path)) not in self.public:
            self.complain(path, 1, "is on no PUBLIC list")
            return
        if library is None:
            self.complain(path, 1, "belongs to no vesalius_library")
            return
        unit = unit_of(str(self.place_of(path)))
        edges = self.graph.setdefault(unit, set()) if not is_for_tests(path) else set()
        for number, quoted, target in includes(path):
            if not quoted:
                if library.opens_no_files and not is_for_tests(path) and target in FILE_HEADERS:
                    self.complain(path, number, f"includes <{target}>: {library.name} opens no file and prints nothing")
            elif target.endswith(".inc"):
                continue
            elif "/" not in target:
                self.complain(path, number, f'includes "{target}", expected a path from include/, src/ or training/')
            elif not any((self.root / wing / target).is_file() for wing in (INCLUDE_DIR, "src", "training", "tests")):
                self.complain(path, number, f'includes "{target}", which is not there')
            else:
                target = self.places.get(target, target)
                reason = self.why_not(path, library, folder, target)
                if reason:
                    self.complain(path, number, reason)
                if str(self.place_of(path)) in library.public and target not in self.public:
                    self.complain(path, number, f"is public and includes {target}, which is not")
                of_product = self.owner.get(str(Path(target).parent), library).wing == "src"
                if library.wing == "training" and of_product and target not in self.public and not is_for_tests(path):
                    self.check_private(path, number, target)
                if unit_of(target) != unit:
                    edges.add(unit_of(target))

    def read_private(self):
        """What the workshop may include besides public headers: each line is headers and folders, a colon, and why."""
        path = self.root / PRIVATE
        lines = path.read_text().splitlines() if path.is_file() else []
        reasons = [line.partition(":") for line in lines if line and not line.startswith("#")]
        for names, _, why in reasons:
            if not why.strip():
                self.violations.append(f"{PRIVATE}: {names} has no reason")
        return {name: False for names, _, _ in reasons for name in names.split()}

    def check_private(self, path, number, target):
        """The workshop's includes of the product."""
        listed = [name for name in self.private if target == name or name.endswith("/") and target.startswith(name)]
        for name in listed:
            self.private[name] = True
        if not listed:
            self.complain(path, number, f"includes {target}, which is not public; {PRIVATE} has those that may be, and why")

    def check_public(self):
        """How many public headers there are, and whether they are those that the documentation has."""
        if len(self.public) > MOST_PUBLIC:
            self.violations.append(f"{len(self.public)} public headers, expected at most {MOST_PUBLIC}")
        for header in sorted(header for header in self.places if not (self.root / INCLUDE_DIR / header).is_file()):
            self.violations.append(f"{INCLUDE_DIR}/{header}: is not there, and {self.places[header]} is PUBLIC")
        path = self.root / TABLE
        table = set(re.findall(r"^\| `([^`]+\.h)` \|", path.read_text() if path.is_file() else "", re.MULTILINE))
        for header in sorted(set(self.places) ^ table):
            known = "is public and not in the table" if header in self.places else "is in the table and not public"
            self.violations.append(f"{TABLE}: {header} {known}")
        for name in sorted(name for name, used in self.private.items() if not used):
            self.violations.append(f"{PRIVATE}: nobody includes {name}")

    def read_budget(self):
        """The folders' lines: each line of the file is a folder, a number, and for whom it was last raised."""
        path = self.root / BUDGET
        lines = path.read_text().splitlines() if path.is_file() else []
        words = [line.split(maxsplit=2) for line in lines if line and not line.startswith("#")]
        return {folder: int(number) for folder, number, *_ in words}

    def check_amounts(self, sources):
        """`sources`: those that are no tests."""
        budget = self.read_budget()
        if not budget:
            return
        by_folder = {}
        for path in sources:
            by_folder.setdefault(path.parent, []).append(path)
        for folder, paths in sorted(by_folder.items()):
            name = str(folder.relative_to(self.root))
            own = [Path(header) for header in self.public if str(Path(header).parent) == name.partition("/")[2]]
            units = units_of(paths + own)
            if len(units) > MOST_UNITS:
                self.violations.append(f"{name}: {len(units)} units, expected at most {MOST_UNITS}")
            lines = sum(len(path.read_text().splitlines()) for path in paths)
            if name not in budget:
                self.violations.append(f"{BUDGET}: {name} is missing; it has {lines} lines")
            elif lines > budget[name]:
                self.violations.append(f"{name}: {lines} lines, granted are {budget[name]}; take some out, or raise the number in "
                                       f"{BUDGET} and say for whom")
        for name in sorted(set(budget) - {str(folder.relative_to(self.root)) for folder in by_folder}):
            self.violations.append(f"{BUDGET}: {name} has no sources")

    def check_names(self):
        """Whether types of one name are one type, in what is built into one program as well as elsewhere."""
        first = {}
        folders = {wing.split("/")[0] for wing in WINGS} | {"tools", "python"}
        for path in sorted(path for folder in folders for path in (self.root / folder).rglob("*.h")):
            if path.stem.endswith("_inl"):  # once for each instruction set
                continue
            for number, name in types(path):
                if name in first:
                    self.complain(path, number, f"defines {name}, as {first[name].relative_to(self.root)} does")
                first.setdefault(name, path)

    def check(self):
        if CORE not in self.libraries:
            sys.exit("src/: no CMakeLists.txt calls vesalius_library(core ...)")
        sources = []
        for path in sorted(path for wing in WINGS for path in (self.root / wing).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                self.check_file(path)
            if path.suffix in (".h", ".cpp", ".cu", ".cuh") and not is_for_tests(path) and self.wing_of(path) != "tests":
                sources.append(path)
        for group in circles(self.graph):
            self.violations.append(f"src/{group[0]}.h:1: units include each other: {', '.join(group)}")
        self.check_amounts(sources)
        self.check_public()
        self.check_names()
        return self.violations


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?", type=Path, default=Path(__file__).parent.parent, help="default: this repository")
    violations = Checker(parser.parse_args().root.resolve()).check()
    print("\n".join(violations) or "layers: all includes go downwards")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
