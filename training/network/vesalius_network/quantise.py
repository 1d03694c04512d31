"""Turns a learnt network into the convolutions in integers that the program runs (src/vesalius/network/network.h).

    python -m vesalius_network.quantise NET.npz FRAMES... --out NET.network

Normalisation is folded into the weights. Every channel that a convolution makes has a scale for its weights; every result has
one scale, chosen by what the network says of some frames."""

import argparse
import struct
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F

from .damage import as_program_sees
from .errors import InputError
from .inputs import inputs_of
from .nets import padded
from .shards import Dataset
from .weights import load, write_whole

CHANNELS = 8  # kNetworkInputs
ZERO = 88  # kNetworkZero
STEPS = 32  # kNetworkSteps
FINER = 4  # kNearFiner
LOGIT_UNIT = 1 / 256  # kLogitUnit
PERSON_UNITS = np.array([1e-3, 1e-3, 1e-3, 1 / 8192, 1 / 8192])  # of a PersonVote, in m and 1
CENTRE_UNIT = 1e-3  # of a way to a part's centre, in m
HEAD_UNITS = {"labels": LOGIT_UNIT, "inst": PERSON_UNITS, "joints.1": CENTRE_UNIT}  # of the heads in nets.py
WIDE_STEPS = 64  # of a wide result in one of the narrow result that it is added to
SHARES = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2)  # of the largest value, as the most that a scale reaches
MOST_FRAMES = 60  # of a dataset by which scales are chosen
KEPT = 20000  # values of a result of a frame by which its scale is chosen
EPSILON = 1e-5  # of normalisations


@dataclass
class Layer:
    """A convolution of real numbers. It reads the result of layer `source`, -1: the inputs."""

    name: str  # of its parameters in nets.py
    source: int
    weight: torch.Tensor  # [outputs, inputs, side, side] float64
    bias: torch.Tensor  # [outputs]
    normalisation: str | None = None  # name of its parameters
    stride: int = 1
    added: int | None = None
    wide: bool = False


@dataclass
class Convolution:
    """The same in integers: a Convolution of network.h."""

    input: int  # picture that it reads: 0 the channels, n what convolution n - 1 makes
    stride: int
    added: int  # picture that it adds, 0 for none
    added_scale: float
    wide: bool
    scale: np.ndarray  # [outputs] float32
    offset: np.ndarray
    weights: np.ndarray  # [outputs, inputs, side, side] int8


class _Folder:
    """Makes layers of the parameters of a network."""

    def __init__(self, state):
        self.state = {name: value.double() for name, value in state.items()}
        self.layers = []

    def add(self, name, source, normalisation=None, **more):
        weight = self.state[f"{name}.weight"]
        bias = self.state.get(f"{name}.bias", torch.zeros(len(weight), dtype=torch.double))
        if normalisation:
            scale, shift = self._normalisation(normalisation)
            weight, bias = weight * scale[:, None, None, None], bias * scale + shift
        self.layers.append(Layer(name, source, weight, bias, normalisation, **more))
        return len(self.layers) - 1

    def add_up(self, name, source, normalisation):
        """A convolution whose result is added before a normalisation, of which it takes its share."""
        up = self.add(name, source, wide=True)
        self.layers[up].weight = self.layers[up].weight * self._normalisation(normalisation)[0][:, None, None, None]
        return up

    def add_blocks(self, prefix, first, at):
        while f"{prefix}.{first}.f.0.0.weight" in self.state:
            block = f"{prefix}.{first}.f"
            inner = self.add(f"{block}.0.0", at, f"{block}.0.1")
            at = self.add(f"{block}.1.0", inner, f"{block}.1.1", added=at)
            first += 1
        return at

    def _normalisation(self, name):
        scale = self.state[f"{name}.weight"] / torch.sqrt(self.state[f"{name}.running_var"] + EPSILON)
        return scale, self.state[f"{name}.bias"] - self.state[f"{name}.running_mean"] * scale


def layers_of(state):
    """Returns the layers of the parameters of nets.Network, and those of the classes, the person and the parts' centres."""
    folder = _Folder(state)
    levels = [folder.add("stem.0", -1, "stem.1", stride=2)]
    for i in range(4):
        down = folder.add(f"enc.{i}.0.0", levels[-1], f"enc.{i}.0.1", stride=2)
        levels.append(folder.add_blocks(f"enc.{i}", 1, down))
    at = levels.pop()
    back = []
    for j in range(4):
        up = folder.add_up(f"up.{j}", at, f"dec.{j}.0")
        lateral = folder.add(f"lat.{j}", levels.pop(), f"dec.{j}.0", added=up)
        back.append(at := folder.add_blocks(f"dec.{j}", 2, lateral))
    classes = folder.add("labels", back[3], wide=True)
    person = folder.add("inst", back[2], wide=True)
    centres = folder.add("joints.1", folder.add_blocks("joints", 0, back[1]), wide=True)
    return folder.layers, classes, person, centres


def _enlarged(added, like):
    return added if added.shape[-1] == like.shape[-1] else F.interpolate(added, scale_factor=2, mode="nearest")


def run_layers(layers, x):
    """Returns what each layer makes of the inputs [n, 4, h, w]."""
    results = []
    for layer in layers:
        source = x if layer.source < 0 else results[layer.source]
        y = F.conv2d(source, layer.weight.float(), layer.bias.float(), layer.stride, layer.weight.shape[-1] // 2)
        if layer.added is not None:
            y = y + _enlarged(results[layer.added], y)
        results.append(y if layer.wide else F.relu(y))
    return results


class Tops:
    """Chooses what a narrow result's 255 stands for: of some shares of the largest value that with the least error."""

    def __init__(self, layers):
        self._kept = [[] for _ in layers]

    def add(self, results):
        for kept, result in zip(self._kept, results):
            values = result.flatten()
            kept.append(torch.cat([values[:: max(1, len(values) // KEPT)], values.max()[None]]))

    def of(self, layer):
        values = torch.cat(self._kept[layer]).double()
        values = values[values > 0]
        if not len(values):
            return 1.0

        def error(top):
            steps = (values / top * 255).round().clamp(0, 255)
            return float(((steps * top / 255 - values) ** 2).mean())

        return min((float(values.max()) * share for share in SHARES), key=error)


def _of_channels(weight):
    """Returns the weights of the inputs as those of the channels that stand for them, in their steps."""
    out = torch.zeros(len(weight), CHANNELS, *weight.shape[2:], dtype=weight.dtype)
    out[:, 0], out[:, 1] = weight[:, 0], weight[:, 0] / FINER
    out[:, 2:5] = weight[:, 1:4]
    return out


def _units(layers, tops):
    """Returns what 1 of each layer's result stands for: [outputs] each."""
    units = [None if layer.wide else tops.of(i) / 255 for i, layer in enumerate(layers)]
    for i, layer in enumerate(layers):
        if layer.added is not None and layers[layer.added].wide:
            units[layer.added] = units[i] / WIDE_STEPS
    heads = [HEAD_UNITS.get(layer.name) for layer in layers]
    return [np.broadcast_to(head if unit is None else unit, len(layer.bias)) for unit, head, layer in zip(units, heads, layers)]


def quantise(layers, tops):
    """Returns the layers as convolutions in integers."""
    units, out = _units(layers, tops), []
    for layer, unit in zip(layers, units):
        first = layer.source < 0
        weight = (_of_channels(layer.weight) if first else layer.weight).numpy()
        step = np.maximum(np.abs(weight).reshape(len(weight), -1).max(1), 1e-9) / 127
        weights = np.rint(weight / step[:, None, None, None]).astype(np.int8)
        scale = ((1 / STEPS if first else units[layer.source][0]) * step / unit).astype(np.float32)
        offset = layer.bias.numpy() / unit
        if first:
            offset = offset - ZERO * weights.astype(np.int64).sum((1, 2, 3)) * scale.astype(np.float64)
        added_scale = 0.0 if layer.added is None else units[layer.added][0] / unit[0]
        added = 0 if layer.added is None else layer.added + 1
        convolution = Convolution(layer.source + 1, layer.stride, added, added_scale, layer.wide, scale, offset, weights)
        out.append(convolution)
    return out


def channels_of(inputs):
    """Returns the channels that the program makes of inputs [n, 4, h, w], whole numbers [n, CHANNELS, h, w]."""
    out = torch.full((len(inputs), CHANNELS, *inputs.shape[2:]), float(ZERO))
    fine = torch.floor(inputs[:, 0] * (STEPS * FINER) + 0.5)
    coarse = torch.floor((fine + FINER / 2) / FINER)
    out[:, 1] += fine - FINER * coarse
    for channel, steps in ((0, coarse), *((i + 1, torch.floor(inputs[:, i] * STEPS + 0.5)) for i in (1, 2, 3))):
        out[:, channel] += steps.clamp(-ZERO, 255 - ZERO)
    return out


def run_convolutions(convolutions, channels):
    """Returns what the program makes of the channels [n, CHANNELS, h, w]: these, then the result of each convolution."""
    results = [channels.double()]
    for layer in convolutions:
        side = layer.weights.shape[-1]
        source = F.pad(results[layer.input], (side // 2,) * 4, value=0.0 if layer.input else float(ZERO))
        sums = F.conv2d(source, torch.from_numpy(layer.weights.astype(np.float64)), None, layer.stride).float()
        scale, offset = (torch.from_numpy(n.astype(np.float32))[:, None, None] for n in (layer.scale, layer.offset))
        y = sums * scale + offset
        if layer.added:
            y = y + _enlarged(results[layer.added], y).float() * np.float32(layer.added_scale)
        low, high = (-32768, 32767) if layer.wide else (0, 255)
        results.append(torch.round(y).clamp(low, high).double())
    return results


def section_of(convolutions, classes, person, centres):
    """Returns the bytes of a model file's section `network` (docs/formats.md). Without the parts' centres `centres` is -1."""
    out = [struct.pack("<H", len(convolutions))]
    for layer in convolutions:
        outputs, inputs, side, _ = layer.weights.shape
        added = layer.added + 1 if layer.added else 0
        head = (layer.input, side, layer.stride, inputs, outputs, added, layer.added_scale, layer.wide)
        out.append(struct.pack("<HBBHHHfB", *head))
        out += [numbers.astype("<f4").tobytes() for numbers in (layer.scale, layer.offset)]
        out.append(layer.weights.transpose(0, 2, 3, 1).tobytes())
    out.append(struct.pack("<HHH", classes, person, centres + 1))
    return b"".join(out)


@torch.no_grad()
def tops_of(layers, folders, most):
    """Returns Tops of up to `most` frames of each dataset."""
    tops = Tops(layers)
    for folder in folders:
        dataset, left = Dataset(folder), most
        for shard in range(dataset.shards):
            frames = dataset.read(shard)
            for depth_mm, camera in list(zip(frames.depth_mm, frames.camera))[:left]:
                depth = as_program_sees(torch.from_numpy(depth_mm.astype(np.float32) / 1000)[None])
                tops.add(run_layers(layers, padded(inputs_of(depth, torch.tensor([camera[0]])))))
                left -= 1
            if left <= 0:
                break
    return tops


def write_network(weights, folders, out, most, note=""):
    """Writes the network of integers of a file of weights: a text that says how it was made, and its section. Scales are
    chosen by up to `most` frames of each dataset. Returns the number of convolutions."""
    about, state = load(weights)
    layers, *heads = layers_of(state)
    convolutions = quantise(layers, tops_of(layers, folders, most))
    made_from = "\n".join(text for text in (f'config = "{about["config"]}"', about["made_from"], note) if text)
    text = f"{made_from}\n".encode()
    write_whole(out, struct.pack("<I", len(text)) + text + section_of(convolutions, *heads))
    return len(convolutions)


def main(arguments):
    parser = argparse.ArgumentParser(prog="vesalius_network.quantise", description="Makes a network of integers.")
    parser.add_argument("weights", help="network.npz")
    parser.add_argument("data", nargs="+", help="folders of labelled frames by which scales are chosen")
    parser.add_argument("--out", required=True, help="the .network to write, of which `vesalius convert` makes a model")
    parser.add_argument("--frames", type=int, default=MOST_FRAMES, help="most frames of a folder (%(default)s)")
    parser.add_argument("--note", default="", help="added to what the file says of how the network was made")
    options = parser.parse_args(arguments)
    try:
        count = write_network(options.weights, options.data, options.out, options.frames, options.note)
    except (InputError, OSError) as error:
        sys.exit(f"vesalius_network.quantise: {error}")
    print(f"{options.out}: {count} convolutions, {Path(options.out).stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main(sys.argv[1:])
