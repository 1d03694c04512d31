"""Trains one small forest in one process and on an engine, and compares the files byte for byte.

    engines.py PROGRAM SOURCE_FOLDER WORK_FOLDER local|faults|slurm|hadoop|spark [--full]

`local` and `faults` run processes of this machine; `spark` is this Python's pyspark.

Exits with 77 where the engine cannot be had, saying why. --full adds what takes minutes: all numbers of tasks, a node
that is killed, every first attempt that dies.
"""

import importlib.util
import itertools
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

OPTIONS = """trees = 2
hard-trees = 1
depth = 4
pixels = 150
candidates = 70
split-pixels = 1500
min-samples = 5
leaf-rounds = 3
leaf-portions = 2
"""
# A level is one job where every node is looked at whole.
HADOOP_OPTIONS = """trees = 2
hard-trees = 0
depth = 3
pixels = 150
split-pixels = 65535
leaf-rounds = 0
"""
# Half of the levels and rounds: each job costs Slurm two seconds.
SLURM_OPTIONS = OPTIONS.replace("depth = 4", "depth = 2").replace("leaf-rounds = 3", "leaf-rounds = 1")
RECIPE = """[body]
kind = "builtin"
[pose]
captured = 0
[sensor]
width = 160
height = 120
fx = 140
fy = 140
cx = 79.5
cy = 59.5
"""


class Failure(Exception):
    pass


def expect(right, what):
    if not right:
        raise Failure(what)


class Trainings:
    """Runs `vesalius train` in a folder of its own."""

    def __init__(self, program, source, work, options):
        self.program = program
        self.examples = source / "examples" / "cluster"
        self.work = work
        self.environment = dict(os.environ, VESALIUS_ASSETS="/nonexistent")
        (work / "options.toml").write_text(options)
        (work / "recipe.toml").write_text(RECIPE)
        self.count = 0
        self.expected = self.train([], "one").read_bytes()

    def command(self, arguments, out):
        return [self.program, "train", "--recipe", "recipe.toml", "--count", "40", "--options", "options.toml",
                "--out", out, *arguments]

    def start(self, arguments, out):
        return subprocess.Popen(self.command(arguments, out), cwd=self.work, env=self.environment,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def train(self, arguments, name):
        out = name + ".forest"
        process = self.start(arguments, out)
        text, _ = process.communicate()
        expect(process.returncode == 0, f"{' '.join(arguments)}: exit {process.returncode}\n{text}")
        expect(not (self.work / (out + ".work")).exists(), f"{out}.work was left behind")
        return self.work / out

    def same(self, arguments, what):
        self.count += 1
        begun = time.time()
        model = self.train(arguments, f"same-{self.count}")
        expect(model.read_bytes() == self.expected, f"{what}: another forest than in one process")
        print(f"same bytes: {what} ({time.time() - begun:.0f} s)", flush=True)

    def refused(self, arguments, message, what, name=None):
        self.count += 1
        out = name or f"refused-{self.count}.forest"
        process = self.start(arguments, out)
        text, _ = process.communicate()
        last = text.strip().splitlines()[-1] if text.strip() else ""
        expect(process.returncode in (1, 2), f"{what}: exit {process.returncode}\n{text}")
        expect(message in last, f"{what}: expected '{message}' in\n{text}")
        expect(not (self.work / out).exists(), f"{what}: a model was written")
        print(f"refused: {what}: {last}", flush=True)

    def same_after_kills(self, arguments, pauses, what):
        """Kills the driver -9 after each of some seconds and lets the last run end."""
        self.count += 1
        out = f"killed-{self.count}.forest"
        for pause in pauses:
            process = self.start(arguments, out)
            try:
                process.wait(timeout=pause)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
                process.communicate()
        model = self.train(arguments, out.removesuffix(".forest"))
        expect(model.read_bytes() == self.expected, f"{what}: another forest than in one process")
        print(f"same bytes: {what}", flush=True)


def dying_program(trainings):
    """A program whose first attempt of every task is killed."""
    script = trainings.work / "dies_first"
    marks = trainings.work / "marks"
    shutil.rmtree(marks, ignore_errors=True)
    marks.mkdir()
    script.write_text(f"""#!/bin/bash
who="$mapreduce_task_id${{mapreduce_task_id:-$(tr '\\0' ' ' </proc/$PPID/cmdline)}} $2"
key=$(echo "$who $*" | md5sum | cut -c 1-32)
[ "$2" != combine ] && mkdir "{marks}/$key" 2>/dev/null && kill -9 $$
exec "{trainings.program}" "$@"
""")
    script.chmod(0o755)
    return str(script), marks


def check_faults(trainings, engine, full):
    program, marks = dying_program(trainings)
    trainings.same([*engine, "--map-tasks", "3", "--shard-frames", "9", "--program", program],
                   "the first attempt of every task killed")
    expect(len(list(marks.iterdir())) > 5, "no attempt was killed")
    trainings.same_after_kills([*engine, "--map-tasks", "3", "--shard-frames", "9", "--task-memory", "0"],
                               [1.5, 2.5, 4.0] + ([0.7] * 8 if full else []), "driver killed with -9 and begun again")


def check_local(trainings, full):
    tasks = [1, 3, 7] if full else [3]
    for maps, memory, combiner in itertools.product(tasks, ["0", "2"], [[], ["--no-combiner"]] if full else [[]]):
        trainings.same(["--on", "local:5", "--map-tasks", str(maps), "--shard-frames", "6", "--task-memory", memory,
                        *combiner], f"local:5, {maps} map tasks, {memory} GiB a task {' '.join(combiner)}")
    if not full:
        trainings.same(["--on", "local:2", "--map-tasks", "7", "--shard-frames", "6", "--no-combiner"],
                       "local:2, 7 map tasks without combiner")
    trainings.refused(["--on", "local:0"], "expected local:N", "local:0")
    trainings.refused(["--on", "mars"], "expected local:N, slurm, hadoop or script:FILE", "an unknown engine")
    trainings.refused(["--on", "hadoop"], "expects --store webhdfs://", "Hadoop without HDFS")
    trainings.refused(["--on", "local:2", "--report", "r"], "--on expects neither", "--report")
    check_script(trainings)


def check_script(trainings):
    plain = ["--on", f"script:{trainings.examples / 'plain_job.sh'}", "--shard-frames", "6", "--map-tasks", "3"]
    trainings.same(plain, "a script, 3 map tasks")
    trainings.refused([*plain, "--program", "/nonexistent/vesalius"], "plain_job.sh failed: bash: line 1: /nonexistent",
                      "a script that fails")
    trainings.refused(["--on", "script:recipe.toml"], "the file cannot be executed", "a script that is none")
    trainings.refused(["--on", "script:nowhere"], "script:nowhere: no such file", "no script")


def check_rendering(trainings, engine):
    """The shards of a dataset are those of one process, also where the first run was killed."""
    def render(arguments, out):
        return [trainings.program, "synth", "--recipe", "recipe.toml", "--count", "25", "--shard", "4", "--out", out,
                *arguments]

    work, environment = trainings.work, trainings.environment
    for arguments, out in (([], "one-data"), (engine, "machines-data")):
        if arguments:
            killed = subprocess.Popen(render(arguments, out), cwd=work, env=environment, stderr=subprocess.DEVNULL)
            time.sleep(1.5)
            killed.kill()
            killed.wait()
        ended = subprocess.run(render(arguments, out), cwd=work, env=environment, capture_output=True, text=True)
        expect(ended.returncode == 0, f"synth {arguments}: {ended.stderr}")
    files = sorted(path.name for path in (work / "one-data").iterdir() if path.is_file())
    expect(len([name for name in files if name.endswith(".shard")]) == 7, f"files: {files}")
    for name in files:
        expect((work / "one-data" / name).read_bytes() == (work / "machines-data" / name).read_bytes(),
               f"{name} differs")
    expect(not (work / "machines-data.work").exists(), "machines-data.work was left behind")
    print("same bytes: frames rendered by tasks", flush=True)


def check_local_faults(trainings, full):
    check_faults(trainings, ["--on", "local:3"], full)
    check_rendering(trainings, ["--on", "local:2", "--map-tasks", "3"])

    # A shard that is damaged after it was written: its task fails, is tried again, and one line names it.
    name = "damaged.forest"
    sets = trainings.work / (name + ".work") / "cluster" / "sets-0"
    process = trainings.start(["--on", "local:2", "--shard-frames", "9", "--task-memory", "0"], name)
    while not (sets.parent / "jobs" / "trees-1000-level-00-rows").exists() and process.poll() is None:
        time.sleep(0.01)
    process.kill()
    process.communicate()
    shard = sets / "000001"
    damaged = bytearray(shard.read_bytes())
    damaged[len(damaged) // 2] ^= 1
    shard.write_bytes(damaged)
    shutil.rmtree(sets.parent / "jobs" / "trees-1000-level-00-rows", ignore_errors=True)
    trainings.refused(["--on", "local:2", "--shard-frames", "9", "--task-memory", "0"],
                      "sets-0/000001: damaged, its checksum does not match", "a damaged shard", name)
    trainings.same(["--on", "local:2", "--shard-frames", "9", "--restart"], "--restart")

    trainings.refused(["--on", "local:2", "--program", "/nonexistent/vesalius"], "failed 4 times",
                      "no program on the machine")


def cluster(source, folder, engine, command, *more):
    script = source / "tools" / "cluster" / engine / "cluster.sh"
    return subprocess.run(["bash", script, command, folder, *more], stderr=subprocess.PIPE, text=True)


def environment_of(folder):
    text = subprocess.run(["bash", "-c", f". {folder}/env.sh && env -0"], capture_output=True, text=True,
                          check=True).stdout
    return dict(line.split("=", 1) for line in text.split("\0") if "=" in line)


def check_slurm(trainings, full):
    engine = ["--on", "slurm", "--shard-frames", "9"]
    trainings.same([*engine, "--map-tasks", "3", "--task-memory", "0"], "Slurm, 3 map tasks")
    trainings.refused([*engine, "--engine-arguments=--partition=nowhere"], "Slurm refuses the job",
                      "a partition that does not exist")
    if not full:
        return
    for maps in (1, 7):
        trainings.same([*engine, "--map-tasks", str(maps), "--task-memory", "0"], f"Slurm, {maps} map tasks")
    check_faults(trainings, engine, full)


def check_hadoop(trainings, full):
    store = trainings.environment["VESALIUS_HDFS"] + "/vesalius-test"
    engine = ["--on", "hadoop", "--store", store, "--shard-frames", "9", "--task-memory", "0"]
    trainings.same([*engine, "--map-tasks", "2", "--reduce-tasks", "2"], "Hadoop, 2 map tasks, 3 levels")
    if not full:
        return
    for maps, combiner in ((1, []), (7, ["--no-combiner"])):
        trainings.same([*engine, "--map-tasks", str(maps), *combiner], f"Hadoop, {maps} map tasks {combiner}")
    trainings.same([*engine, "--map-tasks", "3", "--engine-arguments",
                    "-D mapreduce.map.speculative=true -D mapreduce.reduce.speculative=true"], "speculative attempts")
    program, _ = dying_program(trainings)
    trainings.same([*engine, "--map-tasks", "3", "--program", program], "the first attempt of every task killed")
    trainings.same_after_kills([*engine, "--map-tasks", "3"], [20, 25], "driver killed with -9 and begun again")


def check_spark(trainings, full):
    engine = ["--on", f"script:{trainings.examples / 'spark_job.py'}", "--shard-frames", "9"]
    program, marks = dying_program(trainings)
    trainings.same([*engine, "--map-tasks", "3", "--program", program], "Spark, first attempts killed")
    expect(list(marks.iterdir()), "no attempt was killed")
    trainings.refused([*engine, "--program", "/nonexistent/vesalius"], "No such file or directory: '/nonexistent/",
                      "no program on the machine")
    if not full:
        return
    trainings.same([*engine, "--map-tasks", "5", "--task-memory", "0", "--no-combiner"], "Spark, every level a job")
    check_rendering(trainings, engine[:2])


def missing_for_spark():
    if importlib.util.find_spec("pyspark") is None:
        return f"{sys.executable} has no pyspark"
    return None if shutil.which("java") or "JAVA_HOME" in os.environ else "java is not installed"


def main():
    program, source, work, engine = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]), sys.argv[4]
    full = "--full" in sys.argv
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    os.environ.setdefault("VESALIUS_HADOOP_LIB", str(work.parent / "hadoop-lib"))
    if engine == "spark":
        if missing := missing_for_spark():
            print("SKIPPED:", missing)
            return 77
        # The example asks for python3, and no machine but this one is to be heard.
        os.environ.update(PATH=f"{pathlib.Path(sys.executable).parent}:{os.environ['PATH']}", SPARK_LOCAL_IP="127.0.0.1")
    real = engine in ("slurm", "hadoop")
    folder = tempfile.mkdtemp(prefix="vesalius-") if real else ""  # sockets' paths must be short
    if real:
        started = cluster(source, folder, engine, "start")
        if started.returncode == 77:
            print("SKIPPED:", started.stderr.strip())
            return 77
        expect(started.returncode == 0, f"{engine} does not start: {started.stderr}")
    try:
        if real:
            os.environ.update(environment_of(folder))
        options = {"hadoop": HADOOP_OPTIONS, "spark": HADOOP_OPTIONS, "slurm": OPTIONS if full else SLURM_OPTIONS}
        trainings = Trainings(program, source, work, options.get(engine, OPTIONS))
        {"local": check_local, "faults": check_local_faults, "slurm": check_slurm, "hadoop": check_hadoop,
         "spark": check_spark}[engine](trainings, full)
    except Failure as failure:
        print("FAILED:", failure)
        return 1
    finally:
        if real:
            cluster(source, folder, engine, "stop")
            shutil.rmtree(folder, ignore_errors=True)
    shutil.rmtree(work)
    return 0


if __name__ == "__main__":
    sys.exit(main())
