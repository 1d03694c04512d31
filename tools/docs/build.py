#!/usr/bin/env python3
"""Builds the documentation as a site that opens without a network and without a server.

usage: build.py PROGRAM OUT [STUB]

PROGRAM is `vesalius`, whose help becomes the reference of commands; STUB the Python module's .pyi, whose signatures and
docstrings become the reference of Python. Needs Sphinx, MyST, Furo, Breathe and Doxygen (./dev docs). Warnings are errors, and
so are links that lead nowhere. OUT is replaced when all is well; what stood there stays otherwise.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import check_links
import command_reference
import cpp_reference
import python_reference
from stage import BrokenLinks, Stage

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parents[1]


def version():
    return re.search(r"project\(vesalius VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text()).group(1)


def run_sphinx(staged, html, work, xml):
    environment = {**os.environ, "VESALIUS_VERSION": version(), "VESALIUS_DOXYGEN_XML": str(xml)}
    command = ["sphinx-build", "-q", "-W", "--keep-going", "-c", str(HERE), "-d", str(work / "doctrees"), "-b", "html",
               str(staged), str(html)]
    return subprocess.run(command, env=environment, check=False).returncode


def mend_colours(html):
    """Furo's "not print and dark" is true on every screen, also where light is preferred: code would be white on white."""
    for sheet in (html / "_static").rglob("*.css"):
        sheet.write_text(sheet.read_text().replace("@media not print and (", "@media screen and ("))


def build(program, out, stub):
    work = SOURCE / "build/docs"
    staged, html = work / "source", work / "html"
    for folder in (staged, html):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
    command_reference.write(program, staged)
    if not python_reference.write(SOURCE, staged, stub):
        print("docs: the Python module was not built; its classes are not in the reference", file=sys.stderr)
    xml = cpp_reference.write(SOURCE, staged, work)
    try:
        Stage(SOURCE, staged).write_pages()
    except BrokenLinks as error:
        sys.exit(str(error))
    if run_sphinx(staged, html, work, xml) != 0:
        sys.exit("docs: Sphinx warned; warnings are errors")
    mend_colours(html)
    lines = list(check_links.broken(html))
    if lines:
        sys.exit("\n".join(lines))
    shutil.rmtree(out, ignore_errors=True)
    out.parent.mkdir(parents=True, exist_ok=True)
    shutil.move(html, out)
    print(f"{sum(1 for _ in out.rglob('*.html'))} pages, every link has its target: {out / 'index.html'}")


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__.split("\n\n")[1])
    build(sys.argv[1], Path(sys.argv[2]).resolve(), Path(sys.argv[3]) if len(sys.argv) == 4 else None)
