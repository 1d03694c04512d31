#!/usr/bin/env python3
"""Runs the blocks of a page in order, as a reader would, in a folder of their own, and compares what they say with the page.

usage: run_blocks.py [--clone] [--python PYTHON] VESALIUS SOURCE_DIR WORK_DIR PAGE...

PAGE is a page of docs/, or a folder of pages: starts, python.

Quickly, in a folder that looks like a clone in which everything is built already: blocks marked `nightly` are left out, and Python's
unless PYTHON is given, which has the package vesalius. With --clone in a clone, with nothing left out.

A page's blocks say what they are behind their language:

    ```bash                   run by bash; all blocks of a page are one session, and a command that fails is a failure
    ```bash nightly           the same, with --clone alone: it builds or fetches for minutes
    ```bash camera            the same, with a recording in the place of the camera that is not there
    ```bash ctrl-c            the same, ended by Ctrl-C when its page, whose address it prints, was looked at
    ```bash needs: COMMAND    the same, where the program has that command: a build may lack it
    ```bash no-run: REASON    not run; the reason says who tries it, or why nobody can
    ```python                 run by Python; blocks that follow each other are one session
    ```text output            what the block before says: these lines, in this order; "..." stands for anything
    ```cpp file: PATH         part of a file of the repository, word by word

A block that names no language, or a mark that is not listed here, is an error.
"""

import argparse
import os
import re
import shutil
import signal
import subprocess
import sys
import urllib.request
from dataclasses import dataclass, field
from pathlib import Path

CAMERA = re.compile(r"\b(openni2|freenect|realsense|orbbec):\w*")
MARKS = {"bash": ("", "nightly", "camera", "ctrl-c", "needs", "no-run"), "python": ("", "no-run"), "text": ("", "output"),
         "cpp": ("", "file")}
SECONDS = 3600
SMALL = ["--sensor.width", "320", "--sensor.height", "240", "--pose.captured", "0", "--body.kind", "builtin"]
TWO_PEOPLE = ["--people.none", "0", "--people.one", "0", "--people.two", "1", "--people.three", "0", "--people.four", "0"]
# Files that a page takes for the reader's own, and what the program makes them with.
READERS_OWN = {"recording.mcap": ["record", "data/rooms", "-q", "--out"]}


@dataclass
class Block:
    page: Path
    line: int
    language: str
    mark: str
    argument: str
    lines: list = field(default_factory=list)
    expected: list = field(default_factory=list)

    @property
    def text(self):
        return "\n".join(self.lines) + "\n"

    @property
    def place(self):
        return f"{self.page.name}:{self.line}"


class Wrong(Exception):
    pass


def read_blocks(page):
    """A page's blocks, those with output joined to what they are the output of."""
    blocks, block = [], None
    for number, line in enumerate(page.read_text().splitlines(), 1):
        if not line.startswith("```"):
            if block:
                block.lines.append(line)
            continue
        if block:
            blocks.append(block)
            block = None
            continue
        language, _, rest = line[3:].strip().partition(" ")
        mark, _, argument = rest.partition(":")
        block = Block(page, number, language, mark.strip(), argument.strip())
        if not language:
            raise Wrong(f"{block.place}: a block without a language")
        if block.mark not in MARKS.get(language, ("",)):
            raise Wrong(f"{block.place}: unknown mark {block.mark}, expected one of {', '.join(filter(None, MARKS[language]))}")
        if block.mark in ("no-run", "needs") and not block.argument:
            raise Wrong(f"{block.place}: {block.mark} without saying {'why' if block.mark == 'no-run' else 'what'}")
    return join_output(blocks)


def join_output(blocks):
    joined = []
    for block in blocks:
        if block.mark != "output":
            joined.append(block)
        elif not joined or joined[-1].language not in ("bash", "python"):
            raise Wrong(f"{block.place}: output of nothing")
        else:
            joined[-1].expected = block.lines
    return joined


def matches(expected, said):
    """Whether a line is as expected, where "..." stands for anything."""
    return re.fullmatch(".*".join(map(re.escape, expected.rstrip().split("..."))), said.rstrip()) is not None


def missing_line(expected, said):
    """The first expected line that is not said behind the one before it; None if all are."""
    rest = iter(said.splitlines())
    for line in expected:
        if line.strip() not in ("", "...") and not any(matches(line, each) for each in rest):
            return line
    return None


class Reader:
    """Somebody who follows a page in a folder."""

    def __init__(self, program, folder, work, python, quick, environment=None):
        self.environment = environment or {}
        self.program, self.folder, self.work, self.python, self.quick = program, folder, work, python, quick
        self.recording = work / "recording"

    def is_run(self, block):
        if block.language == "python":
            return block.mark == "" and (self.python or not self.quick)
        if block.mark == "needs":
            said = subprocess.run([self.program, block.argument, "--help"], check=False, capture_output=True, text=True).stdout
            return f"Usage: vesalius {block.argument}" in said
        return block.language == "bash" and block.mark != "no-run" and not (self.quick and block.mark == "nightly")

    def bash(self, block):
        text = block.text
        if block.mark in ("camera", "ctrl-c"):
            text, found = CAMERA.subn(str(self.recording), text)
            if block.mark == "camera" and not found:
                raise Wrong(f"{block.place}: no camera in it")
            if found:
                self.make_recording()
        if block.mark == "ctrl-c":
            path = self.work / f"ctrl_c_{block.line}.sh"
            path.write_text("set -e\n" + text)
            return f"{sys.executable} {Path(__file__).resolve()} --ctrl-c {path}\n"
        return text

    def make_recording(self):
        """What a camera would have seen: two rendered people who walk about for two seconds."""
        if not self.recording.exists():
            subprocess.run([self.program, "synth", "-q", "--clip", "2", "--rate", "10", "--count", "1", "--seed", "10", "--format",
                            "folder", "--out", self.recording, "--clip.walking-share", "1", *SMALL, *TWO_PEOPLE], check=True)

    def python_session(self, blocks):
        """Python's blocks that follow each other, as one command."""
        path = self.work / f"session_{blocks[0].line}.py"
        for name, command in READERS_OWN.items():
            if any(f'"{name}"' in block.text for block in blocks) and not (self.folder / name).exists():
                subprocess.run([self.program, *command, name], cwd=self.folder, check=True)
        path.write_text("".join(f"print({mark_of(block)!r}, flush=True)\n{block.text}" for block in blocks))
        return f"{self.python or 'python3'} {path}\n"

    def script(self, blocks):
        parts, session = ["set -eo pipefail\n"], []
        for block in [*blocks, None]:
            if session and (block is None or block.language != "python"):
                parts.append(self.python_session(session))
                session = []
            if block is not None and block.language == "python":
                session.append(block)
            elif block is not None:
                parts.append(f"echo {mark_of(block)}\n{self.bash(block)}")
        return "".join(parts)

    def follow(self, page):
        """Runs a page's blocks. Returns how many were run; raises Wrong with what is not as the page says."""
        blocks = read_blocks(page)
        for block in blocks:
            if block.mark == "file":
                compare_with_file(block, self.folder)
        left_out = [block for block in blocks if block.language in ("bash", "python") and not self.is_run(block)]
        blocks = [block for block in blocks if self.is_run(block)]
        script = self.work / "page.sh"
        script.write_text(self.script(blocks))
        environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        environment |= {"XDG_DATA_HOME": str(self.work / "home"), "PYTHONUNBUFFERED": "1"} | self.environment
        done = subprocess.run(["bash", str(script)], cwd=self.folder, env=environment, check=False, text=True, errors="replace",
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=SECONDS)
        check_output(blocks, done)
        for block in left_out:
            print(f"{block.place}: left out: {block.argument or block.mark or 'no Python with the package'}")
        return len(blocks)


def mark_of(block):
    return f"=== block at line {block.line} ==="


def compare_with_file(block, folder):
    if block.text not in (folder / block.argument).read_text():
        raise Wrong(f"{block.place}: not what stands in {block.argument}")


def check_output(blocks, done):
    said = {}
    at = None
    for line in done.stdout.splitlines():
        found = re.fullmatch(r"=== block at line (\d+) ===", line)
        if found:
            at = int(found.group(1))
            said[at] = []
        elif at is not None:
            said[at].append(line)
    for block in blocks:
        lines = "\n".join(said.get(block.line, []))
        if block.line not in said:
            raise Wrong(f"{block.place}: not reached; the block before ended with {done.returncode}:\n{done.stdout[-3000:]}")
        missing = missing_line(block.expected, lines)
        if missing is not None:
            raise Wrong(f"{block.place}: expected the line\n  {missing}\nbut it said\n{lines}")
    if done.returncode != 0:
        raise Wrong(f"{blocks[-1].place}: ended with {done.returncode}:\n{done.stdout[-3000:]}")


def like_a_clone(source, program, folder):
    """Makes a folder with all of the repository, in which whatever ./dev builds is the program that is there; returns where a cmake
    lies that has nothing to do."""
    folder.mkdir(parents=True)
    for each in sorted(source.iterdir()):
        if each.name not in (".git", "build", "out", "dev"):
            (folder / each.name).symlink_to(each)
    shutil.copy(source / "dev", folder / "dev")
    for preset in ("dev", "release"):
        place = folder / "build" / preset / "src/cli"
        place.mkdir(parents=True)
        (place / "vesalius").write_text('#!/bin/sh\n[ "$1" != view ] || set -- "$@" --port 0 --no-browser\n'
                                        f'exec "{program}" "$@"\n')
        (place / "vesalius").chmod(0o755)
    tools = folder / "build/tools"
    tools.mkdir()
    (tools / "cmake").write_text("#!/bin/sh\n")
    (tools / "cmake").chmod(0o755)
    return tools


def fresh_folder(given, folder):
    """The folder as a reader of one more page finds it: nothing in it but the repository and, of a clone, what was built."""
    if given.clone and folder.exists():
        subprocess.run(["git", "-C", str(folder), "clean", "-qfdx", "-e", "/build"], check=True)
    elif given.clone:
        subprocess.run(["git", "clone", "-q", str(given.source), str(folder)], check=True)
    else:
        shutil.rmtree(folder, ignore_errors=True)
        return {"PATH": f"{like_a_clone(given.source, given.program, folder)}:{os.environ['PATH']}"}
    return {}


def pages_of(docs, names):
    for name in names:
        place = docs / name
        found = sorted(place.glob("*.md")) if place.is_dir() else [place.with_suffix(".md")]
        if not found or not found[0].exists():
            sys.exit(f"{place}: no such page")
        yield from found


def press_ctrl_c(script):
    """Runs a viewer until its page was there, then ends it as Ctrl-C does: a signal to all that the terminal runs."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # what runs in the background of a script ignores it
    with subprocess.Popen(["bash", script], stdout=subprocess.PIPE, text=True, start_new_session=True) as viewer:
        for line in viewer.stdout:
            print(line, end="", flush=True)
            if line.startswith("http://"):
                with urllib.request.urlopen(line.strip(), timeout=20) as page:
                    if page.status != 200:
                        sys.exit(f"{line.strip()}: {page.status}")
                os.killpg(viewer.pid, signal.SIGINT)
        return viewer.wait(timeout=30)


def main():
    if sys.argv[1:2] == ["--ctrl-c"]:
        return press_ctrl_c(sys.argv[2])
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--python")
    parser.add_argument("--clone", action="store_true")
    for name in ("program", "source", "work"):
        parser.add_argument(name, type=lambda path: Path(path).resolve())
    parser.add_argument("pages", nargs="+")
    given = parser.parse_args()
    shutil.rmtree(given.work, ignore_errors=True)
    folder = given.work / "vesalius"
    failures = 0
    for name in pages_of(given.source / "docs", given.pages):
        page = folder / name.relative_to(given.source)
        try:
            environment = fresh_folder(given, folder)
            reader = Reader(given.program, folder, given.work, given.python, not given.clone, environment)
            print(f"{page.name}: {reader.follow(page)} blocks run", flush=True)
        except Wrong as error:
            failures += 1
            print(error, flush=True)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
