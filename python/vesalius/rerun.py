"""Shows people in the Rerun viewer, whose package is `rerun-sdk`.

    import rerun, vesalius, vesalius.rerun
    rerun.init("people", spawn=True)
    for frame in vesalius.open("recording.mcap"):
        vesalius.rerun.log(tracker.update(frame), frame)
"""

import numpy as _numpy
import rerun as _rerun

from . import Frame, People, Person

__all__ = ["log"]

_NOBODY = 0  # a class of its own: Rerun does not draw it


def _log_frame(frame: Frame, entity: str, recording: "_rerun.RecordingStream | None") -> None:
    camera = frame.camera
    height, width = frame.depth.shape
    at = f"{entity}/camera"
    _rerun.log(at, _rerun.Pinhole(focal_length=[camera.fx, camera.fy], principal_point=[camera.cx, camera.cy],
                                  width=width, height=height, camera_xyz=_rerun.ViewCoordinates.RDF),
               recording=recording)
    _rerun.log(f"{at}/depth", _rerun.DepthImage(frame.depth, meter=1000.0), recording=recording)
    if frame.colour is not None:
        _rerun.log(f"{at}/colour", _rerun.Image(frame.colour), recording=recording)


def _log_labels(people: People, entity: str, recording: "_rerun.RecordingStream | None") -> None:
    _rerun.log(entity, _rerun.ViewCoordinates.RDF, static=True, recording=recording)
    classes = [_rerun.AnnotationInfo(id=_NOBODY, label="nobody", color=(0, 0, 0, 0))]
    classes += [_rerun.AnnotationInfo(id=1 + i, label=name, color=colour)
                for i, (name, colour) in enumerate(zip(people.part_names, people.part_colours))]
    _rerun.log(entity, _rerun.AnnotationContext(classes), static=True, recording=recording)
    labels = people.labels.min(axis=0, initial=255)  # people share no pixels
    picture = _numpy.where(labels == 255, _NOBODY, labels + 1).astype(_numpy.uint8)
    _rerun.log(f"{entity}/camera/labels", _rerun.SegmentationImage(picture), recording=recording)


def _log_person(person: Person, people: People, joints: str, entity: str,
                recording: "_rerun.RecordingStream | None") -> None:
    parts = person.parts
    known = _numpy.all(_numpy.isfinite(parts), axis=1)
    lines = [(bone.head, bone.tail) for bone in person.bones]
    lines = lines or [(parts[a], parts[b]) for a, b in people.links if known[a] and known[b]]
    classes = 1 + _numpy.flatnonzero(known)
    _rerun.log(f"{entity}/parts", _rerun.Points3D(parts[known], class_ids=classes, radii=0.02, show_labels=False),
               recording=recording)
    _rerun.log(f"{entity}/skeleton", _rerun.LineStrips3D(lines, radii=0.01), recording=recording)
    points = person.joints(joints)
    points = points[~_numpy.isnan(points).any(axis=1)]
    _rerun.log(f"{entity}/joints", _rerun.Points3D(points, radii=0.012), recording=recording)
    if len(points):
        said = [f"{person.score:.2f}" if person.id is None else str(person.id), person.state, person.stance]
        label = ", ".join(word for word in said if word != "unknown")
        above = points[points[:, 1].argmin()] - (0, 0.25, 0)  # y is down
        _rerun.log(f"{entity}/name", _rerun.Points3D([above], radii=0.0, labels=[label]), recording=recording)


def log(people: People, frame: "Frame | None" = None, *, entity: str = "vesalius", joints: str = "k4abt32",
        recording: "_rerun.RecordingStream | None" = None) -> None:
    """Logs people, and the frame in which they were found, at its time if it has one (timeline "time").

    entity: path below which all is logged: `camera` with depth, colour and part labels, `people/ID` with parts, joints
    and a skeleton. joints: the joint set that is shown. recording: the current one of this thread without.
    People who are gone are cleared. Raises ValueError for an unknown joint set.
    """
    if frame is not None:
        if frame.time is not None:
            _rerun.set_time("time", duration=frame.time, recording=recording)
        _log_frame(frame, entity, recording)
    _log_labels(people, entity, recording)
    _rerun.log(f"{entity}/people", _rerun.Clear(recursive=True), recording=recording)
    for number, person in enumerate(people):
        who = person.id if person.id is not None else number
        _log_person(person, people, joints, f"{entity}/people/{who}", recording)
