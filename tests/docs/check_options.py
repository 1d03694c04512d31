#!/usr/bin/env python3
"""Compares the options that docs/options.md names with those that the program has.

usage: check_options.py VESALIUS OPTIONS.md
"""
import fnmatch
import re
import subprocess
import sys
import tomllib


def names(table, prefix=""):
    for key, value in table.items():
        if isinstance(value, dict):
            yield from names(value, f"{prefix}{key}.")
        else:
            yield prefix + key


def main():
    program, document = sys.argv[1:]
    text = subprocess.run([program, "options"], check=True, capture_output=True, text=True).stdout
    options = set(names(tomllib.loads(text)))
    patterns = []
    for row in open(document, encoding="utf-8"):
        if row.startswith("| `"):
            patterns += re.findall(r"`([^`]+)`", row.split("|")[1])
    wrong = [f"{document} does not name {name}" for name in sorted(options)
             if not any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)]
    wrong += [f"{document} names {pattern}, which no option is" for pattern in patterns
              if not fnmatch.filter(options, pattern)]
    print("\n".join(wrong) or f"{len(options)} options, all named")
    return 1 if wrong or not options else 0


if __name__ == "__main__":
    sys.exit(main())
