#!/usr/bin/env python3
"""Runs the commands that a document shows, or those under "Examples:" in each --help, as they are written there.

usage: run_examples.py VESALIUS SOURCE_DIR WORK_DIR (DOCUMENT.md | --help)

Bash runs each block of a document in a folder with the project's data/. `vesalius` is this script there: it makes work small
(few, small frames, small trees), puts a stand-in where a command names a file of the reader's own, and then runs the program
with all flags of the example. Other programs (./dev, cmake, ctest) are not run.
"""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

SMALL_FRAMES = {"--sensor.width": "96", "--sensor.height": "54", "--body.kind": "builtin", "--body.count": "2",
                "--pose.captured": "0"}
EASY_FRAMES = {"--people.none": "0", "--people.one": "1", "--people.two": "0", "--people.three": "0", "--people.four": "0",
               "--scene.furniture-max": "0"}
NOBODY = {**EASY_FRAMES, "--people.none": "1", "--people.one": "0"}
SMALL_FOREST = {"--trees": "1", "--hard-trees": "1", "--depth": "5", "--candidates": "8", "--pixels": "100",
                "--held-out-share": "0.25"}
MOST = {"--count": 12, "--preview": 3, "--trees": 2, "--clip": 0.5}
CAMERA = r"(openni2|freenect|realsense|orbbec):\w*"
NOT_RUN = ("assets",)  # needs a network


class Wrapper:
    """What `vesalius` is while a block runs."""

    def __init__(self):
        self.program = os.environ["EXAMPLE_PROGRAM"]
        self.stand_ins = Path(os.environ["EXAMPLE_STAND_INS"])
        self.source = Path(os.environ["EXAMPLE_SOURCE"])

    def replace(self, words, flags):
        """Sets flags to values, overwriting those that are there."""
        words = list(words)
        for flag, value in flags.items():
            if flag in words:
                words[words.index(flag) + 1] = value
            else:
                words += [flag, value]
        return words

    def limit(self, words):
        words = list(words)
        for flag, most in MOST.items():
            if flag in words:
                at = words.index(flag) + 1
                words[at] = words[at] if float(words[at]) <= most else str(most)
        return words

    def place(self, name, stand_in):
        """Links a stand-in to where the example has a file or folder of the reader's."""
        path = Path(name.split(":")[1] if name.startswith("tum:") else name)
        if not path.exists() and not path.is_symlink():
            if path.parent.resolve().is_relative_to(self.source / "data"):  # data/ is a link to it
                sys.exit(f"{name}: is not among the project's data")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.absolute().symlink_to(self.stand_ins / stand_in)

    def values(self, words, *flags):
        """What follows a flag, up to the next one."""
        found = []
        for i, word in enumerate(words):
            if word in flags:
                for value in words[i + 1:]:
                    if value.startswith("-"):
                        break
                    found.append(value)
        return found

    def positional(self, words):
        found = []
        for word in words[1:]:
            if word.startswith("-"):
                break
            found.append(word)
        return found

    def stand_in_of_source(self, name):
        if name.startswith("tum:"):
            return "walking"
        if name.endswith((".mcap", ".bag", ".db3")):
            return "session.mcap"
        return "depth.png" if name.endswith(".png") else "frames"

    def without_camera(self, words):
        """Cameras are the reader's to plug in."""
        return [str(self.stand_ins / "frames") if re.fullmatch(CAMERA, word) else word for word in words]

    def provide(self, words):
        command = words[0]
        for name in self.values(words, "-m", "--model"):
            self.place(name, "rendered.forest" if "--recipe" in words else "some.forest")
        if command in ("detect", "record", "bench", "view", "ros2"):
            for name in self.positional(words):
                self.place(name, self.stand_in_of_source(name))
        for name in self.values(words, "--extrinsics"):
            self.place(name, "cameras.json")
        if command == "evaluate":
            for name in self.positional(words):
                self.place(name, "nobody" if "empty" in name else "frames")
        if command == "compare":
            for name in self.positional(words):
                self.place(name, "evaluation.json")
        if command == "convert":
            for name in self.positional(words)[:-1]:
                if name.endswith(".forest"):
                    self.place(name, "some.forest")
                else:
                    self.place(name, self.stand_in_of_source(name) if "--to" in words else "tree.txt")
        if command == "export":
            for name in self.positional(words):
                self.place(name, "followed.mcap" if name.endswith(".mcap") else "people.jsonl")
            for name in self.values(words, "--images"):
                self.place(name, "frames/rgb")
        if command == "info":
            for name in self.positional(words):
                self.place(name, "some.forest")
        for name in self.values(words, "--like"):
            self.place(name, "frames")
        for name in self.values(words, "--data"):
            self.place(name, "labelled")
        for name in self.values(words, "--background"):
            self.place(name, "rooms")
        for name in self.values(words, "--recipe"):
            self.place(name, "recipe.toml" if words[0] != "train" or "--count" in words else "model.toml")

    def shrink(self, words):
        command = words[0]
        words = self.limit(words)
        if command == "synth":
            words = self.replace(words, {**SMALL_FRAMES, **({"--count": "2"} if "--like" in words else {})})
        if command == "train" and "--recipe" in words and "--count" not in words:
            words = self.replace(words, {"--scale": "0.99"})  # a trial: so few frames may have nobody to judge
        if command == "train" and not words[-1].endswith("help"):
            words = self.replace(words, {k: v for k, v in SMALL_FOREST.items() if not (k == "--trees" and k in words)})
        if command == "evaluate" and any(word.startswith("real/") for word in words):
            words = self.replace(words, {"--step": "30"})
        if command in ("synth", "train", "evaluate", "bench") and "--help" not in words and "-q" not in words:
            words.append("-q")
        return words

    def small_recipe(self, name):
        """A recipe of its own for each name: the program refuses one that is given twice."""
        path = self.stand_ins / f"small_{Path(name).name}"
        if not path.exists():
            shutil.copy(self.stand_ins / "recipe.toml", path)
        return str(path)

    def without_motions(self, words):
        """Recordings of motions are the reader's to fetch."""
        if "--motions" not in words:
            return words
        at = words.index("--motions")
        return words[:at] + words[at + 2:]

    def run(self, words):
        if not words or words[0] in NOT_RUN or "--dir" in words:
            return 0
        if words[0] == "vesalius":
            words = words[1:]
        if any(w.startswith("real/") for w in words) and not (Path("real").is_dir() and any(Path("real").iterdir())):
            print("example not run, no real frames: vesalius", *words, file=sys.stderr)
            return 0
        words = self.without_camera(self.without_motions(words))
        self.provide(words)
        # A recipe of the reader's own, or one of the project's, at the size of a test. That of a whole model has no --count.
        whole = words[0] == "train" and "--count" not in words
        for i, word in enumerate(words):
            if word == "--recipe" and whole:
                words[i + 1] = str(self.stand_ins / "model.toml")
            elif word == "--recipe" and words[0] in ("train", "evaluate"):
                words[i + 1] = self.small_recipe(words[i + 1])
        words = self.shrink(words)
        if words[0] == "view":
            code = self.look(words)
        elif words[0] == "ros2":
            code = self.speak(words)
        else:
            code = subprocess.run([self.program, *words], check=False).returncode
        with open(os.environ["EXAMPLE_LOG"], "a", encoding="utf-8") as log:
            log.write(f"{code} {' '.join(words)}\n")
        return code

    def look(self, words):
        """Runs the viewer until its page was there, at a port that is free."""
        words = self.replace(words, {"--port": "0"}) + ["--no-browser"]
        with subprocess.Popen([self.program, *words], stdout=subprocess.PIPE, text=True) as viewer:
            address = viewer.stdout.readline().strip()
            if address:
                with urllib.request.urlopen(address, timeout=20) as page:
                    assert page.status == 200, address
                viewer.send_signal(signal.SIGINT)
            return viewer.wait(timeout=30)


    def speak(self, words):
        """Runs a node where nobody hears it; one that waits for topics until it says so."""
        words = [*words, "--localhost", "--domain", str(1 + os.getpid() % 200)]
        if "--subscribe" not in words:
            return subprocess.run([self.program, *words], check=False).returncode
        with subprocess.Popen([self.program, *words], stderr=subprocess.PIPE, text=True) as node:
            assert "waiting" in node.stderr.readline()
            node.send_signal(signal.SIGINT)
            return node.wait(timeout=30)


def make_stand_ins(program, source, folder):
    folder.mkdir(parents=True)

    def vesalius(*words):
        subprocess.run([program, *map(str, words)], check=True)

    small = [word for pair in {**SMALL_FRAMES, **EASY_FRAMES}.items() for word in pair]
    nobody = [word for pair in {**SMALL_FRAMES, **NOBODY}.items() for word in pair]
    vesalius("synth", "-q", "--count", 12, "--seed", 5, "--out", folder / "labelled", *small)
    vesalius("synth", "-q", "--count", 4, "--seed", 6, "--out", folder / "nobody", *nobody)
    vesalius("synth", "-q", "--count", 3, "--seed", 6, "--format", "folder", "--out", folder / "rooms", *nobody)
    vesalius("convert", source / "data/sample", folder / "walking", "--to", "tum", "--rate", 30, "-q")
    vesalius("record", source / "data/sample", "--out", folder / "session.mcap", "-q")
    vesalius("record", source / "data/sample", "--out", folder / "followed.mcap", "--people", "-q")
    vesalius("detect", source / "data/sample", "--json", folder / "people.jsonl", "--track", "-q")
    (folder / "frames").symlink_to(source / "data/sample")
    (folder / "some.forest").symlink_to(source / "data/models/capsule.forest")
    (folder / "rendered.forest").symlink_to(source / "data/models/small.forest")
    (folder / "depth.png").symlink_to(sorted((source / "data/sample/depth").iterdir())[0])
    vesalius("evaluate", source / "data/sample", "-q", "-m", folder / "some.forest", "--json", folder / "evaluation.json")
    # Two cameras at one place: no example shows people over time to two.
    here = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]
    (folder / "cameras.json").write_text(json.dumps({"cameras": [{"first_from_this": here}] * 2}))
    # A tree of the paper's released format: one decision.
    (folder / "tree.txt").write_text("1\n10 0 0 0 0\n3\n9\n")
    sections = {}
    for flag, value in {**SMALL_FRAMES, **EASY_FRAMES}.items():
        section, name = flag[2:].split(".", 1)
        quoted = value if re.fullmatch(r"[0-9.]+", value) else f'"{value}"'
        sections.setdefault(section, []).append(f"{name} = {quoted}\n")
    tables = {name: f"[{name}]\n" + "".join(each) for name, each in sections.items()}
    (folder / "recipe.toml").write_text("".join(tables.values()))
    (folder / "model.toml").write_text('[synth]\nrecipe = "recipe.toml"\n[forest]\nframes = "a"\n[context]\nframes = "b"\n'
                                       '[judge]\nframes = "b"\n[frames.a]\ncount = 24\n[frames.b]\ncount = 16\nseed = 2\n'
                                       'people.none = 0.5\nscene.furniture-max = 8\n')


def blocks_of(document):
    """Blocks between ``` that call vesalius."""
    blocks, block, is_bash = [], None, False
    for line in document.read_text().splitlines():
        if line.startswith("```") and block is None:
            block, is_bash = [], line.split(" ")[0] in ("```", "```bash", "```sh")
        elif line.startswith("```"):
            if is_bash and any(re.match(r"(time )?vesalius ", each) for each in block):
                blocks.append("\n".join(block))
            block = None
        elif block is not None:
            block.append(line)
    return blocks


def blocks_of_help(program):
    def output(*words):
        return subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout

    names = re.findall(r"^  ([a-z0-9]+) {2,}", output("--help").split("Subcommands:")[1], re.MULTILINE)
    blocks = []
    for name in ["", *names]:
        text = output(*([name] if name else []), "--help")
        examples = text.split("Examples:")[1] if "Examples:" in text else ""
        for line in examples.splitlines():
            if re.match(r"  (vesalius|source) ", line):
                blocks.append(re.split(r" {4,}", line.strip())[0])
    return blocks


def mirror_of(shared, folder):
    """A folder like that of the developers' real frames, in which examples may write: links to the sets."""
    (folder / "real").mkdir(parents=True)
    if (shared / "real").is_dir():
        for each in (shared / "real").iterdir():
            (folder / "real" / each.name).symlink_to(each.resolve())
    return folder


def main():
    program, source, work, what = sys.argv[1], Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve(), sys.argv[4]
    shutil.rmtree(work, ignore_errors=True)
    make_stand_ins(program, source, work / "stand_ins")
    bin_folder = work / "bin"
    bin_folder.mkdir()
    (bin_folder / "vesalius").write_text(
        f'#!/bin/sh\nexec "{sys.executable}" "{Path(__file__).resolve()}" --as-vesalius "$@"\n')
    (bin_folder / "vesalius").chmod(0o755)
    shared = Path(os.environ.get("VESALIUS_SHARED", source / "../shared"))
    mirror = mirror_of(shared, work / "shared")
    log = work / "log"
    log.touch()
    environment = {**os.environ, "PATH": f"{bin_folder}:{os.environ['PATH']}", "EXAMPLE_PROGRAM": program,
                   "EXAMPLE_STAND_INS": str(work / "stand_ins"), "EXAMPLE_SOURCE": str(source), "EXAMPLE_LOG": str(log),
                   "HOME": str(work), "VESALIUS_SHARED": str(mirror)}
    blocks = blocks_of_help(program) if what == "--help" else blocks_of(source / what)
    if not blocks:
        sys.exit(f"{what}: no example of a command")
    folder = work / "here"
    failures = 0
    for number, block in enumerate(blocks):
        if what == "--help" or number == 0:
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
            (folder / "data").symlink_to(source / "data")
            (folder / "motions").mkdir()
            for body in (source / "data/bodies").glob("upper_body.toml"):
                shutil.copy(body, folder)
            (folder / "real").symlink_to(mirror / "real")
        script = "set -eo pipefail\n" + re.sub(r"^(\./dev|cmake|ctest|build/|bench/)", r": \1", block, flags=re.MULTILINE)
        done = subprocess.run(["bash", "-c", script], cwd=folder, env=environment, check=False, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            failures += 1
            print(f"--- failed with {done.returncode}:\n{block}\n--- said:\n{done.stdout}")
    ran = log.read_text().splitlines()
    print("\n".join(ran))
    print(f"{what}: {len(ran)} commands run, {failures} of {len(blocks)} blocks failed")
    return 1 if failures or not ran else 0


if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[1] == "--as-vesalius":
        sys.exit(Wrapper().run(sys.argv[2:]))
    sys.exit(main())
