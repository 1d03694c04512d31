"""Trains one small forest in one process and on an engine, and compares the files byte for byte.

    engines.py PROGRAM SOURCE_FOLDER WORK_FOLDER local|faults|slurm|hadoop|spark [--full]

`local` and `faults` run processes of this machine; `spark` is this Python's pyspark.

Exits with 77 where the engine cannot be had, saying why. --full adds what takes minutes: all numbers of tasks, a node
that is killed, every first attempt that dies, frames rendered by tasks, and all that an engine or a store refuses.
"""

import importlib.util
import itertools
import os
import pathlib
import re
import shutil
import signal
import struct
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
# Combiners add up what leaves learn from.
FULL_HADOOP_OPTIONS = HADOOP_OPTIONS.replace("depth = 3", "depth = 2").replace("leaf-rounds = 0", "leaf-rounds = 1")
# Half of the levels and rounds, for what must be quick: each job costs Slurm two seconds.
QUICK_OPTIONS = OPTIONS.replace("depth = 4", "depth = 2").replace("leaf-rounds = 3", "leaf-rounds = 1")
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
        self.processes = []
        self.expected = self.train([], "one").read_bytes()

    def command(self, arguments, out):
        return [self.program, "train", "--recipe", "recipe.toml", "--count", "40", "--options", "options.toml",
                "--out", out, *arguments]

    def start(self, arguments, out, prefix=(), **variables):
        self.processes.append(subprocess.Popen(
            [*prefix, *self.command(arguments, out)], cwd=self.work, env=dict(self.environment, **variables),
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)))
        return self.processes[-1]

    def end(self):
        for process in self.processes:
            process.kill()
            process.wait()

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

    def refused(self, arguments, message, what, name=None, **start):
        """Expects one line that says what is wrong, and no model."""
        self.count += 1
        begun = time.time()
        out = name or f"refused-{self.count}.forest"
        process = self.start(arguments, out, **start)
        text, _ = process.communicate()
        said = [line for line in text.splitlines() if line.startswith("vesalius: ")]
        expect(process.returncode in (1, 2), f"{what}: exit {process.returncode}\n{text}")
        expect(len(said) == 1 and text.strip().endswith(said[0]) and message in said[0],
               f"{what}: expected one line with '{message}' in\n{text}")
        expect(not (self.work / out).exists(), f"{what}: a model was written")
        print(f"refused: {what}: {said[0]} ({time.time() - begun:.0f} s)", flush=True)

    def same_after_kills(self, arguments, pauses, what, last=()):
        """Kills the driver -9 after each of some seconds and lets the last run end, with more arguments."""
        self.count += 1
        begun = time.time()
        out = f"killed-{self.count}.forest"
        for pause in pauses:
            process = self.start(arguments, out)
            try:
                process.wait(timeout=pause)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
                process.communicate()
        model = self.train([*arguments, *last], out.removesuffix(".forest"))
        expect(model.read_bytes() == self.expected, f"{what}: another forest than in one process")
        print(f"same bytes: {what} ({time.time() - begun:.0f} s)", flush=True)

    def same_where_a_node_dies(self, arguments, node_of, nodes, what):
        """Holds a task in the middle of a level, kills its node, and lets the training end without it."""
        self.count += 1
        begun = time.time()
        name = f"node-{self.count}"
        program, marks = holding_program(self)
        process = self.start([*arguments, "--program", program], name + ".forest")
        wait_for(marks / "held", process, 300)
        node = node_of((marks / "held").read_text())
        expect(nodes("kill-node", node).returncode == 0, f"{what}: node {node} cannot be killed")
        text, _ = process.communicate()
        nodes("start-node", node)
        expect(process.returncode == 0, f"{what}: exit {process.returncode}\n{text}")
        expect((self.work / (name + ".forest")).read_bytes() == self.expected,
               f"{what}: another forest than in one process")
        print(f"same bytes: {what} ({time.time() - begun:.0f} s)", flush=True)


def wait_for(path, process, limit):
    end = time.time() + limit
    while not path.exists():
        expect(process.poll() is None and time.time() < end, f"{path.name} did not come")
        time.sleep(0.05)


def program_of(trainings, name, lines):
    """A program that does something before it becomes vesalius, and a folder for its marks."""
    script, marks = trainings.work / name, trainings.work / f"marks-{name}"
    shutil.rmtree(marks, ignore_errors=True)
    marks.mkdir()
    script.write_text(f"#!/bin/bash\nmarks={marks}\n{lines}\nexec {trainings.program} \"$@\"\n")
    script.chmod(0o755)
    return str(script), marks


def holding_program(trainings):
    """The first map task of the second level is held for ten minutes and tells where it runs; so does each attempt."""
    return program_of(trainings, "holds_one", """if [[ "$2 $*" == map*level-01-rows* ]]; then
  touch "$marks/attempt-$mapreduce_task_attempt_id"
  if mkdir "$marks/first" 2>/dev/null; then
    echo "$SLURMD_NODENAME $LOCAL_DIRS" >"$marks/writing" && mv "$marks/writing" "$marks/held"
    sleep 600
  fi
fi""")


def other_build(trainings):
    """A copy of the program with another build id (a note of ELF)."""
    note = struct.pack("<3I4s", 4, 20, 3, b"GNU")  # lengths of name and contents, kind, name
    program = trainings.work / "other_build"
    code = bytearray(pathlib.Path(trainings.program).read_bytes())
    expect(code.count(note) == 1, f"{trainings.program}: expected one build id")
    code[code.index(note) + len(note)] ^= 1
    program.write_bytes(code)
    program.chmod(0o755)
    return str(program)


def dying_program(trainings):
    """A program whose first attempt of every task is killed."""
    return program_of(trainings, "dies_first", r"""
who="$mapreduce_task_id $SLURM_ARRAY_TASK_ID ${mapreduce_task_id:-$(tr '\0' ' ' </proc/$PPID/cmdline)} $2"
key=$(echo "$who $*" | md5sum | cut -c 1-32)
[ "$2" != combine ] && mkdir "$marks/$key" 2>/dev/null && kill -9 $$""")


def check_faults(trainings, engine, full):
    program, marks = dying_program(trainings)
    trainings.same([*engine, "--map-tasks", "3", "--program", program], "the first attempt of every task killed")
    expect(len(list(marks.iterdir())) > 5, "no attempt was killed")
    trainings.same_after_kills([*engine, "--map-tasks", "3", "--task-memory", "0"],
                               [1.5, 2.5, 4.0] + ([0.7] * 8 if full else []), "driver killed with -9 and begun again")
    if full:
        trainings.same_after_kills([*engine, "--task-memory", "0"], [2.0, 3.5, 5.0],
                                   "driver killed with -9 and begun again with other tasks", ["--map-tasks", "2"])


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


def check_rendering(trainings, engine, pause=1.5):
    """The shards of a dataset are those of one process, also where the first run was killed."""
    def render(arguments, out):
        return [trainings.program, "synth", "--recipe", "recipe.toml", "--count", "25", "--shard", "4", "--out", out,
                *arguments]

    begun = time.time()
    work, environment = trainings.work, trainings.environment
    for arguments, out in (([], "one-data"), (engine, "machines-data")):
        if arguments:
            killed = subprocess.Popen(render(arguments, out), cwd=work, env=environment, stderr=subprocess.DEVNULL)
            time.sleep(pause)
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
    print(f"same bytes: frames rendered by tasks ({time.time() - begun:.0f} s)", flush=True)


def check_unwritable(trainings, engine):
    """Stores into which the driver cannot write."""
    work = trainings.work
    (work / "file").write_text("")
    trainings.refused([*engine, "--store", str(work / "file" / "store")], "Not a directory", "a store below a file")
    store, anyones = work / "not-mine", work / "anyones"
    store.mkdir(mode=0o755)
    anyones.mkdir()
    anyones.chmod(0o777)
    prefix = []
    if os.geteuid() == 0:
        prefix = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]
        try:
            subprocess.run([*prefix, trainings.program, "--version"], check=True, capture_output=True)
        except (OSError, subprocess.CalledProcessError) as error:
            print(f"not tried: a store of another user: {error}", flush=True)
            return
    else:
        store.chmod(0o555)
    trainings.refused([*engine, "--store", str(store)], "Permission denied", "a store of another user",
                      "anyones/refused.forest", prefix=prefix)


def check_full(trainings, engine):
    """A file system that has room for the job and not for the frames."""
    folder = trainings.work / "small"
    folder.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256k", "none", folder], stderr=subprocess.DEVNULL).returncode:
        print("not tried: a full file system: needs the right to mount one", flush=True)
        return
    try:
        trainings.refused([*engine, "--store", str(folder / "store")], "No space left on device", "a full file system")
    finally:
        subprocess.run(["umount", folder], check=True)


def check_local_faults(trainings, full):
    check_faults(trainings, ["--on", "local:3", "--shard-frames", "9"], full)
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
    if not full:
        return
    engine = ["--on", "local:2", "--shard-frames", "9"]
    trainings.refused([*engine, "--program", other_build(trainings)], "expected the same on all machines",
                      "tasks of another build")
    check_unwritable(trainings, engine)
    check_full(trainings, engine)


def cluster(source, folder, engine, command, *more):
    script = source / "tools" / "cluster" / engine / "cluster.sh"
    return subprocess.run(["bash", script, command, folder, *more], stderr=subprocess.PIPE, text=True)


def environment_of(folder):
    text = subprocess.run(["bash", "-c", f". {folder}/env.sh && env -0"], capture_output=True, text=True,
                          check=True).stdout
    return dict(line.split("=", 1) for line in text.split("\0") if "=" in line)


def check_waiting_queue(trainings, engine):
    """A partition that is down: the user is told why nothing starts, and Ctrl-C leaves nothing in the queue."""
    def partition(state):
        subprocess.run(["scontrol", "update", "PartitionName=all", f"State={state}"], check=True)

    begun = time.time()
    partition("DOWN")
    process = trainings.start(engine, "waiting.forest")
    told = next((line for line in process.stdout if "waiting for Slurm" in line or time.time() > begun + 120), "")
    expect("waiting for Slurm: PartitionDown" in told, f"a queue that starts nothing: '{told}'")
    process.send_signal(signal.SIGINT)
    text, _ = process.communicate()
    queue = subprocess.run(["squeue", "-h"], capture_output=True, text=True, check=True).stdout
    expect(process.returncode == 1 and "interrupted" in text, f"Ctrl-C: exit {process.returncode}\n{text}")
    expect(queue == "", f"left in the queue: {queue}")
    partition("UP")
    print(f"told: a queue that starts nothing: {told.strip()}", flush=True)
    print(f"left the queue: {text.strip().splitlines()[-1]} ({time.time() - begun:.0f} s)", flush=True)


def check_slurm(trainings, full, nodes):
    engine = ["--on", "slurm", "--shard-frames", "9"]
    trainings.same([*engine, "--map-tasks", "3", "--task-memory", "0"], "Slurm, 3 map tasks")
    trainings.refused([*engine, "--engine-arguments=--partition=nowhere"], "Slurm refuses the job",
                      "a partition that does not exist")
    if not full:
        return
    for maps, combiner in itertools.product((1, 3, 7), ([], ["--no-combiner"])):
        if (maps, combiner) != (3, []):
            trainings.same([*engine, "--map-tasks", str(maps), "--task-memory", "0", *combiner],
                           f"Slurm, {maps} map tasks {' '.join(combiner)}")
    trainings.same_where_a_node_dies([*engine, "--map-tasks", "3", "--task-memory", "0"],
                                     lambda told: re.search(r"node(\d)", told)[1], nodes,
                                     "a node killed in the middle of a level")
    check_faults(trainings, engine, full)
    check_rendering(trainings, ["--on", "slurm", "--map-tasks", "3"])
    check_waiting_queue(trainings, engine)
    trainings.refused([*engine, "--program", other_build(trainings)], "expected the same on all machines",
                      "tasks of another build")
    check_unwritable(trainings, engine)
    folder = pathlib.Path(os.environ["SLURM_CONF"]).parent
    os.kill(int((folder / "run" / "munged.pid").read_text()), signal.SIGKILL)
    trainings.refused(engine, "Slurm: sbatch does not answer within 30 s", "Slurm without munge")


def hdfs(*arguments):
    subprocess.run(["hdfs", *arguments], check=True, capture_output=True)


def check_hdfs_refuses(trainings, engine, hdfs_root):
    """A folder of another user; no room for the driver; no room for the tasks, whose messages find none either."""
    hdfs("dfs", "-mkdir", "-p", "/private", "/full", "/nearly")
    hdfs("dfs", "-chown", "other", "/private")
    hdfs("dfs", "-chmod", "700", "/private")
    trainings.refused([*engine, "--store", hdfs_root + "/private/forest"],
                      "AccessControlException: Permission denied: user=somebody", "a folder of HDFS without permission",
                      HADOOP_USER_NAME="somebody")
    block = 2 * 128 * 2**20  # HDFS wants room for a whole block on two data nodes
    hdfs("dfsadmin", "-setSpaceQuota", str(block // 2), "/full")
    trainings.refused([*engine, "--store", hdfs_root + "/full"], "DSQuotaExceededException", "a full HDFS")
    hdfs("dfsadmin", "-setSpaceQuota", str(block + 150_000), "/nearly")
    trainings.refused([*engine, "--store", hdfs_root + "/nearly"], "DSQuotaExceededException",
                      "an HDFS that the tasks fill")


def check_hadoop(trainings, full, nodes):
    store = trainings.environment["VESALIUS_HDFS"] + "/vesalius-test"
    without_store = ["--on", "hadoop", "--shard-frames", "9", "--task-memory", "0"]
    engine = [*without_store, "--store", store]
    trainings.same([*engine, "--map-tasks", "2", "--reduce-tasks", "2"], "Hadoop, 2 map tasks, 3 levels")
    if not full:
        return
    for maps, combiner in itertools.product((1, 3, 7), ([], ["--no-combiner"])):
        trainings.same([*engine, "--map-tasks", str(maps), *combiner],
                       f"Hadoop, {maps} map tasks {' '.join(combiner)}")
    program, marks = holding_program(trainings)
    trainings.same([*engine, "--map-tasks", "3", "--program", program, "--engine-arguments",
                    "-D mapreduce.map.speculative=true -D mapreduce.reduce.speculative=true"],
                   "a task that hangs and its speculative attempt")
    expect(any(path.name.endswith("_1") for path in marks.iterdir()), "no attempt was speculative")
    trainings.same_where_a_node_dies([*engine, "--map-tasks", "3"], lambda told: re.search(r"/node(\d)/local", told)[1],
                                     nodes, "a node manager killed in the middle of a level")
    program, marks = dying_program(trainings)
    trainings.same([*engine, "--map-tasks", "3", "--program", program], "the first attempt of every task killed")
    expect(len(list(marks.iterdir())) > 5, "no attempt was killed")
    trainings.same_after_kills([*engine, "--map-tasks", "3"], [20, 25], "driver killed with -9 and begun again")
    check_rendering(trainings, ["--on", "hadoop", "--map-tasks", "3", "--store", store], 12)
    trainings.refused([*engine, "--program", other_build(trainings)], "expected the same on all machines",
                      "tasks of another build")
    check_hdfs_refuses(trainings, without_store, trainings.environment["VESALIUS_HDFS"])


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


def empty_folder(work):
    """Empties the folder of an earlier run, and no other."""
    mark = work / ".of-engines-py"
    if work.exists() and not mark.exists() and any(work.iterdir()):
        sys.exit(f"{work}: has other files, expected a new folder")
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    mark.touch()


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--full"]
    full = len(arguments) < len(sys.argv) - 1
    if len(arguments) != 4 or arguments[3] not in ("local", "faults", "slurm", "hadoop", "spark"):
        sys.exit("expected: engines.py PROGRAM SOURCE_FOLDER WORK_FOLDER local|faults|slurm|hadoop|spark [--full]")
    program = str(pathlib.Path(arguments[0]).resolve())
    source, work, engine = pathlib.Path(arguments[1]).resolve(), pathlib.Path(arguments[2]).resolve(), arguments[3]
    empty_folder(work)
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
    trainings = None
    try:
        if real:
            os.environ.update(environment_of(folder))
        options = {"hadoop": FULL_HADOOP_OPTIONS if full else HADOOP_OPTIONS, "spark": HADOOP_OPTIONS,
                   "slurm": QUICK_OPTIONS, "local": OPTIONS if full else QUICK_OPTIONS}
        trainings = Trainings(program, source, work, options.get(engine, OPTIONS))
        if real:
            check = {"slurm": check_slurm, "hadoop": check_hadoop}[engine]
            check(trainings, full, lambda command, node: cluster(source, folder, engine, command, node))
        else:
            {"local": check_local, "faults": check_local_faults, "spark": check_spark}[engine](trainings, full)
    except Failure as failure:
        print("FAILED:", failure)
        return 1
    finally:
        if trainings is not None:
            trainings.end()
        if real:
            cluster(source, folder, engine, "stop")
            shutil.rmtree(folder, ignore_errors=True)
    shutil.rmtree(work)
    return 0


if __name__ == "__main__":
    sys.exit(main())
