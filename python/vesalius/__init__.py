"""People in depth pictures: 3-D body parts and joints, a part label for every pixel, a mask for each person.

    import vesalius
    detector = vesalius.Detector()
    for frame in vesalius.open("recording.mcap"):
        people = detector.detect(frame)
        print(people.joints("k4abt32"))  # (people, 32, 3) metres

Positions are metres in the camera's optical frame: x right, y down, z away.
"""

import importlib as _importlib
import os as _os
from pathlib import Path as _Path


def _expect_main_interpreter() -> None:
    """What nanobind knows of classes is of one interpreter in a process: a second one would take it from the first."""
    for name in ("_interpreters", "_xxsubinterpreters"):  # of Python 3.13 and later, of those before
        try:
            interpreters = _importlib.import_module(name)
        except ImportError:
            continue
        if interpreters.get_current() != interpreters.get_main():
            raise ImportError("vesalius works in the main interpreter only; from a subinterpreter, hand frames to that one "
                              "or to another process (multiprocessing)")
        return


_expect_main_interpreter()
from . import _calls  # noqa: E402

_calls.install()
from ._vesalius import VERSION as __version__  # noqa: E402
from ._vesalius import (Bone, Camera, Error, Event, Floor, Frame, People, Person, Source, Tracker, describe_options,  # noqa: E402
                        open, options)  # noqa: A004
from ._vesalius import Detector as _Detector  # noqa: E402

__all__ = ["Bone", "Camera", "Detector", "Error", "Event", "Floor", "Frame", "People", "Person", "Source", "Tracker",
           "describe_options", "open", "options", "__version__"]

_MODEL = _Path(__file__).parent / "models" / "default.model"


class Detector(_Detector):
    __doc__ = f"""Finds the people in one frame at a time. It may be used from several threads.

    model: path of a trained forest; the one that comes with vesalius without. threads: most threads, 0 for all.
    Everything else is an option of the detector, of tracking or of fitted bodies, ``Detector(refine_min_score=0.9)``:

{describe_options()}"""

    def __init__(self, model: "str | _os.PathLike[str] | None" = None, *, threads: int = 0,
                 **options: "float | int | bool | str") -> None:
        super().__init__(_os.fspath(model if model is not None else _MODEL), threads, **options)
