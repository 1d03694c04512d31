"""Measures the processor time of the program's default network and of ONNX Runtime, one thread each, in turns, on a
frame of data/rooms: `oracle_time.py VESALIUS_NETWORK_HEADS`, with the program of tests/network. The library runs the
network in real numbers, and in the integers that its own quantiser makes of them: 8 bits, a scale for each channel of
the weights."""

import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np
import onnx
import onnxruntime
from onnxruntime.quantization import CalibrationDataReader, QuantType, quantize_static

from graphs import real_graph
from oracle_test import DATA, MODEL, frames_of
from vesalius_network.model_file import read_network, read_sections
from vesalius_network.quantise import ZERO

ROUNDS = 30
RUNS = 20  # in a row


class Frames(CalibrationDataReader):
    def __init__(self, inputs):
        self.left = iter(inputs)

    def get_next(self):
        return next(self.left, None)


def session_of(path):
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    return onnxruntime.InferenceSession(path, options, providers=["CPUExecutionProvider"])


def library_ms(session, inputs):
    times = []
    for _ in range(RUNS):
        begin = time.process_time()
        session.run(None, inputs)
        times.append(1e3 * (time.process_time() - begin))
    return median(times)


def program_ms(program, out):
    command = [program, MODEL, DATA / "rooms" / "depth" / "01.png", out, "--runs", str(RUNS)]
    return float(subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()[0])


def main(program):
    with tempfile.TemporaryDirectory() as folder:
        real, quantised, out = (str(Path(folder) / name) for name in ("real.onnx", "quantised.onnx", "heads"))
        inputs = [{"channels": frame.channels[None].astype(np.float32) - ZERO} for frame in frames_of(program, out)]
        convolutions, *heads = read_network(read_sections(MODEL)["network"][1])
        onnx.save(real_graph(convolutions, [head + 1 for head in heads]), real)
        types = {"activation_type": QuantType.QUInt8, "weight_type": QuantType.QInt8}
        quantize_static(real, quantised, Frames(inputs), per_channel=True, **types)
        sessions = [session_of(path) for path in (quantised, real)]
        rounds = [
            (program_ms(program, out), *(library_ms(session, inputs[0]) for session in sessions)) for _ in range(ROUNDS)
        ]
    for name, times in zip(("program", "library, 8 bits", "library, real numbers"), zip(*rounds)):
        ratio = median(each / ours for each, (ours, *_) in zip(times, rounds))
        print(f"{name}: {median(times):.2f} ms, {ratio:.2f} of the program's, {min(times):.2f} to {max(times):.2f} ms")


if __name__ == "__main__":
    main(sys.argv[1])
