#!/usr/bin/env python3
"""Puts fitted joint sets into files that have sets of those names.

`vesalius evaluate --fit-joints FITTED` writes joint sets. In each FILE (a body model, or sets for evaluation) every set
that FITTED has as well is replaced by it; comments, order and everything else stay.

Usage: put_joints.py FITTED FILE... [--sets NAME,NAME]: only these sets.
"""

import argparse
import re
import sys
from pathlib import Path

SET = "[[joint_set]]"
NAME = re.compile(r'^name = "([\w-]+)"', re.MULTILINE)
# A table, or a comment, that is no part of a joint set.
END = re.compile(r"^(?:#|\[\[(?!joint_set\.joint\]\]))", re.MULTILINE)


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
        path.write_text(text)
        print(f"{path}: {', '.join(replaced) or 'no set of those names'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
