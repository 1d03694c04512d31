"""Measures what training by tasks costs, beside one process.

    costs.py PROGRAM RECIPE [--frames N] [--growing | --out FILE]

Renders N frames (1000) of a recipe of `vesalius synth`, trains on them in several ways and prints what each took.
--growing only compares a subtrees task with one process. --out writes what predict.py reads. Rates are of processor
seconds, so that what else runs matters little.
"""

import argparse
import collections
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

TREES, DEPTH, CANDIDATES, ROUNDS = 4, 16, 64, 6
FOREST = ["--trees", str(TREES), "--depth", str(DEPTH), "--candidates", str(CANDIDATES)]
GROWING = ["--hard-trees", "0", "--leaf-rounds", "0"]  # trees alone
WHOLE = [*FOREST, "--hard-trees", "1", "--leaf-rounds", str(ROUNDS)]
SHARD = 2000
MAPS = 4


def run_task(program, log):
    """Runs a task for an engine, as the program would be, and notes what it took."""
    arguments = sys.argv[4:]
    child = subprocess.Popen([program, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    written = 0
    while block := child.stdout.read(1 << 20):
        written += len(block)
        sys.stdout.buffer.write(block)
    said = child.stderr.read().decode()
    sys.stderr.write(said)
    code = child.wait()
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    job = arguments[arguments.index("--job") + 1] if "--job" in arguments else ""
    counted = sum(int(n) for n in re.findall(r"^reporter:counter:vesalius,evaluations,(\d+)", said, re.MULTILINE))
    with open(log, "a") as out:
        out.write(json.dumps({"kind": arguments[1], "job": job, "cpu": used.ru_utime + used.ru_stime,
                              "mb": used.ru_maxrss / 1024, "bytes": written, "evaluations": counted}) + "\n")
    sys.exit(code)


class Measurements:
    def __init__(self, program, recipe, frames, folder):
        self.program, self.recipe, self.frames, self.folder = program, recipe, frames, folder
        self.data = folder / "data"
        self.log = folder / "tasks"
        self.wrapper = folder / "program"
        self.wrapper.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{os.path.abspath(__file__)}" --task '
                                f'"{program}" "{self.log}" "$@"\n')
        self.wrapper.chmod(0o755)
        self.run(["synth", "--recipe", recipe, "--count", str(frames), "--shard", str(SHARD), "--out", self.data, "-q"])

    def run(self, arguments):
        """Returns wall time, processor time and what the program says."""
        before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.time()
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{arguments}: {done.stderr}")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return time.time() - begun, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stderr

    def train(self, arguments, source=None):
        out = self.folder / "out.forest"
        took = self.run(["train", *(source or ["--data", self.data]), "--out", out, *arguments])
        return *took, out.read_bytes()

    def tasks_of(self, arguments, source=None):
        """Trains by single tasks; returns {(job, kind): sums over its tasks}."""
        self.log.unlink(missing_ok=True)
        self.train([*arguments, "--on", "local:1", "--task-threads", "1", "--map-tasks", str(MAPS), "--shard-frames",
                    str(SHARD), "--program", self.wrapper], source)
        jobs = collections.OrderedDict()
        for line in self.log.read_text().splitlines():
            task = json.loads(line)
            total = jobs.setdefault((task["job"], task["kind"]),
                                    {"tasks": 0, "cpu": 0.0, "mb": 0.0, "bytes": 0, "evaluations": 0})
            total["tasks"] += 1
            total["mb"] = max(total["mb"], task["mb"])
            for name in ("cpu", "bytes", "evaluations"):
                total[name] += task[name]
        return jobs


def least_squares(rows, values):
    """Solves for two unknowns."""
    a = sum(x * x for x, _ in rows)
    b = sum(x * y for x, y in rows)
    d = sum(y * y for _, y in rows)
    e = sum(x * v for (x, _), v in zip(rows, values))
    f = sum(y * v for (_, y), v in zip(rows, values))
    return (e * d - b * f) / (a * d - b * b), (a * f - b * e) / (a * d - b * b)


def compare_growing(m):
    """Returns the evaluations a processor second of one process."""
    grown = sorted(float(re.search(r"grown in ([\d.]+) s", m.train([*FOREST, *GROWING, "--threads", "1"])[2])[1])
                   for _ in range(3))
    alone = m.tasks_of([*FOREST, *GROWING])["trees-0000-level-00-subtrees", "map"]
    one, tasks = alone["evaluations"] / grown[1], alone["evaluations"] / alone["cpu"]
    print(f"growing, million evaluations a second of a processor: one process {one / 1e6:.0f}, subtree tasks "
          f"{tasks / 1e6:.0f} ({tasks / one:.0%}), start and reading included", flush=True)
    return one


def measure(m):
    known = {"frames": m.frames, "trees": TREES, "depth": DEPTH, "rounds": ROUNDS, "shard": SHARD, "runs": []}
    models = set()
    for name, arguments in (("one process", []),
                            ("local:2, whole trees in tasks", ["--on", "local:2", "--task-memory", "2"]),
                            ("local:2, every level a job", ["--on", "local:2", "--task-memory", "0"])):
        wall, cpu, said, model = m.train([*WHOLE, *arguments])
        models.add(model)
        text = re.search(r"([\d.]+) million samples, ([\d.]+) GiB", said)
        if arguments and "samples" not in known:
            known["samples"] = float(text[1]) * 1e6 / m.frames
            known["set_bytes"] = float(text[2]) * 2**30 / m.frames
        known["runs"].append({"name": name, "wall": wall, "cpu": cpu})
        print(f"{name}: {wall:.1f} s, {cpu:.1f} s of processors", flush=True)
    if len(models) != 1:
        sys.exit("the forests differ")

    starts = sorted(m.run(["train", "map", "--help"])[1] for _ in range(5))
    start = known["start"] = starts[2]
    print(f"start of a task: {start:.2f} s of a processor")
    frames = m.frames
    few, many = (m.tasks_of(["--trees", "1", "--depth", "1", *GROWING], ["--recipe", m.recipe, "--count", str(count)])
                 ["prepare", "map"]["cpu"] for count in (SHARD // 4, SHARD))
    known["render"] = (many - few) / (SHARD - SHARD // 4)
    known["render_start"] = few - known["render"] * (SHARD // 4)
    print(f"render: {known['render'] * 1e3:.1f} s of a processor for 1,000 frames, drawing and storing included; "
          f"{known['render_start']:.1f} s for a task's start")

    little = m.tasks_of(["--trees", str(MAPS), "--depth", "1", *GROWING])["trees-0000-level-00-subtrees", "map"]
    known["read"] = (little["cpu"] - little["tasks"] * start) / little["tasks"] / frames

    whole = m.tasks_of(WHOLE)
    subtrees = whole["trees-0000-level-00-subtrees", "map"]
    work = subtrees["cpu"] - subtrees["tasks"] * (start + frames * known["read"])
    known["evaluation"] = work / subtrees["evaluations"]
    # The share of samples, levels and candidates that are evaluated: leaves end early, large nodes count some samples.
    known["evaluations"] = subtrees["evaluations"] / (frames * known["samples"] * TREES * DEPTH * CANDIDATES)
    one = compare_growing(m)

    rows = m.tasks_of([*FOREST, *GROWING, "--task-memory", "0"])
    equations, seconds, ratios = [], [], []
    for level in range(DEPTH):
        of_level = rows.get((f"trees-0000-level-{level:02}-rows", "map"))
        if of_level is None:
            break
        rate = of_level["evaluations"] / of_level["cpu"]
        print(f"level {level:2}: {of_level['evaluations'] / 1e6:6.0f} million values, {rate / 1e6:3.0f} million a second "
              f"({rate / one:.0%}), {of_level['bytes'] / 1e6:4.0f} MB, "
              f"{of_level['bytes'] / of_level['evaluations']:.2f} bytes a value")
        equations.append((frames * TREES, of_level["evaluations"]))
        seconds.append(of_level["cpu"] - of_level["tasks"] * start)
        ratios.append(of_level["bytes"] / of_level["evaluations"])
    known["rows_frame"], known["rows_value"] = least_squares(equations, seconds)
    known["value_bytes"] = ratios[-1]
    print(f"rows tasks without start and reading: {1e-6 / known['rows_value']:.0f} million a second")
    reduced = [(of, rows[job, "map"]["evaluations"]) for (job, kind), of in rows.items()
               if kind == "reduce" and job.endswith("-rows")]
    known["reduce_value"] = (sum(of["cpu"] - of["tasks"] * start for of, _ in reduced)
                             / sum(values for _, values in reduced))
    counts = [of["cpu"] - of["tasks"] * start for (job, kind), of in rows.items()
              if kind == "map" and job.endswith("-counts")]
    known["count_frame"] = sum(counts) / len(counts) / (frames * TREES)
    leaves = {"hard_counts": "hard-counts", "harden": "harden", "leaf_counts": "leaf-counts",
              "gradient": "gradient-0001", "facing": "facing"}
    for name, job in leaves.items():
        of = whole[job, "map"]
        known[name + "_frame"] = (of["cpu"] - of["tasks"] * start) / frames
        known[name + "_bytes"] = of["bytes"] / of["tasks"]
    known["rest"] = sum(known[name + "_frame"] * (ROUNDS if name == "gradient" else 1) for name in leaves)
    print(f"hard negatives, {ROUNDS} rounds of leaves, facing: {known['rest'] * 1e3:.2f} s of a processor for 1,000 frames; "
          f"growing {TREES + 1} trees: {known['evaluation'] * known['evaluations'] * known['samples'] * (TREES + 1) * DEPTH * CANDIDATES * 1e3:.2f} s")
    largest = max(of["mb"] for (_, kind), of in [*rows.items(), *whole.items()] if kind == "reduce")
    print(f"reduce tasks: at most {largest:.0f} MB")
    return known


def main():
    if sys.argv[1] == "--task":
        run_task(sys.argv[2], sys.argv[3])
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=lambda path: str(pathlib.Path(path).resolve()))
    parser.add_argument("recipe", type=lambda path: str(pathlib.Path(path).resolve()))
    parser.add_argument("--frames", type=int, default=1000)
    parser.add_argument("--growing", action="store_true")
    parser.add_argument("--out", type=pathlib.Path)
    arguments = parser.parse_args()
    for path in (arguments.program, arguments.recipe):
        if not os.path.isfile(path):
            sys.exit(f"{path}: no such file")
    folder = pathlib.Path(tempfile.mkdtemp(prefix="vesalius-costs-"))
    try:
        measurements = Measurements(arguments.program, arguments.recipe, arguments.frames, folder)
        if arguments.growing:
            compare_growing(measurements)
            return
        known = measure(measurements)
    finally:
        shutil.rmtree(folder)
    if arguments.out:
        arguments.out.write_text(json.dumps(known, indent=1) + "\n")


if __name__ == "__main__":
    main()
