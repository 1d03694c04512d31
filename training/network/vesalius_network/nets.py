"""The network: an encoder-decoder of 3x3 convolutions."""

from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import nn

MULTIPLE = 32  # pictures are padded to a multiple of this, in training as in use
INPUTS = 4  # inputs.py
PERSON = 5  # way to the person's middle in m, cosine and sine of its heading


@dataclass(frozen=True)
class Config:
    """Channels and residual blocks at 1/2, 1/4, 1/8, 1/16 and 1/32 of the size, and channels on the way back, at 1/16,
    1/8, 1/4 and 1/2."""

    channels: tuple
    blocks: tuple
    back: tuple


CONFIGS = {
    "small": Config((12, 24, 40, 64, 96), (0, 1, 1, 2, 2), (64, 40, 24, 16)),
    "default": Config((16, 32, 64, 112, 160), (0, 1, 2, 3, 3), (112, 64, 32, 16)),
}


def convolution(inputs, outputs, stride=1, rectified=True):
    """A 3x3 convolution with its normalisation."""
    layers = [nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False), nn.BatchNorm2d(outputs)]
    return nn.Sequential(*layers, *([nn.ReLU(inplace=True)] if rectified else []))


class Residual(nn.Module):
    """Two convolutions and what they are added to."""

    def __init__(self, channels):
        super().__init__()
        self.f = nn.Sequential(convolution(channels, channels), convolution(channels, channels, rectified=False))

    def forward(self, x):
        return F.relu(x + self.f(x))


class Network(nn.Module):
    """Takes inputs [n, 4, h, w], h and w multiples of MULTIPLE. Returns logits of classes [n, parts + 1, h/2, w/2], of
    the person [n, 5, h/4, w/4], and the ways to the centres of all parts in m, hidden ones too [n, 3 parts, h/8, w/8];
    that these are learnt makes the others better as well."""

    def __init__(self, config, parts):
        super().__init__()
        wide, back = config.channels, config.back
        self.stem = nn.Sequential(*convolution(INPUTS, wide[0], 2))
        self.enc = nn.ModuleList(
            nn.Sequential(convolution(wide[i - 1], wide[i], 2), *[Residual(wide[i]) for _ in range(config.blocks[i])])
            for i in range(1, 5)
        )
        self.lat, self.up, self.dec = nn.ModuleList(), nn.ModuleList(), nn.ModuleList()
        below = wide[4]
        for channels, beside in zip(back, reversed(wide[:4])):
            self.lat.append(nn.Conv2d(beside, channels, 1))
            self.up.append(nn.Conv2d(below, channels, 1, bias=False))
            self.dec.append(nn.Sequential(nn.BatchNorm2d(channels), nn.ReLU(inplace=True), Residual(channels)))
            below = channels
        self.labels = nn.Conv2d(back[3], parts + 1, 1)
        self.inst = nn.Conv2d(back[2], PERSON, 1)
        self.joints = nn.Sequential(Residual(back[1]), nn.Conv2d(back[1], 3 * parts, 1))

    def forward(self, x):
        finer = [self.stem(x)]
        for level in self.enc:
            finer.append(level(finer[-1]))
        y, levels = finer.pop(), []
        for lateral, up, decode in zip(self.lat, self.up, self.dec):
            beside = finer.pop()
            y = decode(F.interpolate(up(y), size=beside.shape[-2:], mode="nearest") + lateral(beside))
            levels.append(y)
        return self.labels(levels[3]), self.inst(levels[2]), self.joints(levels[1])


def padded(x):
    """Returns pictures [..., h, w] with zeros below and on the right up to multiples of MULTIPLE."""
    height, width = x.shape[-2:]
    return F.pad(x, (0, -width % MULTIPLE, 0, -height % MULTIPLE))


def answer(network, x):
    """Returns what the network says of inputs [n, 4, h, w] of any size, without what it says of the padding."""
    height, width = x.shape[-2:]
    answers = network(padded(x).contiguous(memory_format=torch.channels_last))
    return [a[..., : -(-height // step), : -(-width // step)].float() for a, step in zip(answers, (2, 4, 8))]


def multiply_adds(network, height=256, width=320):
    """Returns how many one picture takes."""
    total, hooks = [], []
    for module in network.modules():
        if isinstance(module, nn.Conv2d):
            count = module.weight.numel()
            hooks.append(module.register_forward_hook(lambda m, i, out, n=count: total.append(n * out[0, 0].numel())))
    with torch.no_grad():
        network(torch.zeros(1, INPUTS, height, width, device=next(network.parameters()).device))
    for hook in hooks:
        hook.remove()
    return sum(total)
