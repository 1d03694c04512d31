#!/usr/bin/env python3
"""What is installed of Python packages has exact versions and hashes, wherever the project installs some.

usage: pins.py VESALIUS SOURCE_DIR [...]
"""
import re
import subprocess
import sys
import tomllib
from pathlib import Path

# What installs the project itself, into an environment that has the rest.
OF_THE_PROJECT = re.compile(r"--no-deps|pip install (?:\.|`|vesalius|pyproject)|--upgrade")
PINNED = re.compile(r"^([\w.-]+)(?:\[[\w,-]+\])?==([^\s;]+)(?: ;[^\\]*)? \\$")
HASH = re.compile(r"^    --hash=sha256:[0-9a-f]{64}(?: \\)?$")


def name_of(requirement):
    """Its name as registries compare it."""
    return re.sub(r"[-_.]+", "-", re.match(r"[\w.-]+", requirement)[0]).lower()


def pinned(path):
    """{name: versions} of a list; each has hashes."""
    found, hashes = {}, 1
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if line.startswith("#"):
            continue
        if HASH.match(line):
            hashes += 1
            continue
        package = PINNED.match(line)
        if not package or hashes == 0:
            sys.exit(f"{path}:{number}: expected NAME==VERSION with hashes, found: {line}")
        found.setdefault(name_of(package[1]), set()).add(package[2])
        hashes = 0
    if hashes == 0:
        sys.exit(f"{path}: the last has no hash")
    return found


def check_list(wanted):
    """Returns what is pinned of a list of wanted packages."""
    of = pinned(wanted.with_suffix(".txt"))
    for line in wanted.read_text(encoding="utf-8").splitlines():
        if line and line[0] not in "#-" and name_of(line) not in of:
            sys.exit(f"{wanted}: {line} is not in {wanted.with_suffix('.txt').name}; run tools/python/pin.sh")
    return of


def check_commands(source):
    """Every `pip install` of scripts and documents takes hashes, or installs the project alone."""
    count = 0
    for name in subprocess.run(["git", "-C", source, "ls-files"], check=True, capture_output=True, text=True).stdout.splitlines():
        path = source / name
        if path.suffix not in ("", ".sh", ".md", ".py", ".yml", ".cmake") or path.is_dir() or path.resolve() == Path(__file__).resolve():
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
            if re.search(r"pip\"? (?:install|download|wheel)", line):
                count += 1
                if "--require-hashes" not in line and not OF_THE_PROJECT.search(line):
                    sys.exit(f"{name}:{number}: expected --require-hashes -r LIST: {line.strip()}")
    return count


def main():
    source = Path(sys.argv[2]).resolve()
    lists = [*sorted((source / "tools/python/pins").glob("*.in")), *sorted((source / "training/network").rglob("requirements.in"))]
    of = {path.stem: check_list(path) for path in lists}
    built_with = tomllib.loads((source / "pyproject.toml").read_text(encoding="utf-8"))["build-system"]["requires"]
    for requirement in built_with:
        version = requirement.partition("==")[2].partition(";")[0]
        if version not in of["package"].get(name_of(requirement), set()):
            sys.exit(f"pyproject.toml: {requirement}, but tools/python/pins/package.txt has {of['package'][name_of(requirement)]}")
    print(f"{len(lists)} lists, {check_commands(source)} commands")


if __name__ == "__main__":
    main()
