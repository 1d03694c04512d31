"""Measures what a level of a tree costs on an engine beyond its work, on this machine alone.

    overhead.py PROGRAM SOURCE_FOLDER slurm|hadoop

Trains a small forest twice, with few levels and with more, on the engine and by local processes. The difference of the
two, by the number of levels, is what a level takes; that of local processes is its work and theirs.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "cluster"))
from engines import RECIPE, cluster, environment_of  # noqa: E402

FEW, MANY = 1, 6
OPTIONS = """trees = 2
hard-trees = 0
pixels = 200
split-pixels = 65535
min-samples = 2
leaf-rounds = 0
"""


def train(program, folder, depth, engine):
    begun = time.time()
    subprocess.run([program, "train", "--recipe", "recipe.toml", "--count", "40", "--options", "options.toml", "--depth",
                    str(depth), "--shard-frames", "20", "--task-memory", "0", "--map-tasks", "2", "--reduce-tasks", "2",
                    "--out", f"{depth}.forest", "-q", *engine], cwd=folder, check=True,
                   env=dict(os.environ, VESALIUS_ASSETS="/nonexistent"))
    return time.time() - begun


def level(program, folder, engine):
    """Returns the seconds of a level: the median of three pairs."""
    seconds = []
    for _ in range(3):
        few, many = (train(program, folder, depth, engine) for depth in (FEW, MANY))
        seconds.append((many - few) / (MANY - FEW))
    return sorted(seconds)[1]


def main():
    if len(sys.argv) != 4 or sys.argv[3] not in ("slurm", "hadoop") or not os.path.isfile(sys.argv[1]):
        sys.exit("expected: overhead.py PROGRAM SOURCE_FOLDER slurm|hadoop")
    program, source, engine = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]), sys.argv[3]
    folder = tempfile.mkdtemp(prefix="vesalius-")
    work = pathlib.Path(folder, "work")
    work.mkdir()
    (work / "recipe.toml").write_text(RECIPE)
    (work / "options.toml").write_text(OPTIONS)
    try:
        started = cluster(source, folder, engine, "start")
        if started.returncode != 0:
            sys.exit(started.stderr.strip())
        os.environ.update(environment_of(folder))
        store = ["--store", os.environ["VESALIUS_HDFS"] + "/overhead"] if engine == "hadoop" else []
        local = level(program, work, ["--on", "local:2"])
        there = level(program, work, ["--on", engine, *store])
    finally:
        cluster(source, folder, engine, "stop")
        shutil.rmtree(folder, ignore_errors=True)
    print(f"a level: {there:.1f} s on {engine}, {local:.2f} s by two local processes; {there - local:.1f} s more")


if __name__ == "__main__":
    main()
