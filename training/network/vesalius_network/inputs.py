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


def without_blended(depth_mm):
    """Drops readings that somebody blended with holes, as src/vesalius/base/blended_depth.cpp does. `depth_mm`: floats
    [..., h, w] with whole numbers, 0 = no reading."""
    out, hole = depth_mm, depth_mm == 0
    for _ in range(WIDEST_RAMP):
        blended = torch.zeros_like(hole)
        for dv, du in SIDES:
            blended |= moved(hole, -dv, -du) & (out < KEPT_SHARE * moved(out, dv, du))
        blended &= out > 0
        out, hole = out.masked_fill(blended, 0), blended
    return out


def inputs_of(depth_m, focal):
    """Returns [n, 4, h, w] of depth [n, h, w] in m and focal lengths [n] in pixels: pixels of the picture in a metre
    there, whether there is a reading, and the slopes along the row and the column. All are 0 where there is none."""
    seen = depth_m > 0
    focal = focal.view(-1, 1, 1)
    depth = torch.where(seen, depth_m, torch.ones_like(depth_m))

    def slope(dv, du):
        after, before = moved(depth_m, dv, du), moved(depth_m, -dv, -du)
        rise = torch.where((after > 0) & (before > 0), after - before, torch.zeros_like(depth))
        return (rise * focal / (4 * depth)).clamp(-STEEPEST, STEEPEST) * seen

    nearness = (2 * focal / REFERENCE_FOCAL / depth - 0.7) * seen
    return torch.stack([nearness, seen.to(depth.dtype), slope(0, 2), slope(2, 0)], 1)
