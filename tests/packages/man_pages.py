#!/usr/bin/env python3
"""The manual that packages get, rendered: a page for every command with every flag of its --help, and every option of a file, with its
default, in vesalius-options(1). groff has nothing to say against it, and made again it has the same bytes.

usage: man_pages.py VESALIUS SOURCE_DIR [...]
"""
import gzip
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

FLAG = re.compile(r"(?:^|[\s,])(--?[A-Za-z][\w.-]*)")


def said(*command):
    return subprocess.run([str(each) for each in command], check=True, capture_output=True, text=True).stdout


def commands_of(help_text):
    found = re.search(r"^Subcommands:\n((?:  .*\n)+)", help_text, re.M)
    return re.findall(r"^  ([a-z0-9]+)", found[1], re.M) if found else []


def flags_of(help_text):
    """The flags that a help text introduces: those at the left."""
    lines = [line for line in help_text.splitlines() if re.match(r"  -", line)]
    return {flag for line in lines for flag in FLAG.findall(re.split(r"\s{2,}|\s[A-Z]", line.strip())[0])}


def rendered(page):
    """The page as it is read, in lines of any length; what groff warns of is an error."""
    done = subprocess.run(["groff", "-ww", "-man", "-Tascii", "-P-cbou", "-rLL=1000n"], input=gzip.decompress(page.read_bytes()).decode(),
                          capture_output=True, text=True, check=True)
    if done.stderr:
        sys.exit(f"{page}: groff: {done.stderr}")
    return done.stdout


def introduced(text):
    """The flags that begin an item of the page."""
    return {flag for line in text.splitlines() if re.match(r" {4,8}-", line) for flag in FLAG.findall(" " + line)}


def check_page(program, folder, words, seen):
    name = "-".join(["vesalius", *words])
    help_text = said(program, *words, "--help")
    page = rendered(folder / f"{name}.1.gz")
    first = help_text.splitlines()[0].split()[0]
    if not re.search(rf"^NAME\n +{name} - {first}", page, re.M):
        sys.exit(f"{name}.1: expected NAME to begin with {first}, found\n{page[:400]}")
    missing = flags_of(help_text) - introduced(page)
    if missing:
        sys.exit(f"{name}.1 lacks {sorted(missing)}")
    seen[name] = len(flags_of(help_text))
    if name == "vesalius-options":
        lines = {line.strip() for line in page.splitlines()}
        for of in {"detect", *commands_of(said(program, "--help"))} & {"detect", "synth", "train"}:
            lacking = [line for line in said(program, "options", of).splitlines() if line.strip() not in lines]
            if lacking:
                sys.exit(f"{name}.1 lacks, of {of}: {lacking}")
    for command in commands_of(help_text):
        check_page(program, folder, [*words, command], seen)


def main():
    program, source = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    if not shutil.which("groff") or not shutil.which("help2man"):
        print("SKIPPED: no groff, or no help2man")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for time in ("once", "again"):
            said("bash", source / "cmake/manual.sh", program, folder / time)
        seen = {}
        check_page(program, folder / "once", [], seen)
        pages = {page.name.removesuffix(".1.gz") for page in (folder / "once").iterdir()}
        if pages != set(seen):
            sys.exit(f"pages without command, or commands without page: {pages ^ set(seen)}")
        for name in pages:
            if (folder / "once" / f"{name}.1.gz").read_bytes() != (folder / "again" / f"{name}.1.gz").read_bytes():
                sys.exit(f"{name}.1 has other bytes the second time")
        print(f"{len(seen)} pages, {sum(seen.values())} flags")


if __name__ == "__main__":
    main()
