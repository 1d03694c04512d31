"""Says in one line what a wrong call should have been, where nanobind would list the types that every overload takes."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, NoReturn

from . import _vesalius

_SET = 'the name of a joint set, such as "k4abt32"'
_PICTURE = "a vesalius.Frame, or depth as a numpy array with its camera: {}(depth, vesalius.Camera(fx, fy, cx, cy), colour)"
_METHODS = {
    _vesalius.Camera: {"project": "a numpy array of points (..., 3)"},
    _vesalius.Detector: {"detect": _PICTURE.format("detect"), "joint_names": _SET},
    _vesalius.Tracker: {"update": _PICTURE.format("update")},
    _vesalius.Person: {name: _SET for name in ("joints", "smoothed", "pixels", "confidences", "states", "unseen", "behind", "rotations")}
    | {"points": "the vesalius.Frame in which the person was found, or its depth as a numpy array"},
    _vesalius.People: {name: _SET for name in ("joints", "smoothed", "pixels")}
    | {"draw": "a vesalius.Frame, or a picture as a numpy array (height, width, 3) of dtype uint8",
       "__getitem__": "a whole number"},
}
_CONSTRUCTORS = {
    _vesalius.Camera: "(fx, fy, cx, cy): four numbers, in pixels",
    _vesalius.Frame: "(depth, camera, colour, time=, up=, name=, turn=): numpy arrays and a vesalius.Camera(fx, fy, cx, cy)",
    _vesalius.Tracker: "(detector): a vesalius.Detector",
    _vesalius.Detector: "(model, threads=0, ...): the path of a model and a whole number of threads",
}
_OPEN = "the path of a folder or file, or a camera such as \"realsense:\", and settings by the keywords that help(vesalius.open) has"


def _raise_wrong(name: str, expected: str, given: tuple[Any, ...], keywords: dict[str, Any]) -> NoReturn:
    said = [type(value).__name__ for value in given] + [f"{key}={type(value).__name__}" for key, value in keywords.items()]
    raise TypeError(f"{name}: expected {expected}; got ({', '.join(said)})")


def answer_plainly(function: Callable[..., Any], name: str, expected: str, is_method: bool = True) -> Callable[..., Any]:
    """Returns a function of nanobind with one line for calls that it does not take."""
    @functools.wraps(function)
    def call(*given: Any, **keywords: Any) -> Any:
        try:
            return function(*given, **keywords)
        except TypeError as error:
            if "incompatible function arguments" not in str(error):
                raise
        _raise_wrong(name, expected, given[1:] if is_method else given, keywords)

    return call


def _answer_construction(name: str, expected: str) -> Callable[..., NoReturn]:
    return lambda *given, **keywords: _raise_wrong(name, expected, given, keywords)


def install() -> None:
    for owner, methods in _METHODS.items():
        for name, expected in methods.items():
            said = owner.__name__ if name.startswith("__") else f"{owner.__name__}.{name}"
            setattr(owner, name, answer_plainly(getattr(owner, name), said, expected))
    for owner, expected in _CONSTRUCTORS.items():
        answer = getattr(_vesalius, "_answer_wrong_construction")  # noqa: B009  (no part of the stub)
        answer(owner, _answer_construction(owner.__name__, f"{owner.__name__}{expected}"))
    setattr(_vesalius, "open", answer_plainly(_vesalius.open, "open", _OPEN, is_method=False))
