#!/usr/bin/env python3
"""The version stands in CMakeLists.txt, and nothing says another.

usage: versions.py VESALIUS SOURCE_DIR BUILD_DIR
"""
import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

NUMBER = r"(\d+\.\d+\.\d+)"
# The name, then the number: after a space, "-", "_", "==" or "/".
NAMED = re.compile(r"vesalius(?:[ _-]v?|[=~]=|/)" + NUMBER, re.I)


def said(*command):
    return subprocess.run([str(each) for each in command], check=True, capture_output=True, text=True).stdout


def of_the_program(program):
    yield "vesalius --version", re.fullmatch(f"vesalius {NUMBER}\n", said(program, "--version"))[1]
    yield "vesalius info", json.loads(said(program, "info", "--json"))["version"]


def of_the_wheel(source):
    """What pyproject.toml makes of CMakeLists.txt."""
    rule = tomllib.loads((source / "pyproject.toml").read_text(encoding="utf-8"))
    assert "version" in rule["project"]["dynamic"] and "version" not in rule["project"]
    rule = rule["tool"]["scikit-build"]["metadata"]["version"]
    yield "pyproject.toml", re.search(rule["regex"], (source / rule["input"]).read_text(encoding="utf-8"))["value"]


def of_the_packages(build):
    text = (build / "vesaliusConfigVersion.cmake").read_text(encoding="utf-8")
    yield "vesaliusConfigVersion.cmake", re.search(rf'set\(PACKAGE_VERSION "{NUMBER}"\)', text)[1]
    text = (build / "CPackConfig.cmake").read_text(encoding="utf-8")
    yield "CPackConfig.cmake", re.search(rf'set\(CPACK_PACKAGE_VERSION "{NUMBER}"\)', text)[1]
    yield "changelog.Debian", NAMED.search((build / "package/changelog.Debian").read_text().replace("(", ""))[1]


def of_the_sources(source):
    """Whatever names a version of this project in a text file of it."""
    for name in said("git", "-C", source, "ls-files").splitlines():
        path = source / name
        if not path.is_file() or path.suffix in (".forest", ".model", ".png", ".jpg", ".gz"):
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        for number, line in enumerate(text.splitlines(), 1):
            for found in NAMED.finditer(line):
                yield f"{name}:{number}", found[1]
        if path.name == "package.json" and "version" in json.loads(text):
            yield name, json.loads(text)["version"]
        if path.name == "package.xml":
            yield name, re.search(f"<version>{NUMBER}</version>", text)[1]


def number_of(version):
    return tuple(int(each) for each in version.split("."))


def check_changelog(source, version):
    """What is not released yet stands on top; else the newest heading is this version."""
    headings = re.findall(r"^## (.*)", (source / "CHANGELOG.md").read_text(encoding="utf-8"), re.M)
    released = [found[1] for heading in headings if (found := re.match(NUMBER, heading))]
    if headings[0] != "Unreleased" and released[:1] != [version]:
        sys.exit(f"CHANGELOG.md: expected a heading Unreleased or {version} on top, found {headings[0]}")
    if any(number_of(each) > number_of(version) for each in released):
        sys.exit(f"CHANGELOG.md has a version later than {version}: {released}")


def main():
    program, source, build = (Path(each).resolve() for each in sys.argv[1:4])
    version = re.search(rf"^project\(vesalius VERSION {NUMBER} ", (source / "CMakeLists.txt").read_text(), re.M)[1]
    count = 0
    for where, found in [*of_the_program(program), *of_the_wheel(source), *of_the_packages(build), *of_the_sources(source)]:
        if found != version:
            sys.exit(f"{where}: version {found}, in CMakeLists.txt {version}")
        count += 1
    check_changelog(source, version)
    print(f"{version} in all {count} places")


if __name__ == "__main__":
    main()
