"""Views of frames from elsewhere: nearer, turned, shifted, mirrored, cut off by the border."""

import math

import torch

from .shards import BACKGROUND
from .views import Views

ZOOM = (0.75, 1.3)  # of 35 in 100 views
NEAR_ZOOM = (1.3, 2.8)  # of 15 in 100 views, which are aimed at somebody
TILT = 0.3  # rad, of a quarter of the views; a tenth is turned on its side or on its head besides
TURNED_SHIFT = 30.0  # pixels


def choose_zoom(n, chance):
    """Returns how much larger each view shows things, [n]."""
    draw = chance.share(n)
    usual = torch.exp(chance.between(*map(math.log, ZOOM), n))
    near = torch.exp(chance.between(*map(math.log, NEAR_ZOOM), n))
    return torch.where(draw < 0.35, usual, torch.where(draw < 0.5, near, torch.ones_like(draw)))


def choose_turn(n, chance):
    """Returns how far each camera is rolled about its axis, [n] rad."""
    draw = chance.share(n)
    turn = torch.where(draw < 0.25, chance.between(-TILT, TILT, n), torch.zeros_like(draw))
    side = chance.between(-0.2, 0.2, n)
    for least, end, angle in ((0.25, 0.29, math.pi / 2), (0.29, 0.33, -math.pi / 2), (0.33, 0.35, math.pi)):
        turn = torch.where((draw >= least) & (draw < end), angle + side, turn)
    return turn


def turned(points, turn):
    """Returns points [n, ..., 3] turned by [n] rad about the camera's axis."""
    shape = (-1, *[1] * (points.dim() - 2))
    cosine, sine = torch.cos(turn).view(shape), torch.sin(turn).view(shape)
    x, y, z = points.unbind(-1)
    return torch.stack([cosine * x - sine * y, sine * x + cosine * y, z], -1)


def _aims(frames, chance):
    """Returns a part of somebody in each frame, [n, 3] m, and whether there is anybody, [n]."""
    n, _, parts, _ = frames.centres.shape
    there = ~frames.middles.isnan().any(-1)
    row = torch.arange(n, device=frames.depth.device)
    who = chance.one_of(there.float() + 1e-6)
    part = frames.centres[row, who, chance.whole(0, parts, n)]
    aim = torch.where(part.isnan().any(1, keepdim=True), frames.middles[row, who], part)
    return aim.nan_to_num(nan=1.0), there.any(1)


def choose_origin(frames, zoom, turn, size, chance):
    """Returns where the principal point comes to lie in each view, [n, 2] pixels u, v."""
    n, device = len(frames), frames.depth.device
    extent = torch.tensor([size[1], size[0]], device=device, dtype=torch.float32)
    source = torch.tensor([frames.depth.shape[2], frames.depth.shape[1]], device=device, dtype=torch.float32)
    zoomed = zoom[:, None]
    # What is shown lies inside the picture, or the picture inside what is shown.
    origin = frames.origin * zoomed + chance.share(n, 2) * (extent - source * zoomed)
    centred = extent / 2 + chance.between(-TURNED_SHIFT, TURNED_SHIFT, n, 2)
    near = zoom > ZOOM[1]
    origin = torch.where(((turn != 0) & ~near)[:, None], centred, origin)
    aim, anybody = _aims(frames, chance)
    aim = turned(aim, turn)
    aim = frames.focal[:, None] * zoomed * aim[:, :2] / aim[:, 2:].clamp(min=0.2)
    aimed = anybody & near & (chance.share(n) < 0.85)
    return torch.where(aimed[:, None], chance.between(0.05, 0.95, n, 2) * extent - aim, origin)


def seen_from(frames, zoom, turn, origin, size):
    """Returns the views [n, *size] that a camera has whose focal length is `zoom` times that of the frames, which is
    rolled by `turn`, and whose principal point is `origin`. What no frame shows has no reading."""
    height, width = frames.depth.shape[1:]
    device = frames.depth.device
    u = torch.arange(size[1], device=device)[None, None] - origin[:, 0, None, None]
    v = torch.arange(size[0], device=device)[None, :, None] - origin[:, 1, None, None]
    cosine, sine = torch.cos(turn)[:, None, None], torch.sin(turn)[:, None, None]
    from_u = ((cosine * u + sine * v) / zoom[:, None, None] + frames.origin[:, 0, None, None]).round().long()
    from_v = ((cosine * v - sine * u) / zoom[:, None, None] + frames.origin[:, 1, None, None]).round().long()
    inside = (from_u >= 0) & (from_u < width) & (from_v >= 0) & (from_v < height)
    place = (from_v.clamp(0, height - 1) * width + from_u.clamp(0, width - 1)).flatten(1)

    def look_up(picture, outside):
        return picture.flatten(1).gather(1, place).view(-1, *size).masked_fill(~inside, outside)

    return Views(
        look_up(frames.depth, 0),
        look_up(frames.labels, BACKGROUND),
        look_up(frames.person, BACKGROUND),
        frames.focal * zoom,
        origin,
        turned(frames.centres, turn),
        turned(frames.middles, turn),
        frames.headings,
    )


def mirrored(views, which, body):
    """Returns views of which those where `which` [n] are seen in a mirror: left parts are then right ones."""
    mirror = torch.as_tensor(body.mirror, device=which.device)
    partners = torch.full((256,), BACKGROUND, dtype=torch.uint8, device=which.device)
    partners[: body.parts] = mirror.to(torch.uint8)
    flip_x = torch.tensor([-1.0, 1.0, 1.0], device=which.device)
    picture, person, point = which[:, None, None], which[:, None], which[:, None, None]
    return Views(
        torch.where(picture, views.depth.flip(2), views.depth),
        torch.where(picture, partners[views.labels.flip(2).long()], views.labels),
        torch.where(picture, views.person.flip(2), views.person),
        views.focal,
        torch.where(which[:, None], _other_side(views), views.origin),
        torch.where(point[..., None], (views.centres * flip_x)[:, :, mirror], views.centres),
        torch.where(point, views.middles * flip_x, views.middles),
        torch.where(person, -views.headings, views.headings),
    )


def _other_side(views):
    return torch.stack([views.depth.shape[2] - 1 - views.origin[:, 0], views.origin[:, 1]], 1)


def placed(frames, body, size, chance, plain):
    """Returns a view [*size] of each frame. Plain ones are neither zoomed nor turned."""
    n = len(frames)
    zoom, turn = choose_zoom(n, chance), choose_turn(n, chance)
    if plain:
        zoom, turn = torch.ones_like(zoom), torch.zeros_like(turn)
    views = seen_from(frames, zoom, turn, choose_origin(frames, zoom, turn, size, chance), size)
    return mirrored(views, chance.share(n) < 0.5, body)
