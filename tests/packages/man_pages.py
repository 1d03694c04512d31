#!/usr/bin/env python3
"""The manual that a program writes, rendered: every flag of every --help and every option of a file stand in its page, and
groff and man have nothing to say against it.

usage: man_pages.py VESALIUS [...]
"""
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

FLAG = re.compile(r"(?:^|[\s,])(--?[A-Za-z][\w.-]*)")
OF_A_FILE = {"detect": "detect", "view": "detect", "bench": "detect", "ros2": "detect", "synth": "synth", "train": "train"}


def said(*command):
    return subprocess.run([str(each) for each in command], check=True, capture_output=True, text=True).stdout


def commands_of(help_text):
    found = re.search(r"^Subcommands:\n((?:  .*\n)+)", help_text, re.M)
    return re.findall(r"^  ([a-z0-9]+)", found[1], re.M) if found else []


def flags_of(help_text):
    """The flags that a help text introduces: those at the left."""
    lines = [line for line in help_text.splitlines() if re.match(r"  -", line)]
    return {flag for line in lines for flag in FLAG.findall(re.split(r"\s{2,}|\s[A-Z]", line.strip())[0])}


def names(table, prefix=""):
    for key, value in table.items():
        if isinstance(value, dict):
            yield from names(value, f"{prefix}{key}.")
        else:
            yield prefix + key, value


def rendered(page):
    """The page as it is read, in lines of any length; what groff warns of is an error."""
    done = subprocess.run(["groff", "-ww", "-man", "-Tascii", "-P-cbou", "-rLL=1000n", page], capture_output=True, text=True,
                          check=True)
    if done.stderr:
        sys.exit(f"{page}: groff: {done.stderr}")
    return done.stdout


def introduced(text):
    """The flags that begin an item of the page."""
    return {flag for line in text.splitlines() if re.match(r" {4,8}-", line) for flag in FLAG.findall(" " + line)}


def check_page(program, folder, words, seen):
    name = "-".join(["vesalius", *words])
    help_text = said(program, *words, "--help")
    page = rendered(folder / f"{name}.1")
    flags = introduced(page)
    missing = flags_of(help_text) - flags
    if missing:
        sys.exit(f"{name}.1 lacks {sorted(missing)}")
    seen[name] = len(flags)
    if words and words[0] in OF_A_FILE and len(words) == 1:
        for option, _ in names(tomllib.loads(said(program, "options", OF_A_FILE[words[0]]))):
            if f"--{option}" not in flags:
                sys.exit(f"{name}.1 lacks the option {option}")
    for command in commands_of(help_text):
        check_page(program, folder, [*words, command], seen)


def check_defaults(program, folder):
    """The defaults that the page gives are those of the file."""
    page = rendered(folder / "vesalius-detect.1")
    for option, value in names(tomllib.loads(said(program, "options"))):
        text = re.search(rf"^ +--{re.escape(option)}\b.*\n(.*)", page, re.M)[1]
        told = re.search(r"Default: (\S+)\.$", text)
        if isinstance(value, str):
            same = (told[1] if told else "") == value
        elif isinstance(value, bool):
            same = told[1] == str(value).lower()
        else:
            same = abs(float(told[1]) - value) <= 1e-5 * abs(value)
        if not same:
            sys.exit(f"{option}: the page says {text!r}, the file {value}")


def check_bad_folder(program):
    """A folder that cannot be made ends in one line that names it."""
    done = subprocess.run([str(program), "man", "/dev/null/pages"], capture_output=True, text=True, check=False)
    if done.returncode != 1 or not re.fullmatch(r"vesalius: /dev/null/pages: .*\n", done.stderr):
        sys.exit(f"man /dev/null/pages: exit code {done.returncode}, {done.stderr!r}")


def main():
    program = Path(sys.argv[1]).resolve()
    if not shutil.which("groff"):
        print("SKIPPED: no groff")
        sys.exit(77)
    check_bad_folder(program)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        said(program, "man", folder)
        said(program, "man", folder / "again")
        for page in folder.glob("*.1"):
            assert page.read_bytes() == (folder / "again" / page.name).read_bytes(), page.name
        seen = {}
        check_page(program, folder, [], seen)
        check_defaults(program, folder)
        pages = {page.stem for page in folder.glob("*.1")}
        if pages != set(seen):
            sys.exit(f"pages without command, or commands without page: {pages ^ set(seen)}")
        print(f"{len(seen)} pages, {sum(seen.values())} flags")


if __name__ == "__main__":
    main()
