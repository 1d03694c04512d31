"""What the network is to say of views, and how wrong it is."""

from dataclasses import dataclass

import torch
import torch.nn.functional as F

from .shards import BACKGROUND
from .views import MOST_PEOPLE, voters

PERSON_STEP, CENTRES_STEP = 4, 8  # pixels of the picture a pixel of the answer
BODY_WEIGHT = 1.5  # of a body's pixel, beside one of the background
BALANCE = 0.6  # parts of share s have weight s^-BALANCE
NEAR_M = 0.1  # below this, errors of places count by their square; a way to a part as long as this counts half
WEIGHTS = {"body": 4.0, "parts": 1.0, "middle": 0.8, "heading": 0.6, "centres": 2.0}


@dataclass
class Targets:
    """Pixels are every second, fourth or eighth of the picture."""

    seen: torch.Tensor  # [n, h/2, w/2] whether there is a reading
    classes: torch.Tensor  # [n, h/2, w/2], the background last
    to_middle: torch.Tensor  # [n, 3, h/4, w/4] m; NaN = not known, as below
    heading: torch.Tensor  # [n, 2, h/4, w/4] cosine, sine
    to_centres: torch.Tensor  # [n, 3 parts, h/8, w/8] m


def points_of(views, depth, step):
    """Returns the points [n, 3, h/step, w/step] of every so many pixels, m."""
    some = depth[:, ::step, ::step]
    focal = views.focal[:, None, None]
    u = torch.arange(0, depth.shape[2], step, device=depth.device)[None, None] - views.origin[:, 0, None, None]
    v = torch.arange(0, depth.shape[1], step, device=depth.device)[None, :, None] - views.origin[:, 1, None, None]
    return torch.stack([u * some / focal, v * some / focal, some], 1)


def _people(views, depth, step):
    """Returns which person each of every so many pixels shows, and whether it shows one."""
    shown = (voters(views) & (depth > 0))[:, ::step, ::step]
    person = views.person[:, ::step, ::step].long().clamp(max=MOST_PEOPLE - 1)
    return person, shown


def targets_of(views, depth, body):
    """`depth` [n, h, w] is what the network is shown of the views."""
    row = torch.arange(len(views), device=depth.device)[:, None, None]
    unknown = torch.tensor(float("nan"), device=depth.device)
    labels = views.labels[:, ::2, ::2]
    classes = torch.where(labels == BACKGROUND, body.parts, labels.long())
    person, shown = _people(views, depth, PERSON_STEP)
    middles = views.middles[row, person].permute(0, 3, 1, 2)
    to_middle = torch.where(shown[:, None], middles - points_of(views, depth, PERSON_STEP), unknown)
    turn = torch.where(shown, views.headings[row, person], unknown)
    person, shown = _people(views, depth, CENTRES_STEP)
    points = points_of(views, depth, CENTRES_STEP).permute(0, 2, 3, 1)
    ways = views.centres[row, person] - points[:, :, :, None]
    to_centres = torch.where(shown[:, None], ways.flatten(3).permute(0, 3, 1, 2), unknown)
    seen = depth[:, ::2, ::2] > 0
    return Targets(seen, classes, to_middle, torch.stack([torch.cos(turn), torch.sin(turn)], 1), to_centres)


def weights_of_parts(counts):
    """Returns the weight [parts] of a pixel of each part, of which there are so many; 1 in the mean over pixels."""
    share = counts.clamp(min=1).float()
    share = share / share.sum()
    weights = share**-BALANCE
    return weights / (weights * share).sum()


def _mean_where_known(error, target):
    """Mean over pixels of the errors' sum over coordinates; those of unknown targets do not count."""
    known = ~target.isnan()
    return (error * known).sum() / known.any(1).sum().clamp(min=1)


def loss_of_centres(centres, target):
    """How wrong ways [n, 3 parts, h, w] are. Who is near to a part says where it is (vote_parts), and the many who are far
    from it are no reason to draw all of their ways together: a way counts the less the longer it is."""
    known, ways = ~target.isnan(), target.nan_to_num()
    length = ways.unflatten(1, (-1, 3)).norm(dim=2, keepdim=True)
    weight = (NEAR_M / (NEAR_M + length)).expand(-1, -1, 3, -1, -1).flatten(1, 2) * known
    error = F.smooth_l1_loss(centres, ways, beta=NEAR_M, reduction="none")
    return (error * weight).sum() / weight.sum().clamp(min=1)


def losses_of(answers, targets, weights):
    """Returns the losses by name, to be added with WEIGHTS. `answers` are those of nets.answer."""
    classes, person, centres = answers
    parts = classes.shape[1] - 1
    body = targets.seen & (targets.classes < parts)
    # Body or background apart from which part: balancing parts is not to touch a person's outline.
    logit = classes[:, :parts].logsumexp(1) - classes[:, parts]
    wrong = torch.where(body, BODY_WEIGHT * F.softplus(-logit), F.softplus(logit)) * targets.seen
    part = targets.classes.clamp(max=parts - 1)
    of_part = F.cross_entropy(classes[:, :parts], part, weight=weights, reduction="none") * body
    to_middle = F.smooth_l1_loss(person[:, :3], targets.to_middle.nan_to_num(), beta=NEAR_M, reduction="none")
    return {
        "body": wrong.sum() / targets.seen.sum().clamp(min=1),
        "parts": of_part.sum() / (weights[part] * body).sum().clamp(min=1),
        "middle": _mean_where_known(to_middle, targets.to_middle),
        "heading": _mean_where_known((person[:, 3:] - targets.heading.nan_to_num()).square(), targets.heading),
        "centres": loss_of_centres(centres, targets.to_centres),
    }
