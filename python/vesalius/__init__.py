"""People in depth pictures: 3-D body parts and joints, a part label for every pixel, a mask for each person.

    import numpy, vesalius
    detector = vesalius.Detector()
    people = detector.detect(depth, vesalius.Camera(fx=525, fy=525, cx=319.5, cy=239.5))
    print(people.joints("k4abt32"))  # (people, 32, 3) metres

Positions are metres in the camera's optical frame: x right, y down, z away.
"""

from pathlib import Path as _Path

from ._vesalius import Camera, Error, People, Person, Tracker, __version__, options
from ._vesalius import Detector as _Detector

__all__ = ["Camera", "Detector", "Error", "People", "Person", "Tracker", "options", "__version__"]

_MODEL = _Path(__file__).parent / "models" / "default.forest"


class Detector(_Detector):
    """Finds the people in one frame at a time. It may be used from several threads.

    model: path of a trained forest; the one that comes with vesalius without. threads: most threads, 0 for all.
    Everything else is an option of the detector, of tracking or of fitted bodies, listed by `vesalius.options()`:
    ``Detector(refine_min_score=0.9)``.
    """

    def __init__(self, model=None, *, threads=0, **options):
        super().__init__(str(model if model is not None else _MODEL), threads, **options)
