"""What the network is shown of a depth picture: the same that the program shows it."""

import torch

KEPT_SHARE = 0.95  # BlendOptions::least_share
WIDEST_RAMP = 3  # pixels
SIDES = [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (-1, 1), (1, -1), (1, 1)]
STEEPEST = 3.0
REFERENCE_FOCAL = 285.0  # pixels: a Kinect's at 320x240


def moved(picture, dv, du):
    """Returns [..., h, w] with out[v, u] = picture[v + dv, u + du], zero where that is outside."""
    height, width = picture.shape[-2:]
    out = torch.zeros_like(picture)
    into = (..., slice(max(0, -dv), height - max(0, dv)), slice(max(0, -du), width - max(0, du)))
    source = (..., slice(max(0, dv), height - max(0, -dv)), slice(max(0, du), width - max(0, -du)))
    out[into] = picture[source]
    return out


def _inner(extent, step, by):
    """Returns the places along an axis that have neighbours on both sides a step away, moved by so many steps."""
    return slice(abs(step) + by * step, extent - abs(step) + by * step) if step else slice(None)


def _beside_holes(hole, depth):
    """Returns which readings lie beside a hole and have too little of the depth on their other side."""
    height, width = depth.shape[-2:]
    blended, kept = torch.zeros_like(hole), KEPT_SHARE * depth
    for dv, du in SIDES:
        before, here, behind = ((..., _inner(height, dv, by), _inner(width, du, by)) for by in (-1, 0, 1))
        blended[here] |= hole[before] & (depth[here] < kept[behind])
    return blended & (depth > 0)


def without_blended(depth_mm):
    """Drops readings that somebody blended with holes, as src/vesalius/base/blended_depth.cpp does. `depth_mm`: floats
    [..., h, w] with whole numbers, 0 = no reading."""
    out, hole = depth_mm, depth_mm == 0
    for _ in range(WIDEST_RAMP):
        hole = _beside_holes(hole, out)
        out = out.masked_fill(hole, 0)
    return out


def inputs_of(depth_m, focal):
    """Returns [n, 4, h, w] of depth [n, h, w] in m and focal lengths [n] in pixels: pixels of the picture in a metre
    there, whether there is a reading, and the slopes along the row and the column. All are 0 where there is none."""
    seen = depth_m > 0
    focal = focal.view(-1, 1, 1)
    depth = torch.where(seen, depth_m, torch.ones_like(depth_m))

    def slope(axis):
        extent = depth.shape[axis] - 4
        after, before = depth_m.narrow(axis, 4, extent), depth_m.narrow(axis, 0, extent)
        rise = torch.zeros_like(depth)
        rise.narrow(axis, 2, extent).copy_((after - before) * ((after > 0) & (before > 0)))
        return (rise * focal / (4 * depth)).clamp_(-STEEPEST, STEEPEST).mul_(seen)

    nearness = (2 * focal / REFERENCE_FOCAL / depth - 0.7) * seen
    return torch.stack([nearness, seen.to(depth.dtype), slope(2), slope(1)], 1)
