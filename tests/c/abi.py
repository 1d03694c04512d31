#!/usr/bin/env python3
"""Compares what libvesalius.so exports with its header and with the list of each version of its binary interface.

Usage: abi.py LIBRARY HEADER MAP
"""

import re
import subprocess
import sys
from pathlib import Path


def expect_same(what, left, right):
    if left != right:
        sys.exit(f"{what}: only in the first: {sorted(left - right)}, only in the second: {sorted(right - left)}")


def listed(text):
    """{(symbol, version)} of a version script."""
    found = set()
    for version, block in re.findall(r"^(VESALIUS_\d+) \{(.*?)^\}", text, re.MULTILINE | re.DOTALL):
        block = block.split("local:")[0].split("global:")[1]
        found |= {(symbol, version) for symbol in re.findall(r"(\w+);", block)}
    return found


def exported(library):
    """{(symbol, version)} of what others can link to."""
    lines = subprocess.run(["nm", "-D", "--defined-only", "--with-symbol-versions", library], check=True,
                           stdout=subprocess.PIPE, text=True).stdout.splitlines()
    found = set()
    for line in lines:
        _, kind, name = line.split()
        if kind == "A":  # the version itself
            continue
        symbol, _, version = name.partition("@@")
        found.add((symbol, version))
    return found


def main():
    library, header, version_script = sys.argv[1:4]
    declared = set(re.findall(r"^VESALIUS_API [^;]*?\b(vesalius_\w+)\(", Path(header).read_text(), re.MULTILINE))
    symbols = listed(Path(version_script).read_text())
    expect_same("library and list", exported(library), symbols)
    expect_same("header and list", declared, {symbol for symbol, _ in symbols})
    dynamic = subprocess.run(["readelf", "-d", library], check=True, stdout=subprocess.PIPE, text=True).stdout
    (name,) = re.findall(r"\(SONAME\).*\[(.*)\]", dynamic)
    abi = re.search(r"^#define VESALIUS_ABI_VERSION (\d+)$", Path(header).read_text(), re.MULTILINE).group(1)
    if name != f"libvesalius.so.{abi}":
        sys.exit(f"the library is called {name}, expected libvesalius.so.{abi}")
    heavy = [each for each in re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic) if re.match("libopencv|libembree|libhdf5", each)]
    if heavy:
        sys.exit(f"the library needs {heavy}, of which it uses nothing")
    print(f"{name}: {len(symbols)} functions in library, header and list")


if __name__ == "__main__":
    main()
