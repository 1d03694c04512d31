"""Which frames are in memory while a network learns."""

import math
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import torch

from .errors import InputError
from .place import placed
from .shards import Dataset
from .views import Pool, joined

VIEWS_OF_FRAME = 4  # before other frames take its place
BYTES_OF_PIXEL = 4  # depth, label, person


def open_datasets(folders):
    """Returns datasets, which must have the same body."""
    datasets = [Dataset(folder) for folder in folders]
    for dataset in datasets[1:]:
        if dataset.body.text != datasets[0].body.text:
            raise InputError(f"{dataset.folder}: another body than that of {datasets[0].folder}")
    return datasets


def read_pools(shards, body, device):
    """Returns a Pool for each size of picture in shards, which are given as (dataset, number)."""
    counts = Counter()
    for dataset, number in shards:
        counts[dataset.size] += dataset.frames_of(number)
    pools = {size: Pool.empty(count, size, body.parts, device) for size, count in sorted(counts.items())}
    filled = Counter()
    with ThreadPoolExecutor(torch.get_num_threads()) as threads:
        for frames in threads.map(lambda shard: shard[0].read(shard[1]), shards):
            size = frames.depth_mm.shape[1:]
            pools[size].put(filled[size], frames, body)
            filled[size] += len(frames.people)
    return list(pools.values())


@dataclass
class Round:
    """The batches [first, end) come from these shards."""

    first: int
    end: float
    shards: list


class Rounds:
    """Divides a training among shards: all of them where memory has room, else some after others in random order."""

    def __init__(self, datasets, batch, most_bytes, seed):
        self.shards = [(dataset, number) for dataset in datasets for number in range(dataset.shards)]
        self.batch, self.seed = batch, seed
        bytes_of_frame = BYTES_OF_PIXEL * max(math.prod(dataset.size) for dataset in datasets)
        self.room = int(most_bytes / bytes_of_frame)
        self.frames = sum(dataset.frames for dataset in datasets)

    @property
    def at_once(self):
        return self.frames <= self.room

    def of(self, batch):
        """Returns the round of a batch."""
        if self.at_once:
            return Round(0, float("inf"), self.shards)
        for found in self._all():
            if batch < found.end:
                return found

    def _all(self):
        shards, frames, first, turn = [], 0, 0, 0
        while True:
            for i in np.random.default_rng((self.seed, turn)).permutation(len(self.shards)):
                dataset, number = self.shards[i]
                count = dataset.frames_of(number)
                if shards and frames + count > self.room:
                    end = first + max(1, VIEWS_OF_FRAME * frames // self.batch)
                    yield Round(first, end, shards)
                    shards, frames, first = [], 0, end
                shards.append((dataset, number))
                frames += count
            turn += 1


def draw(pools, count, body, size, chance, plain):
    """Returns views [count, *size] of frames drawn from pools."""
    ends = torch.tensor([len(pool) for pool in pools]).cumsum(0)
    numbers = torch.tensor([chance.count(0, int(ends[-1])) for _ in range(count)])
    which = torch.bucketize(numbers, ends, right=True)
    views = []
    for i, pool in enumerate(pools):
        index = (numbers[which == i] - (int(ends[i]) - len(pool))).to(chance.device)
        if len(index):
            views.append(placed(pool.views(index), body, size, chance, plain))
    return joined(views)
