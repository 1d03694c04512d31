#!/usr/bin/env python3
"""Predicts how fast a card labels pictures and trains, from counts.

`vesalius_bench_gpu --count-only` counts what walking one picture reads (nodes, and sectors of 32 bytes of nodes and depth
for each group of 32 pixels), tools/cuda/kernels.py says how much of a multiprocessor each kernel fills. For each kernel
the time is the longest of: its instructions at half of what a multiprocessor can issue, its sectors at the first-level
cache's rate, its misses at the second level's, and what that misses at the memory's; and the start of a kernel. The
rates are the makers'; what cannot be counted (the share of hits in the first level) is assumed and said below. With
--measured FILE, what vesalius_bench_gpu measured stands beside it.

Usage: model.py COUNTS KERNELS [--measured FILE]
"""

import argparse
import json
import sys
from dataclasses import dataclass
from pathlib import Path


@dataclass
class Card:
    name: str
    arch: str
    multiprocessors: int
    ghz: float
    memory_gb_s: float
    level2_gb_s: float  # what others measured on cards of the kind
    level2_mb: float
    pcie_gb_s: float  # practical; Orin's processor and card share a memory


CARDS = [
    Card("Jetson Orin NX 16 GB", "sm_87", 8, 0.92, 102, 400, 4, 50),
    Card("RTX 4060", "sm_86", 24, 2.46, 272, 1500, 24, 12),
    Card("H100 SXM", "sm_90", 132, 1.7, 3350, 5500, 50, 50),
    Card("H200", "sm_90", 132, 1.7, 4800, 5500, 50, 50),
]

START_US = 3.0  # from one kernel's end to the next one's first work
ISSUE = 0.5  # share of the four instructions a cycle that a multiprocessor reaches
SECTORS_A_CYCLE = 4  # of the first-level cache: 128 bytes
LEVEL1_HITS = 0.7  # of probes and nodes: neighbouring pixels look at neighbouring places
SECTOR = 32
# Instructions of a thread in the loops of the code for sm_90 (tools/cuda/loops.py).
INSTRUCTIONS_A_LEVEL = 69
INSTRUCTIONS_A_TREE = 18  # of four logits
INSTRUCTIONS_A_PLACE = 110  # from the sum of the trees to the posterior
INSTRUCTIONS_A_PIXEL = 300  # what one of the pixel's threads does alone
INSTRUCTIONS_A_NEIGHBOUR = 9.6  # of two classes
INSTRUCTIONS_TO_FIND_ONE = 142
INSTRUCTIONS_A_CLASS = 28  # of choosing
NEIGHBOURS = 25
LANES = 16  # threads of a pixel
INSTRUCTIONS_A_STEP = 63  # of a network, 32 of them four products each
STEP_CYCLES = 200  # until the next step of a thread: its weights come from the second level
INSTRUCTIONS_A_VALUE = {"Evaluate": 229, "Ranges": 29, "Count": 52}  # of a candidate at a sample


def kernel_us(card, occupancy, instructions, sectors, level2_bytes, memory_bytes):
    """`instructions` are those of groups of 32 threads."""
    cycles = max(instructions / (4 * ISSUE), sectors / SECTORS_A_CYCLE) / card.multiprocessors
    busy = cycles / (card.ghz * 1e3) / min(1.0, occupancy / 0.5)
    return START_US + max(busy, level2_bytes / card.level2_gb_s / 1e3, memory_bytes / card.memory_gb_s / 1e3)


def predict(card, counts, kernels):
    def occupancy(name):
        return next(k["occupancy"] for k in kernels if k["kernel"] == name and k["arch"] == card.arch)

    pixels, trees, classes = counts["pixels"], counts["trees"], counts["classes"]
    places = classes + 3 * counts["headings"]
    sectors = counts["node_sectors"] + counts["probe_sectors"]
    touched = counts["touched_bytes"] + 2 * pixels
    misses = (1 - LEVEL1_HITS) * sectors * SECTOR
    of_logits = (INSTRUCTIONS_A_TREE * trees * -(-places // 4) + INSTRUCTIONS_A_PLACE * places + LANES * INSTRUCTIONS_A_PIXEL) / 32
    of_neighbour = (INSTRUCTIONS_A_NEIGHBOUR * LANES + INSTRUCTIONS_TO_FIND_ONE) / 32
    fits = touched + counts["logit_bytes"] < card.level2_mb * 1e6
    times = {
        "walk": kernel_us(card, occupancy("Walk"), INSTRUCTIONS_A_LEVEL * counts["warp_levels"], sectors, misses,
                          touched if fits else misses),
        "logits": kernel_us(card, occupancy("Logit"), pixels * of_logits, pixels * trees * 3, pixels * trees * 64,
                            pixels * (trees * 64 + 2 * places)),
        "mean": kernel_us(card, occupancy("Mean"), pixels * NEIGHBOURS * of_neighbour, pixels * NEIGHBOURS * 2,
                          pixels * NEIGHBOURS * 2 * classes * (1 - LEVEL1_HITS), pixels * 4 * classes),
        "choose": kernel_us(card, occupancy("ChooseAlone"), pixels / 32 * INSTRUCTIONS_A_CLASS * classes, pixels * classes,
                            pixels * 2 * classes, pixels * 2 * classes),
        "others": 4 * START_US,
    }
    area = counts["width"] * counts["height"]
    times["copies"] = (2 * area + area) / card.pcie_gb_s / 1e3 + 2 * START_US
    return times


def print_table(what, counts, kernels):
    print(f"{what}: {counts['width']}x{counts['height']}, {counts['pixels']:,} pixels walked, {counts['trees']} trees: "
          f"{counts['nodes'] / counts['pixels'] / counts['trees']:.1f} nodes a tree, "
          f"{counts['node_sectors'] / counts['warp_levels']:.1f} sectors of nodes and "
          f"{counts['probe_sectors'] / counts['warp_levels']:.1f} of depth a level of 32 pixels, "
          f"{counts['touched_bytes'] / 1e6:.1f} of {counts['forest_bytes'] / 1e6:.1f} MB of nodes read\n")
    names = ["walk", "logits", "mean", "choose", "others", "copies"]
    print("| predicted, us | " + " | ".join(names) + " | a picture | pictures/s in batches |\n|---|" + "---|" * (len(names) + 2))
    for card in CARDS:
        times = predict(card, counts, kernels)
        kernels_us = sum(times[name] for name in names[:-1])
        # In batches the starts are shared by many pictures, and copies go on beside kernels.
        batched = max(kernels_us - START_US * (len(names) + 2), times["copies"] - 2 * START_US)
        print(f"| {card.name} | " + " | ".join(f"{times[name]:.0f}" for name in names) +
              f" | {kernels_us + times['copies']:.0f} | {1e6 / batched:,.0f} |")
    print()


def print_network(layers):
    """A convolution takes as long as its instructions, or as the steps of a thread one after the other."""
    print("| predicted, us | the network of 320x256 | of it starts of kernels |\n|---|---|---|")
    for card in CARDS:
        starts = START_US * len(layers)
        cycles = sum(max(layer["threads"] / 32 * layer["steps"] * INSTRUCTIONS_A_STEP / (4 * ISSUE * card.multiprocessors),
                         layer["steps"] * STEP_CYCLES) for layer in layers)
        print(f"| {card.name} | {starts + cycles / (card.ghz * 1e3):.0f} | {starts:.0f} |")
    print()


def print_training(kernels):
    """Values of eq. 1 a second where they are computed, ranged and counted; instructions are what bounds them."""
    print("| predicted | values of eq. 1 a second |\n|---|---|")
    for card in CARDS:
        rate = 0.0
        for name, instructions in INSTRUCTIONS_A_VALUE.items():
            occupancy = next(k["occupancy"] for k in kernels if k["kernel"] == name and k["arch"] == card.arch)
            rate += instructions / (card.multiprocessors * 4 * ISSUE * 32 * card.ghz * 1e9) / min(1.0, occupancy / 0.5)
        print(f"| {card.name} | {1e-9 / rate:.1f} thousand million |")
    print()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("counts", type=Path)
    parser.add_argument("kernels", type=Path)
    parser.add_argument("--measured", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    figures = json.loads(arguments.counts.read_text())
    kernels = json.loads(arguments.kernels.read_text())
    for what, key in (("Every pixel is looked at", "counts"), ("With the gate", "gated_counts")):
        print_table(what, figures[key], kernels)
    print_network(figures["network_counts"])
    print_training(kernels)
    if arguments.measured:
        for device, ms in json.loads(arguments.measured.read_text())["measured"]["kernel_ms"].items():
            print(f"measured {device}: {1e3 * ms:.0f} us")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (OSError, KeyError, ValueError) as error:
        sys.exit(f"model.py: {error}")
