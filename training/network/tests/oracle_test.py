"""Compares the program's default network with the same one run by ONNX Runtime, on the frames of data/rooms:
`oracle_test.py VESALIUS_NETWORK_HEADS`, with the program of tests/network. Without ONNX Runtime or PyTorch the exit
code is 77: skipped."""

import subprocess
import sys
import tempfile
import unittest
from dataclasses import dataclass, replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
try:
    import numpy as np
    import onnx  # noqa: F401
    import onnxruntime
    import torch
    import zstandard  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

from graphs import exact_graph
from vesalius_network import quantise
from vesalius_network.inputs import inputs_of
from vesalius_network.model_file import read_network, read_sections
from vesalius_network.nets import padded
from vesalius_network.shards import Bytes

DATA = Path(__file__).parents[3] / "data"
MODEL = DATA / "models" / "default.model"
MOST_UNEQUAL = 1e-3  # share of numbers that may be a step off


@dataclass
class Shown:
    """What the program shows its network of a frame, and what that says: pictures [channels, height, width]."""

    focal: float
    depth_mm: np.ndarray
    channels: np.ndarray
    classes: np.ndarray
    person: np.ndarray
    centres: np.ndarray


def frames_of(program, out):
    """Runs the program of tests/network."""
    subprocess.run([program, MODEL, DATA / "rooms", out], check=True, capture_output=True)
    file, frames = Bytes(Path(out).read_bytes(), out), []

    def picture(kind):
        width, height, channels = file.numbers("III")
        values = np.frombuffer(file.take(width * height * channels * np.dtype(kind).itemsize), kind)
        return values.reshape(height, width, channels).transpose(2, 0, 1)

    while file.at < len(file.data):
        (focal,) = file.numbers("f")
        frames.append(Shown(focal, *(picture(kind) for kind in ("<u2", "u1", "<i2", "<i2", "<i2"))))
    return frames


def run(convolutions, answers, channels):
    """Returns the pictures that ONNX Runtime makes of channels."""
    options = onnxruntime.SessionOptions()
    options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_DISABLE_ALL
    options.intra_op_num_threads = 2
    graph = exact_graph(convolutions, answers).SerializeToString()
    session = onnxruntime.InferenceSession(graph, options, providers=["CPUExecutionProvider"])
    return [answer[0] for answer in session.run(None, {"channels": channels[None]})]


class Oracle(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            cls.frames = frames_of(sys.argv[1], str(Path(folder) / "heads"))
        cls.section = read_sections(MODEL)["network"][1]
        cls.convolutions, *heads = read_network(cls.section)
        cls.heads = [head + 1 for head in heads]

    def assert_a_step_apart(self, what, pairs):
        """Says how many numbers of the pairs of pictures are equal; none may be more than a step off."""
        off = np.concatenate([np.abs(np.subtract(*pair, dtype=np.float64)).ravel() for pair in pairs])
        unequal = np.count_nonzero(off)
        print(f"{what}: {off.size - unequal} of {off.size} equal, at most {off.max():g} off", flush=True)
        self.assertLessEqual(float(off.max()), 1, what)
        self.assertLess(unequal, MOST_UNEQUAL * off.size, what)

    def heads_off(self, convolutions):
        """Returns how far the program's heads are off what other convolutions say of the first frame."""
        frame = self.frames[0]
        said = run(convolutions, self.heads, frame.channels)
        return max(float(np.abs(a - b).max()) for a, b in zip(said, (frame.classes, frame.person, frame.centres)))

    def test_frames_are_those_of_the_folder(self):
        self.assertEqual(len(self.frames), len(list((DATA / "rooms" / "depth").iterdir())))

    def test_a_network_that_is_read_is_the_one_that_was_written(self):
        self.assertEqual(quantise.section_of(self.convolutions, *(head - 1 for head in self.heads)), self.section)

    def test_heads_are_those_of_the_library(self):
        said = [run(self.convolutions, self.heads, frame.channels) for frame in self.frames]
        self.assert_a_step_apart("logits", [(a[0], frame.classes) for a, frame in zip(said, self.frames)])
        self.assert_a_step_apart("votes", [(a[1], frame.person) for a, frame in zip(said, self.frames)])
        self.assert_a_step_apart("centres", [(a[2], frame.centres) for a, frame in zip(said, self.frames)])

    def test_every_layer_of_the_tool_is_that_of_the_library(self):
        channels = self.frames[0].channels
        said = run(self.convolutions, range(1, len(self.convolutions) + 1), channels)
        with torch.no_grad():
            expected = quantise.run_convolutions(self.convolutions, torch.from_numpy(channels.astype(np.float32))[None])
        self.assert_a_step_apart("layers", [(a, b[0].numpy()) for a, b in zip(said, expected[1:])])

    def test_the_tool_shows_a_network_what_the_program_shows_it(self):
        pairs = []
        for frame in self.frames:
            depth_m = torch.from_numpy(frame.depth_mm.astype(np.float32) / 1000)
            channels = quantise.channels_of(padded(inputs_of(depth_m, torch.tensor([frame.focal]))))[0].numpy()
            for each in (channels, program := frame.channels.astype(np.float32)):
                each[1] += quantise.FINER * each[0]  # nearness in its finer steps, whose two channels change together
            pairs.append((channels, program))
        self.assert_a_step_apart("channels", pairs)

    def test_a_weight_a_scale_and_an_offset_that_are_others_are_seen(self):
        layers = self.convolutions
        weights = layers[0].weights.copy()
        weights[0, 0, 1, 1] ^= 8
        middle, last = len(layers) // 2, self.heads[0] - 1
        for at, other in (
            (0, replace(layers[0], weights=weights)),
            (middle, replace(layers[middle], scale=layers[middle].scale * np.float32(1.01))),
            (last, replace(layers[last], offset=layers[last].offset + 2)),
        ):
            self.assertGreater(self.heads_off([*layers[:at], other, *layers[at + 1 :]]), 1, f"layer {at + 1}")


if __name__ == "__main__":
    result = unittest.main(argv=[sys.argv[0], "-v"], exit=False).result
    sys.exit(0 if result.wasSuccessful() else 1)
