#!/usr/bin/env python3
"""Metrics of tracks by other programs, for the same random sequences as training/metrics/track_metrics_test.cpp makes.

CLEAR MOT and IDF1 come from motmetrics, HOTA from trackeval. Prints the table of the test; with a path, checks that the
test has just these numbers.

Needs a Python with: motmetrics trackeval

usage: reference.py [training/metrics/track_metrics_test.cpp]
"""
import contextlib
import io
import sys

import motmetrics
import numpy as np
from trackeval.metrics import HOTA

SEQUENCES, FRAMES, TRUE_IDS, FOUND_IDS = 3, 60, 4, 6


class Random:
    """PCG32 (O'Neill 2014) as src/vesalius/base/random.h has it."""

    MASK = (1 << 64) - 1

    def __init__(self, seed, stream):
        self.state, self.increment = 0, (stream << 1) | 1
        self.next()
        self.state = (self.state + seed) & self.MASK
        self.next()

    def next(self):
        old = self.state
        self.state = (old * 6364136223846793005 + self.increment) & self.MASK
        shifted = (((old >> 18) ^ old) >> 27) & 0xFFFFFFFF
        rotation = old >> 59
        return ((shifted >> rotation) | (shifted << ((32 - rotation) & 31))) & 0xFFFFFFFF

    def uniform(self):
        return self.next() / 4294967296.0


def sequence(seed):
    """Frames of (true ids, found ids, similarity). Each true id has a found one most like it, another one every 20 frames."""
    random, frames = Random(seed, 7), []
    for frame in range(FRAMES):
        truth = [i for i in range(TRUE_IDS) if random.uniform() < 0.8]
        found = [i for i in range(FOUND_IDS) if random.uniform() < 0.7]
        similarity = np.zeros((len(truth), len(found)))
        for t, true_id in enumerate(truth):
            for f, found_id in enumerate(found):
                own = found_id == (true_id + frame // 20) % FOUND_IDS
                similarity[t, f] = 0.4 + 0.6 * random.uniform() if own else 0.6 * random.uniform()
        frames.append((np.array(truth, dtype=int), np.array(found, dtype=int), similarity))
    return frames


def clear_and_identity(sequences):
    """Rows of each sequence and of all."""
    accumulators = []
    for frames in sequences:
        accumulator = motmetrics.MOTAccumulator(auto_id=True)
        for truth, found, similarity in frames:
            accumulator.update(truth, found, np.where(similarity >= 0.5, 1.0 - similarity, np.nan))
        accumulators.append(accumulator)
    names = ["mota", "num_misses", "num_false_positives", "num_switches", "idf1"]
    table = motmetrics.metrics.create().compute_many(accumulators, metrics=names, generate_overall=True)
    return table[names].to_numpy(dtype=float)


def hota(sequences):
    metric, results = HOTA(), {}
    for number, frames in enumerate(sequences):
        data = {
            "gt_ids": [f[0] for f in frames], "tracker_ids": [f[1] for f in frames], "similarity_scores": [f[2] for f in frames],
            "num_gt_dets": sum(len(f[0]) for f in frames), "num_tracker_dets": sum(len(f[1]) for f in frames),
            "num_gt_ids": TRUE_IDS, "num_tracker_ids": FOUND_IDS, "num_timesteps": len(frames),
        }
        results[number] = metric.eval_sequence(data)
    rows = list(results.values()) + [metric.combine_sequences(results)]
    return np.array([[np.mean(row["HOTA"])] for row in rows])


def main():
    sequences = [sequence(seed) for seed in range(SEQUENCES)]
    with contextlib.redirect_stdout(io.StringIO()):
        rows = np.hstack([clear_and_identity(sequences), hota(sequences)])
    lines = ["    {" + ", ".join(f"{value:.12g}" for value in row) + "}," for row in rows]
    print("\n".join(lines))
    if len(sys.argv) < 2:
        return 0
    numbers = "".join(open(sys.argv[1], encoding="utf-8").read().split())
    missing = [line for line in lines if "".join(line.split()).strip(",") not in numbers]
    for line in missing:
        print("not in the test:", line)
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
