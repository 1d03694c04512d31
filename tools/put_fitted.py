#!/usr/bin/env python3
"""Puts what `vesalius evaluate` fitted into body models.

FITTED is what --fit-joints or --fit-parts wrote. In each FILE (a body model, or joint sets for evaluation) every joint
set that FITTED has as well is replaced by it; comments, order and everything else stay. A distribution of parts
replaces the file's, or is put at its end.

Usage: put_fitted.py FITTED FILE... [--sets NAME,NAME]: only these joint sets.
"""

import argparse
import re
import sys
from pathlib import Path

SET = "[[joint_set]]"
NAME = re.compile(r'^name = "([\w-]+)"', re.MULTILINE)
# A comment, or a table that is no part of a joint set.
END = re.compile(r"^(?:#|\[(?!\[joint_set\.joint\]\]))", re.MULTILINE)


def joint_sets(text):
    """Returns {name: (begin, end)} of the joint sets in a TOML text, without blank lines at their ends."""
    found = {}
    for start in re.finditer(re.escape(SET), text):
        end = END.search(text, start.end())
        body = text[start.start() : end.start() if end else len(text)].rstrip()
        found[NAME.search(body).group(1)] = (start.start(), start.start() + len(body))
    return found


def put(fitted, text, only=None):
    """Returns the text with its joint sets replaced by those of `fitted`, and the names of these."""
    new = joint_sets(fitted)
    replaced = [name for name in joint_sets(text) if name in new and (only is None or name in only)]
    for name in replaced:
        begin, end = joint_sets(text)[name]
        text = text[:begin] + fitted[slice(*new[name])] + text[end:]
    return text, replaced


def distribution(text):
    """Returns (begin, end) of the distribution of parts in a TOML text, both its length where there is none."""
    start = re.search(r"^\[distribution\]", text, re.MULTILINE)
    if not start:
        return len(text), len(text)
    end = re.compile(r"^(?:#|\[(?!\[distribution\.part\]\]))", re.MULTILINE).search(text, start.end())
    return start.start(), start.start() + len(text[start.start() : end.start() if end else len(text)].rstrip())


def put_distribution(fitted, text):
    """Returns the text with the distribution of `fitted`, if that has one, and whether it has."""
    begin, end = distribution(fitted)
    if begin == end:
        return text, False
    at, after = distribution(text)
    new = fitted[begin:end]
    return (text.rstrip() + "\n\n" + new + "\n" if at == after else text[:at] + new + text[after:]), True


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fitted", type=Path)
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE")
    parser.add_argument("--sets", help="names of joint sets, separated by commas")
    arguments = parser.parse_args()
    fitted = arguments.fitted.read_text()
    only = arguments.sets.split(",") if arguments.sets else None
    for path in arguments.files:
        text, replaced = put(fitted, path.read_text(), only)
        text, has_distribution = put_distribution(fitted, text)
        replaced += ["distribution"] if has_distribution else []
        path.write_text(text)
        print(f"{path}: {', '.join(replaced) or 'nothing of those names'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
