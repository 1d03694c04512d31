#!/usr/bin/env python3
"""Writes the files of a package for data/assets.toml: path, bytes and SHA-256 of each, and of the archive.

Usage: list_assets.py ARCHIVE...   e.g. list_assets.py makehuman.tar.xz mocap.tar.xz > files.toml

An archive NAME.tar.xz holds one folder NAME; paths are listed as below it. What describes a package (licence, credit,
homes) is written by hand.
"""

import hashlib
import sys
import tarfile
from pathlib import Path


def digest(data):
    return f'{len(data)}, "{hashlib.sha256(data).hexdigest()}"'


def list_archive(path):
    name = path.name.split(".")[0]
    rows = []
    with tarfile.open(path) as archive:
        for member in archive:
            if member.isdir():
                continue
            top, _, below = member.name.partition("/")
            if not member.isfile() or top != name or not below:
                sys.exit(f"{path}: {member.name}: expected a file below {name}/")
            rows.append((below, digest(archive.extractfile(member).read())))
    print(f'name = "{name}"')
    print(f'archive = ["{path.name}", {digest(path.read_bytes())}]')
    print("files = [")
    for below, text in sorted(rows):
        print(f'  ["{below}", {text}],')
    print("]\n")


if len(sys.argv) < 2:
    sys.exit(__doc__)
for argument in sys.argv[1:]:
    list_archive(Path(argument))
