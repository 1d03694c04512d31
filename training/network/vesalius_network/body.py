"""Body models (docs/formats.md): all that learning asks about parts, which are numbered in the order of their file."""

import tomllib
from dataclasses import dataclass

import numpy as np

from .errors import InputError

# Bones whose surface is the trunk. The middle of a person is the mean of the parts on them.
TRUNK_BONES = {"pelvis", "spine", "chest"}
LEAST_ACROSS_M = 0.1
# Smallest share of the viewing direction across the body's axis that tells a heading: about 17 degrees off it.
LEAST_SEEN = 0.3


@dataclass(frozen=True)
class Body:
    """A body model. The arrays have an element for each part."""

    text: str  # the TOML
    names: tuple
    mirror: np.ndarray  # index of the partner on the other side
    upper: np.ndarray  # whether it is above the pelvis
    left: np.ndarray  # whether it is on the person's left side
    trunk: np.ndarray  # whether it counts for the person's middle

    @property
    def parts(self):
        return len(self.names)

    @property
    def classes(self):
        """Parts, then the background."""
        return self.parts + 1


def read_body(text, place):
    """Returns the body model of a TOML text. `place` is the file, for errors."""
    try:
        model = tomllib.loads(text)
        names = [part["name"] for part in model["part"]]
        mirror = np.array([names.index(part["mirror"]) for part in model["part"]])
        upper = np.array([part["upper_body"] for part in model["part"]], bool)
    except (tomllib.TOMLDecodeError, KeyError, ValueError) as error:
        raise InputError(f"{place}: no body model: {error}") from error
    on_trunk = {rule["part"] for rule in model.get("surface", []) if rule["bone"] in TRUNK_BONES}
    trunk = np.array([name in on_trunk for name in names])
    if not trunk.any():
        trunk[:] = True
    left = np.array([name.startswith("l_") for name in names])
    return Body(text, tuple(names), mirror, upper, left, trunk)


def _mean_known(points):
    """Mean of points [n, k, 3] over k, of those that are known; NaN where none is."""
    known = ~np.isnan(points).any(-1, keepdims=True)
    count = known.sum(1)
    total = np.where(known, points, 0).sum(1)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def middles_of(centres, body):
    """Returns the middles [..., 3] of people whose parts' centres are [..., parts, 3], m; NaN = not known."""
    flat = centres.reshape(-1, body.parts, 3)
    return _mean_known(flat[:, body.trunk]).reshape(*centres.shape[:-2], 3).astype(np.float32)


def headings_of(centres, body):
    """Returns which way people are turned about their own axis, as vesalius::body_yaw does: 0 faces the camera,
    positive is turned to the own left. `centres` [..., parts, 3] in m, optical frame; NaN = not known. Returns [...] rad, NaN
    where nothing tells it."""
    flat = centres.reshape(-1, body.parts, 3).astype(np.float64)
    up = _mean_known(flat[:, body.upper]) - _mean_known(flat[:, ~body.upper])
    length = np.linalg.norm(up, axis=1, keepdims=True)
    up = np.where(length >= LEAST_ACROSS_M, up / np.maximum(length, LEAST_ACROSS_M), np.array([0.0, -1.0, 0.0]))
    across = _mean_known(flat[:, body.left] - flat[:, body.mirror[body.left]])
    left = across - (across * up).sum(1, keepdims=True) * up
    width = np.linalg.norm(left, axis=1, keepdims=True)
    left = left / np.maximum(width, LEAST_ACROSS_M)
    middle = _mean_known(flat)
    to_camera = -middle / np.maximum(np.linalg.norm(middle, axis=1, keepdims=True), 1e-6)
    ahead = (to_camera * np.cross(left, up)).sum(1)
    aside = (to_camera * left).sum(1)
    told = (width[:, 0] >= LEAST_ACROSS_M) & (np.hypot(ahead, aside) >= LEAST_SEEN)
    return np.where(told, np.arctan2(-aside, ahead), np.nan).reshape(centres.shape[:-2]).astype(np.float32)
