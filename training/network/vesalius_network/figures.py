"""How well a network does on frames that it did not learn from."""

import math
from dataclasses import dataclass

import torch

from .damage import as_program_sees
from .inputs import inputs_of
from .losses import NEAR_M, PERSON_STEP, targets_of
from .nets import answer
from .views import voters

BACKGROUND_WEIGHT = 0.5  # by which the background's probability counts against the best part's
LEAST_PIXELS = 7  # of a person at 1/4 of the size, for its heading to count
AT_ONCE = 8
NEAR = math.pi / 4
LONG_M = 0.3


@dataclass
class Figures:
    parts: float  # recall of parts inside the true masks, their mean
    iou: float  # of all people's pixels, body against background
    empty: float  # share of pixels taken for a body where nobody is
    heading: float  # share of people whose heading is within 45 degrees
    centres: float  # share of ways to the centres of parts that end within NEAR_M of them, of ways up to LONG_M

    def __str__(self):
        return (
            f"parts {100 * self.parts:.1f} %, person IoU {self.iou:.3f}, body in empty frames "
            f"{100 * self.empty:.2f} %, heading within 45° {100 * self.heading:.0f} %, "
            f"ways to parts within {100 * NEAR_M:.0f} cm {100 * self.centres:.0f} %"
        )


class _Counts:
    def __init__(self, classes, device):
        self.inside = torch.zeros(classes, classes, dtype=torch.long, device=device)
        self.both = self.either = self.empty = self.empty_all = self.people = self.near = self.ways = self.right = 0

    def add_pixels(self, logits, targets):
        parts = logits.shape[1] - 1
        share = logits.softmax(1)
        best, part = share[:, :parts].max(1)
        body = (best > BACKGROUND_WEIGHT * share[:, parts]) & targets.seen
        truth = targets.seen & (targets.classes < parts)
        pairs = targets.classes[truth] * (parts + 1) + part[truth]
        self.inside += torch.bincount(pairs, minlength=(parts + 1) ** 2).view_as(self.inside)
        self.both += int((body & truth).sum())
        self.either += int((body | truth).sum())
        nobody = ~truth.flatten(1).any(1)
        self.empty += int(body[nobody].sum())
        self.empty_all += int(targets.seen[nobody].sum())

    def add_headings(self, person, views, depth):
        shown = (voters(views) & (depth > 0))[:, ::PERSON_STEP, ::PERSON_STEP]
        index = views.person[:, ::PERSON_STEP, ::PERSON_STEP]
        for i, p in (~views.headings.isnan()).nonzero().tolist():
            mask = shown[i] & (index[i] == p)
            if mask.sum() < LEAST_PIXELS:
                continue
            cosine, sine = person[i, 3:, mask].mean(1).tolist()
            off = math.remainder(math.atan2(sine, cosine) - float(views.headings[i, p]), 2 * math.pi)
            self.people += 1
            self.near += abs(off) < NEAR

    def add_centres(self, centres, ways):
        target, said = (x.unflatten(1, (-1, 3)) for x in (ways, centres))
        short = target.norm(dim=2) < LONG_M
        self.ways += int(short.sum())
        self.right += int((((said - target).norm(dim=2) < NEAR_M) & short).sum())

    def figures(self):
        pixels = self.inside.sum(1)
        recall = self.inside.diagonal()[pixels > 0] / pixels[pixels > 0]
        parts = float(recall.mean()) if len(recall) else 0.0
        share = lambda part, all: part / max(1, all)
        return Figures(
            parts,
            share(self.both, self.either),
            share(self.empty, self.empty_all),
            share(self.near, self.people),
            share(self.right, self.ways),
        )


@torch.no_grad()
def figures_of(network, pools, body):
    """Returns the Figures of a network in evaluation mode on all frames of pools, as they are."""
    counts = _Counts(body.classes, pools[0].depth_mm.device)
    for pool in pools:
        for begin in range(0, len(pool), AT_ONCE):
            views = pool.views(slice(begin, begin + AT_ONCE))
            depth = as_program_sees(views.depth)
            classes, person, centres = answer(network, inputs_of(depth, views.focal))
            targets = targets_of(views, depth, body)
            counts.add_pixels(classes, targets)
            counts.add_headings(person, views, depth)
            counts.add_centres(centres, targets.to_centres)
    return counts.figures()
