"""Measures what training by tasks costs, beside one process. Every figure is printed with what it is.

    costs.py PROGRAM DATASET

DATASET: a folder of `vesalius synth`; docs/cluster.md names the one that its figures are of.
"""

import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import time

FOREST = ["--trees", "4", "--depth", "16"]
GROWING = [*FOREST, "--hard-trees", "0", "--leaf-rounds", "0"]  # trees alone
WHOLE = [*FOREST, "--hard-trees", "1", "--leaf-rounds", "6"]


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
        out.write(json.dumps({"kind": arguments[1], "job": job, "cpu_s": used.ru_utime + used.ru_stime,
                              "max_mb": used.ru_maxrss / 1024, "bytes": written, "evaluations": counted}) + "\n")
    sys.exit(code)


def train(program, dataset, folder, name, arguments):
    """Returns the wall time in seconds, what the program says, and the forest's bytes."""
    out = folder / (name + ".forest")
    begun = time.time()
    done = subprocess.run([program, "train", "--data", dataset, "--out", out, *arguments], capture_output=True,
                          text=True)
    if done.returncode != 0:
        sys.exit(f"{name}: {done.stderr}")
    return time.time() - begun, done.stderr, out.read_bytes()


def main():
    if sys.argv[1] == "--task":
        run_task(sys.argv[2], sys.argv[3])
    program, dataset = (str(pathlib.Path(a).resolve()) for a in sys.argv[1:3])
    folder = pathlib.Path(tempfile.mkdtemp(prefix="vesalius-costs-"))
    log = folder / "tasks"
    wrapper = folder / "program"
    wrapper.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{os.path.abspath(__file__)}" --task "{program}" "{log}" "$@"\n')
    wrapper.chmod(0o755)

    models = set()
    for name, arguments in (("one process", []), ("local:2, whole trees in tasks", ["--on", "local:2", "--shard-frames", "250"]),
                            ("local:2, every level a job", ["--on", "local:2", "--shard-frames", "250", "--task-memory", "0"])):
        seconds, said, model = train(program, dataset, folder, "whole", [*WHOLE, *arguments])
        models.add(model)
        shards = re.search(r"\d+ frames in .* GiB", said)
        print(f"{name}: {seconds:.1f} s{'; ' + shards[0] if shards else ''}", flush=True)

    grown = []
    for _ in range(3):
        said = train(program, dataset, folder, "one", [*GROWING, "--threads", "1"])[1]
        grown.append(float(re.search(r"grown in ([\d.]+) s", said)[1]))
    engine = [*GROWING, "--on", "local:1", "--task-threads", "1", "--shard-frames", "250", "--program", wrapper]
    train(program, dataset, folder, "subtrees", engine)
    train(program, dataset, folder, "rows", [*engine, "--task-memory", "0"])
    tasks = [json.loads(line) for line in log.read_text().splitlines()]
    subtrees = [t for t in tasks if t["job"].endswith("-subtrees")]
    rows = [t for t in tasks if t["job"].endswith("-rows") and t["kind"] == "map"]
    evaluations = sum(t["evaluations"] for t in subtrees)
    print(f"one process: {evaluations / sorted(grown)[1] / 1e6:.0f} million evaluations a core-second (growing, median of 3)")
    print(f"subtrees tasks: {evaluations / sum(t['cpu_s'] for t in subtrees) / 1e6:.0f} million, start and reading included")
    for task in rows:
        print(f"{task['job']}: {task['evaluations'] / task['cpu_s'] / 1e6:.0f} million a core-second, "
              f"{task['bytes'] / 1e6:.0f} MB, {task['bytes'] / max(1, task['evaluations']):.2f} bytes a value")
    print(f"reduce tasks: at most {max(t['max_mb'] for t in tasks if t['kind'] == 'reduce'):.0f} MB")
    if len(models) != 1:
        sys.exit("the forests differ")


if __name__ == "__main__":
    main()
