#!/usr/bin/env python3
"""Trains the same forest on a card and on the processor, compares their bytes and their times.

Usage: train.py PROGRAM [--device cuda:0] [--frames 2000] [--threads N] [--folder out/bench_train]

The frames are rendered once into the folder. Times are those of growing, as `vesalius train` tells them; reading frames
comes before. With --device auto on a machine without a card both trainings run on the processor, to try this script.
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

RECIPE = '[body]\nkind = "builtin"\n[pose]\ncaptured = 0\n'


def run(command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"train.py: {' '.join(map(str, command))}: {done.stderr.strip().splitlines()[-1]}")
    return done.stderr


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("--device", default="cuda:0")
    parser.add_argument("--frames", type=int, default=2000)
    parser.add_argument("--threads", type=int, default=2, help="of the processor")
    parser.add_argument("--trees", type=int, default=3)
    parser.add_argument("--folder", type=Path, default=Path("out/bench_train"))
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    data = arguments.folder / f"frames-{arguments.frames}"
    if not data.exists():
        recipe = arguments.folder / "recipe.toml"
        recipe.write_text(RECIPE)
        run([arguments.program, "synth", "--recipe", recipe, "--count", arguments.frames, "--seed", 1, "--out", data])
    seconds, forests = [], []
    for device in (arguments.device, "cpu"):
        forest = arguments.folder / f"{device.replace(':', '-')}.forest"
        text = run([arguments.program, "train", "--data", data, "--trees", arguments.trees, "--threads", arguments.threads,
                    "--restart", "--device", device, "--out", forest])
        seconds.append(float(re.search(r"grown in ([0-9.]+) s", text).group(1)))
        forests.append(forest.read_bytes())
        print(f"{device}: grown in {seconds[-1]:.1f} s, {len(forests[-1])} bytes")
    if forests[0] != forests[1]:
        sys.exit("train.py: the forests differ")
    print(f"the same bytes; the processor took {seconds[1] / seconds[0]:.2f} times as long with {arguments.threads} threads")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (OSError, AttributeError) as error:
        sys.exit(f"train.py: {error}")
