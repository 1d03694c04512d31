"""Views of labelled frames: what a network learns from at once."""

from dataclasses import dataclass, fields

import numpy as np
import torch

from .body import headings_of, middles_of
from .shards import BACKGROUND

MOST_PEOPLE = 6  # of a frame; further ones are labelled, but nobody votes for them
MOST_DEPTH_MM = 32000


class Chance:
    """The random numbers of one batch. They depend on seed and number of the batch alone, so that a training which goes
    on sees the same views as one that never stopped."""

    def __init__(self, seed, batch, device):
        self.device = device
        mixed = (seed * 0x9E3779B97F4A7C15 + batch * 0xBF58476D1CE4E5B9 + 0x94D049BB133111EB) % 2**63
        self._here = torch.Generator("cpu").manual_seed(mixed)
        self._there = self._here if device.type == "cpu" else torch.Generator(device).manual_seed(mixed)

    def share(self, *shape):
        return torch.rand(*shape, device=self.device, generator=self._there)

    def between(self, low, high, *shape):
        return low + (high - low) * self.share(*shape)

    def normal(self, *shape):
        return torch.randn(*shape, device=self.device, generator=self._there)

    def whole(self, low, end, *shape):
        return torch.randint(low, end, shape, device=self.device, generator=self._there)

    def one_of(self, weights):
        """Returns for each row of weights [n, k] an index, the likelier the greater its weight."""
        return torch.multinomial(weights, 1, generator=self._there)[:, 0]

    def number(self, low, high):
        """A number of Python's, for what all of a batch has in common."""
        return low + (high - low) * float(torch.rand((), generator=self._here))

    def count(self, low, end):
        return int(torch.randint(low, end, (), generator=self._here))


@dataclass
class Views:
    """n pictures with their truth; NaN = not known."""

    depth: torch.Tensor  # [n, h, w] float m, 0 = no reading
    labels: torch.Tensor  # [n, h, w] uint8, 255 = background
    person: torch.Tensor  # [n, h, w] uint8, 255 = nobody
    focal: torch.Tensor  # [n] pixels
    origin: torch.Tensor  # [n, 2] principal point u, v
    centres: torch.Tensor  # [n, people, parts, 3] m
    middles: torch.Tensor  # [n, people, 3] m
    headings: torch.Tensor  # [n, people] rad

    def __len__(self):
        return len(self.depth)


def joined(parts):
    """Returns several Views of the same size as one."""
    return Views(*[torch.cat([getattr(part, field.name) for part in parts]) for field in fields(Views)])


@dataclass
class Pool:
    """n frames of one size on a device."""

    depth_mm: torch.Tensor  # [n, h, w] int16
    labels: torch.Tensor  # as those of Views
    person: torch.Tensor
    camera: torch.Tensor  # [n, 4] fx, fy, cx, cy
    centres: torch.Tensor
    middles: torch.Tensor
    headings: torch.Tensor

    @staticmethod
    def empty(count, size, parts, device):
        """Returns room for so many frames."""
        pictures, people = (count, *size), (count, MOST_PEOPLE)
        shapes = [pictures, pictures, pictures, (count, 4), (*people, parts, 3), (*people, 3), people]
        kinds = [torch.int16, torch.uint8, torch.uint8] + 4 * [torch.float32]
        return Pool(*[torch.empty(shape, dtype=kind, device=device) for shape, kind in zip(shapes, kinds)])

    def put(self, first, frames, body):
        """Puts shards.Frames into their places, from `first` on."""
        missing = MOST_PEOPLE - frames.centres.shape[1]
        room = ((0, 0), (0, max(0, missing)), (0, 0), (0, 0))
        centres = np.pad(frames.centres[:, :MOST_PEOPLE], room, constant_values=np.nan)
        depth = frames.depth_mm.clip(max=MOST_DEPTH_MM).astype(np.int16)
        truth = centres, middles_of(centres, body), headings_of(centres, body)
        arrays = depth, frames.labels, frames.person, frames.camera, *truth
        for field, array in zip(fields(Pool), arrays):
            getattr(self, field.name)[first : first + len(depth)] = torch.from_numpy(array)

    def __len__(self):
        return len(self.depth_mm)

    @property
    def size(self):
        """Height, width."""
        return tuple(self.depth_mm.shape[1:])

    def views(self, index):
        """Returns frames as they are."""
        camera = self.camera[index]
        return Views(
            self.depth_mm[index].float() / 1000,
            self.labels[index],
            self.person[index],
            (camera[:, 0] + camera[:, 1]) / 2,
            camera[:, 2:],
            self.centres[index],
            self.middles[index],
            self.headings[index],
        )


def voters(views):
    """Returns where somebody is whom votes are for, [n, h, w]."""
    return (views.labels != BACKGROUND) & (views.person < MOST_PEOPLE)
