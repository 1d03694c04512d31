"""What real depth suffers: readings that are missing, moved or smoothed. Each kind falls on a share of the views."""

from dataclasses import dataclass

import torch
import torch.nn.functional as F

from .inputs import SIDES, moved, without_blended
from .shards import BACKGROUND

SOUND_SHARE = 0.35  # of the views, to which none of these happens
LEAST_LEFT = 0.35  # of the readings; views of which less is left stay as they were
NEAREST_M = 0.05


@dataclass
class Scene:
    """What the views of a batch show that something falls on."""

    labels: torch.Tensor  # [n, h, w] long, the background last
    person: torch.Tensor  # [n, h, w] bool
    upper: torch.Tensor  # [parts] bool

    def of(self, index):
        return Scene(self.labels[index], self.person[index], self.upper)


def _drop(depth, gone):
    return depth.masked_fill(gone, 0)


def _each(chance, low, high, depth):
    """A number for each view, [n, 1, 1]."""
    return chance.between(low, high, len(depth), 1, 1)


def _waves(depth, chance, rows, columns):
    """Smooth noise of unit variance at so many points, between which it is interpolated."""
    noise = chance.normal(len(depth), 1, rows, columns)
    return F.interpolate(noise, size=depth.shape[1:], mode="bilinear", align_corners=True)[:, 0]


def _add(depth, change):
    """Adds to readings alone."""
    return torch.where(depth > 0, (depth + change).clamp(min=NEAREST_M), depth)


def cloth(depth, scene, chance):
    """Clothes or hair without readings: of the upper body, the lower one, all parts, or some."""
    n, parts = len(depth), len(scene.upper)
    upper = scene.upper.expand(n, parts)
    kind = chance.whole(0, 4, n, 1)
    worn = torch.where(kind == 0, upper, torch.where(kind == 1, ~upper, kind == 2))
    worn = torch.where(kind == 3, chance.share(n, parts) < 0.25, worn) & (chance.share(n, parts) < 0.75)
    worn = F.pad(worn, (0, 1))
    of_pixel = worn.gather(1, scene.labels.flatten(1)).view_as(scene.labels)
    return _drop(depth, of_pixel & (_waves(depth, chance, 12, 16) > _each(chance, -1.6, 0.4, depth)))


def furniture(depth, scene, chance):
    """Dark furniture, floors that mirror, sun."""
    blobs = _waves(depth, chance, chance.count(4, 14), chance.count(5, 18)) > _each(chance, 0.3, 1.3, depth)
    return _drop(depth, blobs & (~scene.person | (chance.share(len(depth), 1, 1) < 0.3)))


def noise(depth, scene, chance):
    return _add(depth, chance.normal(*depth.shape) * _each(chance, 0, 0.004, depth) * depth**2)


def stereo_waves(depth, scene, chance):
    rows = chance.count(12, 60)
    return _add(depth, _waves(depth, chance, rows, rows * 4 // 3) * _each(chance, 0, 0.008, depth) * depth**2)


def disparity_steps(depth, scene, chance):
    step = _each(chance, 3e-4, 4e-3, depth)
    nearness = 1 / depth.clamp(min=NEAREST_M)
    return torch.where(depth > 0, 1 / ((nearness / step).round() * step).clamp(min=0.03), depth)


def smoothed_over_edges(depth, scene, chance):
    side = 2 * chance.count(1, 4) + 1
    seen = (depth > 0).float()
    share = F.avg_pool2d(seen[:, None], side, 1, side // 2)[:, 0]
    mean = F.avg_pool2d(depth[:, None], side, 1, side // 2)[:, 0] / share.clamp(min=1e-6)
    filled = (share > 0.5) & (chance.share(len(depth), 1, 1) < 0.5)
    return torch.where((depth > 0) | filled, mean, depth)


def smoothed_within_surfaces(depth, scene, chance):
    for _ in range(chance.count(1, 4)):
        total, count = depth.clone(), (depth > 0).float()
        for dv, du in SIDES[:4]:
            beside = moved(depth, 2 * dv, 2 * du)
            same = ((beside > 0) & ((beside - depth).abs() < 0.06 * depth)).float()
            total, count = total + beside * same, count + same
        depth = torch.where(depth > 0, total / count.clamp(min=1), depth)
    return depth


def flying_pixels(depth, scene, chance):
    dv, du = SIDES[chance.count(0, 4)]
    beside = moved(depth, dv, du)
    edge = (depth > 0) & (beside > 0) & ((beside - depth).abs() > 0.08 * depth)
    flying = depth + (beside - depth) * chance.share(*depth.shape)
    return torch.where(edge & (chance.share(*depth.shape) < 0.6), flying, depth)


def far_end(depth, scene, chance):
    return _drop(depth, depth > _each(chance, 2.2, 6, depth))


def near_end(depth, scene, chance):
    return _drop(depth, depth < _each(chance, 0.4, 1, depth))


def rims(depth, scene, chance):
    """Readings around holes, and behind edges, are missing."""
    gone = (depth == 0).float()
    if chance.number(0, 1) < 0.5:
        for dv, du in SIDES[:4]:
            beside = moved(depth, dv, du)
            gone = torch.maximum(gone, ((beside > 0) & (depth - beside > 0.08 * beside)).float())
    side = 2 * chance.count(1, 4) + 1
    wide = F.max_pool2d(gone[:, None], (1, side), 1, (0, side // 2))
    return _drop(depth, F.max_pool2d(wide, (side, 1), 1, (side // 2, 0))[:, 0] > 0)


def single_readings(depth, scene, chance):
    return _drop(depth, chance.share(*depth.shape) < _each(chance, 0, 0.45, depth) ** 2)


def boxes(depth, scene, chance):
    n, height, width = depth.shape
    v = torch.arange(height, device=depth.device)[None, :, None]
    u = torch.arange(width, device=depth.device)[None, None]
    for _ in range(3):
        top, left = chance.whole(-20, height, n, 1, 1), chance.whole(-20, width, n, 1, 1)
        tall, wide = chance.whole(3, 50, n, 1, 1), chance.whole(3, 50, n, 1, 1)
        depth = _drop(depth, (v >= top) & (v < top + tall) & (u >= left) & (u < left + wide))
    return depth


def cut_out(depth, scene, chance):
    """Readings of people alone."""
    return _drop(depth, ~scene.person)


def filled_from_the_side(depth, scene, chance):
    du = 1 if chance.number(0, 1) < 0.5 else -1
    for _ in range(chance.count(3, 24)):
        depth = torch.where(depth > 0, depth, moved(depth, 0, du))
    return depth


def halved(depth, scene, chance):
    twice = depth[:, ::2, ::2].repeat_interleave(2, 1).repeat_interleave(2, 2)
    return twice[:, : depth.shape[1], : depth.shape[2]]


def resized_with_holes(depth, scene, chance):
    """Made smaller and larger again by interpolation, which makes ramps around holes."""
    size = [max(1, int(side * chance.number(0.45, 0.95))) for side in depth.shape[1:]]
    smooth = {"align_corners": False}
    way = {"mode": "nearest"} if chance.number(0, 1) < 0.5 else {"mode": "bilinear", **smooth}
    smaller = F.interpolate(depth[:, None], size=size, **way)
    way = {"mode": "bilinear" if chance.number(0, 1) < 0.7 else "bicubic", **smooth}
    out = F.interpolate(smaller, size=depth.shape[1:], **way)[:, 0]
    return _drop(out, out < NEAREST_M)


# Share of the views that each falls on, in the order in which they happen.
KINDS = [
    (0.22, cloth),
    (0.3, furniture),
    (0.15, noise),
    (0.2, stereo_waves),
    (0.25, disparity_steps),
    (0.12, smoothed_over_edges),
    (0.12, smoothed_within_surfaces),
    (0.2, flying_pixels),
    (0.12, far_end),
    (0.08, near_end),
    (0.3, rims),
    (0.15, single_readings),
    (0.2, boxes),
    (0.05, cut_out),
    (0.1, filled_from_the_side),
    (0.06, halved),
    (0.16, resized_with_holes),
]


def as_program_sees(depth):
    """Returns depth in m as it comes to the network: whole millimetres, without readings blended with holes."""
    return without_blended((depth * 1000).round()) / 1000


def damaged(views, body, chance):
    """Returns the depth [n, h, w] of views after what happens to it."""
    labels = torch.where(views.labels == BACKGROUND, body.parts, views.labels.long())
    scene = Scene(labels, labels < body.parts, torch.as_tensor(body.upper, device=labels.device))
    n, depth = len(views), views.depth.clone()
    sound = chance.share(n) < SOUND_SHARE
    for share, spoil in KINDS:
        hit = ((chance.share(n) < share) & ~sound).nonzero()[:, 0]
        if len(hit):
            depth[hit] = spoil(depth[hit], scene.of(hit), chance)
    left, before = ((d > 0).flatten(1).sum(1) for d in (depth, views.depth))
    people_alone = ~((depth > 0) & ~scene.person).flatten(1).any(1)
    too_much = (left < LEAST_LEFT * before) & ~people_alone
    return as_program_sees(torch.where(too_much[:, None, None], views.depth, depth))
