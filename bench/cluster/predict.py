"""Predicts what a training takes on a cluster, from what costs.py measured.

    predict.py MEASURED.json                      tables: which numbers of nodes pay for 10^5 to 10^8 frames
    predict.py MEASURED.json --check              the runs of costs.py, simulated, beside what they took
    predict.py MEASURED.json --frames N --nodes N [...]     one training, job by job

The jobs of a training are simulated one after the other as the driver asks for them. The tasks of each are given to
free slots, longest first, and vary by 10 %. Reading, shuffling and handing out the jobs' files take the network.
"""

import argparse
import dataclasses
import heapq
import json
import math
import random
import sys


@dataclasses.dataclass
class Cluster:
    nodes: int = 1
    cores: int = 16
    memory: float = 64e9
    network: float = 1.2e9  # bytes a second of a node
    store: float = 0.3e9  # bytes a second that a node reads of HDFS, from its disks and others'
    shared: float = 0.0  # bytes a second of a folder that all share, as for Slurm; 0: HDFS
    overhead: float = 13.0  # seconds of a job beyond its work
    speed: float = 1.0  # of a core, beside the one that was measured

    @property
    def slots(self):
        return self.nodes * self.cores

    def read_seconds(self, size):
        """Seconds until all nodes together have read so many bytes."""
        return size / (self.shared or self.store * self.nodes)


@dataclasses.dataclass
class Training:
    frames: int
    rendered: bool = True
    trees: int = 8
    hard_trees: int = 2
    depth: int = 20
    rounds: int = 24
    candidates: int = 64
    split: int = 20000
    shard: int = 2000
    memory: float = 0.0  # of a subtrees task; 0: what the cluster has


@dataclasses.dataclass
class Job:
    name: str
    seconds: float
    work: float  # core-seconds
    read: float = 0.0  # bytes
    shuffled: float = 0.0


def makespan(durations, slots, chance):
    """Seconds until all tasks ended: each goes to the slot that is free first."""
    free = [0.0] * min(slots, len(durations))
    end = 0.0
    for duration in sorted(durations, reverse=True):
        at = heapq.heappop(free) + duration * chance.lognormvariate(0.0, 0.1)
        heapq.heappush(free, at)
        end = max(end, at)
    return end


class Simulation:
    def __init__(self, known, cluster, training):
        self.known, self.cluster, self.training = known, cluster, training
        self.chance = random.Random(1)
        self.samples = training.frames * known["samples"]
        self.bytes = training.frames * known["set_bytes"]
        self.shards = math.ceil(training.frames / training.shard)
        self.tasks = min(self.shards, cluster.slots)
        self.jobs = []

    def add(self, name, work, tasks=None, read=0.0, shuffled=0.0, reduce_work=0.0, job_bytes=1e5, start=None, slots=None):
        """A job of tasks that share `work` core-seconds evenly, then of reducers."""
        tasks = tasks or self.tasks
        start = self.known["start"] if start is None else start
        reduced = bool(shuffled or reduce_work)
        if reduced and self.cluster.shared:
            start += self.known["start"]  # of the program that divides a map task's records among the reducers
        each = (work / tasks + start) / self.cluster.speed
        seconds = self.cluster.overhead + makespan([each] * tasks, slots or self.cluster.slots, self.chance)
        seconds += self.cluster.read_seconds(read) + job_bytes * self.cluster.nodes / (
            self.cluster.shared or self.cluster.network * self.cluster.nodes)
        reducers = 0
        if reduced:
            reducers = self.cluster.nodes
            seconds += shuffled / (self.cluster.network * self.cluster.nodes)
            seconds += makespan([reduce_work / reducers / self.cluster.speed + start] * reducers, self.cluster.slots,
                                self.chance)
        self.jobs.append(Job(name, seconds, work + tasks * start + reduce_work + reducers * start, read, shuffled))

    def grow(self, trees, name):
        k, t = self.known, self.training
        memory = t.memory or self.cluster.memory * 0.8 / math.ceil(self.cluster.cores / max(1, self.threads()))
        subtrees = self.bytes + 20 * self.samples < memory
        for level in range(t.depth):
            open_nodes = trees * min(2**level, self.samples / 100)
            # A node may be 1.2 times its task's share; at each level nodes are of unequal size, hence the 4.
            if subtrees and (open_nodes >= 4 * self.tasks or level == 0 and trees >= self.tasks):
                return self.grow_subtrees(trees, level, name)
            counted = min(self.samples * trees, open_nodes * t.split)
            values = counted * t.candidates
            walked = t.frames * trees
            large = open_nodes if self.samples * trees / open_nodes > t.split else 0
            ranks = 8 * large * self.shards
            self.add(f"{name} level {level} rows", walked * k["rows_frame"] + values * k["rows_value"], read=self.bytes,
                     shuffled=values * k["value_bytes"], reduce_work=values * k["reduce_value"],
                     job_bytes=1e5 + 30 * open_nodes + ranks)
            if large:
                self.add(f"{name} level {level} counts", walked * k["count_frame"], read=self.bytes,
                         shuffled=self.shards * 8 * 27 * 2 * large, job_bytes=1e5 + 30 * open_nodes)

    def threads(self):
        """Threads of a subtrees task, so that all cores of a node can work: its memory holds so many tasks."""
        need = self.bytes + 20 * self.samples
        fit = int(self.cluster.memory * 0.8 // need) if need else self.cluster.cores
        return max(1, math.ceil(self.cluster.cores / max(1, fit)))

    def grow_subtrees(self, trees, level, name):
        k, t = self.known, self.training
        left = sum(min(self.samples * trees, trees * 2**i * t.split) for i in range(level, t.depth)) * t.candidates
        left *= k["evaluations"]
        threads = self.threads()
        tasks = max(trees, 2 * self.cluster.slots // threads) if level > 0 else trees
        slots = max(1, self.cluster.slots // threads)
        runs = min(tasks, slots)  # processes: each reads all sets once, however many subtrees it grows
        work = left * k["evaluation"] + runs * t.frames * k["read"]
        self.add(f"{name} subtrees from level {level}", work / threads, tasks=tasks, read=self.bytes * runs,
                 job_bytes=1e5 + 30 * trees * 2**level, slots=slots)
        self.jobs[-1].work = work

    def run(self):
        k, t = self.known, self.training
        per_tree = 1.0 / k["trees"]
        if t.rendered:
            self.add("prepare", t.frames * k["render"], start=k["start"] + k["render_start"])
        else:
            self.add("prepare", t.frames * k["read"] * 4, read=self.bytes)
        if t.hard_trees:
            self.grow(t.hard_trees, "hard round")
            self.add("hard counts", t.frames * k["hard_counts_frame"], read=self.bytes)
            self.add("harden", t.frames * k["harden_frame"], read=2 * self.bytes)
        self.grow(t.trees, "trees")
        if t.rounds:
            leaves = min(2.0**t.depth, self.samples / 60) / min(2.0**k["depth"], k["frames"] * k["samples"] / 60)
            scale = leaves * t.trees * per_tree
            shuffled = self.tasks * k["gradient_bytes"] * scale
            self.add("leaf counts", t.frames * t.trees * per_tree * k["leaf_counts_frame"], read=self.bytes,
                     shuffled=self.tasks * k["leaf_counts_bytes"] * scale)
            for turn in range(t.rounds):
                self.add(f"gradient {turn}", t.frames * t.trees * per_tree * k["gradient_frame"], read=self.bytes,
                         shuffled=shuffled, job_bytes=shuffled / self.tasks)
            self.add("facing", t.frames * k["facing_frame"], read=self.bytes)
        return self

    @property
    def seconds(self):
        return sum(job.seconds for job in self.jobs)

    @property
    def work(self):
        return sum(job.work for job in self.jobs)


def one_pc(known, training, cores):
    """Seconds of one process with so many cores and memory enough."""
    values = training.candidates * known["evaluations"] * known["samples"] * training.frames
    trees = values * (training.trees + training.hard_trees) * training.depth * known["evaluation"]
    leaves = training.frames * (known["hard_counts_frame"] + training.trees / known["trees"] * (
        known["leaf_counts_frame"] + training.rounds * known["gradient_frame"]))
    return (known["render_start"] + training.frames * known["render"] + trees + leaves) / cores


def duration(seconds):
    if seconds < 600:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.0f} h" if seconds < 2e6 else f"{seconds / 86400:.0f} d"


def table(known, base):
    steps = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]
    print("frames    | one PC  | " + " | ".join(f"{n:>6}" for n in steps) + " | shortest | pays up to | most time there")
    for frames in (10**5, 10**6, 10**7, 10**8):
        training = dataclasses.replace(base[1], frames=frames)
        runs = {n: Simulation(known, dataclasses.replace(base[0], nodes=n), training).run() for n in steps}
        shortest = min(runs, key=lambda n: runs[n].seconds)
        # Twice the nodes pay while they save a third of the time.
        pays = 1
        for before, after in zip(steps, steps[1:]):
            if runs[after].seconds > runs[before].seconds * (before / after) ** 0.585:
                break
            pays = after
        groups = {}
        for job in runs[shortest].jobs:
            name = "leaves" if job.name.startswith(("gradient", "leaf")) else job.name.split(" from")[0].split(" level")[0]
            groups[name] = groups.get(name, 0.0) + job.seconds
        most = max(groups, key=groups.get)
        print(f"{frames:9} | {duration(one_pc(known, training, base[0].cores)):>7} | "
              + " | ".join(f"{duration(runs[n].seconds):>6}" for n in steps)
              + f" | {shortest:8} | {pays:10} | {most}: {groups[most] / runs[shortest].seconds:.0%}")


def check(known):
    # A pause of the driver and two of bash are 0.3 s.
    here = Cluster(nodes=1, cores=2, memory=20e9, network=1e9, shared=1e9, overhead=0.3)
    small = Training(frames=known["frames"], rendered=False, trees=known["trees"], hard_trees=1, depth=known["depth"],
                     rounds=known["rounds"])
    for run in known["runs"]:
        if run["name"].startswith("one process"):
            continue
        training = dataclasses.replace(small, memory=1.0 if "every level" in run["name"] else 1e12)
        simulated = Simulation(known, here, training).run()
        print(f"{run['name']}: {run['wall']:.0f} s, simulated {simulated.seconds:.0f} s ({simulated.seconds / run['wall']:.0%}); "
              f"of processors {run['cpu']:.0f} s, simulated {simulated.work:.0f} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("measured")
    parser.add_argument("--check", action="store_true")
    for field in dataclasses.fields(Cluster) + dataclasses.fields(Training):
        default = None if field.name == "frames" else field.default
        kind = type(default) if isinstance(default, (int, float)) and not isinstance(default, bool) else int
        if field.name not in ("rendered", "memory"):
            parser.add_argument("--" + field.name.replace("_", "-"), type=kind, default=default)
    parser.add_argument("--memory", type=float, default=64e9, help="bytes of a node")
    arguments = parser.parse_args()
    try:
        with open(arguments.measured) as file:
            known = json.load(file)
    except (OSError, ValueError) as error:
        sys.exit(f"{arguments.measured}: expected what costs.py --out wrote: {error}")
    if not isinstance(known, dict) or "gradient_bytes" not in known:
        sys.exit(f"{arguments.measured}: expected what costs.py --out wrote")
    if arguments.check:
        return check(known)
    values = vars(arguments)
    cluster = Cluster(**{field.name: values[field.name] for field in dataclasses.fields(Cluster)})
    names = [field.name for field in dataclasses.fields(Training) if field.name not in ("rendered", "memory")]
    training = Training(**{name: values[name] for name in names} | {"frames": arguments.frames or 1})
    if not arguments.frames:
        return table(known, (cluster, training))
    simulation = Simulation(known, cluster, training).run()
    for job in simulation.jobs:
        print(f"{job.name}: {duration(job.seconds)}, {job.work / 3600:.2f} core-hours, read {job.read / 1e9:.1f} GB, "
              f"shuffled {job.shuffled / 1e9:.2f} GB")
    print(f"in all {duration(simulation.seconds)}, {simulation.work / 3600:.2f} core-hours; shards {simulation.bytes / 1e9:.1f} GB, "
          f"one PC of {cluster.cores} cores {duration(one_pc(known, training, cluster.cores))}")


if __name__ == "__main__":
    sys.exit(main())
