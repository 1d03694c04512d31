#!/usr/bin/env python3
"""Puts what tools/fit_body fitted into body models.

FITTED is what `vesalius_fit_body joints` or `parts` wrote. In each FILE (a body model, or joint sets for evaluation) every joint
set that FITTED has as well is replaced by it; comments, order and everything else stay. A distribution of parts
replaces the file's, or is put at its end.

Usage: put_fitted.py FITTED FILE... [--sets NAME,NAME]: only these joint sets.
"""

import argparse
import re
import sys
from pathlib import Path

NAME = re.compile(r'^name = "([\w-]+)"', re.MULTILINE)


def sections(text, table, entry):
    """Returns [(begin, end)] of the tables with this header in a TOML text, each with its entries and without blank
    lines at its end. A comment or another table ends one."""
    end = re.compile(rf"^(?:#|\[(?!\[{re.escape(entry)}\]\]))", re.MULTILINE)
    found = []
    for start in re.finditer("^" + re.escape(table), text, re.MULTILINE):
        stop = end.search(text, start.end())
        found.append((start.start(), len(text[: stop.start() if stop else len(text)].rstrip())))
    return found


def joint_sets(text):
    """Returns {name: (begin, end)} of the joint sets in a TOML text."""
    named = [(NAME.search(text, *place), place) for place in sections(text, "[[joint_set]]", "joint_set.joint")]
    if not all(name for name, _ in named):
        raise ValueError('a joint set without name = "..."')
    return {name.group(1): place for name, place in named}


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
    return next(iter(sections(text, "[distribution]", "distribution.part")), (len(text), len(text)))


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
    only = arguments.sets.split(",") if arguments.sets else None
    changed = []
    path = arguments.fitted
    try:
        fitted = path.read_text()
        joint_sets(fitted)  # so that an error names this file
        for path in arguments.files:
            text, replaced = put(fitted, path.read_text(), only)
            text, has_distribution = put_distribution(fitted, text)
            changed.append((path, text, replaced + (["distribution"] if has_distribution else [])))
        for path, text, replaced in changed:
            beside = path.with_name(path.name + ".part")
            beside.write_text(text)
            beside.replace(path)
            print(f"{path}: {', '.join(replaced) or 'nothing of those names'}")
    except (OSError, ValueError) as error:
        print(f"put_fitted: {path}: {getattr(error, 'strerror', None) or error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
