#!/usr/bin/env python3
"""Counts the instructions of every loop in the kernels' code for one kind of card, for bench/gpu/model.py.

NVDISASM comes with a full CUDA toolkit, or as the Python package nvidia-cuda-nvdisasm.

Usage: loops.py NVCC NVDISASM [ARCH]
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    nvcc, nvdisasm, arch = (*sys.argv[1:], "sm_90")[:3]
    with tempfile.TemporaryDirectory() as folder:
        binary = Path(folder) / "kernels.cubin"
        flags = ["-std=c++20", "-O3", "-fmad=false", "--expt-relaxed-constexpr", f"-I{ROOT / 'include'}",
                 f"-I{ROOT / 'src'}", f"-arch={arch}", "-cubin"]
        subprocess.run([nvcc, *flags, "-o", binary, ROOT / "src/cuda/cuda_device.cu"], check=True)
        text = subprocess.run([nvdisasm, "-c", binary], check=True, capture_output=True, text=True).stdout
    for part in re.split(r"\n\s*\.section\s+\.text\.", text)[1:]:
        labels, code = {}, []
        for line in part.split("\n"):
            if label := re.match(r"\s*(\.L_x_\d+):", line):
                labels[label.group(1)] = len(code)
            elif instruction := re.match(r"\s*/\*[0-9a-f]+\*/\s+(.*?);", line):
                code.append(instruction.group(1))
        print(re.search(r"\d([A-Z]\w*?)ArgumentsE", part.split(",")[0]).group(1))
        for end, instruction in enumerate(code):
            jump = re.search(r"BRA.*?(\.L_x_\d+)", instruction)
            if jump and labels.get(jump.group(1), end + 1) < end:
                begin = labels[jump.group(1)]
                loads = sum(bool(re.search(r"\bLD[GS]", one)) for one in code[begin : end + 1])
                print(f"  {begin:5} to {end:5}: {end - begin + 1:4} instructions, {loads} of them loads")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (OSError, AttributeError, subprocess.CalledProcessError) as error:
        sys.exit(f"loops.py: {error}")
