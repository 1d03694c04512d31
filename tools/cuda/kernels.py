#!/usr/bin/env python3
"""Compiles the kernels for each kind of card and says what they need of it.

Prints a table: registers, shared memory and occupancy (the share of a multiprocessor's threads that can run at once, in
blocks of 256) of every kernel on every architecture. Exit code 1 if a kernel spills registers or fills less than half
of a multiprocessor. --json also writes the figures, for bench/gpu/model.py.

Usage: kernels.py NVCC [--json FILE]
"""

import argparse
import json
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ("src/cuda/cuda_device.cu", "training/cuda_train/train_kernels.cu")
BLOCK = 256
LEAST_OCCUPANCY = 0.5
# Limits of a multiprocessor (CUDA C++ Programming Guide, table of compute capabilities): threads, blocks, bytes of shared
# memory. All have 65,536 registers.
LIMITS = {
    "sm_75": (1024, 16, 64 << 10),
    "sm_80": (2048, 32, 164 << 10),
    "sm_86": (1536, 16, 100 << 10),
    "sm_87": (1536, 16, 164 << 10),
    "sm_90": (2048, 32, 228 << 10),
}
REGISTERS = 65536
RESERVED_SHARED = 1024  # of each block, by the driver


def occupancy(arch, registers, shared):
    """Share of a multiprocessor's threads that run at once."""
    threads, blocks, shared_bytes = LIMITS[arch]
    of_warp = -(-registers // 8) * 8 * 32  # registers come in eights to each thread
    by_registers = REGISTERS // of_warp * 32 // BLOCK
    by_shared = shared_bytes // (shared + RESERVED_SHARED)
    return min(blocks, threads // BLOCK, by_registers, by_shared) * BLOCK / threads


def parse(text, arch):
    """Figures of each kernel in what `ptxas -v` says."""
    found = []
    for part in re.split(r"Compiling entry function ", text)[1:]:
        name = re.search(r"\d([A-Z]\w*?)ArgumentsE", part)
        spills = re.search(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads", part)
        registers = re.search(r"Used (\d+) registers", part)
        if not (name and spills and registers):
            raise ValueError(f"{arch}: cannot read what ptxas says of a kernel: {part[:200]}")
        shared = re.search(r"(\d+) bytes smem", part)
        kernel = {
            "kernel": name.group(1),
            "arch": arch,
            "registers": int(registers.group(1)),
            "shared_bytes": int(shared.group(1)) if shared else 0,
            "local_bytes": int(spills.group(1)),
            "spilled_bytes": int(spills.group(2)) + int(spills.group(3)),
        }
        kernel["occupancy"] = occupancy(arch, kernel["registers"], kernel["shared_bytes"])
        found.append(kernel)
    return found


def compile_for(nvcc, source, arch):
    flags = ["-std=c++20", "-O3", "-fmad=false", "--expt-relaxed-constexpr", f"-I{ROOT / 'include'}",
             f"-I{ROOT / 'src'}", f"-I{ROOT / 'training'}"]
    command = [nvcc, *flags, f"-arch={arch}", "-Xptxas", "-v", "-cubin", "-o", "/dev/null", ROOT / source]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise ValueError(f"{arch}: nvcc failed:\n{done.stderr}")
    return parse(done.stderr + done.stdout, arch)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("nvcc")
    parser.add_argument("--json", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    with ThreadPoolExecutor(2) as pool:
        compilations = [(arguments.nvcc, source, arch) for source in SOURCES for arch in LIMITS]
        kernels = sum(pool.map(lambda one: compile_for(*one), compilations), [])
    if arguments.json:
        arguments.json.write_text(json.dumps(kernels, indent=1) + "\n")
    print("| kernel | " + " | ".join(LIMITS) + " |\n|---|" + "---|" * len(LIMITS))
    for name in sorted({kernel["kernel"] for kernel in kernels}):
        cells = []
        for arch in LIMITS:
            k = next(k for k in kernels if k["kernel"] == name and k["arch"] == arch)
            cells.append(f"{k['registers']} registers, {k['shared_bytes']} B, {k['occupancy']:.0%}")
        print(f"| {name} | " + " | ".join(cells) + " |")
    bad = [k for k in kernels if k["spilled_bytes"] or k["local_bytes"] or k["occupancy"] < LEAST_OCCUPANCY]
    for k in bad:
        print(f"{k['arch']}: {k['kernel']}: {k['spilled_bytes']} bytes spilled, {k['local_bytes']} local, "
              f"{k['occupancy']:.0%} of a multiprocessor", file=sys.stderr)
    return 1 if bad else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (OSError, ValueError) as error:
        sys.exit(f"kernels.py: {error}")
