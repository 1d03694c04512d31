"""The counting of bench/peers/peers.py: by the rules of `vesalius evaluate` where only one person is in view (docs/metrics.md).

Masks are whole numbers with a bit for each pixel, so that nothing but Python is needed.
"""
import math
import statistics

SHARE_ON_MASK = 0.5


def lies_on(found, truth, readings):
    """Whether a found person's mask is on the true one: at least half of its pixels lie there, or it covers half of them.

    Pixels without a reading of depth do not count.
    """
    found, truth = found & readings, truth & readings
    inside = (found & truth).bit_count()
    return inside > 0 and inside >= SHARE_ON_MASK * min(found.bit_count(), truth.bit_count())


def iou(a, b, readings):
    """Intersection over union of two masks on the pixels with a reading; 0 where both are empty."""
    union = ((a | b) & readings).bit_count()
    return (a & b & readings).bit_count() / union if union else 0.0


class Counts:
    """What a detector of one person a frame did on a set of frames."""

    def __init__(self):
        self.found = self.expected = self.empty = self.empty_with_person = self.false = 0
        self.ious, self.wall_ms, self.cpu_ms = [], [], []

    def add(self, people, truth, found, readings):
        """Counts a frame.

        people: the exact number in view, or -1 for at least one. truth: the true mask, or None. found: the mask of the person
        found, or None. readings: the pixels with depth.
        """
        if people == 0:
            self.empty += 1
            self.empty_with_person += found is not None
            self.false += found is not None
            return
        self.expected += max(1, people)
        if found is None:
            return
        if truth is not None and not lies_on(found, truth, readings):
            self.false += 1
            return
        self.found += 1
        if truth is not None:
            self.ious.append(iou(found, truth, readings))

    def add_time(self, wall_ms, cpu_ms):
        self.wall_ms.append(wall_ms)
        self.cpu_ms.append(cpu_ms)

    def figures(self):
        """{name: value} under the names of `vesalius evaluate`, and times; what is not known is left out."""
        figures = {"people.found": (self.found, self.expected), "people.false": self.false,
                   "frames.empty_with_person": (self.empty_with_person, self.empty)}
        if self.ious:
            figures["mask.iou_where_found"] = statistics.mean(self.ious)
        if self.wall_ms:
            figures["ms"] = statistics.median(self.wall_ms)
            figures["cpu_ms"] = statistics.mean(self.cpu_ms)
        return figures


def across_ray_m(joint_px, landmark_px, depth_m, focal_px):
    """Distance of a joint from a landmark across the viewing ray, and its downward part, in metres at the landmark's depth."""
    right = (joint_px[0] - landmark_px[0]) * depth_m / focal_px[0]
    down = (joint_px[1] - landmark_px[1]) * depth_m / focal_px[1]
    return math.hypot(right, down), down


def markdown(header, rows):
    """A table; None is an empty cell."""
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join("" if cell is None else str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines)
